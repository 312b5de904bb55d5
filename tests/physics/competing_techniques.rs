//! Light that one technique alone finds badly: lamps in glass that rough metal reflects, and sky
//! light that enters a room through a small opening.

use crate::common::compare::{Measured, assert_same, compare_with};
use crate::common::{colour_blocks, diffuse, overhead_camera};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_1_PI, TAU};

/// A lamp in a ball of glass above a floor of rough metal. Without `lamp`, the sky is the light.
fn light_through_a_ball(glass: Value, lamp: Option<f64>, roughness: f64) -> Value {
    let (mut objects, mut lights) = (Vec::new(), Vec::new());
    match lamp {
        Some(radius) => objects.push(json!({
            "shape": { "sphere": { "radius": radius, "center": [0, 0.5, 0] } }, "material": "black",
            "emission": { "spectrum": "E", "power": 10 }
        })),
        None => lights.push(json!({ "environment": { "spectrum": "E", "irradiance": 10 } })),
    }
    objects.push(json!({ "shape": { "sphere": { "radius": 0.3, "center": [0, 0.5, 0] } }, "material": "glass" }));
    objects.push(json!({ "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "floor" }));
    json!({
        "camera": { "from": [0, 1.6, 3], "at": [0, 0, 0.6], "lens": { "pinhole": { "fov": 25 } } },
        "film": { "width": 16, "height": 8 },
        "materials": {
            "glass": glass, "black": diffuse(0.0),
            "floor": { "conductor": { "metal": "aluminium", "roughness": roughness } }
        },
        "objects": objects, "lights": lights, "render": { "photons": 10000, "camera_samples": 1 }
    })
}

/// Photons and camera paths share the light that reaches rough metal through glass. `noise` is a
/// bound on the standard error of the photons' blocks.
fn check_shared_light(name: &str, scene: &Value, noise: f64) {
    let photon = Measured::new(scene, (Integrator::Photon, 16), 0..5, colour_blocks(8));
    let path = Measured::new(scene, (Integrator::Path, 300), 10..15, colour_blocks(8));
    assert_same(name, &photon, &path, noise);
}

#[test]
#[ignore = "slow: 7 seconds of CPU time"]
fn rough_metal_reflects_a_lamp_in_glass() {
    let clear = json!({ "dielectric": { "ior": 1.5 } });
    check_shared_light("lamp in glass", &light_through_a_ball(clear.clone(), Some(0.1), 0.2), 0.07);
    check_shared_light("small lamp, rough metal", &light_through_a_ball(clear.clone(), Some(0.03), 0.5), 0.1);
    check_shared_light("sky through glass", &light_through_a_ball(clear, None, 0.3), 0.018);
}

#[test]
#[ignore = "nightly: 4 seconds of CPU time"]
fn rough_metal_reflects_a_lamp_in_dispersive_glass() {
    let flint = json!({ "dielectric": { "ior": "SF10" } });
    check_shared_light("lamp in flint", &light_through_a_ball(flint, Some(0.1), 0.3), 0.1);
}

/// A black room of 4 m × 3 m × 4 m with a square opening in its roof, under a uniform sky of 10000
/// lx.
fn room_with_opening(side: f64) -> Value {
    let wall = |width: f64, height: f64, at: [f64; 3], turn: Value| {
        json!({ "shape": { "rectangle": { "width": width, "height": height } }, "material": "black",
                "transform": [{ "rotate": turn }, { "translate": at }] })
    };
    let about = |axis: [i32; 3], degrees: i32| json!({ "axis": axis, "degrees": degrees });
    let (flat, along_x, along_z) = (about([0, 1, 0], 0), about([0, 0, 1], 90), about([1, 0, 0], 90));
    let strip = 2.0 - 0.5 * side;
    let place = 0.5 * side + 0.5 * strip;
    let mut objects = vec![json!({ "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "floor" })];
    for sign in [-1.0, 1.0] {
        objects.push(wall(3.0, 4.0, [2.0 * sign, 1.5, 0.0], along_x.clone()));
        objects.push(wall(4.0, 3.0, [0.0, 1.5, 2.0 * sign], along_z.clone()));
        objects.push(wall(strip, 4.0, [place * sign, 3.0, 0.0], flat.clone()));
        objects.push(wall(side, strip, [0.0, 3.0, place * sign], flat.clone()));
    }
    json!({
        "camera": overhead_camera([0.5, 0.2], 2.5, 2.0), "film": { "width": 8, "height": 8 },
        "materials": { "black": diffuse(0.0), "floor": diffuse(0.5) }, "objects": objects,
        "lights": [{ "environment": { "spectrum": "E", "illuminance": 10000 } }], "render": { "photons": 2000 }
    })
}

/// The fraction of the light of a uniform sky that a point of the floor receives through the
/// opening: the form factor of a rectangle that is parallel to a small area.
fn sky_factor(side: f64, x: f64, z: f64) -> f64 {
    // The form factor of a rectangle with one corner above the area.
    let corner = |width: f64, depth: f64| {
        let (a, b) = (width / 3.0, depth / 3.0);
        let part = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
        (part(a, b) + part(b, a)) / TAU
    };
    let half = 0.5 * side;
    corner(half - x, half - z) - corner(-half - x, half - z) - corner(half - x, -half - z)
        + corner(-half - x, -half - z)
}

#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn a_small_opening_lights_the_floor_by_its_form_factor() {
    let blocks = |rendered: &Rendered| colour_blocks(4)(rendered)[4..8].to_vec();
    for (side, noise) in [(1.0, 0.025), (0.2, 0.03)] {
        let scene = room_with_opening(side);
        // The mean luminance of each quarter of the picture.
        let quarter = |i: usize| {
            let place = |i: usize, n: usize| (n as f64 + 0.5) / 16.0 - 1.0 + i as f64;
            let points = (0..256).map(|n| sky_factor(side, 0.5 + place(i % 2, n % 16), 0.2 + place(i / 2, n / 16)));
            0.5 * FRAC_1_PI * 10000.0 * points.sum::<f64>() / 256.0
        };
        let truth: Vec<f64> = (0..4).map(quarter).collect();
        for (integrator, passes) in [(Integrator::Photon, 64), (Integrator::Path, 64)] {
            let measured = Measured::new(&scene, (integrator, passes), 0..5, blocks);
            let found = compare_with(&measured, &truth);
            println!("opening of {side} m, {integrator:?}: {found}; standard error {:.4}", measured.relative_error());
            assert!(found.is_equal(), "{found}");
            assert!(measured.relative_error() < noise, "too noisy: {}", measured.relative_error());
        }
    }
}
