//! Light straight from the lamps: shadow rays, and scattered rays that find a lamp by themselves, weighted by multiple importance
//! sampling (Veach & Guibas 1995, power heuristic).

use crate::math::distribution::Discrete;
use crate::math::random::hash64;
use crate::optics::surface::Transport;
use crate::plan::BetweenPlan;
use crate::scene::Scene;
use crate::scene::geometry::{Hit, Ray};
use crate::scene::light::{Incident, Light, Tint};
use crate::scene::medium::Medium;
use crate::walk::{Encounter, Passages, Start, Tally, passages, passages_tracked};
use glam::DVec3;
use std::ops::Range;

/// At most this many lamps are all asked at every point; of more, one is drawn.
const ASK_ALL: usize = 8;

/// Which lamps a point asks for light.
#[derive(Debug)]
pub struct Direct<'a> {
    scene: &'a Scene,
    choice: &'a Discrete,
    weakening: Weakening,
}

/// How the light is weakened on the way of shadow rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Weakening {
    /// Not at all: nothing in the scene absorbs or scatters on the way.
    Absent,
    /// As each medium states.
    AsStated,
    /// By ratio tracking in all media.
    Tracked,
}

/// A point that asks for light.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asking<'e, 'a> {
    pub(super) encounter: &'e Encounter<'a>,
    /// The wavelength at which the path's directions are drawn; densities of scattering are taken there.
    pub(super) nm: f64,
    /// Draws the lamp and the place on it.
    pub(super) u: [f64; 3],
}

/// A point inside a medium that asks for light.
#[derive(Debug, Clone, Copy)]
pub(super) struct AskingInside<'a> {
    /// The point, and the bodies around it.
    pub(super) start: Start,
    pub(super) medium: &'a Medium,
    /// The wavelength at which directions would be drawn, where scattered rays look for lamps too.
    pub(super) scattered_nm: Option<f64>,
    pub(super) u: [f64; 3],
}

/// Light that reaches a point straight from a lamp.
pub(super) struct Lit<'a> {
    pub(super) light: &'a Light,
    /// Towards the lamp, unit, in the encounter's frame.
    pub(super) wi: DVec3,
    /// What the reflected radiance at a wavelength is: this × S(λ) × f(λ); cosine, density and the weight of multiple importance
    /// sampling are in it.
    pub(super) strength: f64,
    pub(super) tint: Tint,
    /// Towards the lamp, unit, in the world.
    pub(super) direction: DVec3,
    /// How far it is, in m.
    pub(super) distance: f64,
}

/// Light that reaches a point inside a medium straight from a lamp.
pub(super) struct LitInside<'a> {
    pub(super) light: &'a Light,
    /// The way of the light there, unit, in the world.
    pub(super) incoming: DVec3,
    /// What the scattered radiance at a wavelength is: this × S(λ) × σ_s(λ) × p(cos θ, λ).
    pub(super) strength: f64,
    pub(super) tint: Tint,
    /// What passes on the way.
    pub(super) through: Passages<'a>,
}

/// A lamp found where a ray ends.
pub(super) struct Found<'a> {
    pub(super) light: &'a Light,
    /// Radiance over the band, W/m²/sr, times the weight of multiple importance sampling.
    pub(super) radiance: f64,
    pub(super) tint: Tint,
}

/// How the light that a ray finds counts, given where the ray comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Counts {
    /// Fully: no surface before could have asked this lamp.
    Fully,
    /// Shared with the shadow rays of the surface at `place`, from which the ray was drawn with this density per steradian.
    Shared { place: DVec3, pdf: f64 },
    /// Not at all: another estimator counts it.
    Not,
}

impl<'a> Direct<'a> {
    /// The lamps of a scene, how one of many is drawn, and what stands between them and what they light.
    pub fn new(scene: &'a Scene, choice: &'a Discrete, between: BetweenPlan) -> Self {
        Self { scene, choice, weakening: if between.is_clear() { Weakening::Absent } else { Weakening::AsStated } }
    }

    /// The same for the reference path tracer, which tracks its way through all media.
    pub fn tracked(scene: &'a Scene, choice: &'a Discrete, between: BetweenPlan) -> Self {
        Self { scene, choice, weakening: if between.is_clear() { Weakening::Absent } else { Weakening::Tracked } }
    }

