//! The start of paths of the path tracer at the sensors of meters.

use super::tracer::{PathTracer, TracedPath};
use crate::gather::camera::sampler::{PixelSampler, sensor_pdf};
use crate::gather::direct::light_tree::ReceivingPoint;
use crate::gather::direct::lighting::HitWeighting;
use crate::plan::{CameraEvents, LightOrigin, PathClass, Tally};
use crate::walk::{
    DepthLimit, PathMatrices, Sink, TruncatedLight, crosses_more_panes, light_between_panes, pane_matrix, transmittance,
};
use abbe_scene::meter::Sensor;
use abbe_spectra::spectrum::{LANES, Wavelengths};

impl PathTracer<'_> {
    /// Adds direct light at a sensor, the first scattering event, and starts the path.
    pub(super) fn start_at_sensor<S: Sink>(
        &self,
        sensor: &Sensor,
        sampler: &PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) -> TracedPath {
        tally.sensor_samples += 1;
        let (nm, inverse_pdf) = self.stratified_wavelengths(sampler);
        let start = sampler.sensor_sample(self.scene, sensor, self.direct.portals);
        let from = ReceivingPoint::on_sensor(&start.point);
        let limit = DepthLimit::of(self.scene);
        let pdf = |direction| sensor_pdf((start.point.position, start.point.response), self.direct.portals, direction);
        for selected in self.direct.select_lights(from, sampler.light()) {
            let sample = self.direct.sample_direct_at_sensor(&start.point, pdf, selected, tally);
            let Some(sample) = sample else { continue };
            let origin = LightOrigin { class: PathClass::Direct, light: selected.number };
            let along = &sample.transmittance;
            let radiance = |k: usize| {
                let arriving = sample.light.spd_at(sample.spd, nm[k]) * sample.strength;
                let polarised = if self.polarised { pane_matrix(along, nm[k]).0[0][0] } else { 1.0 };
                inverse_pdf[k] * arriving * transmittance(along, nm[k]) * polarised
            };
            if limit.is_explicit() && crosses_more_panes(along, limit.events()) {
                let truncated = &mut TruncatedLight { sink, factor: 1.0 };
                (0..LANES).for_each(|k| truncated.radiance(origin, nm[k], radiance(k)));
                continue;
            }
            for (k, &nm) in nm.iter().enumerate() {
                sink.biased(origin, nm, radiance(k), -radiance(k) * light_between_panes(along, nm));
            }
        }
        TracedPath {
            ray_state: start.ray_state,
            initial_count: LANES,
            wavelengths: Wavelengths::new(nm),
            observed: nm,
            throughput: inverse_pdf.map(|throughput| throughput * start.weight),
            matrices: PathMatrices::IDENTITY,
            to_picture: None,
            initial_throughput: inverse_pdf,
            hit_weighting: HitWeighting::Mis { from, pdf: start.pdf, caustic: None },
            events: CameraEvents::Surface,
            events_left: TracedPath::UNLIMITED,
        }
    }
}
