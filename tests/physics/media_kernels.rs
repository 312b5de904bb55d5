//! Kernels in media against a closed form: the bias of the single-scattering estimate is
//! proportional to the square of the kernel radius.

use abbe_scene::geometry::Ray;
use abbe_spectra::math::sobol::Sobol;
use abbe_spectra::math::warp;
use abbe_transport::map::{KernelWidth, PhotonBeam, PhotonPower, QueryCone, VolumeMap, VolumePhoton, WavelengthCode};
use glam::DVec3;
use std::f64::consts::PI;

/// Length of the photon paths in m.
const REACH: f64 = 4.0;

/// Distance in m at which rays pass the light; the rays extend by `SIGHT` to both sides.
const PASSING: f64 = 0.5;
const SIGHT: f64 = 2.0;
const RAYS: u32 = 64;

const RADII: [f64; 3] = [0.4, 0.2, 0.1];

fn load() -> PhotonPower {
    PhotonPower::new(WavelengthCode::default(), [1.0, 0.0, 0.0, 0.0], None, 0.0)
}

/// Estimates the light of one point source along many rays, and returns the mean for each kernel
/// radius relative to the exact integral, minus 1. Each unit of a photon path scatters the share
/// `scattered`.
fn bias(map: &VolumeMap, scattered: f64, photons: u32) -> [f64; 3] {
    // The exact value is ∫ 1/(4π d²) along the ray.
    let truth = 2.0 * (SIGHT / PASSING).atan() / (4.0 * PI * PASSING);
    let sobol = Sobol::new(5);
    RADII.map(|radius| {
        let mut found = 0.0;
        for i in 0..RAYS {
            let away = warp::sphere([sobol.at(i, 0), sobol.at(i, 1)]);
            let (side, other) = away.any_orthonormal_pair();
            let (sine, cosine) = (2.0 * PI * sobol.at(i, 2)).sin_cos();
            let direction = cosine * side + sine * other;
            let ray = Ray::new(PASSING * away - SIGHT * direction, direction);
            let cone = QueryCone::of_camera(ray, 2.0 * SIGHT, 0.0, KernelWidth::Constant(radius));
            map.along(&cone, |photon| found += photon.kernels.estimate);
        }
        found * scattered / (f64::from(photons) * f64::from(RAYS) * truth) - 1.0
    })
}

/// Each halving of the radius must show order 2 within half an order: at the largest radius the
/// fourth power adds 0.3, and at the smallest one there is noise.
fn check_order(name: &str, bias: [f64; 3]) {
    let orders = [(bias[0] / bias[1]).log2(), (bias[1] / bias[2]).log2()];
    println!("{name}, radii {RADII:?} m: bias {bias:+.5?}, order {orders:.2?}");
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.5), "{orders:?}");
}

#[test]
fn the_bias_of_points_falls_with_the_square_of_the_radius() {
    const PHOTONS: u32 = 1 << 17;
    let sobol = Sobol::new(1);
    let points = (0..PHOTONS).map(|i| {
        let direction = warp::sphere([sobol.at(i, 0), sobol.at(i, 1)]);
        VolumePhoton::new(REACH * sobol.at(i, 2) * direction, direction, 0, load())
    });
    let bias = bias(&VolumeMap::of_points(points.collect(), &[]), REACH, PHOTONS);
    check_order("points", bias);
    // The integral along a ray at distance ρ is proportional to 1/ρ. Epanechnikov's kernel on the
    // disk overestimates it by r²/12 ∇²(1/ρ) = r²/(12 ρ³) and 3/128 r⁴/ρ⁵.
    let expected = RADII.map(|radius: f64| {
        let square = (radius / PASSING).powi(2);
        square / 12.0 + 3.0 / 128.0 * square * square
    });
    assert!((bias[1] - expected[1]).abs() < 5e-3, "{} for {}", bias[1], expected[1]);
}

#[test]
fn the_bias_of_beams_falls_with_the_square_of_the_radius() {
    const PHOTONS: u32 = 1 << 13;
    let sobol = Sobol::new(1);
    let beams = (0..PHOTONS).map(|i| {
        let direction = warp::sphere([sobol.at(i, 0), sobol.at(i, 1)]);
        PhotonBeam::new([DVec3::ZERO, REACH * direction], 0, load())
    });
    let bias = bias(&VolumeMap::of_beams(beams.collect(), Vec::new()), 1.0, PHOTONS);
    check_order("beams", bias);
}
