//! Next-event estimation: shadow rays to sampled points of lights, and scattered rays that happen
//! to hit a light, combined by multiple importance sampling with the power heuristic (Veach &
//! Guibas 1995, "Optimally Combining Sampling Techniques for Monte Carlo Rendering").

use super::light_tree::{Receiver, ReceivingPoint};
use super::portals::Portals;
use super::selection::{LightSelection, LightSelector, SelectedLight};
use crate::plan::{MediumPlan, Tally};
use crate::walk::{
    BodyMode, CausticWeights, PathTransmittance, PolarisingPane, RayDensities, RayDensity, RayState,
    SegmentTransmittance, SurfaceInteraction, path_transmittance, path_transmittance_tracked,
};
use abbe_optics::bsdf::{Texels, ThinDielectric, TransportMode};
use abbe_optics::phase::{Deflection, PhaseMixture};
use abbe_optics::texture::TexturePoint;
use abbe_scene::Scene;
use abbe_scene::geometry::{Hit, Ray, SurfaceId};
use abbe_scene::light::{EmittedSpd, LiSample, Light};
use abbe_scene::meter::SensorPoint;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use glam::DVec3;

#[derive(Debug)]
pub struct DirectLighting<'a> {
    pub(in crate::gather) scene: &'a Scene,
    pub(super) selector: &'a LightSelector,
    attenuation: ShadowAttenuation,
    /// True if shadow rays carry the polarisation of light.
    polarised: bool,
    pub(in crate::gather) portals: &'a Portals,
    /// The densities of the emitted rays. `None` if no photon competes with camera paths.
    pub(in crate::gather) ray_densities: Option<&'a RayDensities>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ShadowAttenuation {
    /// Nothing in the scene absorbs or scatters between surfaces.
    Absent,
    PerMedium,
    /// By ratio tracking in all media. Shadow rays may pass through thin panes, also through those
    /// of a mixture, where a random number selects the component.
    Tracked {
        panes: bool,
    },
}

/// The straight line of a shadow ray that reaches its light.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) enum ShadowLine {
    Clear,
    /// Only thin panes are on the line. Holds the surface of the light, if it has one.
    ThroughPanes(Option<SurfaceId>),
}

#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct LightSampleContext<'e, 'a> {
    pub(in crate::gather) interaction: &'e SurfaceInteraction<'a>,
    /// The wavelength (nm) at which the path samples directions, for the BSDF's density.
    pub(in crate::gather) nm: f64,
}

#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct VolumeLightSampleContext<'a> {
    /// The path's ray. The origin of this ray is the point in the medium.
    pub(in crate::gather) ray_state: RayState,
    pub(in crate::gather) phase: PhaseMixture<'a>,
    /// True if the path continues with `phase`, so that scattered rays may hit the light as well.
    /// Otherwise, the shadow ray counts all light.
    pub(in crate::gather) continues: bool,
}

/// A sample of direct light at a surface. The sample does not include the attenuation by media.
pub(in crate::gather) struct LightSample<'a> {
    pub(in crate::gather) light: &'a Light,
    /// The unit direction towards the light, in the interaction's frame.
    pub(in crate::gather) wi: DVec3,
    /// The reflected radiance is `strength` × S(λ) × f(λ), for the light's spectrum S and the BSDF
    /// f. It includes the cosine, the density and the weight of multiple importance sampling.
    pub(in crate::gather) strength: f64,
    pub(in crate::gather) spd: EmittedSpd,
    /// The unit direction towards the light, in world space.
    pub(in crate::gather) direction: DVec3,
    pub(in crate::gather) line: ShadowLine,
    /// The distance to the light in m.
    pub(in crate::gather) distance_m: f64,
}

pub(in crate::gather) struct VolumeLightSample<'a> {
    pub(in crate::gather) light: &'a Light,
    /// The unit direction in which the light travels, in world space.
    pub(in crate::gather) incoming: DVec3,
    /// The scattered radiance without attenuation is `strength` × S(λ) × σ_s(λ) × p(cos θ, λ), for
    /// the light's spectrum S, the scattering coefficient σ_s and the phase function p.
    pub(in crate::gather) strength: f64,
    pub(in crate::gather) spd: EmittedSpd,
    pub(in crate::gather) transmittance: PathTransmittance<'a>,
}

