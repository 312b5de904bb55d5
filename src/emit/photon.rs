//! One photon's life.

use super::aim::Aim;
use super::drift::{Collision, Crossing, drift};
use crate::math::distribution::Discrete;
use crate::math::random::{Purpose, Stream, hash64};
use crate::math::sobol::Sobol;
use crate::optics::surface::{Class, Transport};
use crate::plan::BetweenPlan;
use crate::plan::partition::LightPath;
use crate::scene::Scene;
use crate::scene::geometry::Ray;
use crate::scene::interior::Interior;
use crate::scene::light::{Emission, EmissionNumbers, Light};
use crate::spectrum::{LANES, Lanes, Wavelengths};
use crate::walk::ledger::Ledger;
use crate::walk::{Encounter, Scattered, Start, next, next_in_air, scatter, scatter_together};
use glam::DVec3;
use std::ops::Range;

/// Which wavelengths the photons of a set carry.
#[derive(Debug, Clone, Copy)]
pub enum Wavelengthed {
    /// Each photon draws its own from its light's power and the eye's sensitivity.
    Free,
    /// All carry the pass's shared wavelengths (nm), drawn with these densities (per nm).
    Shared {
        /// The wavelengths.
        nm: Lanes,
        /// Their densities.
        pdf: Lanes,
    },
}

/// A photon set's common ground: who emits, how many, on which wavelengths.
#[derive(Debug)]
pub struct Emitters<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Draws the light.
    pub choice: &'a Discrete,
    /// Where each light aims.
    pub aims: &'a [Aim],
    /// Which wavelengths.
    pub wavelengths: Wavelengthed,
    /// How many photon paths the set has.
    pub count: u64,
    /// Surface events a path may have.
    pub max_depth: u32,
    /// The render's seed.
    pub seed: u64,
    /// The purpose of the set's random streams.
    pub purpose: Purpose,
    /// The pass.
    pub pass: u64,
    /// What happens between surfaces.
    pub between: BetweenPlan,
}

/// A photon where it meets a surface.
#[derive(Debug)]
pub struct Arrival<'a> {
    /// The surface.
    pub encounter: &'a Encounter<'a>,
    /// What happened to it before.
    pub path: LightPath,
    /// Its wavelengths.
    pub wavelengths: &'a Wavelengths,
    /// Power per wavelength: W for free photons, W/nm for shared ones.
    pub power: &'a Lanes,
    /// Which of the set's shared wavelengths a single wavelength is.
    pub lane: usize,
}

