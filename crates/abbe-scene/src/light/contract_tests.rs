//! The contract of all lights: the mean emitted flux equals the power of the light, and the
//! irradiance from shadow rays equals the irradiance from emitted rays.
//!
//! Estimates must agree within four standard errors, which are small enough to detect a deviation
//! of two per cent. All runs use the same random numbers.

mod distant;
mod local;
mod volume;

pub(super) use local::TestLight;

use super::*;
use crate::geometry::Ray;
use crate::geometry::mesh::TriangleMesh;
use crate::geometry::shape::{PlacedShape, Shape};
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::random::{ONE_MINUS_ULP, Purpose, Seed, Stream};
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use distant::distant_cases;
use glam::{DAffine3, DMat3, DQuat};
use local::{local_case, local_cases, local_place};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// The radius of the bounding sphere that distant lights illuminate.
const WORLD_RADIUS_M: f64 = 1.5;

/// A light, the surfaces of the scene, and a square on which the irradiance is measured.
struct LightCase {
    name: &'static str,
    light: Light,
    geometry: Geometry,
    receiver: ReceiverSquare,
}

#[derive(Clone, Copy)]
struct ReceiverSquare {
    centre: DVec3,
    normal: DVec3,
    sides: [DVec3; 2],
}

impl ReceiverSquare {
    fn new(centre: DVec3, facing: DVec3, side: f64) -> Self {
        let normal = facing.normalize();
        let across = normal.any_orthonormal_vector();
        Self { centre, normal, sides: [across * side, normal.cross(across) * side] }
    }

    fn area(&self) -> f64 {
        self.sides[0].cross(self.sides[1]).length()
    }

    fn point(&self, u: [f64; 2]) -> DVec3 {
        self.centre + self.sides[0] * (u[0] - 0.5) + self.sides[1] * (u[1] - 0.5)
    }

    fn intersect(&self, ray: &Ray) -> Option<f64> {
        let approach = -ray.direction.dot(self.normal);
        let t = (ray.origin - self.centre).dot(self.normal) / approach;
        let offset = ray.at(t) - self.centre;
        let inside = self.sides.iter().all(|side| offset.dot(*side).abs() <= 0.5 * side.length_squared());
        (approach > 0.0 && t > 0.0 && inside).then_some(t)
    }
}

impl LightCase {
    fn extent(&self) -> SceneExtent<'_> {
        SceneExtent { geometry: &self.geometry, radius_m: WORLD_RADIUS_M }
    }

    fn emit(&self, stream: &mut Stream) -> LeSample {
        self.light.sample_le(self.extent(), LeRandoms { aim: stream.pair(), rest: stream.triple() })
    }

    fn sees(&self, from: DVec3, incident: &LiSample) -> bool {
        let ray = Ray::new(from, incident.direction);
        !self.geometry.occluded(&ray, None, incident.target, incident.distance)
    }
}

fn light(emitter: Emitter, spectrum: Spectrum) -> Light {
    let wavelengths = WavelengthDistribution::new(&spectrum).unwrap();
    Light {
        name: String::new(),
        group: String::new(),
        emitter,
        spectrum,
        wavelengths,
        ultraviolet: None,
        importance_per_watt: 1.0,
        medium_stack: MediumStack::AIR,
        crosses_bodies: false,
        motion: None,
    }
}

fn flat_spectrum() -> Spectrum {
    Spectrum::constant(1.0 / 470.0)
}

fn place_turned(shape: Shape) -> PlacedShape {
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    PlacedShape {
        shape,
        to_world: DAffine3::from_rotation_translation(rotation, DVec3::new(0.2, 0.1, -0.1)),
        object: 0,
    }
}

