//! The first kernel radii of the sensors of meters.

use crate::emit::{EmissionStrata, PhotonFlight, PhotonVisitor, SurfaceArrival, WavelengthSampling, trace};
use crate::pass::{EmissionRequest, PassContext, PointDisks, crossing};
use crate::plan::CausticPlan;
use crate::plan::partition::LightPath;
use crate::walk::ledger::Ledger;
use abbe_optics::bsdf::BsdfClass;
use abbe_scene::Scene;
use abbe_scene::meter::{Sensor, SensorShape};
use abbe_scene::view::SENSOR_MARGIN;
use abbe_spectra::math::random::{Purpose, Stream};
use abbe_spectra::math::sphere::BoundingSphere;
use glam::DVec3;

const PILOT_PATHS: u64 = 1 << 16;

/// The largest first radius, as a fraction of the radius of the largest specular object.
const LARGEST_RADIUS: f64 = 0.5;

/// Returns the first radii in m, none without sensors or caustics.
pub(super) fn first_radii(context: &PassContext<'_>, scene: &Scene, strata: &EmissionStrata, photons: u64) -> Vec<f64> {
    let sensors = scene.camera.sensors();
    if sensors.is_empty() || context.plan.caustics == CausticPlan::Absent {
        return Vec::new();
    }
    let specular = |object: u32| {
        let mut components = scene.material_of(object).surface.components();
        components.any(|component| component.class() == BsdfClass::Specular)
    };
    let bounds = scene.geometry.object_bounds();
    let radius = |(low, high): &(DVec3, DVec3)| 0.5 * (*high - *low).length();
    let largest = bounds.iter().filter(|(object, _)| specular(**object)).map(|(_, around)| radius(around));
    let most_m = LARGEST_RADIUS * largest.fold(0.0, f64::max).min(scene.radius_m.max(f64::MIN_POSITIVE));
    let paths = PILOT_PATHS.min(photons.max(1));
    let wavelengths = WavelengthSampling::Free;
    let request = EmissionRequest { wavelengths, count: paths, purpose: Purpose::ReceptorPhoton, pass: 0 };
    let source = context.photon_source(scene, strata, request);
    let disks = PointDisks::new(sensors, |_| most_m);
    let mut survey = SensorSurvey { sensors, disks, most_m, distances2: vec![Vec::new(); sensors.len()] };
    let mut ledger = Ledger::new(scene.materials.len());
    trace(&source, &source.points(), 0..paths, &mut survey, &mut ledger);
    // A pass has more photon paths than the survey.
    let nearest = (context.budget.nearest as f64 * paths as f64 / photons.max(1) as f64).max(1.0) as usize;
    let view = scene.visible_sphere();
    let radius_m = |(sensor, mut distances2): (&Sensor, Vec<f64>)| {
        let enough = distances2.len() >= nearest;
        let found_m =
            if enough { distances2.select_nth_unstable_by(nearest - 1, f64::total_cmp).1.sqrt() } else { most_m };
        sensor.position().map_or(found_m, |position| found_m.min(largest_radius_m(view, position)))
    };
    sensors.iter().zip(survey.distances2).map(radius_m).collect()
}

/// Returns the largest radius (m) of a sensor at a position. Photons are denser inside of `view`,
/// the sphere around the sensors, and a kernel lies on one side of its edge.
fn largest_radius_m(view: Option<BoundingSphere>, position: DVec3) -> f64 {
    let Some(view) = view else { return f64::INFINITY };
    let inner_m = view.radius_m / SENSOR_MARGIN;
    if position.distance(view.centre) <= inner_m { view.radius_m - inner_m } else { f64::INFINITY }
}

/// Collects the distances of caustic photons from the sensors.
struct SensorSurvey<'a> {
    sensors: &'a [Sensor],
    disks: PointDisks,
    most_m: f64,
    distances2: Vec<Vec<f64>>,
}

impl PhotonVisitor for SensorSurvey<'_> {
    fn on_emission(&mut self, _stratum: usize, _aim: [f64; 2]) {}

    fn on_surface(&mut self, _arrival: &SurfaceArrival<'_>, _stream: &mut Stream) {}

    fn on_flight(&mut self, flight: &PhotonFlight<'_>) {
        if flight.photon.light_path != LightPath::Caustic {
            return;
        }
        let (sensors, most_m, distances2) = (self.sensors, self.most_m, &mut self.distances2);
        self.disks.visit(flight, |number| {
            let SensorShape::Point(position, response) = sensors[number].shape else { return };
            let found = crossing(flight, position, response, most_m);
            distances2[number].extend(found.map(|(_, d2)| d2));
        });
    }
}