    /// What passes on a free way of this length from an encounter, among `BODIES` at least; `u` seeds what is random about it.
    #[inline(always)]
    pub(super) fn through<const BODIES: bool>(
        &self,
        encounter: &Encounter<'_>,
        (direction, length_m): (DVec3, f64),
        u: [f64; 3],
    ) -> Passages<'a> {
        if !BODIES {
            return Passages::new();
        }
        self.passages(encounter.leave(direction, encounter.interior_towards(direction)), length_m, u)
    }

    fn passages(&self, start: Start, distance: f64, u: [f64; 3]) -> Passages<'a> {
        let seed = || hash64(u.map(f64::to_bits));
        match self.weakening {
            Weakening::Absent => Passages::new(),
            Weakening::AsStated => passages(self.scene, start, distance, seed()),
            Weakening::Tracked => passages_tracked(self.scene, start, distance, seed()),
        }
    }

    /// The numbers of the lamps that a point asks: all, or of many one, drawn by the last of `u`, which is stretched to be used again.
    #[inline]
    pub(super) fn asked(&self, u: &mut [f64; 3]) -> Range<usize> {
        let count = self.scene.lights.len();
        if count <= ASK_ALL {
            return 0..count;
        }
        let number = self.choice.sample(&mut u[2]);
        number..number + 1
    }

    /// What reaches a point inside a medium straight from a lamp.
    pub(super) fn ask_inside(
        &self,
        asking: AskingInside<'a>,
        number: usize,
        tally: &mut Tally,
    ) -> Option<LitInside<'a>> {
        let AskingInside { start, medium, scattered_nm, u } = asking;
        let light = &self.scene.lights[number];
        let incident = light.towards(self.scene.world(), start.ray.origin, u)?;
        let (incoming, probability) = (-incident.direction, self.probability(number));
        let share = match (scattered_nm, incident.pdf_solid_angle) {
            (Some(nm), Some(pdf)) => {
                // The path comes from the camera: it would have gone on into this direction with the same density.
                power_heuristic(pdf * probability, medium.phase.at(start.ray.direction.dot(incident.direction), nm))
            }
            _ => 1.0,
        };
        let strength = incident.irradiance * share / probability;
        tally.shadow_rays += 1;
        let ray = Ray { origin: start.ray.origin, direction: incident.direction };
        let reaches = strength > 0.0 && !self.scene.geometry.occluded(&ray, None, incident.target, incident.distance);
        reaches.then(|| {
            let through = self.passages(Start { ray, ..start }, incident.distance, u);
            LitInside { light, incoming, strength, tint: incident.tint, through }
        })
    }

    /// The probability that a point asks this lamp.
    pub(super) fn probability(&self, number: usize) -> f64 {
        if self.scene.lights.len() <= ASK_ALL { 1.0 } else { self.choice.probability(number) }
    }

    /// What would reach an encounter straight from a lamp if nothing weakened it on its way.
    #[inline(always)]
    pub(super) fn ask(&self, asking: Asking<'_, '_>, number: usize, tally: &mut Tally) -> Option<Lit<'a>> {
        let Asking { encounter, nm, u } = asking;
        let light = &self.scene.lights[number];
        let incident = light.towards(self.scene.world(), encounter.hit.position, u)?;
        let wi = encounter.frame.to_local(incident.direction);
        let (surface, wo, sides) = (encounter.surface, encounter.wo, encounter.sides);
        let pdf_surface = surface.pdf(wo, wi, sides, nm);
        // Spare the shadow ray where the surface sends nothing from there on.
        if pdf_surface <= 0.0 && surface.eval(wo, wi, sides, Transport::Radiance, nm) <= 0.0 {
            return None;
        }
        let probability = self.probability(number);
        let share = incident.pdf_solid_angle.map_or(1.0, |pdf| power_heuristic(pdf * probability, pdf_surface));
        let strength = incident.irradiance * wi.z.abs() * share / probability;
        tally.shadow_rays += 1;
        if !(strength > 0.0 && encounter.sees(self.scene, incident.direction, incident.distance, incident.target)) {
            return None;
        }
        let Incident { direction, distance, tint, .. } = incident;
        Some(Lit { light, wi, strength, tint, direction, distance })
    }

    /// The numbers of the lamps that a ray sees where it ends: that of the surface there, or, where it leaves the scene, those at infinity.
    #[inline(always)]
    pub(super) fn seen(&self, hit: Option<&Hit>) -> &'a [usize] {
        match hit {
            Some(hit) => self.scene.objects[hit.object as usize].light.as_slice(),
            None => &self.scene.distant_lights,
        }
    }

    /// One of these lamps, if it shines this way.
    #[inline(never)]
    pub(super) fn found(
        &self,
        number: usize,
        (direction, hit): (DVec3, Option<Hit>),
        counts: Counts,
        tally: &mut Tally,
    ) -> Option<Found<'a>> {
        if matches!(counts, Counts::Not) {
            return None;
        }
        let light = &self.scene.lights[number];
        let (radiance, tint) = match &hit {
            Some(hit) => (light.surface_radiance(direction, hit), Tint::Own),
            None => {
                tally.environment_rays += 1;
                light.escaping(direction)?
            }
        };
        let share = match counts {
            Counts::Not => 0.0,
            Counts::Fully => 1.0,
            Counts::Shared { place, pdf } => {
                let pdf_light = match &hit {
                    Some(hit) => light.surface_pdf(self.scene.world(), place, hit),
                    None => light.escaping_pdf(direction),
                };
                power_heuristic(pdf, pdf_light * self.probability(number))
            }
        };
        (radiance * share > 0.0).then_some(Found { light, radiance: radiance * share, tint })
    }
}

/// The power heuristic's weight of a sample drawn with density `a` that could have been drawn with `b`.
pub fn power_heuristic(a: f64, b: f64) -> f64 {
    if a.is_infinite() {
        return 1.0;
    }
    let ratio = b / a;
    1.0 / (1.0 + ratio * ratio)
}