/// Takes photons where they meet surfaces and where they cross media.
pub trait Receiver {
    /// A photon has come to a diffuse or glossy surface, by way of others.
    fn arrive(&mut self, arrival: &Arrival<'_>, stream: &mut Stream);

    /// A photon has come to the face of a body.
    fn meet_body(&mut self) {}

    /// A photon sets out through a medium.
    fn cross(&mut self, _crossing: &Crossing<'_>, _stream: &mut Stream) {}

    /// A photon has met a particle of a medium.
    fn collide(&mut self, _collision: &Collision, _stream: &mut Stream) {}

    /// A photon path starts at this aiming pair of its light.
    fn depart(&mut self, light: usize, aim: [f64; 2]);
}

impl Emitters<'_> {
    /// The wavelengths of a photon from this light, and S(λ)/p(λ) for each: the power per lane of one watt.
    #[inline(always)]
    fn draw_wavelengths(&self, light: &Light, emission: &Emission, u: f64) -> (Wavelengths, Lanes) {
        match self.wavelengths {
            Wavelengthed::Free => {
                let mut nm = [0.0; LANES];
                let mut share = [0.0; LANES];
                for k in 0..LANES {
                    let (drawn, pdf) = light.wavelengths.sample((u + k as f64) / LANES as f64);
                    nm[k] = drawn;
                    share[k] = light.shape_at(emission.tint, drawn) / (pdf * LANES as f64);
                }
                (Wavelengths::new(nm), share)
            }
            Wavelengthed::Shared { nm, .. } => (Wavelengths::new(nm), nm.map(|nm| light.shape_at(emission.tint, nm))),
        }
    }

    /// What one unit of a lane's power means in W, for the ledger.
    #[inline]
    fn watts(&self) -> Lanes {
        match self.wavelengths {
            Wavelengthed::Free => [1.0; LANES],
            Wavelengthed::Shared { pdf, .. } => pdf.map(|pdf| if pdf > 0.0 { 1.0 / (pdf * LANES as f64) } else { 0.0 }),
        }
    }

    /// The set's low-discrepancy points; a pass's points are scrambled apart from every other pass's.
    pub fn points(&self) -> Sobol {
        Sobol::new(hash64([self.seed, self.purpose as u64, self.pass]))
    }
}

/// A photon under way.
pub(super) struct Flight {
    pub(super) start: Start,
    pub(super) wavelengths: Wavelengths,
    pub(super) power: Lanes,
    pub(super) watts: Lanes,
    pub(super) lane: usize,
    pub(super) path: LightPath,
}

impl Flight {
    #[inline]
    pub(super) fn total_w(&self) -> f64 {
        // Lanes that are not in use hold no power.
        (0..LANES).map(|k| self.power[k] * self.watts[k]).sum()
    }
}

/// Emits the photons of the set with these numbers and follows each to its end.
pub fn trace<R: Receiver>(
    emitters: &Emitters<'_>,
    points: &Sobol,
    indices: Range<u64>,
    receiver: &mut R,
    ledger: &mut Ledger,
) {
    match emitters.between {
        BetweenPlan::Air => {
            indices.for_each(|index| trace_one::<false, R>(emitters, points, index, receiver, ledger));
        }
        BetweenPlan::Clear | BetweenPlan::Absorbing | BetweenPlan::Scattering(_) => {
            indices.for_each(|index| trace_one::<true, R>(emitters, points, index, receiver, ledger));
        }
    }
}

/// One photon's life. Without `BODIES` nothing has an inside: there is air on both sides of every surface, and photons keep all their wavelengths.
#[inline(always)]
fn trace_one<const BODIES: bool, R: Receiver>(
    emitters: &Emitters<'_>,
    points: &Sobol,
    index: u64,
    receiver: &mut R,
    ledger: &mut Ledger,
) {
    let mut stream = Stream::new(emitters.seed, emitters.purpose, emitters.pass, index);
    let mut flight = emit::<BODIES, R>(emitters, points, index as u32, receiver);
    ledger.emitted += flight.total_w();
    let scene = emitters.scene;
    for _ in 0..emitters.max_depth {
        let met = fly::<BODIES, R>(emitters, &mut flight, (&mut stream, &mut *receiver), ledger);
        let Some(encounter) = &met else {
            return;
        };
        if BODIES && scene.body_of(encounter.hit.object).is_some() {
            receiver.meet_body();
        }
        if encounter.crossed_hidden && flight.path == LightPath::Direct {
            flight.path = LightPath::Caustic;
        }
        // Offered whichever component of a mix the photon drew: camera paths draw theirs anew. What comes straight from a lamp they ask lamps for.
        if flight.path != LightPath::Direct && scene.materials[encounter.material].surface.class() >= Class::Glossy {
            let (wavelengths, power) = (&flight.wavelengths, &flight.power);
            let arrival = Arrival { encounter, path: flight.path, wavelengths, power, lane: flight.lane };
            receiver.arrive(&arrival, &mut stream);
        }
        let scattered = match BODIES {
            true => scatter(encounter, &flight.wavelengths, Transport::Importance, &mut stream),
            false => {
                let all = Wavelengths::new(flight.wavelengths.nm);
                scatter_together(encounter, &all, Transport::Importance, &mut stream)
            }
        };
        let Some(scattered) = scattered else {
            ledger.absorbed[encounter.material] += flight.total_w();
            return;
        };
        if !go_on::<BODIES>(&mut flight, encounter, &scattered, ledger, &mut stream) {
            return;
        }
    }
    ledger.depth_limit += flight.total_w();
}

#[inline(always)]
fn emit<const BODIES: bool, R: Receiver>(
    emitters: &Emitters<'_>,
    points: &Sobol,
    index: u32,
    receiver: &mut R,
) -> Flight {
    let u = points.point(index);
    let mut which = u[1];
    let number = emitters.choice.sample(&mut which);
    let light = &emitters.scene.lights[number];
    let (aim, density) = emitters.aims[number].draw([u[2], u[3]]);
    receiver.depart(number, aim);
    let emission = light.emit(emitters.scene.world(), EmissionNumbers { aim, rest: [u[4], u[5], u[6]] });
    let (wavelengths, share) = emitters.draw_wavelengths(light, &emission, u[0]);
    let flux = emission.flux_w / (emitters.count as f64 * emitters.choice.probability(number) * density);
    Flight {
        start: Start {
            ray: Ray { origin: emission.origin, direction: emission.direction },
            from: emission.from,
            interior: if BODIES { light.interior } else { Interior::AIR },
        },
        wavelengths,
        power: share.map(|s| s * flux),
        watts: emitters.watts(),
        lane: LANES,
        path: LightPath::Direct,
    }
}

/// Follows the photon to the next surface; `None` where it ends before.
#[inline(always)]
fn fly<'a, const BODIES: bool, R: Receiver>(
    emitters: &Emitters<'a>,
    flight: &mut Flight,
    (stream, receiver): (&mut Stream, &mut R),
    ledger: &mut Ledger,
) -> Option<Encounter<'a>> {
    if BODIES && !emitters.between.is_clear() {
        return drift(emitters.scene, flight, (stream, receiver), ledger);
    }
    let component = stream.uniform();
    let encounter = match BODIES {
        true => next(emitters.scene, flight.start, component),
        false => next_in_air(emitters.scene, flight.start, component),
    };
    if encounter.is_none() {
        ledger.escaped += flight.total_w();
    }
    encounter
}