fn area_case(name: &'static str, placed: PlacedShape) -> LightCase {
    let up = placed.to_world.transform_vector3(DVec3::Y).normalize();
    let middle = placed.to_world.translation;
    let geometry = Geometry::build(vec![placed], DVec3::ZERO).unwrap();
    let emitter = Emitter::Area(AreaLight { object: 0, radiance: 3.0, area_m2: geometry.area(0), slide: None });
    let light = light(emitter, flat_spectrum());
    // The receiver is above the shape's front, to one side of it, and tilted.
    let way = (up + 0.4 * up.any_orthonormal_vector()).normalize();
    let tilt = way.cross(up).normalize();
    LightCase { name, light, geometry, receiver: ReceiverSquare::new(middle + 1.3 * way, -way + 0.3 * tilt, 0.9) }
}

fn area_cases() -> Vec<LightCase> {
    let unequal = PlacedShape {
        shape: Shape::Sphere { radius: 0.4 },
        to_world: DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(1.8, 0.5, 1.0))),
        object: 0,
    };
    vec![
        area_case("rectangle", place_turned(Shape::Rectangle { width: 0.8, height: 0.5 })),
        area_case("disk", place_turned(Shape::Disk { radius: 0.4 })),
        area_case("sphere", place_turned(Shape::Sphere { radius: 0.4 })),
        area_case("ellipsoid", unequal),
        area_case("box", place_turned(Shape::Box { size: DVec3::new(0.7, 0.4, 0.5) })),
        area_case("cylinder", place_turned(Shape::Cylinder { radius: 0.3, height: 0.6 })),
        area_case("prism", place_turned(Shape::Prism { side: 0.7, length: 0.6, apex_deg: 50.0 })),
        area_case("lens", place_turned(Shape::Lens { radius1: 0.5, radius2: -0.8, thickness: 0.4, diameter: 0.7 })),
        // A concave surface shades itself.
        area_case(
            "hollow lens",
            place_turned(Shape::Lens { radius1: -0.5, radius2: 0.5, thickness: 0.1, diameter: 0.9 }),
        ),
        area_case("mesh", place_turned(Shape::Mesh(Arc::new(tetrahedron())))),
    ]
}

fn tetrahedron() -> TriangleMesh {
    let corners = [[0.5, -0.2, 0.0], [-0.4, -0.3, 0.4], [-0.3, -0.2, -0.5], [0.0, 0.5, 0.1]].map(DVec3::from);
    TriangleMesh::new(corners.to_vec(), None, None, vec![[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]]).unwrap()
}

fn all_cases() -> Vec<LightCase> {
    local_cases().into_iter().chain(distant_cases()).chain(area_cases()).chain(volume::cases()).collect()
}

#[derive(Debug, Clone, Copy)]
struct SampleMean {
    value: f64,
    error: f64,
}

impl SampleMean {
    fn of(count: u32, mut draw: impl FnMut() -> f64) -> Self {
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..count {
            let value = draw();
            sum += value;
            squares += value * value;
        }
        let n = f64::from(count);
        let value = sum / n;
        Self { value, error: ((squares / n - value * value).max(0.0) / n).sqrt() }
    }

    /// Asserts that the mean equals `expected` within four standard errors (and rounding), and that
    /// its relative standard error is below `precision`.
    fn agrees(self, expected: Self, precision: f64, what: &str) {
        let error = self.error.hypot(expected.error);
        let difference = (self.value - expected.value).abs();
        assert!(
            error <= precision * expected.value.abs(),
            "{what}: {self:?} against {expected:?} is not precise enough"
        );
        assert!(difference <= 4.0 * error + 1e-9 * expected.value.abs(), "{what}: {self:?} against {expected:?}");
    }
}

fn exactly(value: f64) -> SampleMean {
    SampleMean { value, error: 0.0 }
}

fn stream(number: u64) -> Stream {
    Stream::new(Seed::new(11), Purpose::SurveyPhoton, 7, number)
}

