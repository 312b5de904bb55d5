//! Single scattering in fog: sampled distances and light maps against integrals along camera rays.

use crate::common::compare::Measured;
use crate::common::{all_y, job, mean_y, render, with_setting};
use abbe_session::render::Integrator;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Pixels per side.
const FILM: usize = 8;

/// Scattering as a share of the extinction. It is so small that double scattering does not matter.
const SCATTERING: f64 = 1e-4;
const ABSORPTION: f64 = 0.6;

/// The z of an absorbing wall, which the camera inside the fog sees past a light of 1 cd.
const WALL_Z: f64 = -2.0;
const LAMP: DVec3 = DVec3::new(0.5, 0.1, -1.0);

/// Passes with light maps. A map is evaluated at many points per ray, so its noise is lower.
const MAPPED_PASSES: u64 = 64;

fn fog(phase: &Value) -> Value {
    let objects = [
        json!({ "shape": { "sphere": { "radius": 4 } }, "material": "fog" }),
        json!({ "shape": { "rectangle": { "width": 3, "height": 3 } }, "material": "black",
                "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, WALL_Z] }] }),
    ];
    let lamp = json!({ "point": { "at": LAMP.to_array(), "spectrum": { "lines": [{ "nm": 550, "power": 1 }] },
                                      "luminous_intensity": 1 } });
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 24 } } },
        "film": { "width": FILM, "height": FILM },
        "media": { "fog": { "homogeneous": { "absorption": ABSORPTION, "scattering": SCATTERING, "phase": phase } } },
        "materials": { "fog": { "boundary": { "medium": "fog" } }, "black": "absorber" },
        "objects": objects,
        "lights": [lamp],
        "render": { "photons": 1000 }
    })
}

/// Returns ∫ f from 0 to `end` by Simpson's rule. The step is halved until the result changes by
/// less than 1e-8.
pub(crate) fn integral(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    let simpson = |steps: u32| {
        let h = end / f64::from(steps);
        let weight = |i: u32| if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        (0..=steps).map(|i| weight(i) * f(f64::from(i) * h)).sum::<f64>() * h / 3.0
    };
    let (mut steps, mut last) = (64, simpson(32));
    loop {
        let next = simpson(steps);
        if (next / last - 1.0).abs() < 1e-8 {
            return next;
        }
        assert!(steps < 1 << 22, "no convergence");
        (steps, last) = (2 * steps, next);
    }
}

/// Returns the mean luminance under a light of 1 cd at `lamp`, from rays through the centres of 4 ×
/// 4 parts of each pixel.
fn expected(scene: &Value, lamp: DVec3, phase: &dyn Fn(f64) -> f64) -> f64 {
    let camera = job(scene).scene;
    let parts = 4 * FILM;
    let along = |i: usize| {
        let film = DVec2::new((i % parts) as f64 + 0.5, (i / parts) as f64 + 0.5) * 0.25;
        let direction = camera.camera.ray(film, [0.5; 2]).direction;
        let scattered = |t: f64| {
            let way = t * direction - lamp;
            let d = way.length();
            let passed = (-(ABSORPTION + SCATTERING) * (t + d)).exp();
            SCATTERING * phase(-(way / d).dot(direction)) * passed / (d * d)
        };
        integral(scattered, WALL_Z / direction.z)
    };
    (0..parts * parts).map(along).sum::<f64>() / (parts * parts) as f64
}

pub(crate) fn henyey_greenstein(g: f64) -> (Value, impl Fn(f64) -> f64) {
    let at = move |cosine: f64| (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5));
    (json!({ "henyey_greenstein": { "g": g } }), at)
}

/// The phase function table of fog drops at 550 nm, interpolated linearly in the angle.
fn drops() -> (Value, impl Fn(f64) -> f64) {
    let text = std::fs::read_to_string("tests/golden/mie_fog_phase.csv").expect("the table");
    let rows: Vec<(f64, f64)> = text
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            (cells[0], cells[4])
        })
        .collect();
    let at = move |cosine: f64| {
        let angle = cosine.clamp(-1.0, 1.0).acos().to_degrees();
        let after = rows.partition_point(|row| row.0 <= angle).clamp(1, rows.len() - 1);
        let ((a, low), (b, high)) = (rows[after - 1], rows[after]);
        low + (high - low) * (angle - a) / (b - a)
    };
    (json!({ "table": { "path": "golden/mie_fog_phase.csv" } }), at)
}