/// Applies a scattering event and Russian roulette; false where the photon ends.
#[inline(always)]
fn go_on<const BODIES: bool>(
    flight: &mut Flight,
    encounter: &Encounter<'_>,
    scattered: &Scattered,
    ledger: &mut Ledger,
    stream: &mut Stream,
) -> bool {
    let before = flight.total_w();
    let correction =
        if scattered.delta { 1.0 } else { encounter.adjoint_correction(-encounter.incoming, scattered.direction) };
    let mut absorbed = 0.0;
    // Roulette keeps the photons' powers alike: a photon survives with the mean of its lanes' weights.
    let (mut weights, count) = (0.0, if BODIES { flight.wavelengths.count } else { LANES });
    for k in 0..count {
        absorbed += flight.power[k] * flight.watts[k] * scattered.absorbed[k];
        flight.power[k] *= scattered.weight[k] * correction;
        weights += scattered.weight[k] * correction;
    }
    if let Some(kept) = scattered.kept {
        flight.keep(kept);
    }
    ledger.absorbed[encounter.material] += absorbed;
    let survival = (weights / count as f64).min(1.0);
    let survives = survival > 0.0 && stream.uniform() < survival;
    if survives {
        flight.power.iter_mut().for_each(|power| *power /= survival);
    } else {
        flight.power = [0.0; LANES];
    }
    ledger.sampling += flight.total_w() + absorbed - before;
    flight.start = match BODIES {
        true => encounter.after(scattered),
        false => encounter.leave(scattered.direction, Interior::AIR),
    };
    flight.path = match (flight.path, scattered.delta) {
        (LightPath::Indirect, _) | (_, false) => LightPath::Indirect,
        (LightPath::Direct | LightPath::Caustic, true) => LightPath::Caustic,
    };
    survives
}

impl Flight {
    /// Gives up all wavelengths but one.
    fn keep(&mut self, kept: usize) {
        self.lane = kept;
        self.wavelengths = Wavelengths::single(self.wavelengths.nm[kept]);
        let only = |lanes: Lanes| std::array::from_fn(|k| if k == 0 { lanes[kept] } else { 0.0 });
        self.power = only(self.power);
        self.watts = only(self.watts);
    }
}

impl Arrival<'_> {
    /// The direction back towards where the photon came from, unit.
    #[inline]
    pub fn to_light(&self) -> DVec3 {
        -self.encounter.incoming
    }
}
