//! Transmittance of media, as a function of wavelength.

use super::medium_segment::{MediumSegment, for_each_segment};
use super::polarising_pane::PolarisingPane;
use super::ray_state::RayState;
use abbe_optics::bsdf::{PowerFractions, ThinDielectric};
use abbe_optics::glass::RefractiveIndex;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::medium::{Medium, TransmittanceEstimator};
use abbe_spectra::math::elementary::{exp, exp_m1, ln_1p};
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::spectrum::Spectrum;
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// The transmittance of one segment as a function of wavelength.
#[derive(Debug, Clone, Copy)]
pub enum SegmentTransmittance<'a> {
    /// Beer's law in clear glass or liquid.
    Clear {
        /// The absorption coefficient in 1/m.
        absorption: &'a Spectrum,
        length_m: f64,
    },
    /// Beer's law from the column density of a medium.
    Column {
        medium: &'a Medium,
        /// The column density: the integral of the relative density, in m.
        column_m: f64,
        /// The error of ray marching in the column density (estimate minus exact), in m.
        excess_m: f64,
    },
    /// Ratio tracking (Novák, Selle & Jarosz 2014, "Residual Ratio Tracking for Estimating
    /// Attenuation in Participating Media"): unbiased at every wavelength, with the same random
    /// positions for all.
    Tracked { medium: &'a Medium, ray: Ray, length_m: f64, seed: Seed },
    /// A thin pane that the path crosses in a straight line.
    Pane {
        pane: &'a ThinDielectric,
        /// The cosine of the angle of incidence.
        cosine: f64,
        outside: &'a RefractiveIndex,
        /// What the pane does to polarised light. `None` unless the plan contains polarisation.
        polarising: Option<PolarisingPane>,
    },
}

/// The transmittances of the segments along a path. Paths with more than three segments are rare.
pub type PathTransmittance<'a> = SmallVec<[SegmentTransmittance<'a>; 3]>;

impl<'a> SegmentTransmittance<'a> {
    /// Takes the first `length_m` metres of the ray in `medium`, which determines the method. Only
    /// ratio tracking uses `seed`.
    pub fn new(medium: &'a Medium, ray: Ray, length_m: f64, seed: Seed) -> Self {
        match medium.transmittance {
            TransmittanceEstimator::Exact => {
                Self::Column { medium, column_m: medium.column_m(&ray, length_m), excess_m: 0.0 }
            }
            TransmittanceEstimator::March { steps } => {
                let column_m = medium.column_by_steps(&ray, length_m, steps);
                Self::Column { medium, column_m, excess_m: column_m - medium.column_m(&ray, length_m) }
            }
            TransmittanceEstimator::Ratio => Self::Tracked { medium, ray, length_m, seed },
        }
    }

    pub fn at(&self, nm: f64) -> f64 {
        match *self {
            Self::Clear { absorption, length_m } => {
                let coefficient = absorption.at(nm);
                if coefficient > 0.0 { exp(-coefficient * length_m) } else { 1.0 }
            }
            Self::Column { medium, column_m, .. } => exp(-medium.optical_depth(nm, column_m)),
            Self::Tracked { medium, ray, length_m, seed } => {
                ratio_tracked(medium, &ray, length_m, medium.extinction.at(nm), seed)
            }
            Self::Pane { pane, cosine, outside, .. } => pane.transmittance(cosine, outside, nm),
        }
    }
}

/// Returns the error (estimate minus exact) of ray marching in the path's optical depth.
#[inline]
pub fn excess_optical_depth(path_transmittance: &[SegmentTransmittance<'_>], nm: f64) -> f64 {
    let of_segment = |segment: &SegmentTransmittance<'_>| match *segment {
        SegmentTransmittance::Column { medium, excess_m, .. } => {
            excess_m.signum() * medium.optical_depth(nm, excess_m.abs())
        }
        SegmentTransmittance::Clear { .. }
        | SegmentTransmittance::Tracked { .. }
        | SegmentTransmittance::Pane { .. } => 0.0,
    };
    path_transmittance.iter().map(of_segment).sum()
}