/// Renders and compares the mean luminance with the integral.
fn check(name: &str, scene: &Value, (integrator, passes): (Integrator, u64), truth: f64) {
    let measured = Measured::new(scene, (integrator, passes), 0..4, mean_y);
    let (ratio, error) = (measured.mean(0) / truth, measured.error(0) / truth);
    println!("single scattering, {name}: {ratio:.5} ± {error:.5} of {truth:.5e} cd/m²");
    assert!(error < 2e-3, "too noisy to tell");
    assert!((ratio - 1.0).abs() < 5e-3, "{name}: {ratio} of the integral");
}

fn check_phase(name: &str, phase: Value, at: &dyn Fn(f64) -> f64, passes: u64) {
    let scene = fog(&phase);
    let truth = expected(&scene, LAMP, at);
    check(&format!("{name}, drawn places"), &scene, (Integrator::Photon, passes), truth);
    let mapped = with_setting(&scene, "light_map", json!({ "resolution": 8 }));
    check(&format!("{name}, light map"), &mapped, (Integrator::Photon, MAPPED_PASSES), truth);
}

#[test]
#[ignore = "nightly: 21 seconds of CPU time"]
fn a_lamp_in_fog_that_scatters_evenly_or_as_air_does() {
    check_phase("isotropic", json!("isotropic"), &|_| 0.25 / PI, 256);
    check_phase("Rayleigh", json!("rayleigh"), &|c| 3.0 / (16.0 * PI) * (1.0 + c * c), 256);
}

/// Twenty lamps of different intensities, of which each ray samples one. Two more lamps shine away
/// from the view.
#[test]
fn many_lamps_in_fog() {
    let mut scene = fog(&json!("isotropic"));
    let spectrum = json!({ "lines": [{ "nm": 550, "power": 1 }] });
    let at = |i: u32| {
        let turn = 2.4 * f64::from(i);
        DVec3::new((0.2 + 0.08 * f64::from(i)) * turn.cos(), 0.7 * turn.sin(), -0.1 * f64::from(i) + 0.4)
    };
    let intensity = |i: u32| 1.5_f64.powi(i as i32 % 7);
    let mut lights: Vec<Value> = (0..20)
        .map(|i| json!({ "point": { "at": at(i).to_array(), "spectrum": spectrum, "luminous_intensity": intensity(i) } }))
        .collect();
    lights.extend([1, 2].map(|_| {
        json!({ "spot": { "at": [0.4, 0, -1], "to": [1, 0, -1], "half_angle": 20, "spectrum": spectrum,
                          "luminous_intensity": 50 } })
    }));
    scene["lights"] = json!(lights);
    let truth: f64 = (0..20).map(|i| intensity(i) * expected(&scene, at(i), &|_| 0.25 / PI)).sum();
    check("20 lamps, photon", &scene, (Integrator::Photon, 80), truth);
}

#[test]
#[ignore = "slow: a minute of CPU time"]
fn a_lamp_in_fog_of_every_mean_cosine() {
    for g in [0.3, 0.76, -0.4] {
        let (phase, at) = henyey_greenstein(g);
        check_phase(&format!("g = {g}"), phase, &at, 4096);
    }
}

#[test]
#[ignore = "slow: half a minute of CPU time"]
fn a_lamp_in_fog_of_drops() {
    let (phase, at) = drops();
    check_phase("drops", phase, &at, 6144);
}

/// The narrow backward peak of the fog sends an even sky behind the camera into it. All pixels find
/// this light, which single shadow rays rarely do. The wall covers less than 1e-4 of the peak's
/// tail.
#[test]
fn an_even_sky_in_fog_with_a_narrow_peak() {
    let (phase, _) = henyey_greenstein(-0.999);
    let mut scene = fog(&phase);
    scene["media"]["fog"]["homogeneous"]["absorption"] = json!(0);
    scene["lights"] = crate::furnace::surroundings();
    scene["render"]["forbid"] = json!(["photon-beams"]);
    let values = all_y(&render(&scene, Integrator::Photon, 8));
    let camera = job(&scene).scene.camera;
    for (i, value) in values.into_iter().enumerate() {
        let film = DVec2::new((i % FILM) as f64 + 0.5, (i / FILM) as f64 + 0.5);
        let truth = SCATTERING * WALL_Z / camera.ray(film, [0.5; 2]).direction.z;
        assert!((value / truth - 1.0).abs() < 0.25, "pixel {i}: {value} for {truth} cd/m²");
    }
}
