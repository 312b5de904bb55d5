//! Samples of the light that surrounds the scene: by its radiance, through portals, and in media by
//! the phase function.

use super::lighting::DirectLighting;
use super::portals::PORTAL_FRACTION;
use abbe_optics::phase::{Deflection, PhaseMixture};
use abbe_scene::geometry::Ray;
use abbe_scene::light::{LiSample, Light};
use glam::DVec3;

/// The fraction of the samples at a point of a medium that follow the phase function.
const PHASE_FRACTION: f64 = 0.5;

impl DirectLighting<'_> {
    /// Samples a direction from a point towards a light; see [`Light::sample_li`].
    #[inline(always)]
    pub(super) fn sample_li(&self, light: &Light, from: DVec3, u: [f64; 3]) -> Option<LiSample> {
        if self.portals.open.count() == 0 || !light.surrounds() {
            return light.sample_li(self.scene.extent(), from, u);
        }
        self.sample_li_through_portals(light, from, u)
    }

    /// Samples a direction from the origin of a ray in a medium towards a light. If the light
    /// surrounds the scene, half of the samples follow the phase function, whose forward peak the
    /// others would rarely find.
    #[inline(always)]
    pub(super) fn sample_li_in_medium(
        &self,
        light: &Light,
        ray: Ray,
        phase: &PhaseMixture<'_>,
        u: [f64; 3],
    ) -> Option<LiSample> {
        if !light.surrounds() || phase.is_smooth() {
            return self.sample_li(light, ray.origin, u);
        }
        self.sample_li_by_phase(light, ray, phase, u)
    }

    #[inline(never)]
    fn sample_li_by_phase(
        &self,
        light: &Light,
        Ray { origin, direction: travel }: Ray,
        phase: &PhaseMixture<'_>,
        [u, v, choice]: [f64; 3],
    ) -> Option<LiSample> {
        let sample = if choice < PHASE_FRACTION {
            unweighted(light, phase.sample(travel, [u, v]))?
        } else {
            let choice = (choice - PHASE_FRACTION) / (1.0 - PHASE_FRACTION);
            without_weight(self.sample_li(light, origin, [u, v, choice])?)
        };
        let by_radiance = self.pdf_li_escaped(light, origin, sample.direction);
        let by_phase = phase.pdf(Deflection::between(travel, sample.direction));
        with_density(sample, (1.0 - PHASE_FRACTION) * by_radiance + PHASE_FRACTION * by_phase)
    }

    /// Samples a direction towards the surroundings, through a portal or by their radiance.
    #[inline(never)]
    fn sample_li_through_portals(&self, light: &Light, from: DVec3, [u, v, choice]: [f64; 3]) -> Option<LiSample> {
        let sample = if choice < PORTAL_FRACTION {
            unweighted(light, self.portals.open.sample(from, choice / PORTAL_FRACTION, [u, v]))?
        } else {
            without_weight(light.sample_li(self.scene.extent(), from, [u, v, choice])?)
        };
        with_density(sample, self.pdf_li_escaped(light, from, sample.direction))
    }

    /// Returns the density of [`Self::sample_li`] for the direction of a ray that leaves the scene.
    pub(super) fn pdf_li_escaped(&self, light: &Light, from: DVec3, direction: DVec3) -> f64 {
        let pdf = light.pdf_li_escaped(direction);
        if self.portals.open.count() == 0 || !light.surrounds() {
            return pdf;
        }
        (1.0 - PORTAL_FRACTION) * pdf + PORTAL_FRACTION * self.portals.open.pdf(from, direction)
    }
}

/// Returns the radiance of the surroundings in a direction, as a sample that has no density yet.
fn unweighted(light: &Light, direction: DVec3) -> Option<LiSample> {
    let (radiance, spd) = light.le(direction)?;
    Some(LiSample {
        direction,
        distance: f64::INFINITY,
        target: None,
        irradiance: radiance,
        pdf_solid_angle: None,
        spd,
    })
}

/// Removes the density of a sample.
fn without_weight(sample: LiSample) -> LiSample {
    let irradiance = sample.irradiance * sample.pdf_solid_angle.unwrap_or(1.0);
    LiSample { irradiance, pdf_solid_angle: None, ..sample }
}

fn with_density(sample: LiSample, pdf: f64) -> Option<LiSample> {
    let irradiance = sample.irradiance / pdf;
    (pdf > 0.0).then_some(LiSample { irradiance, pdf_solid_angle: Some(pdf), ..sample })
}
