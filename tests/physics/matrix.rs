//! One scene with every option that must not change its light: estimators of transmittance, kinds
//! of photons, emission distributions, wavelengths, forms of the lamp, and shared shapes.
//!
//! Light crosses the smoke on every kind of path: along the rays of the camera and of the meter, on
//! shadow rays to the lamp, on connections of photons to the camera, and as photons and beams.

use super::meters::{measure, readings};
use crate::common::compare::{Measured, assert_same};
use crate::common::{all_y, block_means, diffuse, with_setting};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// Pixels per side of the film, and of a block.
const FILM: usize = 8;
const BLOCK: usize = 4;

const SEEDS: std::ops::Range<u64> = 0..5;

/// The radiance of the lamp in W/(m² sr), and its side in m.
const RADIANCE: f64 = 20.0;
const SIDE: f64 = 0.8;

/// A lamp and a narrow beam over a floor. A cloud of smoke, thicker at the ground, surrounds a
/// mirror ball, which throws the light of the beam onto the floor.
fn scene(transmittance: &str) -> Value {
    json!({
        "camera": { "from": [0, 3, 5], "at": [0, 0.6, 0], "lens": { "pinhole": { "fov": 30 } } },
        "film": { "width": FILM, "height": FILM },
        "media": { "smoke": { "grid": {
            "bounds": [[-1.5, 0.01, -1.5], [1.5, 1.8, 1.5]],
            "density": { "exponential": { "value": 1, "scale_height": 1 } },
            "absorption": 0.3, "scattering": 0.3, "phase": "isotropic", "transmittance": transmittance
        } } },
        "materials": { "grey": diffuse(0.5), "mirror": { "conductor": { "metal": "silver" } }, "black": "absorber",
                       "smoke": { "boundary": { "medium": "smoke" } } },
        "shapes": { "ball": { "sphere": { "radius": 0.3 } } },
        "objects": [
            { "shape": { "rectangle": { "width": 5, "height": 5 } }, "material": "grey" },
            { "shape": { "box": { "size": [3, 1.79, 3] } }, "material": "smoke", "transform": [{ "translate": [0, 0.905, 0] }] },
            { "shape": { "sphere": { "radius": 0.3 } }, "material": "mirror", "transform": [{ "translate": [0.3, 0.5, 0] }] },
            { "shape": { "rectangle": { "width": SIDE, "height": SIDE } }, "material": "black",
              "emission": { "spectrum": "E", "radiance": RADIANCE },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.6, 2.6, 0] }] }
        ],
        "lights": [{ "beam": { "from": [0.45, 3, 0], "to": [0.45, 0, 0], "radius": 0.05, "divergence": 0,
                               "spectrum": "E", "power": 1 } }],
        "meters": [{ "name": "floor", "points": [[-0.5, 0.02, 0.4]], "quantity": "illuminance" }],
        "render": { "photons": 6000, "radius": 0.15 }
    })
}

/// The lamp is the object with this number.
const LAMP: usize = 3;

fn blocks(rendered: &Rendered) -> Vec<f64> {
    block_means(&all_y(rendered), FILM, BLOCK, &[true; FILM * FILM])
}

fn picture(scene: &Value, first_seed: u64) -> Measured {
    let seeds = first_seed..first_seed + SEEDS.end;
    Measured::new(scene, (Integrator::Photon, 4), seeds, blocks)
}

fn meter(scene: &Value, first_seed: u64) -> Measured {
    let run = |seed: u64| {
        let report = measure(&with_setting(scene, "seed", first_seed + seed), None, 4);
        readings(&report).into_iter().map(|[lux, _, _]| lux).collect()
    };
    Measured::from_runs(SEEDS.map(run).collect())
}

#[test]
#[ignore = "nightly: 80 seconds of CPU time"]
fn estimators_of_transmittance_agree_on_all_paths() {
    let exact = scene("exact");
    let [known, known_lux] = [picture(&exact, 0), meter(&exact, 0)];
    for (i, name) in ["ratio", "march"].into_iter().enumerate() {
        let seed = 100 * (i as u64 + 1);
        assert_same(&format!("picture, {name}"), &known, &picture(&scene(name), seed), 5e-2);
        assert_same(&format!("meter, {name}"), &known_lux, &meter(&scene(name), seed), 5e-2);
    }
}

#[test]
#[ignore = "nightly: 60 seconds of CPU time"]
fn points_and_beams_aim_and_wavelengths_agree() {
    let exact = scene("exact");
    let known = picture(&exact, 0);
    let forced = |effects: Value| with_setting(&exact, "force", effects);
    let variants = [
        (
            "points in place of beams",
            with_setting(&forced(json!(["volume-photons"])), "forbid", json!(["photon-beams"])),
            5e-2,
        ),
        ("no aim", with_setting(&exact, "forbid", json!(["aim"])), 5e-2),
        ("shared wavelengths", forced(json!(["shared"])), 7e-2),
        ("a map of direct light", with_setting(&exact, "light_map", json!({"resolution": 32})), 5e-2),
    ];
    for (i, (name, scene, noise)) in variants.iter().enumerate() {
        assert_same(name, &known, &picture(scene, 100 * (i as u64 + 1)), *noise);
    }
}

/// Two forms of the same scene have the same picture up to rounding.
fn assert_equal_pictures(name: &str, a: &Value, b: &Value) {
    let [a, b] = [a, b].map(|scene| Measured::new(scene, (Integrator::Photon, 1), 0..1, blocks));
    for i in 0..a.count() {
        let ratio = a.mean(i) / b.mean(i);
        assert!((ratio - 1.0).abs() < 1e-6, "{name}, block {i}: {} and {}", a.mean(i), b.mean(i));
    }
}

#[test]
fn each_form_of_the_lamp_gives_the_same_light() {
    use std::f64::consts::PI;
    let with_lamp = |key: &str, value: f64| {
        let mut scene = scene("exact");
        scene["objects"][LAMP]["emission"] = json!({ "spectrum": "E", key: value });
        scene
    };
    assert_equal_pictures("power", &scene("exact"), &with_lamp("power", PI * SIDE * SIDE * RADIANCE));
    let luminance = 3000.0;
    let flux = PI * SIDE * SIDE * luminance;
    assert_equal_pictures("flux", &with_lamp("luminance", luminance), &with_lamp("luminous_flux", flux));
    let mut mesh = scene("exact");
    let h = 0.5 * SIDE;
    mesh["objects"][LAMP]["shape"] = json!({ "triangles": {
        "positions": [[-h, 0, -h], [h, 0, -h], [h, 0, h], [-h, 0, h]], "indices": [[0, 2, 1], [0, 3, 2]]
    } });
    assert_same("triangles", &picture(&scene("exact"), 0), &picture(&mesh, 100), 5e-2);
}

#[test]
fn shared_shapes_and_copies_are_equal() {
    let mut shared = scene("exact");
    shared["objects"][2]["shape"] = json!({ "shared": "ball" });
    assert_equal_pictures("shared", &scene("exact"), &shared);
}
