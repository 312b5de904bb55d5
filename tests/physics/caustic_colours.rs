//! The colours of a caustic's fringe, compared with rays that this test traces backward through the
//! ball. It uses a sphere, Snell's law and Fresnel's formulas. From the program it takes only the
//! observer and the positions of the pixels on the floor.

use crate::common::{job, render, with_setting};
use crate::free_and_shared::{beside_the_ball, s1};
use abbe_session::render::Integrator;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::spectrum::{BAND_NM, Observer};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde_json::json;
use std::f64::consts::PI;

/// Camera, ball, light and floor of S1, copied from its scene file.
const CAMERA: DVec3 = DVec3::new(0.0, 4.0, 9.0);
const CENTRE: DVec3 = DVec3::new(0.0, 1.01, 0.0);
const LAMP: DVec3 = DVec3::new(2.0, 6.0, 0.0);
const LAMP_SIDE: f64 = 0.3;
const LAMP_TILT_DEGREES: f64 = 158.159007943;
const LUMINANCE: f64 = 1000.0;
const REFLECTANCE: f64 = 0.5;
/// The number of reflections inside the ball that are followed.
const INSIDE: usize = 4;

fn index(nm: f64) -> f64 {
    1.5046 + 0.0042 / (1e-3 * nm).powi(2)
}

/// Tells whether a ray hits the emitting side of the light.
fn meets_lamp(from: DVec3, direction: DVec3) -> bool {
    let (sin, cos) = LAMP_TILT_DEGREES.to_radians().sin_cos();
    let (along, normal) = (DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0));
    let towards = direction.dot(normal);
    let distance = (LAMP - from).dot(normal) / towards;
    let place = from + distance * direction - LAMP;
    let half = 0.5 * LAMP_SIDE;
    towards < 0.0 && distance > 0.0 && place.dot(along).abs() < half && place.z.abs() < half
}

/// Returns Fresnel's reflectance from index n1 to n2 and the cosine of the refracted ray; `None`
/// under total reflection.
fn fresnel(cos: f64, n1: f64, n2: f64) -> Option<(f64, f64)> {
    let sin2 = (n1 / n2).powi(2) * (1.0 - cos * cos);
    let behind = (1.0 - sin2).max(0.0).sqrt();
    let s = (n1 * cos - n2 * behind) / (n1 * cos + n2 * behind);
    let p = (n2 * cos - n1 * behind) / (n2 * cos + n1 * behind);
    (sin2 < 1.0).then_some((0.5 * (s * s + p * p), behind))
}

/// Returns the share of the light's radiance that reaches the floor along a ray through the ball.
fn through_the_ball(from: DVec3, direction: DVec3, n: f64) -> f64 {
    let to = from - CENTRE;
    let b = to.dot(direction);
    let root = (b * b - to.length_squared() + 1.0).max(0.0).sqrt();
    let mut place = to + (-b - root) * direction;
    let cos = -direction.dot(place);
    let Some((reflected, behind)) = fresnel(cos, 1.0, n) else { return 0.0 };
    let lamp = |place: DVec3, direction: DVec3| f64::from(u8::from(meets_lamp(CENTRE + place, direction)));
    let mut share = reflected * lamp(place, direction + 2.0 * cos * place);
    let mut inside = direction / n + (cos / n - behind) * place;
    let mut weight = 1.0 - reflected;
    for _ in 0..=INSIDE {
        place += -2.0 * place.dot(inside) * inside;
        let cos = inside.dot(place);
        let reflected = match fresnel(cos, n, 1.0) {
            Some((reflected, behind)) => {
                share += weight * (1.0 - reflected) * lamp(place, n * inside - (n * cos - behind) * place);
                reflected
            }
            None => 1.0,
        };
        weight *= reflected;
        inside -= 2.0 * cos * place;
    }
    share
}