pub(in crate::gather) struct SensorLightSample<'a> {
    pub(in crate::gather) light: &'a Light,
    /// The mean radiance without attenuation is `strength` × S(λ), for the light's spectrum S.
    pub(in crate::gather) strength: f64,
    pub(in crate::gather) spd: EmittedSpd,
    pub(in crate::gather) transmittance: PathTransmittance<'a>,
}

pub(in crate::gather) struct EmitterHit<'a> {
    pub(in crate::gather) light: &'a Light,
    /// Over the band (W/m²/sr), times the weight of multiple importance sampling.
    pub(in crate::gather) radiance: f64,
    pub(in crate::gather) spd: EmittedSpd,
}

/// The weight of a light that a path happens to hit, by the path vertex before the light.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) enum HitWeighting {
    /// The weight is 1, because no shadow ray could have sampled this light.
    Full,
    /// By multiple importance sampling with shadow rays. The ray was sampled at `from` with the
    /// density `pdf` per steradian. `caustic` weights the light that the path hits after a specular
    /// event, or is `None` if another estimator counts it.
    Mis { from: ReceivingPoint, pdf: f64, caustic: Option<CausticWeights> },
    /// By multiple importance sampling with photons. The path was sampled with `pdf` per steradian
    /// at a glossy surface, and then had only specular events.
    Caustic { pdf: f64, weights: CausticWeights },
    /// The weight is 0, because another estimator counts the light.
    Ignored,
}

impl HitWeighting {
    /// Returns the weighting after a specular event. A shadow ray does not follow such events.
    pub(in crate::gather) fn after_specular_event(self) -> Self {
        match self {
            Self::Full | Self::Caustic { .. } | Self::Ignored => self,
            Self::Mis { pdf, caustic: Some(weights), .. } => Self::Caustic { pdf, weights },
            Self::Mis { caustic: None, .. } => Self::Ignored,
        }
    }
}

impl<'a> DirectLighting<'a> {
    pub fn new(scene: &'a Scene, selector: &'a LightSelector, media_plan: MediumPlan) -> Self {
        Self::attenuated(scene, selector, media_plan, ShadowAttenuation::PerMedium)
    }

    /// Serves the reference path tracer: ratio tracking, and shadow rays through thin panes.
    pub fn tracked(scene: &'a Scene, selector: &'a LightSelector, media_plan: MediumPlan) -> Self {
        let panes = scene.materials.iter().any(|material| material.surface.has_uniform_pane());
        let tracked = ShadowAttenuation::Tracked { panes };
        let direct = Self::attenuated(scene, selector, media_plan, tracked);
        if panes { Self { attenuation: tracked, ..direct } } else { direct }
    }

    /// Returns true if shadow rays pass through thin panes. Paths that cross a pane straight are
    /// then weighted as if it were not there.
    #[inline]
    pub fn passes_panes(&self) -> bool {
        matches!(self.attenuation, ShadowAttenuation::Tracked { panes: true })
    }

    /// Returns the line from the ray's origin on the surface `from` to a light on the surface
    /// `target`, or `None` if a surface blocks it. `u` is hashed to a seed.
    #[inline(always)]
    pub(super) fn line_to_light(
        &self,
        ray: Ray,
        [from, target]: [Option<SurfaceId>; 2],
        length_m: f64,
        u: [f64; 3],
    ) -> Option<ShadowLine> {
        if !self.scene.geometry.occluded(&ray, from, target, length_m) {
            return Some(ShadowLine::Clear);
        }
        let passes = self.passes_panes() && self.cross_panes(ray, [from, target], length_m, u, |_, _| ());
        passes.then_some(ShadowLine::ThroughPanes(target))
    }

