//! What of the light of each wavelength passes a stretch of a medium.

use super::encounter::Start;
use super::stretch::{Stretch, stretches};
use crate::math::random::{Purpose, Stream};
use crate::scene::Scene;
use crate::scene::geometry::Ray;
use crate::scene::medium::{Medium, Transmittance};
use crate::spectrum::Spectrum;
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// The transmittance of one stretch as a function of wavelength.
#[derive(Debug, Clone, Copy)]
pub enum Passage<'a> {
    /// Of a body of clear glass or liquid.
    Clear {
        /// Its absorption in 1/m.
        absorption: &'a Spectrum,
        /// The way through it in m.
        length_m: f64,
    },
    /// By Beer's law, from the column density.
    Column {
        /// The medium.
        medium: &'a Medium,
        /// Its column density in m.
        column_m: f64,
        /// By how much steps along the way overrate it.
        excess_m: f64,
    },
    /// By ratio tracking (Novák, Selle & Jarosz 2014): unbiased at every wavelength, the same random places for all of them.
    Tracked {
        /// The medium.
        medium: &'a Medium,
        /// Along which way.
        ray: Ray,
        /// How far, in m.
        length_m: f64,
        /// The seed of the places.
        seed: u64,
    },
}

/// All stretches of a way; ways through more than a few media are rare.
pub type Passages<'a> = SmallVec<[Passage<'a>; 3]>;

impl<'a> Passage<'a> {
    /// The passage through `medium` along the ray's first `length_m`; `seed` is for tracking alone.
    pub fn new(medium: &'a Medium, ray: Ray, length_m: f64, seed: u64) -> Self {
        match medium.transmittance {
            Transmittance::Exact => Self::Column { medium, column_m: medium.column_m(&ray, length_m), excess_m: 0.0 },
            Transmittance::March { steps } => {
                let column_m = medium.column_by_steps(&ray, length_m, steps);
                Self::Column { medium, column_m, excess_m: column_m - medium.column_m(&ray, length_m) }
            }
            Transmittance::Ratio => Self::Tracked { medium, ray, length_m, seed },
        }
    }

    /// The transmittance at a wavelength.
    pub fn at(&self, nm: f64) -> f64 {
        match *self {
            Self::Clear { absorption, length_m } => {
                let coefficient = absorption.at(nm);
                if coefficient > 0.0 { (-coefficient * length_m).exp() } else { 1.0 }
            }
            Self::Column { medium, column_m, .. } => (-medium.optical_depth(nm, column_m)).exp(),
            Self::Tracked { medium, ray, length_m, seed } => {
                ratio_tracked(medium, &ray, length_m, medium.extinction.at(nm), seed)
            }
        }
    }
}

/// By how much steps through media overrate the optical depth of the whole way at a wavelength.
#[inline]
pub fn excess_depth(passages: &[Passage<'_>], nm: f64) -> f64 {
    let of_one = |passage: &Passage<'_>| match *passage {
        Passage::Column { medium, excess_m, .. } => excess_m.signum() * medium.optical_depth(nm, excess_m.abs()),
        Passage::Clear { .. } | Passage::Tracked { .. } => 0.0,
    };
    passages.iter().map(of_one).sum()
}

/// The bias, relative to itself, of light that came a way whose optical depth is overrated by so much: e^−(τ + δ) stands for e^−τ.
#[inline]
pub fn bias_of_excess(depth: f64) -> f64 {
    if depth == 0.0 { 0.0 } else { -depth.exp_m1() }
}

/// The transmittance of the whole way at a wavelength.
#[inline]
pub fn product(passages: &[Passage<'_>], nm: f64) -> f64 {
    passages.iter().map(|passage| passage.at(nm)).product()
}

impl<'a> Stretch<'a> {
    /// The passages along its first `length_m`; `seed` is for tracking alone.
    pub fn passages(&self, length_m: f64, seed: u64) -> Passages<'a> {
        self.passages_by(length_m, |medium| Passage::new(medium, self.ray, length_m, seed))
    }

    /// The same by ratio tracking, for the reference path tracer, which trusts no column density.
    pub fn passages_tracked(&self, length_m: f64, seed: u64) -> Passages<'a> {
        self.passages_by(length_m, |medium| Passage::Tracked { medium, ray: self.ray, length_m, seed })
    }

    fn passages_by(&self, length_m: f64, through: impl FnOnce(&'a Medium) -> Passage<'a>) -> Passages<'a> {
        let clear = self.absorption.map(|absorption| Passage::Clear { absorption, length_m });
        let filled = self.medium.map(|(_, medium)| through(medium));
        clear.into_iter().chain(filled).collect()
    }
}

/// The passages along the first `length_m` of a ray on which no surface stands.
pub fn passages<'a>(scene: &'a Scene, start: Start, length_m: f64, seed: u64) -> Passages<'a> {
    all_along(scene, start, length_m, |stretch| stretch.passages(stretch.length_m, seed))
}

/// The same by ratio tracking.
pub fn passages_tracked<'a>(scene: &'a Scene, start: Start, length_m: f64, seed: u64) -> Passages<'a> {
    all_along(scene, start, length_m, |stretch| stretch.passages_tracked(stretch.length_m, seed))
}

fn all_along<'a>(
    scene: &'a Scene,
    start: Start,
    length_m: f64,
    of: impl Fn(&Stretch<'a>) -> Passages<'a>,
) -> Passages<'a> {
    let mut passages = Passages::new();
    let mut add = |stretch: &Stretch<'a>| {
        passages.extend(of(stretch));
        ControlFlow::Continue(())
    };
    let _end = stretches(scene, start, length_m, &mut add);
    passages
}

/// Π (1 − σ_t ρ(x_j)/σ̄) over places x_j that a Poisson process of rate σ̄ draws, with σ̄ the largest extinction of all wavelengths.
fn ratio_tracked(medium: &Medium, ray: &Ray, length_m: f64, sigma_t: f64, seed: u64) -> f64 {
    let Some((begin, end)) = medium.window(ray, length_m) else {
        return 1.0;
    };
    let bound = medium.majorant(ray, length_m);
    let rate = medium.largest_extinction() * bound;
    if rate <= 0.0 {
        return 1.0;
    }
    let mut stream = Stream::new(seed, Purpose::Camera, 0, 0);
    let (mut t, mut transmittance) = (begin, 1.0);
    loop {
        t -= (-stream.uniform()).ln_1p() / rate;
        if t >= end || transmittance <= 0.0 {
            return transmittance;
        }
        transmittance *= 1.0 - sigma_t * medium.density_at(ray.at(t)) / rate;
    }
}
