//! Local lights for the contract tests.

use super::*;

#[derive(Clone)]
pub(in crate::light) struct TestLight {
    pub(in crate::light) name: &'static str,
    pub(in crate::light) emitter: Emitter,
    /// The largest angle between an emitted ray and the axis.
    pub(in crate::light) cone_rad: f64,
    /// The largest distance from the light's position at which a ray starts, on the plane through
    /// this position that is perpendicular to the axis.
    pub(in crate::light) disk_m: f64,
    /// The irradiance on the axis at a distance of 2 m, if it has a closed form.
    pub(in crate::light) irradiance_at_2_m: Option<f64>,
}

/// The position and the axis of the local lights.
pub(super) fn local_place() -> (DVec3, DVec3) {
    (DVec3::new(0.3, -0.2, 0.4), DVec3::new(0.5, 1.0, -0.3).normalize())
}

pub(super) fn local_case(name: &'static str, emitter: Emitter) -> LightCase {
    let (at, axis) = local_place();
    let ahead =
        ReceiverSquare::new(at + 1.2 * axis + DVec3::new(0.1, 0.0, 0.05), -axis + DVec3::new(0.2, 0.1, 0.0), 0.8);
    let geometry = Geometry::build(Vec::new(), DVec3::ZERO).unwrap();
    LightCase { name, light: light(emitter, flat_spectrum()), geometry, receiver: ahead }
}

pub(super) fn local_cases() -> Vec<LightCase> {
    let (at, axis) = local_place();
    local_test_lights(at, axis).into_iter().map(|test| local_case(test.name, test.emitter)).collect()
}

#[test]
fn local_lights_emit_within_their_bounds() {
    for case in local_cases() {
        let (low, high) = case.light.bounds(&BTreeMap::new()).unwrap();
        let mut stream = stream(15);
        for _ in 0..5000 {
            let origin = case.emit(&mut stream).origin;
            let inside = origin.cmpge(low - 1e-12).all() && origin.cmple(high + 1e-12).all();
            assert!(inside, "{}: {origin} outside {low} to {high}", case.name);
        }
    }
}

#[test]
fn moved_lights_shine_on_moved_points() {
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 1.1);
    let map = DAffine3::from_rotation_translation(rotation, DVec3::new(0.4, 0.2, -0.7));
    for case in local_cases() {
        let moved = light(case.light.emitter.moved(&map), flat_spectrum());
        let mean = |light: &Light, from: DVec3| {
            let mut stream = stream(16);
            SampleMean::of(100_000, || {
                light.sample_li(case.extent(), from, stream.triple()).map_or(0.0, |incident| incident.irradiance)
            })
        };
        let from = case.receiver.centre;
        mean(&moved, map.transform_point3(from)).agrees(mean(&case.light, from), 0.01, case.name);
    }
}

/// The bounds of a beam begin at the apex of its cone, so the test follows the rays for 1 m.
#[test]
fn emitted_light_stays_within_the_intensity_bounds() {
    for case in all_cases() {
        let Some(bounds) = case.light.intensity_bounds(case.extent()) else { continue };
        let mut stream = stream(7);
        for _ in 0..2000 {
            let sample = case.emit(&mut stream);
            if sample.flux_w <= 0.0 {
                continue;
            }
            let from = sample.origin.clamp(bounds.low, bounds.high);
            let along = (sample.origin + sample.direction - from).normalize();
            let angle = along.dot(bounds.axis).clamp(-1.0, 1.0).acos();
            assert!(angle <= bounds.normals_rad + bounds.emission_rad + 1e-6, "{}: {angle}", case.name);
        }
    }
}

/// Every kind of local light has bounds, except beams of parallel rays.
#[test]
fn only_light_that_does_not_fall_with_the_distance_has_no_bounds() {
    for case in all_cases() {
        let parallel = matches!(&case.light.emitter, Emitter::Beam(beam) if beam.is_parallel());
        let bounded = case.light.intensity_bounds(case.extent()).is_some();
        assert_eq!(bounded, !case.light.is_distant() && !parallel, "{}", case.name);
    }
}