    /// Follows a line through thin panes to a light, and calls `visit` with each pane and the hit.
    /// Returns false if another surface blocks the line. The same `u` selects
    /// the same components of mixtures.
    #[inline(never)]
    fn cross_panes(
        &self,
        mut ray: Ray,
        [mut from, target]: [Option<SurfaceId>; 2],
        mut length_m: f64,
        u: [f64; 3],
        mut visit: impl FnMut((&'a ThinDielectric, Texels), &Hit),
    ) -> bool {
        let scene = self.scene;
        let mut stream = Stream::new(Seed::of_numbers(u), Purpose::Pane, 0, 0);
        while scene.geometry.occluded(&ray, from, target, length_m) {
            let Some(hit) = scene.geometry.intersect(&ray, from, length_m) else { return false };
            let surface = &scene.material_of(hit.object).surface;
            let local = if surface.is_textured() {
                surface.at_point(&TexturePoint::new(scene.geometry.uv(&hit)), stream.uniform())
            } else {
                surface.at(stream.uniform())
            };
            let Some(pane) = local.model.uniform_pane() else { return false };
            visit((pane, local.texels), &hit);
            (ray.origin, from) = (hit.position, Some(hit.surface));
            length_m -= hit.t;
        }
        true
    }

    /// Sets the densities of rays, if photons compete with camera paths.
    #[must_use]
    pub fn with_ray_densities(self, ray_densities: Option<&'a RayDensities>) -> Self {
        Self { ray_densities, ..self }
    }

    #[must_use]
    pub fn with_portals(self, portals: &'a Portals) -> Self {
        Self { portals, ..self }
    }

    /// Sets whether shadow rays carry the polarisation of light.
    #[must_use]
    pub fn with_polarisation(self, polarised: bool) -> Self {
        Self { polarised, ..self }
    }

    fn attenuated(
        scene: &'a Scene,
        selector: &'a LightSelector,
        media_plan: MediumPlan,
        in_media: ShadowAttenuation,
    ) -> Self {
        let attenuation = if media_plan.is_clear() { ShadowAttenuation::Absent } else { in_media };
        Self { scene, selector, attenuation, polarised: false, portals: Portals::NONE, ray_densities: None }
    }

    /// Returns the transmittance of an unoccluded ray from a surface. `u` is hashed to a seed.
    #[inline(always)]
    pub(in crate::gather) fn transmittance_from<M: BodyMode>(
        &self,
        interaction: &SurfaceInteraction<'_>,
        (direction, line): (DVec3, ShadowLine),
        length_m: f64,
        u: [f64; 3],
    ) -> PathTransmittance<'a> {
        if !M::HAS_BODIES {
            return PathTransmittance::new();
        }
        let ray_state = interaction.spawn_ray(direction, interaction.medium_stack_towards(direction));
        self.path_transmittance(ray_state, line, length_m, u)
    }

    /// Returns the transmittance along a straight line of this length.
    fn path_transmittance(
        &self,
        ray_state: RayState,
        line: ShadowLine,
        length_m: f64,
        u: [f64; 3],
    ) -> PathTransmittance<'a> {
        let seed = || Seed::of_numbers(u);
        match self.attenuation {
            ShadowAttenuation::Absent => PathTransmittance::new(),
            ShadowAttenuation::PerMedium => path_transmittance(self.scene, ray_state, length_m, seed()),
            ShadowAttenuation::Tracked { .. } => {
                let mut along = path_transmittance_tracked(self.scene, ray_state, length_m, seed());
                if let ShadowLine::ThroughPanes(target) = line {
                    let RayState { ray, from, medium_stack } = ray_state;
                    let outside = self.scene.index_in(&medium_stack);
                    self.cross_panes(ray, [from, target], length_m, u, |(pane, texels), hit| {
                        let cosine = ray.direction.dot(hit.normal).abs();
                        let sheet =
                            || PolarisingPane::new(self.scene, (pane, texels.retardance()), hit, -ray.direction);
                        let polarising = self.polarised.then(sheet);
                        along.push(SegmentTransmittance::Pane { pane, cosine, outside, polarising });
                    });
                }
                along
            }
        }
    }