/// Returns the bias of a transmittance relative to the estimate, for the error δ of the optical
/// depth τ: the estimate is e^−(τ + δ) and the exact value e^−τ, so the bias is 1 − e^δ.
#[inline]
pub fn bias_of_excess(excess: f64) -> f64 {
    if excess == 0.0 { 0.0 } else { -exp_m1(excess) }
}

/// Returns true if a path crosses more than `most` panes.
#[inline]
pub fn crosses_more_panes(path_transmittance: &[SegmentTransmittance<'_>], most: u32) -> bool {
    let is_pane = |segment: &&SegmentTransmittance<'_>| matches!(segment, SegmentTransmittance::Pane { .. });
    (most as usize) < path_transmittance.len() && path_transmittance.iter().filter(is_pane).count() > most as usize
}

/// Returns the light that is reflected back and forth between the panes on a straight line,
/// relative to the light that passes straight, for parallel panes. No shadow ray finds it.
pub fn light_between_panes(path_transmittance: &[SegmentTransmittance<'_>], nm: f64) -> f64 {
    let (mut stack, mut straight) = (PowerFractions { reflected: 0.0, transmitted: 1.0 }, 1.0);
    for segment in path_transmittance {
        let SegmentTransmittance::Pane { pane, cosine, outside, .. } = segment else { continue };
        let next = pane.plain_powers(*cosine, outside, nm);
        let series = 1.0 / (1.0 - stack.reflected * next.reflected);
        stack = PowerFractions {
            reflected: next.reflected + next.transmitted * next.transmitted * stack.reflected * series,
            transmitted: stack.transmitted * next.transmitted * series,
        };
        straight *= next.transmitted;
    }
    if straight > 0.0 { stack.transmitted / straight - 1.0 } else { 0.0 }
}

/// Returns the transmittance of the whole path at the wavelength `nm`.
#[inline]
pub fn transmittance(path_transmittance: &[SegmentTransmittance<'_>], nm: f64) -> f64 {
    path_transmittance.iter().map(|segment| segment.at(nm)).product()
}

impl<'a> MediumSegment<'a> {
    /// Returns the transmittances along `length_m` metres. Only ratio tracking uses `seed`.
    pub fn path_transmittance(&self, length_m: f64, seed: Seed) -> PathTransmittance<'a> {
        self.transmittance_by(length_m, |medium| SegmentTransmittance::new(medium, self.ray, length_m, seed))
    }

    /// Returns them by ratio tracking, for the path tracer, which needs no column densities.
    pub fn path_transmittance_tracked(&self, length_m: f64, seed: Seed) -> PathTransmittance<'a> {
        self.transmittance_by(length_m, |medium| SegmentTransmittance::Tracked {
            medium,
            ray: self.ray,
            length_m,
            seed,
        })
    }

    fn transmittance_by(
        &self,
        length_m: f64,
        of_medium: impl FnOnce(&'a Medium) -> SegmentTransmittance<'a>,
    ) -> PathTransmittance<'a> {
        let clear = self.absorption.map(|absorption| SegmentTransmittance::Clear { absorption, length_m });
        let filled = self.medium.map(|filling| of_medium(filling.medium));
        clear.into_iter().chain(filled).collect()
    }
}

/// Returns the transmittances along the first `length_m` metres of a ray, which no surface may
/// interrupt. Only ratio tracking uses `seed`.
pub fn path_transmittance<'a>(
    scene: &'a Scene,
    ray_state: RayState,
    length_m: f64,
    seed: Seed,
) -> PathTransmittance<'a> {
    collect_segments(scene, ray_state, length_m, seed, MediumSegment::path_transmittance)
}

