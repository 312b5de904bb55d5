//! Light that the path tracer finds seldom or never.

use super::job::Job;
use super::request::Integrator;
use abbe_optics::bsdf::{Bsdf, BsdfClass};
use abbe_scene::light::Light;
use abbe_transport::plan::{CausticPlan, IndirectPlan};

impl Job {
    /// Returns the lights that only photons carry.
    fn ray_sets(&self) -> impl Iterator<Item = &Light> {
        self.scene.lights.iter().filter(|light| light.is_ray_set())
    }

    /// Returns the integrator that suits the meters. The path tracer has no bias, but it finds the
    /// light of small lamps and of the sun behind glass, mirrors or slightly rough metal seldom or
    /// never. Its shadow rays pass through thin panes, so panes alone need no photons.
    pub fn integrator_for_meters(&self) -> Integrator {
        let caustics = self.plan.caustics != CausticPlan::Absent;
        if self.needs_photons(caustics) { Integrator::Photon } else { Integrator::Path }
    }

    /// Returns true if only photons carry the light of a lamp, or if metal, or with `caustics` also
    /// mirrors or glass, deflect the light of lamps that the path tracer finds seldom or never.
    fn needs_photons(&self, caustics: bool) -> bool {
        let mirrors = |bsdf: &Bsdf| bsdf.class() == BsdfClass::Specular && bsdf.uniform_pane().is_none();
        let focusing = caustics && self.any_surface(mirrors) || self.has_narrow_lobes();
        self.ray_sets().next().is_some() || focusing && self.hidden_lamps().next().is_some()
    }

    fn any_surface(&self, is: impl Fn(&Bsdf) -> bool) -> bool {
        self.scene.materials.iter().any(|material| material.surface.components().any(&is))
    }

    /// Returns true if rough metal or glass scatters into lobes so narrow that the path tracer finds
    /// a small lamp by way of them seldom.
    fn has_narrow_lobes(&self) -> bool {
        /// The density of the reflected directions of GGX at its peak is 1/(4πα²). Below this α, a
        /// lobe covers less than 1/400 of all directions, like a small lamp.
        const NARROW_ALPHA: f64 = 0.05;
        let narrow = |bsdf: &Bsdf| bsdf.alpha().is_some_and(|alpha| alpha < NARROW_ALPHA);
        self.plan.indirect != IndirectPlan::Absent && self.any_surface(narrow)
    }

    /// Returns the lamps that the path tracer finds seldom or never after a mirror.
    pub(super) fn hidden_lamps(&self) -> impl Iterator<Item = &Light> {
        self.scene.lights.iter().filter(|light| light.is_small(self.scene.extent()))
    }

    /// Returns true if the errors of the picture or of the readings are unknown, because the path
    /// tracer leaves out light of hidden lamps that glass, mirrors or metal deflect. Panes pass most
    /// of their light straight; the bias contains the light between several of them. The path
    /// tracer also finds, by chance, the light of forbidden caustics.
    pub(super) fn errors_are_unknown(&self, integrator: Integrator) -> bool {
        integrator == Integrator::Path && self.needs_photons(true)
    }

    /// Returns a note if the path tracer leaves out light that panes, glass or mirrors deflect.
    pub(super) fn note_of_missing_light(&self, integrator: Integrator) -> Option<String> {
        if let Some(light) = self.ray_sets().next().filter(|_| integrator == Integrator::Path) {
            return Some(format!(
                "the path tracer leaves out the light of {}, of which only rays are known, so the errors are unknown; \
                 `--integrator photon` finds it",
                light.name
            ));
        }
        let deflects = |bsdf: &Bsdf| {
            let is_hole = bsdf.uniform_pane().is_some_and(|pane| pane.matches(&self.scene.air));
            bsdf.class() == BsdfClass::Specular && !is_hole
        };
        if integrator == Integrator::Photon || !(self.any_surface(deflects) || self.has_narrow_lobes()) {
            return None;
        }
        let lamp = &self.hidden_lamps().next()?.name;
        let unknown = if self.errors_are_unknown(integrator) { ", so the errors are unknown" } else { "" };
        Some(format!(
            "the path tracer finds the light of {lamp} that mirrors, metal or panes reflect or that glass refracts seldom or \
             never{unknown}; `--integrator photon` finds it"
        ))
    }
}