#[test]
fn the_mean_emitted_flux_is_the_power() {
    for case in all_cases() {
        let mut stream = stream(0);
        let mean = SampleMean::of(100_000, || case.emit(&mut stream).flux_w);
        mean.agrees(exactly(case.light.power_w(case.extent())), 0.003, case.name);
    }
}

/// Rays sampled through a sphere carry the flux that the other emitted rays bring to the sphere.
#[test]
#[ignore = "nightly: 12 seconds of CPU time"]
fn rays_through_a_sphere_carry_its_flux() {
    for case in all_cases() {
        let sphere = BoundingSphere { centre: case.receiver.centre, radius_m: 0.7 * case.receiver.area().sqrt() };
        let (mut any, mut through) = (stream(3), stream(4));
        let brought = SampleMean::of(1_000_000, || {
            let emission = case.emit(&mut any);
            if sphere.contains_part_of(emission.origin, emission.direction) { emission.flux_w } else { 0.0 }
        });
        let aimed = SampleMean::of(400_000, || {
            let u = LeRandoms { aim: through.pair(), rest: through.triple() };
            case.light.sample_le_through(case.extent(), &sphere, u).flux_w
        });
        aimed.agrees(brought, 0.012, case.name);
    }
}

#[test]
#[ignore = "nightly: 11 seconds of CPU time"]
fn emitted_rays_and_shadow_rays_give_the_same_irradiance() {
    for case in all_cases() {
        let receiver = case.receiver;
        let mut emitted = stream(1);
        let brought = SampleMean::of(1_000_000, || {
            let emission = case.emit(&mut emitted);
            let ray = Ray::new(emission.origin, emission.direction);
            let arrives =
                receiver.intersect(&ray).is_some_and(|t| !case.geometry.occluded(&ray, emission.from, None, t));
            if arrives { emission.flux_w / receiver.area() } else { 0.0 }
        });
        let mut drawn = stream(2);
        let found = SampleMean::of(100_000, || {
            let from = receiver.point(drawn.pair());
            let incident = case.light.sample_li(case.extent(), from, drawn.triple());
            let seen = incident.filter(|incident| case.sees(from, incident));
            seen.map_or(0.0, |incident| incident.irradiance * incident.direction.dot(receiver.normal).max(0.0))
        });
        brought.agrees(found, 0.012, case.name);
    }
}

#[test]
fn shadow_rays_find_the_closed_form_irradiance() {
    let ((at, axis), distance) = (local_place(), 2.0_f64);
    let placed = |shape| PlacedShape {
        shape,
        to_world: DAffine3::from_rotation_translation(DQuat::from_rotation_arc(DVec3::Y, axis), at),
        object: 0,
    };
    let area = |shape| area_case("", placed(shape));
    let local = super::local_test_lights(at, axis)
        .into_iter()
        .filter_map(|test| Some((local_case(test.name, test.emitter), test.irradiance_at_2_m?)));
    let (radius, radiance) = (0.7_f64, 3.0);
    let others = [
        (local_case("directional", Emitter::Directional(DirectionalLight::new(axis, 0.0, 4.0))), 4.0),
        (local_case("sun", Emitter::Directional(DirectionalLight::new(axis, 0.5, 4.0))), 4.0),
        (local_case("sky", Emitter::Environment(EnvironmentLight::new(2.0, EnvironmentPattern::Uniform))), 2.0 * PI),
        (area(Shape::Sphere { radius }), PI * radiance * (radius / distance).powi(2)),
        (area(Shape::Disk { radius }), PI * radiance * radius * radius / (radius * radius + distance * distance)),
    ];
    for (number, (case, expected)) in local.chain(others).enumerate() {
        let from = at + distance * axis;
        let mut stream = stream(3);
        let mean = SampleMean::of(200_000, || {
            let incident = case.light.sample_li(case.extent(), from, stream.triple());
            incident.map_or(0.0, |i| i.irradiance * i.direction.dot(-axis).max(0.0))
        });
        mean.agrees(exactly(expected), 0.004, &format!("closed form {number} {}", case.name));
    }
}

