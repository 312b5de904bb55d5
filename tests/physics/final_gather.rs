//! The final gather against photons in place and against paths, and when the pilot chooses it.

use crate::common::compare::{Measured, assert_same};
use crate::common::{colour_blocks, diffuse, glass, render, with_setting};
use abbe_session::render::Integrator;
use serde_json::{Value, json};

const FILM: usize = 16;
const BLOCK: usize = 8;

/// A closed room with a lamp below its ceiling, a coloured wall, a mirror, a ball of `glass`, a box
/// of rough metal and a coated wall: the first diffuse surface is seen directly, in the mirror and
/// through glass, and light reaches it straight, by caustics and by other surfaces.
fn room(glass: Value) -> Value {
    let wall = |material: &str, axis: [i32; 3], degrees: i32, at: [f64; 3]| {
        json!({ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": material,
                "transform": [{ "rotate": { "axis": axis, "degrees": degrees } }, { "translate": at }] })
    };
    json!({
        "camera": { "from": [0, 1.0, 0.95], "at": [0, 0.8, -1], "lens": { "pinhole": { "fov": 75 } } },
        "film": { "width": FILM, "height": FILM },
        "materials": {
            "white": diffuse(0.7), "red": { "diffuse": { "reflectance": { "rgb": [0.6, 0.1, 0.1] } } },
            "plastic": { "glossy": { "reflectance": 0.6, "ior": 1.5, "roughness": 0.3 } },
            "mirror": { "conductor": { "metal": "silver" } },
            "rough": { "conductor": { "metal": "aluminium", "roughness": 0.4 } },
            "glass": glass, "black": "absorber"
        },
        "objects": [
            wall("white", [1, 0, 0], 0, [0.0, 0.0, 0.0]), wall("white", [1, 0, 0], 180, [0.0, 2.0, 0.0]),
            wall("red", [0, 0, 1], -90, [-1.0, 1.0, 0.0]), wall("plastic", [0, 0, 1], 90, [1.0, 1.0, 0.0]),
            wall("white", [1, 0, 0], 90, [0.0, 1.0, -1.0]), wall("white", [1, 0, 0], -90, [0.0, 1.0, 1.0]),
            { "shape": { "rectangle": { "width": 0.7, "height": 0.7 } }, "material": "mirror",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0.4, 1.2, -0.98] }] },
            { "shape": { "sphere": { "radius": 0.3, "center": [-0.4, 0.35, -0.3] } }, "material": "glass" },
            { "shape": { "box": { "size": [0.4, 0.4, 0.4] } }, "material": "rough",
              "transform": [{ "translate": [0.45, 0.21, -0.2] }] },
            { "shape": { "rectangle": { "width": 0.8, "height": 0.8 } }, "material": "black",
              "emission": { "spectrum": "D65", "radiance": 5 },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 1.98, 0] }] }
        ],
        "render": { "photons": 20000, "camera_samples": 4, "force": ["final-gather"] }
    })
}

fn agree(name: &str, glass: Value, [photon, path]: [u64; 2]) {
    let scene = room(glass);
    let behind = Measured::new(&scene, (Integrator::Photon, photon), 0..6, colour_blocks(BLOCK));
    let paths = Measured::new(&scene, (Integrator::Path, path), 10..16, colour_blocks(BLOCK));
    assert_same(name, &behind, &paths, 0.03);
}

#[test]
fn a_final_gather_has_the_light_of_paths() {
    agree("clear glass", json!({ "dielectric": { "ior": 1.5 } }), [24, 192]);
}

#[test]
#[ignore = "nightly: 15 seconds of CPU time"]
fn a_final_gather_behind_flint_has_the_light_of_paths() {
    agree("flint", glass("SF10"), [48, 512]);
}

/// A final gather needs few photons around each point, so their kernels are narrow.
#[test]
fn a_final_gather_lowers_the_estimated_bias() {
    let median_bias = |force: Value| {
        let scene = with_setting(&room(json!({ "dielectric": { "ior": 1.5 } })), "force", force);
        let picture = render(&scene, Integrator::Photon, 8).picture;
        let mut known: Vec<f32> = picture.bias.into_iter().flatten().collect();
        known.sort_unstable_by(f32::total_cmp);
        known[known.len() / 2]
    };
    let [in_place, behind] = [json!([]), json!(["final-gather"])].map(median_bias);
    assert!(behind < 0.5 * in_place, "{behind} for {in_place}");
}

fn final_gathers(scene: &Value) -> u64 {
    render(scene, Integrator::Photon, 1).stats.effects["final-gather"].events
}

/// A column under a wide sky needs many photons for a smooth picture, and few rays. A lamp behind a
/// screen lights a room by one bright spot, which few rays find.
#[test]
fn the_pilot_gathers_behind_surfaces_where_that_is_less_noisy() {
    let open = json!({
        "camera": { "from": [0, 1.5, 6], "at": [0, 1, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 64, "height": 36 },
        "materials": { "white": diffuse(0.5) },
        "objects": [
            { "shape": { "rectangle": { "width": 300, "height": 300 } }, "material": "white" },
            { "shape": { "cylinder": { "radius": 0.5, "height": 2 } }, "material": "white",
              "transform": [{ "translate": [0, 1, 0] }] }
        ],
        "lights": [{ "environment": { "spectrum": "D65", "luminance": 1000 } }]
    });
    let spot = json!({
        "camera": { "from": [0, 1, 0.9], "at": [0, 1, -1], "lens": { "pinhole": { "fov": 70 } } },
        "film": { "width": 64, "height": 36 },
        "materials": { "white": diffuse(0.8) },
        "objects": [{ "shape": { "box": { "size": [2, 2, 2] } }, "material": "white", "transform": [{ "translate": [0, 1, 0] }] }],
        "lights": [{ "beam": { "from": [0, 1, 0.5], "to": [0.3, 2, 0.6], "radius": 0.02, "spectrum": "D65", "power": 1 } }]
    });
    assert!(final_gathers(&open) > 0);
    assert_eq!(final_gathers(&spot), 0);
    assert!(final_gathers(&with_setting(&spot, "force", json!(["final-gather"]))) > 0);
    assert_eq!(final_gathers(&with_setting(&open, "forbid", json!(["final-gather"]))), 0);
}
