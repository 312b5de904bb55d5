//! Light straight from the lamps: shadow rays, and scattered rays that find a lamp by themselves, weighted by multiple importance
//! sampling (Veach & Guibas 1995, power heuristic).

use crate::math::distribution::Discrete;
use crate::optics::surface::Transport;
use crate::scene::Scene;
use crate::scene::geometry::{Hit, Ray};
use crate::scene::light::{Light, Tint};
use crate::walk::{Encounter, Start, Tally};
use glam::DVec3;

/// At most this many lamps are all asked at every point; of more, one is drawn.
const ASK_ALL: usize = 8;

/// Which lamps a point asks for light.
#[derive(Debug)]
pub struct Direct<'a> {
    scene: &'a Scene,
    choice: &'a Discrete,
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

/// Light that reaches a point straight from a lamp.
pub(super) struct Lit<'a> {
    pub(super) light: &'a Light,
    /// Towards the lamp, unit, in the encounter's frame.
    pub(super) wi: DVec3,
    /// What the reflected radiance at a wavelength is: this × S(λ) × f(λ); cosine, density and the weight of multiple importance
    /// sampling are in it.
    pub(super) strength: f64,
    pub(super) tint: Tint,
}

/// A lamp found by a scattered ray.
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
    /// The lamps of a scene, and how one of many is drawn.
    pub fn new(scene: &'a Scene, choice: &'a Discrete) -> Self {
        Self { scene, choice }
    }

    /// Calls `lit` for every lamp asked that reaches the encounter.
    pub(super) fn ask(&self, asking: Asking<'_, '_>, tally: &mut Tally, mut lit: impl FnMut(Lit<'a>)) {
        let lights = &self.scene.lights;
        if lights.len() <= ASK_ALL {
            for number in 0..lights.len() {
                self.ask_one(asking, number, tally, &mut lit);
            }
        } else {
            let mut u = asking.u;
            let number = self.choice.sample(&mut u[2]);
            self.ask_one(Asking { u, ..asking }, number, tally, &mut lit);
        }
    }

    /// The probability that a point asks this lamp.
    fn probability(&self, number: usize) -> f64 {
        if self.scene.lights.len() <= ASK_ALL { 1.0 } else { self.choice.probability(number) }
    }

    fn ask_one(&self, asking: Asking<'_, '_>, number: usize, tally: &mut Tally, lit: &mut impl FnMut(Lit<'a>)) {
        let Asking { encounter, nm, u } = asking;
        let light = &self.scene.lights[number];
        let Some(incident) = light.towards(self.scene.world(), encounter.hit.position, u) else {
            return;
        };
        let wi = encounter.frame.to_local(incident.direction);
        let (surface, wo, sides) = (encounter.surface, encounter.wo, encounter.sides);
        let pdf_surface = surface.pdf(wo, wi, sides, nm);
        // Spare the shadow ray where the surface sends nothing from there on.
        if pdf_surface <= 0.0 && surface.eval(wo, wi, sides, Transport::Radiance, nm) <= 0.0 {
            return;
        }
        let probability = self.probability(number);
        let share = incident.pdf_solid_angle.map_or(1.0, |pdf| power_heuristic(pdf * probability, pdf_surface));
        let strength = incident.irradiance * wi.z.abs() * share / probability;
        tally.shadow_rays += 1;
        if strength > 0.0 && encounter.sees(self.scene, incident.direction, incident.distance, incident.target) {
            lit(Lit { light, wi, strength, tint: incident.tint });
        }
    }

    /// The lamp whose surface the ray hits, if it shines this way.
    pub(super) fn found_on_surface(&self, direction: DVec3, hit: &Hit, counts: Counts) -> Option<Found<'a>> {
        let number = self.scene.objects[hit.object as usize].light?;
        let light = &self.scene.lights[number];
        let radiance = light.surface_radiance(direction, hit);
        let share = match counts {
            Counts::Not => 0.0,
            Counts::Fully => 1.0,
            Counts::Shared { place, pdf } => {
                let pdf_light = light.surface_pdf(self.scene.world(), place, hit) * self.probability(number);
                power_heuristic(pdf, pdf_light)
            }
        };
        (radiance * share > 0.0).then_some(Found { light, radiance: radiance * share, tint: Tint::Own })
    }

    /// Calls `found` for every distant lamp that a ray leaving the scene sees.
    pub(super) fn found_outside(
        &self,
        direction: DVec3,
        counts: Counts,
        tally: &mut Tally,
        mut found: impl FnMut(Found<'a>),
    ) {
        if matches!(counts, Counts::Not) {
            return;
        }
        for &number in &self.scene.distant_lights {
            tally.environment_rays += 1;
            let light = &self.scene.lights[number];
            let Some((radiance, tint)) = light.escaping(direction) else {
                continue;
            };
            let share = match counts {
                Counts::Not => 0.0,
                Counts::Fully => 1.0,
                Counts::Shared { pdf, .. } => {
                    power_heuristic(pdf, light.escaping_pdf(direction) * self.probability(number))
                }
            };
            if radiance * share > 0.0 {
                found(Found { light, radiance: radiance * share, tint });
            }
        }
    }

    /// What one ray from `start`, drawn with density `pdf`, finds: a lamp's surface, or the distant lamps.
    pub(super) fn look(&self, start: Start, pdf: f64, tally: &mut Tally, mut found: impl FnMut(Found<'a>)) {
        let counts = Counts::Shared { place: start.ray.origin, pdf };
        let Ray { direction, .. } = start.ray;
        match self.scene.geometry.intersect(&start.ray, start.from, f64::INFINITY) {
            Some(hit) => {
                if let Some(lamp) = self.found_on_surface(direction, &hit, counts) {
                    found(lamp);
                }
            }
            None => self.found_outside(direction, counts, tally, found),
        }
    }
}

/// The power heuristic's weight of a sample drawn with density `a` that could have been drawn with `b`.
fn power_heuristic(a: f64, b: f64) -> f64 {
    if a.is_infinite() {
        return 1.0;
    }
    let ratio = b / a;
    1.0 / (1.0 + ratio * ratio)
}