/// A light map uses one virtual light of a light without extent for all passes, so all of them must
/// be equal.
#[test]
fn virtual_lights_add_up_to_the_light() {
    for case in all_cases() {
        let (world, from) = (case.extent(), case.receiver.centre);
        let mut random = stream(13);
        let first = case.light.virtual_light(world, random.triple());
        assert_eq!(first.is_some(), case.light.has_virtual_lights(), "{}", case.name);
        let Some(first) = first else { continue };
        let toward = |incident: Option<LiSample>| incident.map_or(0.0, |incident| incident.irradiance);
        let by_virtual_lights = SampleMean::of(200_000, || {
            let one = case.light.virtual_light(world, random.triple()).unwrap();
            if case.light.is_delta() {
                assert_eq!(one.connection_from(from), first.connection_from(from), "{}", case.name);
            }
            toward(case.light.li_from(world, &one, from).filter(|incident| case.sees(from, incident)))
        });
        let mut drawn = stream(14);
        let found = SampleMean::of(200_000, || {
            let incident = case.light.sample_li(world, from, drawn.triple());
            toward(incident.filter(|incident| case.sees(from, incident)))
        });
        by_virtual_lights.agrees(found, 0.01, case.name);
    }
}

#[test]
fn sampled_directions_hit_the_light_with_their_pdf() {
    for case in area_cases().into_iter().chain(distant_cases()) {
        let (world, receiver) = (case.extent(), case.receiver);
        let mut stream = stream(4);
        for _ in 0..20_000 {
            let from = receiver.point(stream.pair());
            let Some(incident) = case.light.sample_li(world, from, stream.triple()) else { continue };
            let Some(pdf) = incident.pdf_solid_angle.filter(|_| case.sees(from, &incident)) else { continue };
            let (looked_up, radiance) = if case.light.is_distant() {
                let radiance = case.light.le(incident.direction).map_or(0.0, |(radiance, _)| radiance);
                (case.light.pdf_li_escaped(incident.direction), radiance)
            } else {
                let hit = case.geometry.intersect(&Ray::new(from, incident.direction), None, f64::INFINITY);
                let Some(hit) = hit.filter(|hit| hit.normal.dot(incident.direction) < -1e-5) else { continue };
                assert!((hit.t - incident.distance).abs() < 1e-9, "{}: {} m", case.name, hit.t - incident.distance);
                (case.light.pdf_li_surface(world, from, &hit), case.light.le_surface(world, incident.direction, &hit).0)
            };
            assert!((looked_up / pdf - 1.0).abs() < 1e-6, "{}: {looked_up} against {pdf}", case.name);
            let expected = incident.irradiance * pdf;
            assert!((radiance / expected - 1.0).abs() < 1e-6, "{}: {radiance} against {expected}", case.name);
        }
    }
}

#[test]
fn the_surface_pdf_integrates_to_the_lit_fraction() {
    // Both sides are weighted by the cosine at the light, without which the density of area
    // sampling would have no bound near cosine 0.
    for case in area_cases() {
        let (world, from) = (case.extent(), case.receiver.centre);
        // Uniform directions in a cone around the whole object.
        let (low, high) = case.geometry.bounds();
        let (axis, distance) = (0.5 * (low + high) - from).normalize_and_length();
        let cone = warp::one_minus_cos((0.5 * (high - low).length() / distance).asin());
        let frame = Frame::new(axis);
        let mut uniform = stream(5);
        let integral = SampleMean::of(400_000, || {
            let ray = Ray::new(from, frame.to_world(warp::cone(cone, uniform.pair())));
            let hit = case.geometry.intersect(&ray, None, f64::INFINITY);
            let lit = hit.filter(|hit| case.light.le_surface(world, ray.direction, hit).0 > 0.0);
            lit.map_or(0.0, |hit| {
                TAU * cone * case.light.pdf_li_surface(world, from, &hit) * -hit.normal.dot(ray.direction)
            })
        });
        let mut drawn = stream(6);
        let lit = SampleMean::of(200_000, || {
            let incident = case.light.sample_li(world, from, drawn.triple());
            let ray = incident.filter(|i| case.sees(from, i)).map(|i| Ray::new(from, i.direction));
            let hit = ray.and_then(|ray| case.geometry.intersect(&ray, None, f64::INFINITY));
            hit.zip(ray).map_or(0.0, |(hit, ray)| -hit.normal.dot(ray.direction))
        });
        integral.agrees(lit, 0.01, case.name);
    }
}