    /// Selects lights for a receiver. `u` selects lights and points of lights.
    #[inline]
    pub(in crate::gather) fn select_lights<R: Receiver>(&self, receiver: R, u: [f64; 3]) -> LightSelection<'a, R> {
        self.selector.select(receiver, u)
    }

    /// Samples the light of one light at a sensor, or `None` if it does not reach it. `pdf` is the
    /// density with which a path from the sensor starts in a direction.
    pub(in crate::gather) fn sample_direct_at_sensor(
        &self,
        point: &SensorPoint,
        pdf: impl Fn(DVec3) -> f64,
        selected: SelectedLight,
        tally: &mut Tally,
    ) -> Option<SensorLightSample<'a>> {
        let SelectedLight { number, u, probability } = selected;
        let light = &self.scene.lights[number];
        let incident = self.sample_li(light, point.position, u)?;
        let LiSample { direction, distance, spd, .. } = incident;
        let mis_weight =
            incident.pdf_solid_angle.map_or(1.0, |light_pdf| power_heuristic(light_pdf * probability, pdf(direction)));
        let strength = incident.irradiance * point.response.pdf(direction) * mis_weight / probability;
        if strength <= 0.0 {
            return None;
        }
        tally.shadow_rays += 1;
        let ray = Ray { origin: point.position, direction };
        let line = self.line_to_light(ray, [point.from, incident.target], distance, u)?;
        let start = RayState { ray, from: point.from, medium_stack: point.medium_stack };
        let transmittance = self.path_transmittance(start, line, distance, u);
        Some(SensorLightSample { light, strength, spd, transmittance })
    }

    /// Samples one light at a point in a medium, or `None` if it does not reach the point.
    pub(in crate::gather) fn sample_direct_in_medium(
        &self,
        context: VolumeLightSampleContext<'a>,
        selected: SelectedLight,
        tally: &mut Tally,
    ) -> Option<VolumeLightSample<'a>> {
        let VolumeLightSampleContext { ray_state, phase, continues } = context;
        let SelectedLight { number, u, probability } = selected;
        let light = &self.scene.lights[number];
        let incident = if continues {
            self.sample_li(light, ray_state.ray.origin, u)?
        } else {
            self.sample_li_in_medium(light, ray_state.ray, &phase, u)?
        };
        let incoming = -incident.direction;
        let mis_weight = match incident.pdf_solid_angle {
            Some(pdf) if continues => {
                // The density with which the camera path would have continued towards the light.
                let onwards = Deflection::between(ray_state.ray.direction, incident.direction);
                power_heuristic(pdf * probability, phase.pdf(onwards))
            }
            _ => 1.0,
        };
        let strength = incident.irradiance * mis_weight / probability;
        tally.shadow_rays += 1;
        let ray = Ray { origin: ray_state.ray.origin, direction: incident.direction };
        if strength <= 0.0 {
            return None;
        }
        let line = self.line_to_light(ray, [None, incident.target], incident.distance, u)?;
        let transmittance = self.path_transmittance(RayState { ray, ..ray_state }, line, incident.distance, u);
        Some(VolumeLightSample { light, incoming, strength, spd: incident.spd, transmittance })
    }

    /// Samples the light of one light at a surface, without the attenuation by media. Returns
    /// `None` if it does not reach the surface or is not scattered there.
    #[inline(always)]
    pub(in crate::gather) fn sample_direct(
        &self,
        context: LightSampleContext<'_, '_>,
        selected: SelectedLight,
        tally: &mut Tally,
    ) -> Option<LightSample<'a>> {
        let LightSampleContext { interaction, nm } = context;
        let SelectedLight { number, u, probability } = selected;
        let light = &self.scene.lights[number];
        let incident = self.sample_li(light, interaction.hit.position, u)?;
        let wi = interaction.frame.to_local(incident.direction);
        let (bsdf, wo, sides) = (interaction.bsdf, interaction.wo, interaction.sides);
        let pdf_bsdf = bsdf.pdf(wo, wi, sides, nm);
        // If the BSDF is 0 in this direction, no shadow ray is needed. At a dispersive interface,
        // other wavelengths may still be scattered into it.
        let scatters =
            pdf_bsdf > 0.0 || interaction.disperses() || bsdf.eval(wo, wi, sides, TransportMode::Radiance, nm) > 0.0;
        if !scatters {
            return None;
        }
        let mis_weight = incident.pdf_solid_angle.map_or(1.0, |pdf| power_heuristic(pdf * probability, pdf_bsdf));
        let strength = incident.irradiance * wi.z.abs() * mis_weight / probability;
        tally.shadow_rays += 1;
        let LiSample { direction, distance, target, spd, .. } = incident;
        let ray = Ray { origin: interaction.hit.position, direction };
        if strength <= 0.0 {
            return None;
        }
        let line = self.line_to_light(ray, [Some(interaction.hit.surface), target], distance, u)?;
        Some(LightSample { light, wi, strength, spd, direction, line, distance_m: distance })
    }

    /// Returns the lights at the end of a ray: that of the surface, or those at infinity.
    #[inline(always)]
    pub(in crate::gather) fn emitters_hit(&self, hit: Option<&Hit>) -> &'a [usize] {
        match hit {
            Some(hit) => self.scene.objects[hit.object as usize].light.as_slice(),
            None => &self.scene.distant_lights,
        }
    }

    /// Evaluates one of these lights, or returns `None` if it does not emit towards the ray.
    #[inline(never)]
    pub(in crate::gather) fn emitted_by_hit(
        &self,
        number: usize,
        ray: Ray,
        hit: Option<Hit>,
        weighting: HitWeighting,
        tally: &mut Tally,
    ) -> Option<EmitterHit<'a>> {
        if matches!(weighting, HitWeighting::Ignored) {
            return None;
        }
        let (light, direction) = (&self.scene.lights[number], ray.direction);
        let (radiance, spd) = match &hit {
            Some(hit) => light.le_surface(self.scene.extent(), direction, hit),
            None => {
                tally.environment_rays += 1;
                light.le(direction)?
            }
        };
        tally.texture_lookups += u64::from(matches!(spd, EmittedSpd::Filtered(_)));
        let weight = match weighting {
            HitWeighting::Ignored => 0.0,
            HitWeighting::Full => 1.0,
            HitWeighting::Caustic { pdf, weights } => {
                weights.of_camera_path(self.ray_density(number, ray, hit.as_ref(), radiance), pdf)
            }
            HitWeighting::Mis { from, pdf, .. } => {
                let pdf_light = match &hit {
                    Some(hit) => light.pdf_li_surface(self.scene.extent(), from.position, hit),
                    None => self.pdf_li_escaped(light, from.position, direction),
                };
                let probability = self.selector.probability(self.scene, number, hit.as_ref(), &from);
                power_heuristic(pdf, pdf_light * probability)
            }
        };
        (radiance * weight > 0.0).then_some(EmitterHit { light, radiance: radiance * weight, spd })
    }

    /// Returns the density of a light's rays along a camera ray that hit it and found `radiance`.
    fn ray_density(&self, number: usize, ray: Ray, hit: Option<&Hit>, radiance: f64) -> RayDensity {
        let Some(densities) = self.ray_densities else { return RayDensity::NONE };
        // The rays of a distant light start outside the scene.
        let origin = hit.map_or_else(|| ray.at(2.0 * self.scene.extent().radius_m), |hit| hit.position);
        densities.around(number, origin, -ray.direction, radiance)
    }
}

/// Returns the weight of a sample by the power heuristic with exponent 2 (Veach & Guibas 1995).
/// `pdf` is that of the technique that drew the sample, and `other_pdf` that of the other one, in
/// the same measure.
pub fn power_heuristic(pdf: f64, other_pdf: f64) -> f64 {
    if pdf.is_infinite() {
        return 1.0;
    }
    let ratio = other_pdf / pdf;
    1.0 / (1.0 + ratio * ratio)
}
