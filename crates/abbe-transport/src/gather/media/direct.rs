//! Single scattering: direct light that a medium scatters into a camera path.

use super::distance;
use super::segment::segment_seed;
use crate::gather::camera::path::CameraPath;
use crate::gather::camera::throughput::each_wavelength;
use crate::gather::camera_pass::{CameraPass, PathContext};
use crate::gather::direct::light_tree::ReceivingSegment;
use crate::gather::direct::lighting::VolumeLightSampleContext;
use crate::gather::luminescence::{ExcitingLight, Luminescence};
use crate::plan::LightOrigin;
use crate::walk::{
    MediumSegment, NumberedMedium, RayState, SegmentTransmittance, Sink, bias_of_excess, excess_optical_depth,
    transmittance,
};
use abbe_optics::phase::{Deflection, PhaseMixture};
use abbe_scene::geometry::Ray;

impl<'a> CameraPass<'a> {
    /// Gathers direct light from the lights without a light map, each at one sampled distance,
    /// where it is scattered or excites the dye of the medium.
    pub(super) fn gather_direct_in_medium<S: Sink>(
        &self,
        path: &CameraPath,
        segment: &MediumSegment<'a>,
        (NumberedMedium { number: medium_number, medium }, luminescence): (
            NumberedMedium<'a>,
            Option<&Luminescence<'a>>,
        ),
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let Some(interval) = medium.interval(&segment.ray, segment.length_m) else { return };
        let (from, to) = (segment.ray.at(interval.0), segment.ray.at(interval.1));
        let u = context.sampler.light();
        for selected in self.direct.select_lights(ReceivingSegment { from, to }, u) {
            let number = selected.number;
            if self.light_maps.of(number, medium_number).is_some() {
                continue;
            }
            let u_distance = context.sampler.stream.pair();
            let light = &self.scene.lights[number];
            let lit = light.lit_interval(self.scene.extent(), &segment.ray, interval, selected.u);
            let distance = lit.and_then(|lit| distance::sample(medium, &segment.ray, &lit, u_distance));
            let Some(distance) = distance else { continue };
            let density = medium.density_at(segment.ray.at(distance.t_m));
            let to_point = segment.path_transmittance(distance.t_m, segment_seed(context, segment.ray.origin));
            let ray = Ray { origin: segment.ray.at(distance.t_m), direction: segment.ray.direction };
            let ray_state = RayState { ray, from: None, medium_stack: segment.medium_stack };
            let phase = PhaseMixture::at(&medium.phase, path.reference_nm());
            let point = VolumeLightSampleContext { ray_state, phase, continues: false };
            let Some(sample) = self.direct.sample_direct_in_medium(point, selected, context.tally) else { continue };
            let directions = [sample.incoming, -segment.ray.direction];
            let deflection = Deflection::between(directions[0], directions[1]);
            let strength = sample.strength * density / distance.pdf_per_m;
            let excess = |along: &[SegmentTransmittance<'_>]| excess_optical_depth(along, path.reference_nm());
            let bias = bias_of_excess(path.excess_depth + excess(&to_point) + excess(&sample.transmittance));
            let (factors, wavelength) = (&context.buffers.factors, context.sampler.wavelength);
            let origin = LightOrigin { class: path.events.class_in_medium(), light: number };
            let event = factors.event_in_medium(medium, directions);
            each_wavelength(path.spectral_mode, factors, sample.light, wavelength, |nm, throughput| {
                let scattered = medium.scattering.at(nm) * medium.phase.eval(deflection, nm);
                let passed = transmittance(&to_point, nm) * transmittance(&sample.transmittance, nm);
                let weight = throughput * sample.light.spd_at(sample.spd, nm) * strength * scattered * passed;
                factors.deliver((origin, nm), (weight, bias), event.as_ref(), context.sink);
            });
            if let Some(luminescence) = luminescence {
                let exciting = ExcitingLight {
                    number,
                    light: sample.light,
                    spd: sample.spd,
                    irradiance: strength,
                    along: &sample.transmittance,
                };
                let mut radiance = luminescence.excited_radiance(&exciting, self.spectra, wavelength);
                luminescence.attenuate(&to_point, &mut radiance);
                luminescence.add(origin, &radiance, (1.0, bias), context.sink);
            }
        }
    }
}