#[test]
fn the_pdf_of_distant_lights_integrates_to_one() {
    for case in distant_cases().into_iter().filter(|case| !case.light.is_delta()) {
        let mut stream = stream(8);
        let integral = SampleMean::of(400_000, || 4.0 * PI * case.light.pdf_li_escaped(warp::sphere(stream.pair())));
        integral.agrees(exactly(1.0), 0.015, case.name);
    }
}

#[test]
fn area_lights_emit_from_their_surface_to_its_outer_side() {
    for case in area_cases() {
        let mut stream = stream(9);
        for _ in 0..5000 {
            let emission = case.emit(&mut stream);
            // A ray back to the origin must hit the outer side of the same surface.
            let step = 1e-3;
            let back = Ray::new(emission.origin + step * emission.direction, -emission.direction);
            let hit = case.geometry.intersect(&back, None, f64::INFINITY);
            let hit = hit.filter(|hit| hit.normal.dot(emission.direction) > 1e-3);
            let Some(hit) = hit else { continue };
            assert!((hit.t - step).abs() < 1e-9 && Some(hit.surface) == emission.from, "{}: {hit:?}", case.name);
        }
        let lost = (0..5000).filter(|_| {
            let emission = case.emit(&mut stream);
            let ray = Ray::new(emission.origin, emission.direction);
            case.geometry.intersect(&ray, emission.from, f64::INFINITY).is_some()
        });
        let convex = case.name != "hollow lens";
        assert!(!convex || lost.count() == 0, "{}: emitted rays run into the light itself", case.name);
    }
}

#[test]
fn emitted_rays_stay_within_the_cone_and_disk_of_the_light() {
    let axis_angle = |axis: DVec3, direction: DVec3| axis.cross(direction).length().atan2(axis.dot(direction));
    let (at, axis) = local_place();
    let toward = DVec3::new(0.3, -0.9, 0.5).normalize();
    let local = local_test_lights(at, axis)
        .into_iter()
        .map(|test| (local_case(test.name, test.emitter), test.cone_rad, test.disk_m));
    let distant = distant_cases().into_iter().map(|case| {
        let angle = match case.name {
            "directional" => 0.0,
            "sun" => 0.3,
            _ => PI,
        };
        (case, angle, WORLD_RADIUS_M)
    });
    for (case, angle, disk) in local.chain(distant) {
        let mut stream = stream(10);
        let (mut widest, mut outermost) = (0.0_f64, 0.0_f64);
        for _ in 0..20_000 {
            let emission = case.emit(&mut stream);
            widest = widest.max(axis_angle(if case.light.is_distant() { toward } else { axis }, emission.direction));
            let offset = if case.light.is_distant() {
                // Rays of distant lights start outside the bounding sphere and cross it.
                assert!(emission.origin.dot(emission.direction) <= -WORLD_RADIUS_M + 1e-9, "{}", case.name);
                emission.origin - emission.direction * emission.origin.dot(emission.direction)
            } else {
                assert!((emission.origin - at).dot(axis).abs() < 1e-12, "{}", case.name);
                emission.origin - at
            };
            outermost = outermost.max(offset.length());
        }
        // All rays start on the disk and stay within the cone, and some are near the edges of both.
        assert!(widest <= angle + 1e-7 && widest >= 0.95 * angle, "{}: {widest} rad", case.name);
        assert!(outermost <= disk * (1.0 + 1e-12) && outermost >= 0.99 * disk, "{}: {outermost} m", case.name);
    }
}

