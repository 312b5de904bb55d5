//! Direct light at surfaces on a camera path.

use super::path::CameraPath;
use super::throughput::each_wavelength;
use crate::gather::camera_pass::{CameraPass, PathContext};
use crate::gather::direct::light_tree::ReceivingPoint;
use crate::gather::direct::lighting::{EmitterHit, HitWeighting, LightSampleContext, ShadowLine};
use crate::gather::luminescence::{ExcitingLight, Luminescence};
use crate::plan::LightOrigin;
use crate::plan::partition::LightPath;
use crate::walk::{BodyMode, Sink, SurfaceInteraction, bias_of_excess, excess_optical_depth, transmittance};
use abbe_optics::bsdf::TransportMode;
use abbe_scene::geometry::{Hit, Ray};
use glam::DVec3;

impl<'a> CameraPass<'a> {
    /// Adds the radiance of the lights on the surface or at infinity at the end of a path segment.
    #[inline(always)]
    pub(super) fn add_emitters_hit<S: Sink>(
        &self,
        path: &CameraPath,
        direction: DVec3,
        hit: Option<&Hit>,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let ray = Ray { origin: path.ray_state.ray.origin, direction };
        for &number in self.direct.emitters_hit(hit) {
            let emitted = self.direct.emitted_by_hit(number, ray, hit.copied(), path.hit_weighting, context.tally);
            if let Some(emitter) = emitted {
                add_emitter(*path, number, &emitter, context);
            }
        }
    }

    #[inline(always)]
    pub(super) fn gather_direct<M: BodyMode, S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        luminescence: Option<&Luminescence<'a>>,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let (wavelength, u, nm) = (context.sampler.wavelength, context.sampler.light(), path.reference_nm());
        let (bsdf, wo, sides) = (interaction.bsdf, interaction.wo, interaction.sides);
        for selected in self.direct.select_lights(ReceivingPoint::on_surface(interaction), u) {
            let point = LightSampleContext { interaction, nm };
            let Some(sample) = self.direct.sample_direct(point, selected, context.tally) else { continue };
            let towards = (sample.direction, sample.line);
            let along = self.direct.transmittance_from::<M>(interaction, towards, sample.distance_m, selected.u);
            let bias = bias_of_excess(path.excess_depth + excess_optical_depth(&along, nm));
            let factors = &context.buffers.factors;
            let origin = LightOrigin { class: path.events.class_at_surface(LightPath::Direct), light: selected.number };
            let event = factors.event_at(interaction, sample.direction);
            each_wavelength(path.spectral_mode, factors, sample.light, wavelength, |nm, throughput| {
                let f = bsdf.eval(wo, sample.wi, sides, TransportMode::Radiance, nm);
                let weight =
                    throughput * sample.light.spd_at(sample.spd, nm) * sample.strength * f * transmittance(&along, nm);
                factors.deliver((origin, nm), (weight, bias), event.as_ref(), context.sink);
            });
            if let Some(luminescence) = luminescence
                && bsdf.pdf(wo, sample.wi, sides, nm) > 0.0
            {
                let exciting = ExcitingLight::of_sample(selected.number, &sample, &along);
                let radiance = luminescence.excited_radiance(&exciting, self.spectra, wavelength);
                luminescence.add(origin, &radiance, (1.0, bias), context.sink);
            }
        }
    }

    /// Gathers direct light by a ray that is sampled from the BSDF and may hit a light.
    #[inline(always)]
    pub(super) fn gather_direct_by_bsdf<M: BodyMode, S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        luminescence: Option<&Luminescence<'a>>,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let nm = path.reference_nm();
        let u = context.sampler.stream.triple();
        let (bsdf, wo, sides) = (interaction.bsdf, interaction.wo, interaction.sides);
        let Some(sample) = bsdf.sample(wo, sides, nm, u) else { return };
        let direction = interaction.frame.to_world(sample.wi);
        let ray = Ray { origin: interaction.hit.position, direction };
        let hit = self.scene.geometry.intersect(&ray, Some(interaction.hit.surface), f64::INFINITY);
        let from = ReceivingPoint::on_surface(interaction);
        let weighting = HitWeighting::Mis { from, pdf: sample.probability, caustic: None };
        for &number in self.direct.emitters_hit(hit.as_ref()) {
            let emitted = self.direct.emitted_by_hit(number, ray, hit, weighting, context.tally);
            let Some(emitter) = emitted else { continue };
            let length_m = hit.map_or(f64::INFINITY, |hit| hit.t);
            let towards = (direction, ShadowLine::Clear);
            let along = self.direct.transmittance_from::<M>(interaction, towards, length_m, direction.to_array());
            let bias = bias_of_excess(path.excess_depth + excess_optical_depth(&along, nm));
            let (factors, wavelength) = (&context.buffers.factors, context.sampler.wavelength);
            let origin = LightOrigin { class: path.events.class_at_surface(LightPath::Direct), light: number };
            let event = factors.event_at(interaction, direction);
            each_wavelength(path.spectral_mode, factors, emitter.light, wavelength, |nm, throughput| {
                let response = bsdf.eval_sample(wo, &sample, sides, TransportMode::Radiance, nm) / sample.probability;
                let arriving = emitter.light.spd_at(emitter.spd, nm) * emitter.radiance * transmittance(&along, nm);
                let weight = throughput * arriving * response;
                factors.deliver((origin, nm), (weight, bias), event.as_ref(), context.sink);
            });
            if let Some(luminescence) = luminescence {
                let exciting = ExcitingLight {
                    number,
                    light: emitter.light,
                    spd: emitter.spd,
                    irradiance: emitter.radiance * sample.wi.z.abs() / sample.probability,
                    along: &along,
                };
                let radiance = luminescence.excited_radiance(&exciting, self.spectra, wavelength);
                luminescence.add(origin, &radiance, (1.0, bias), context.sink);
            }
        }
    }
}

/// Adds a light that a path hit. The copy lets the calling loop keep its path in registers.
fn add_emitter<S: Sink>(
    path: CameraPath,
    number: usize,
    emitter: &EmitterHit<'_>,
    context: &mut PathContext<'_, '_, S>,
) {
    let bias = bias_of_excess(path.excess_depth);
    let (factors, wavelength) = (&context.buffers.factors, context.sampler.wavelength);
    let origin = LightOrigin { class: path.events.class_of_emission(), light: number };
    each_wavelength(path.spectral_mode, factors, emitter.light, wavelength, |nm, throughput| {
        let weight = throughput * emitter.light.spd_at(emitter.spd, nm) * emitter.radiance;
        factors.deliver((origin, nm), (weight, bias), None, context.sink);
    });
}
