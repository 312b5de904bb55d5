//! The start of camera paths at the sensors of meters. A sensor is the first scattering event of
//! its paths: shadow rays find direct light, and a path all other light, and the lights that it
//! hits by chance.

use super::path::CameraPath;
use super::sampler::sensor_pdf;
use super::throughput::{Factor, PathFactors, SpectralMode, each_wavelength};
use crate::gather::camera_pass::{CameraPass, PathContext};
use crate::gather::direct::light_tree::ReceivingPoint;
use crate::gather::direct::lighting::HitWeighting;
use crate::plan::partition::CameraView;
use crate::plan::{CameraEvents, LightOrigin, PathClass, WavelengthPlan};
use crate::walk::{CausticWeights, Sink, bias_of_excess, excess_optical_depth, transmittance};
use abbe_scene::meter::Sensor;
use abbe_spectra::spectrum::REFERENCE_NM;

impl<'a> CameraPass<'a> {
    /// Estimates the mean radiance of one sample of a sensor and adds it to the sink.
    pub(super) fn sample_sensor<S: Sink>(
        &self,
        (number, sensor): (usize, &Sensor),
        context: &mut PathContext<'_, 'a, S>,
    ) {
        context.tally.sensor_samples += 1;
        let portals = self.direct.portals;
        let start = context.sampler.sensor_sample(self.scene, sensor, portals);
        let no_factors = PathFactors::default();
        let (from, wavelength) = (ReceivingPoint::on_sensor(&start.point), context.sampler.wavelength);
        let pdf = |direction| sensor_pdf((start.point.position, start.point.response), portals, direction);
        for selected in self.direct.select_lights(from, context.sampler.light()) {
            let sample = self.direct.sample_direct_at_sensor(&start.point, pdf, selected, context.tally);
            let Some(sample) = sample else { continue };
            let along = &sample.transmittance;
            let bias = bias_of_excess(excess_optical_depth(along, REFERENCE_NM));
            let origin = LightOrigin { class: PathClass::Direct, light: selected.number };
            each_wavelength(SpectralMode::Free, &no_factors, sample.light, wavelength, |nm, throughput| {
                let arriving = sample.light.spd_at(sample.spd, nm) * sample.strength;
                let weight = throughput * arriving * transmittance(along, nm);
                context.sink.biased(origin, nm, weight, weight * bias);
            });
        }
        if start.weight <= 0.0 {
            return;
        }
        let mut path = CameraPath::new(start.ray_state.ray, start.ray_state.medium_stack);
        path.ray_state = start.ray_state;
        (path.view, path.events) = (CameraView::Indirect, CameraEvents::Surface);
        let weights = self.sensors.get(number).copied().unwrap_or(CausticWeights { photons_m2: 0.0 });
        path.hit_weighting = HitWeighting::Mis { from, pdf: start.pdf, caustic: Some(weights) };
        path.multiply(Factor::Grey(start.weight), context.buffers);
        match self.plan.wavelengths {
            WavelengthPlan::Shared => self.follow_each_shared(path, context),
            WavelengthPlan::Free | WavelengthPlan::Both => self.follow(&path, context),
        }
    }
}