#[test]
fn extreme_random_numbers_give_finite_rays() {
    let ends = [0.0, 0.5, ONE_MINUS_ULP];
    for case in all_cases() {
        for number in 0..243_usize {
            let u: [f64; 5] = std::array::from_fn(|digit| ends[number / 3_usize.pow(digit as u32) % 3]);
            let numbers = LeRandoms { aim: [u[0], u[1]], rest: [u[2], u[3], u[4]] };
            let emission = case.light.sample_le(case.extent(), numbers);
            let unit = (emission.direction.length() - 1.0).abs() < 1e-9;
            let flux = emission.flux_w.is_finite() && emission.flux_w >= 0.0;
            assert!(emission.origin.is_finite() && unit && flux, "{} at {u:?}: {emission:?}", case.name);
            let Some(incident) = case.light.sample_li(case.extent(), case.receiver.centre, [u[0], u[1], u[2]]) else {
                continue;
            };
            let unit = (incident.direction.length() - 1.0).abs() < 1e-9;
            let irradiance = incident.irradiance.is_finite() && incident.irradiance >= 0.0;
            let pdf_is_valid = incident.pdf_solid_angle.is_none_or(|pdf| pdf.is_finite() && pdf > 0.0);
            assert!(
                unit && irradiance && pdf_is_valid && incident.distance > 0.0,
                "{} at {u:?}: {incident:?}",
                case.name
            );
        }
    }
}

#[test]
fn the_spectra_of_an_image_add_up_to_its_mean_spectrum() {
    let case = distant_cases().swap_remove(3);
    let power = case.light.power_w(case.extent());
    for nm in [430.0, 480.0, 545.0, 600.0, 640.0] {
        let mut stream = stream(12);
        let mean = SampleMean::of(100_000, || {
            let emission = case.emit(&mut stream);
            emission.flux_w / power * case.light.spd_at(emission.spd, nm)
        });
        mean.agrees(exactly(case.light.spectrum.at(nm)), 0.01, &format!("{nm} nm"));
    }
}

#[test]
fn points_outside_a_cone_or_behind_a_face_get_no_light() {
    let at = DVec3::ZERO;
    let spot = light(Emitter::Spot(SpotLight::new(at, DVec3::Z, 0.3, 0.1, 1.0)), flat_spectrum());
    let beam = light(Emitter::Beam(BeamLight::new(at, DVec3::Z, 0.1, 0.0, 1.0)), flat_spectrum());
    let spreading = light(Emitter::Beam(BeamLight::new(at, DVec3::Z, 0.1, 0.2, 1.0)), flat_spectrum());
    let empty = Geometry::build(Vec::new(), DVec3::ZERO).unwrap();
    let world = SceneExtent { geometry: &empty, radius_m: 1.0 };
    let beside = DVec3::new(f64::tan(0.31) + 0.11, 0.0, 1.0);
    for light in [spot, beam, spreading] {
        for from in [beside, -DVec3::Z, at] {
            for turn in 0..20 {
                let u = [f64::from(turn) / 20.0, 0.3, 0.0];
                assert!(light.sample_li(world, from, u).is_none(), "{:?} from {from}", light.emitter);
            }
        }
    }
    let face =
        area_case("", PlacedShape { shape: Shape::Disk { radius: 0.3 }, to_world: DAffine3::IDENTITY, object: 0 });
    for turn in 0..20 {
        let angle = TAU * f64::from(turn) / 20.0;
        let behind = DVec3::new(angle.cos(), -0.5, angle.sin());
        assert!(face.light.sample_li(face.extent(), behind, [0.2, 0.7, 0.3]).is_none());
    }
}