/// Does the same as [`path_transmittance`], but uses ratio tracking in all media.
pub fn path_transmittance_tracked<'a>(
    scene: &'a Scene,
    ray_state: RayState,
    length_m: f64,
    seed: Seed,
) -> PathTransmittance<'a> {
    collect_segments(scene, ray_state, length_m, seed, MediumSegment::path_transmittance_tracked)
}

/// Collects the transmittances of all segments. Each segment has its own seed: with equal random
/// positions, the estimates of two segments would be correlated, and their product too large on
/// average.
fn collect_segments<'a>(
    scene: &'a Scene,
    ray_state: RayState,
    length_m: f64,
    seed: Seed,
    of_segment: impl Fn(&MediumSegment<'a>, f64, Seed) -> PathTransmittance<'a>,
) -> PathTransmittance<'a> {
    let mut path_transmittance = PathTransmittance::new();
    let mut number = 0;
    let mut add = |segment: &MediumSegment<'a>| {
        path_transmittance.extend(of_segment(segment, segment.length_m, seed.part(number)));
        number += 1;
        ControlFlow::Continue(())
    };
    let _end = for_each_segment(scene, ray_state, length_m, &mut add);
    path_transmittance
}

/// Estimates the transmittance as the product of 1 − σ_t ρ(x_j)/σ̄ over the positions x_j of a
/// Poisson process along the ray. Its rate σ̄ is the largest extinction coefficient over the band
/// times the upper bound of the density.
fn ratio_tracked(medium: &Medium, ray: &Ray, length_m: f64, sigma_t: f64, seed: Seed) -> f64 {
    let Some((begin, end)) = medium.interval(ray, length_m) else { return 1.0 };
    let bound = medium.majorant(ray, length_m);
    let rate = medium.largest_extinction() * bound;
    if rate <= 0.0 {
        return 1.0;
    }
    let mut stream = Stream::new(seed, Purpose::RatioTracking, 0, 0);
    let (mut t, mut transmittance) = (begin, 1.0);
    loop {
        t -= ln_1p(-stream.uniform()) / rate;
        if t >= end || transmittance <= 0.0 {
            return transmittance;
        }
        transmittance *= 1.0 - sigma_t * medium.density_at(ray.at(t)) / rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_format::{self as format, resolve::resolve};
    use abbe_scene::medium_stack::MediumStack;
    use glam::DVec3;

    /// The mean of the tracked transmittance through two fogs is the product of both.
    #[test]
    fn tracking_is_unbiased_across_several_bodies() {
        let text = r#"{
  "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "media": {"fog": {"homogeneous": {"absorption": 1, "scattering": 0, "phase": "isotropic"}}},
  "materials": {"fog": {"boundary": {"medium": "fog"}}},
  "objects": [{"shape": {"box": {"size": [1, 1, 1]}}, "material": "fog"},
    {"shape": {"box": {"size": [1, 1, 1]}}, "material": "fog", "transform": [{"translate": [2, 0, 0]}]}],
  "lights": [{"point": {"at": [3, 3, 3], "spectrum": "E", "power": 1}}]
}"#;
        let (written, source) = format::parse(text, "fog.json".as_ref(), &[]).unwrap();
        let scene = resolve(&written, &source).unwrap();
        let ray = Ray::new(DVec3::new(-4.0, 0.1, 0.2) - scene.centre, DVec3::X);
        let ray_state = RayState { ray, from: None, medium_stack: MediumStack::AIR };
        let of_seed =
            |seed| transmittance(&path_transmittance_tracked(&scene, ray_state, 10.0, Seed::new(seed)), 550.0);
        let mean = (0..10_000).map(of_seed).sum::<f64>() / 10_000.0;
        let exact = (-2.0_f64).exp();
        assert!((mean / exact - 1.0).abs() < 0.08, "{mean} for {exact}");
        assert!(
            (transmittance(&path_transmittance(&scene, ray_state, 10.0, Seed::new(0)), 550.0) / exact - 1.0).abs()
                < 1e-9
        );
    }
}
