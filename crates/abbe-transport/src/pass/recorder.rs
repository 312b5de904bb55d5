//! Records photons: connects some to the camera, and stores some for the maps.

use super::deposits::{BEAMS, POINTS, PhotonDeposits};
use super::keep_probability::KeepProbability;
use super::sensors::SensorKernels;
use crate::emit::{
    Launch, MediumCollision, MediumCrossing, PhotonDepth, PhotonFlight, PhotonState, PhotonVisitor, RibbonPainter,
    RibbonPart, RibbonTally, SurfaceArrival,
    connect::{PhotonConnector, SplatStokes},
};
use crate::map::{Photon, PhotonBeam, PhotonPower, PhotonSpectra, StoredPolarisation, VolumePhoton};
use crate::plan::partition::{CameraView, Estimator, PerClass, PhotonClass, PhotonSet, estimator, kept_in_map};
use crate::plan::{AimPlan, AperturePlan, CausticPlan, IndirectPlan, PathClass, Plan, Tally, WavelengthPlan};
use crate::sensor::SplatSink;
use crate::walk::{LONG_PATH, NumberedMedium};
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{BAND_NM, LANES};
use glam::DVec3;

/// After this many surface events, only some photons of a path are recorded: they are alike.
const EVENTS_RECORDED_ALWAYS: u32 = 8;

#[derive(Debug, Clone, Copy)]
pub(crate) struct RecordingOptions<'r> {
    pub(crate) keep: PerClass<KeepProbability>,
    /// The number of photon paths in the set, divided by the number of camera samples per pixel.
    pub(crate) photons_per_sample: f64,
    /// The kernels of the sensors of meters. `None` if the set has no sensors.
    pub(crate) sensors: Option<&'r SensorKernels<'r>>,
}

#[derive(Debug)]
pub(crate) struct PhotonRecorder<'a> {
    scene: &'a Scene,
    spectra: &'a PhotonSpectra,
    plan: &'a Plan,
    set: PhotonSet,
    options: RecordingOptions<'a>,
    pub(crate) deposits: PhotonDeposits,
    pub(crate) splats: SplatSink,
    /// The photons beyond the depth limit of the scene.
    pub(crate) truncated: PhotonDeposits,
    pub(crate) truncated_splats: SplatSink,
    pub(crate) tally: Tally,
    ribbons: Option<RibbonPainter<'a>>,
    /// The polarisation of the last connection.
    stokes: SplatStokes,
}

impl<'a> PhotonRecorder<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        spectra: &'a PhotonSpectra,
        plan: &'a Plan,
        set: PhotonSet,
        options: RecordingOptions<'a>,
        splat_sink: impl Fn() -> SplatSink,
    ) -> Self {
        let splats = splat_sink();
        let photons_per_sample = options.photons_per_sample;
        let connector = PhotonConnector::new(scene, plan, photons_per_sample);
        let has_ribbons = plan.ribbons && set == PhotonSet::Free;
        Self {
            scene,
            spectra,
            plan,
            set,
            options,
            ribbons: has_ribbons.then(|| RibbonPainter::new(connector, splats.bands())),
            deposits: PhotonDeposits::default(),
            splats,
            truncated: PhotonDeposits::default(),
            truncated_splats: splat_sink(),
            tally: Tally::default(),
            stokes: [[0.0; 3]; LANES],
        }
    }

    /// Returns the deposits for a photon, and its number of surface events if the scene limits it.
    #[inline]
    fn deposits_for(&mut self, photon: &PhotonState) -> (&mut PhotonDeposits, Option<u16>) {
        match photon.depth {
            PhotonDepth::Unlimited => (&mut self.deposits, None),
            PhotonDepth::Within(events) => (&mut self.deposits, Some(events)),
            PhotonDepth::Beyond(events) => (&mut self.truncated, Some(events)),
        }
    }

    /// Ends the recording after the last photon.
    pub(crate) fn finish(&mut self) {
        self.splats.gather_painted();
        let RibbonTally { ribbons, nodes, pixels } =
            self.ribbons.as_ref().map(RibbonPainter::tally).unwrap_or_default();
        let tally = &mut self.tally;
        (tally.ribbons, tally.ribbon_nodes, tally.ribbon_pixels) = (ribbons, nodes, pixels);
    }

    /// Returns true if a ribbon contains this light.
    fn is_painted(&self, arrival: &SurfaceArrival<'_>) -> bool {
        let SurfaceArrival { interaction, photon, .. } = arrival;
        photon.ribbon == RibbonPart::Painted
            && !photon.is_truncated()
            && interaction.bsdf.model.as_fluorescent().is_none()
    }

    /// Connects the photon, with its power times `factor`, if the plan connects its class.
    fn connect(&mut self, arrival: &SurfaceArrival<'_>, factor: f64, stream: &mut Stream) {
        let class = arrival.interaction.bsdf.class();
        let connects = estimator(arrival.photon.light_path, class, CameraView::Direct) == Estimator::Connection;
        // If camera paths carry shared wavelengths from the camera on, all views count as indirect:
        // camera paths read the photon map, and no photon is connected.
        let free = self.set == PhotonSet::Free && self.plan.wavelengths != WavelengthPlan::Shared;
        if !(free && connects) || self.is_painted(arrival) {
            return;
        }
        let lens = match self.plan.aperture {
            AperturePlan::Pinhole | AperturePlan::LensSystem(_) => [0.5; 2],
            AperturePlan::ThinLens(_) => stream.pair(),
        };
        let camera = PhotonConnector::new(self.scene, self.plan, self.options.photons_per_sample);
        let emission = arrival.interaction.bsdf.model.as_fluorescent().map_or(0.0, |_| stream.uniform());
        if let Some(splat) = camera.connect(arrival, lens, emission, &mut self.stokes) {
            self.tally.connections += 1;
            let lanes = splat.lanes().map(|(nm, radiance)| (nm, radiance * factor));
            let splats = if arrival.photon.is_truncated() { &mut self.truncated_splats } else { &mut self.splats };
            // Only caustic photons on directly visible surfaces are connected.
            let light = self.spectra.light_of(arrival.photon.wavelength_code);
            splats.splat((PathClass::Caustic.number(), light), splat.pixel, lanes);
            if self.plan.polarisation.records_stokes() {
                splats.stokes(
                    splat.pixel,
                    splat.stokes(&self.stokes).map(|(nm, stokes)| (nm, stokes.map(|part| part * factor))),
                );
            }
        }
    }
}

