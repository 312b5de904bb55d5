//! The walk of a camera path through media: attenuation and emission of each segment.

use crate::gather::camera::path::CameraPath;
use crate::gather::camera::throughput::{Factor, each_wavelength};
use crate::gather::camera_pass::{CameraPass, PathContext};
use crate::gather::direct::lighting::HitWeighting;
use crate::plan::LightOrigin;
use crate::walk::{
    MediumSegment, NumberedMedium, Sink, SurfaceInteraction, bias_of_excess, excess_optical_depth,
    next_interaction_through_media, transmittance,
};
use abbe_spectra::math::random::Seed;
use glam::DVec3;
use std::ops::ControlFlow;

/// The number of positions on a segment at which emission is evaluated.
const EMISSION_POSITIONS: u32 = 16;

/// A segment that transmits a smaller part of the light may end the path by Russian roulette.
const FAINT: f64 = 0.05;

impl<'a> CameraPass<'a> {
    /// Advances the path to the next surface, `None` outside, and gathers the light of the media.
    pub(in crate::gather) fn advance_through_media<S: Sink>(
        &self,
        path: &mut CameraPath,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<SurfaceInteraction<'a>> {
        let lookup = self.lookup(path, context.sampler.stream.uniform());
        let mut behind_m = path.distance_m;
        let end = next_interaction_through_media(self.scene, path.ray_state, lookup, |segment| {
            self.gather_segment(path, segment, behind_m, context);
            behind_m += segment.length_m;
            ControlFlow::Continue(())
        });
        end.continue_value().flatten()
    }

    /// Gathers the light of one segment, `behind_m` (m) along the path, and attenuates the path.
    fn gather_segment<S: Sink>(
        &self,
        path: &mut CameraPath,
        segment: &MediumSegment<'a>,
        behind_m: f64,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        if let Some(filling) = segment.medium {
            context.tally.medium_segments += 1;
            if filling.medium.emission.is_some() && matches!(path.hit_weighting, HitWeighting::Full) {
                self.gather_emission(path, segment, filling, context);
            }
            if filling.medium.scatters() && segment.length_m.is_finite() {
                let luminescence = self.luminescence_of_medium(path, filling.medium, context);
                if !self.plan.direct.is_absent() {
                    self.gather_direct_in_medium(path, segment, (filling, luminescence.as_ref()), context);
                    self.gather_mapped_lights(path, segment, filling, context);
                }
                self.gather_volume_photons(path, segment, (filling, luminescence.as_ref()), behind_m, context);
            }
        }
        context.tally.body_events += u64::from(!segment.medium_stack.is_air());
        context.tally.absorptions += u64::from(segment.absorption.is_some());
        let seed = segment_seed(context, segment.ray.origin);
        let along = segment.path_transmittance(segment.length_m, seed);
        path.excess_depth += excess_optical_depth(&along, path.reference_nm());
        let before = path.reference_throughput;
        for segment_transmittance in along {
            path.multiply(Factor::SegmentTransmittance(segment_transmittance), context.buffers);
        }
        path.is_faint |= path.reference_throughput < FAINT * before;
    }

    /// Gathers the light that a medium emits into the ray. Elsewhere, next-event estimation samples
    /// the medium like any other light.
    fn gather_emission<S: Sink>(
        &self,
        path: &CameraPath,
        segment: &MediumSegment<'a>,
        NumberedMedium { number, medium }: NumberedMedium<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let Some(light_number) = self.scene.medium_lights[number] else { return };
        let light = &self.scene.lights[light_number];
        let origin = LightOrigin { class: path.events.class_of_emission(), light: light_number };
        let Some((from, to)) = medium.interval(&segment.ray, segment.length_m) else { return };
        let step = (to - from) / f64::from(EMISSION_POSITIONS);
        let shift = context.sampler.stream.uniform();
        for i in 0..EMISSION_POSITIONS {
            let t = from + (f64::from(i) + shift) * step;
            let position = segment.ray.at(t);
            let along = segment.path_transmittance(t, segment_seed(context, segment.ray.origin));
            let bias = bias_of_excess(path.excess_depth + excess_optical_depth(&along, path.reference_nm()));
            let (factors, wavelength) = (&context.buffers.factors, context.sampler.wavelength);
            each_wavelength(path.spectral_mode, factors, light, wavelength, |nm, throughput| {
                let weight = throughput * medium.emission_per_m(position, nm) * transmittance(&along, nm) * step;
                factors.deliver((origin, nm), (weight, bias), None, context.sink);
            });
        }
    }
}

/// Returns the seed of ratio tracking from `origin`, independent for successive segments.
pub(super) fn segment_seed<S>(context: &PathContext<'_, '_, S>, origin: DVec3) -> Seed {
    let [x, y, z] = origin.to_array();
    Seed::of_pixel(context.pixel, [context.sampler.wavelength, x, y, z])
}