/// Returns the XYZ that a patch of floor reflects: `count` rays from random points of the patch
/// into the cone that the ball fills.
fn xyz(patch: impl Fn([f64; 2]) -> DVec3, count: usize, seed: u64) -> [f64; 3] {
    let mut stream = Stream::new(Seed::new(seed), Purpose::Camera, 0, 0);
    let observer = Observer::cie1931();
    let width = BAND_NM.1 - BAND_NM.0;
    let mut sum = [0.0; 3];
    for i in 0..count {
        let point = patch(stream.pair());
        let axis = CENTRE - point;
        let least = (1.0 - axis.length_squared().recip()).sqrt();
        let [u, v] = stream.pair();
        let (cos, angle) = (1.0 - u * (1.0 - least), 2.0 * PI * v);
        let (right, up) = axis.normalize().any_orthonormal_pair();
        let sideways = (1.0 - cos * cos).sqrt() * (angle.cos() * right + angle.sin() * up);
        let direction = cos * axis.normalize() + sideways;
        let nm = BAND_NM.0 + width * (i as f64 + stream.uniform()) / count as f64;
        let share = direction.y.max(0.0) * 2.0 * PI * (1.0 - least) * through_the_ball(point, direction, index(nm));
        if share > 0.0 {
            let bar = observer.xyz_bar(nm);
            (0..3).for_each(|c| sum[c] += share * bar[c]);
        }
    }
    let white = observer.bars()[1].integral() / width;
    sum.map(|s| s / count as f64 * LUMINANCE * REFLECTANCE / PI / white)
}

#[test]
#[ignore = "slow: 64 million photons, and 60 million rays by hand"]
fn the_caustic_fringe_of_s1_has_the_traced_colour() {
    let mut scene =
        with_setting(&s1(json!({ "cauchy": { "a": 1.5046, "b": 0.0042 } }), &[]), "forbid", json!(["indirect"]));
    scene["render"]["photons"] = json!(1_000_000);
    scene["film"] = json!({ "width": 64, "height": 64 });
    scene["camera"]["at"] = json!([-0.5, 0, 0.2]);
    scene["camera"]["lens"] = json!({ "pinhole": { "fov": 4 } });
    let camera = &job(&scene).scene.camera;
    let patch = |pixel: usize| {
        let corner = DVec2::new((pixel % camera.width()) as f64, (pixel / camera.width()) as f64);
        move |place: [f64; 2]| {
            let ray = camera.ray(corner + DVec2::from(place), [0.5; 2]);
            // The program measures positions from the scene's centre, this test from the file's
            // origin.
            CAMERA - CAMERA.y / ray.direction.y * ray.direction
        }
    };
    // One set of rays selects the fringe and another measures it, so that the selection does not
    // favour pixels that are bright by chance.
    let by_hand = |pixels: &[usize], count: usize, salt: u64| -> Vec<[f64; 3]> {
        pixels.par_iter().map(|&pixel| xyz(patch(pixel), count, salt + pixel as u64)).collect()
    };
    let beside = beside_the_ball(&scene);
    let picked = by_hand(&beside, 40_000, 0);
    let fringe: Vec<usize> =
        beside.iter().zip(&picked).filter(|(_, xyz)| (0.05..0.5).contains(&xyz[1])).map(|(&pixel, _)| pixel).collect();
    let traced = by_hand(&fringe, 2_000_000, 1 << 32);
    let picture = render(&scene, Integrator::Photon, 64).picture;
    let sum =
        |values: &mut dyn Iterator<Item = [f64; 3]>| values.fold([0.0; 3], |a, b| std::array::from_fn(|c| a[c] + b[c]));
    let expected = sum(&mut traced.iter().copied());
    let found = sum(&mut fringe.iter().map(|&pixel| picture.xyz[pixel]));
    let ratios: [f64; 3] = std::array::from_fn(|c| found[c] / expected[c]);
    let colour = (found[2] / found[0]) / (expected[2] / expected[0]);
    println!("S1 fringe, {} pixels: X, Y, Z over those by hand {ratios:.4?}, Z/X {colour:.4}", fringe.len());
    assert!(fringe.len() > 25, "{} pixels", fringe.len());
    assert!((colour - 1.0).abs() < 0.05, "{colour}");
    assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.03), "{ratios:?}");
}