impl PhotonVisitor for PhotonRecorder<'_> {
    fn on_surface(&mut self, arrival: &SurfaceArrival<'_>, stream: &mut Stream) {
        let Some(class) = arrival.photon.light_path.photon_class() else { return };
        let wanted = match class {
            PhotonClass::Caustic => self.plan.caustics != CausticPlan::Absent,
            PhotonClass::Indirect => self.plan.indirect != IndirectPlan::Absent,
        };
        if !wanted {
            return;
        }
        let Some(factor) = recorded_factor(arrival.depth, stream) else { return };
        // A photon starts with several wavelengths, and keeps one after a dispersive refraction.
        self.tally.dispersions += u64::from(arrival.photon.wavelengths.count == 1);
        self.connect(arrival, factor, stream);
        let mut components = self.scene.materials[arrival.interaction.material].surface.components();
        if components.any(|surface| kept_in_map(arrival.photon.light_path, surface.class())) {
            let probability = self.options.keep[class].surface;
            if probability < 1.0 && stream.uniform() >= probability {
                return;
            }
            self.tally.stored += 1;
            let position = arrival.interaction.hit.position.as_vec3().to_array();
            let photon = surface_photon(arrival, factor / probability, stream);
            let polarised = self.plan.polarisation.is_on();
            self.tally.polarised_events += u64::from(polarised);
            let (deposits, events) = self.deposits_for(arrival.photon);
            if polarised {
                let travel = [arrival.interaction.incoming, -photon.to_light()];
                deposits.surface_polarisation[class].push(stored_polarisation(arrival.photon, travel));
            }
            deposits.surface[class].push((photon, position));
            if let Some(before) = events {
                deposits.surface_events[class].push(before + 1);
            }
        }
    }

    fn on_arrival(&mut self, arrival: &SurfaceArrival<'_>) {
        self.tally.photon_segments += 1;
        if let Some(sensors) = self.options.sensors {
            let light = self.spectra.light_of(arrival.photon.wavelength_code);
            let splats = if arrival.photon.is_truncated() { &mut self.truncated_splats } else { &mut self.splats };
            sensors.add_arrival(arrival, light, splats);
        }
    }

    #[inline]
    fn on_flight(&mut self, flight: &PhotonFlight<'_>) {
        if let Some(sensors) = self.options.sensors {
            let light = self.spectra.light_of(flight.photon.wavelength_code);
            let splats = if flight.photon.is_truncated() { &mut self.truncated_splats } else { &mut self.splats };
            sensors.add_flight(flight, light, splats);
        }
    }

    fn on_launch(&mut self, launch: &Launch) {
        let Self { ribbons: Some(painter), splats, spectra, .. } = self else { return };
        let Some(power) = spectra.power(launch.light) else { return };
        let origin = (PathClass::Caustic.number(), spectra.light_of(launch.wavelength_code));
        painter.paint(launch, power, |pixel, nm, radiance| splats.paint(origin, pixel, nm, radiance));
    }

    fn on_body_face(&mut self) {
        self.tally.body_events += 1;
    }

    fn on_medium_crossing(&mut self, crossing: &MediumCrossing<'_>, stream: &mut Stream) {
        let MediumCrossing { segment, medium: NumberedMedium { number, medium }, photon } = *crossing;
        let Some(class) = photon.light_path.photon_class() else { return };
        let wanted = self.plan.volume.keeps_beams(medium.dense) && medium.scatters() && segment.length_m.is_finite();
        let probability = self.options.keep[class].beams;
        if wanted && probability > 0.0 && stream.uniform() < probability {
            self.tally.volume_beams += 1;
            let ends = [segment.ray.origin, segment.ray.at(segment.length_m)];
            let beam = PhotonBeam::new(ends, number, kept_power(photon, probability, stream));
            let polarised = self.plan.polarisation.is_on();
            let (deposits, events) = self.deposits_for(photon);
            if polarised {
                let travel = [segment.ray.direction, beam.direction()];
                deposits.volume[class].polarisation[BEAMS].push(stored_polarisation(photon, travel));
            }
            deposits.volume[class].beams.push(events.map_or(beam, |events| beam.with_events(events)));
        }
    }

    fn on_medium_collision(&mut self, collision: &MediumCollision, stream: &mut Stream) {
        let MediumCollision { position, incoming, medium: NumberedMedium { number, medium }, photon } = *collision;
        let Some(class) = photon.light_path.photon_class() else { return };
        let wanted = self.plan.volume.keeps_points(medium.dense) && medium.scatters();
        let probability = self.options.keep[class].points;
        if wanted && probability > 0.0 && stream.uniform() < probability {
            self.tally.volume_points += 1;
            let power = kept_power(photon, probability, stream);
            let point = VolumePhoton::new(position, incoming, number, power);
            let polarised = self.plan.polarisation.is_on();
            let (deposits, events) = self.deposits_for(photon);
            if polarised {
                let travel = [incoming, point.incoming()];
                deposits.volume[class].polarisation[POINTS].push(stored_polarisation(photon, travel));
            }
            deposits.volume[class].points.push(events.map_or(point, |events| point.with_events(events)));
        }
    }

    fn on_emission(&mut self, _stratum: usize, _aim: [f64; 2]) {
        self.tally.photons += 1;
        self.tally.shared_photons += u64::from(self.set == PhotonSet::Shared);
        self.tally.aimed += u64::from(self.plan.aim == AimPlan::Learned);
    }

    fn on_start(&mut self, _ray: &Ray, photon: &PhotonState) {
        self.tally.ultraviolet_photons += u64::from(photon.wavelengths.nm[0] < BAND_NM.0);
    }
}

/// Returns the polarisation that a map stores for a photon with these two directions: of its flight
/// and of the map.
fn stored_polarisation(photon: &PhotonState, travel: [DVec3; 2]) -> StoredPolarisation {
    StoredPolarisation::new(&photon.polarisation, travel, photon.lane)
}

/// Returns the power of a photon that a medium stores with this probability.
fn kept_power(photon: &PhotonState, probability: f64, stream: &mut Stream) -> PhotonPower {
    let power = photon.power.map(|power| power / probability);
    PhotonPower::new(photon.wavelength_code, power, photon.lane, stream.uniform())
}

/// Decides whether the photon at surface event number `depth` is recorded, and returns the factor
/// for its power. The probability falls as 1/depth, so that a path of n events without loss leaves
/// only about 8 + 8 ln(n/8) photons. On long paths it is constant, because the number of these
/// paths falls as 1/depth.
#[inline]
fn recorded_factor(depth: u32, stream: &mut Stream) -> Option<f64> {
    if depth <= EVENTS_RECORDED_ALWAYS {
        return Some(1.0);
    }
    let factor = f64::from(depth.min(LONG_PATH)) / f64::from(EVENTS_RECORDED_ALWAYS);
    (stream.uniform() * factor < 1.0).then_some(factor)
}

/// Returns the photon that the map stores, with its power times `factor`.
fn surface_photon(arrival: &SurfaceArrival<'_>, factor: f64, stream: &mut Stream) -> Photon {
    let hit = &arrival.interaction.hit;
    let to_light = arrival.to_light();
    let facing = if to_light.dot(hit.normal) >= 0.0 { hit.normal } else { -hit.normal };
    let PhotonState { wavelength_code, power, lane, ray_density, .. } = *arrival.photon;
    let power = PhotonPower::new(wavelength_code, power.map(|power| power * factor), lane, stream.uniform());
    Photon::new(power, to_light, facing).with_ray_density(ray_density)
}
