//! Photons in media against the path tracer, which shares neither their free-flight sampling nor
//! their estimators; and one medium given in several forms.

use crate::common::compare::{Measured, assert_differs, assert_same};
use crate::common::{all_y, block_means, diffuse, with_setting};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// Pixels per side of the film, and of a block.
const FILM: usize = 16;
const BLOCK: usize = 8;

fn blocks(rendered: &Rendered) -> Vec<f64> {
    block_means(&all_y(rendered), FILM, BLOCK, &[true; FILM * FILM])
}

fn measured(scene: &Value, way: (Integrator, u64), seeds: std::ops::Range<u64>) -> Measured {
    Measured::new(scene, way, seeds, blocks)
}

/// Extrapolates photon renders of this first radius and of half of it, and compares them with the
/// path tracer. A faulty scene must fail the comparison.
fn compare_with_path(name: &str, scene: &Value, radius: f64, [photon_passes, path_passes]: [u64; 2], faulty: &Value) {
    let [whole, half] = [radius, 0.5 * radius]
        .map(|radius| measured(&with_setting(scene, "radius", radius), (Integrator::Photon, photon_passes), 0..8));
    let photon = Measured::extrapolated(&whole, &half);
    let path = measured(scene, (Integrator::Path, path_passes), 100..108);
    assert_same(&format!("{name}, photon against path"), &photon, &path, 2e-2);
    let mutant = measured(faulty, (Integrator::Path, path_passes), 100..108);
    assert_differs(&format!("{name}, mutant"), &photon, &mutant);
}

/// A room with a light, a white box on a grey floor, and fog up to the floor and the walls.
fn room(scattering: f64, wide: f64) -> Value {
    json!({
        "camera": { "from": [0, 0, 0.95], "at": [0, -0.2, -1], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 60 } } },
        "film": { "width": FILM, "height": FILM },
        "media": { "fog": { "homogeneous": { "absorption": 0.05, "scattering": scattering,
                                             "phase": { "henyey_greenstein": { "g": 0.4 } } } } },
        "materials": { "fog": { "boundary": { "medium": "fog" } }, "grey": diffuse(0.5), "white": diffuse(0.8) },
        "objects": [
            { "shape": { "box": { "size": [wide, wide, wide] } }, "material": "fog" },
            { "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "grey", "transform": [{ "translate": [0, -1, 0] }] },
            { "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "white",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -1] }] },
            { "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "white",
              "transform": [{ "rotate": { "axis": [0, 0, 1], "degrees": -90 } }, { "translate": [-1, 0, 0] }] },
            { "shape": { "box": { "size": [0.5, 0.6, 0.5] } }, "material": "white", "transform": [{ "translate": [0.2, -0.7, -0.3] }] }
        ],
        "lights": [{ "point": { "at": [0.3, 0.8, 0.2], "spectrum": "D65", "luminous_intensity": 1 } }],
        "render": { "photons": 10000 }
    })
}

#[test]
#[ignore = "slow: a minute of CPU time"]
fn a_room_of_thin_fog() {
    let scene = room(0.4, 2.0);
    compare_with_path("room of fog", &scene, 0.2, [192, 512], &room(0.8, 2.0));
}

#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn fog_may_end_inside_walls_or_behind_them() {
    for way in [(Integrator::Photon, 2), (Integrator::Path, 64)] {
        // Beams would only add noise to this comparison.
        let [flush, wider] = [2.0, 2.02].map(|wide| {
            let scene = with_setting(&room(0.4, wide), "forbid", json!(["photon-beams"]));
            measured(&with_setting(&scene, "radius", 0.1), way, 0..8)
        });
        assert_same(&format!("fog flush with floor and walls, {:?}", way.0), &flush, &wider, 2e-2);
    }
}

/// Smoke in a grid whose extinction varies by a factor of 100 over the band.
fn smoke(scale: f64) -> Value {
    let scattering = json!({ "table": { "nm": [360, 830], "values": [6.0 * scale, 0.06 * scale] } });
    json!({
        "camera": { "from": [0, 0, 4], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 24 } } },
        "film": { "width": FILM, "height": FILM },
        "media": { "smoke": { "grid": { "bounds": [[-0.6, -0.6, -0.6], [0.6, 0.6, 0.6]],
            "density": { "values": [0, 1, 2, 1, 1, 0.5, 0.2, 3], "resolution": [2, 2, 2] },
            "absorption": 0, "scattering": scattering, "phase": "isotropic" } } },
        "materials": { "smoke": { "boundary": { "medium": "smoke" } }, "grey": diffuse(0.5) },
        "objects": [
            { "shape": { "box": { "size": [1.3, 1.3, 1.3] } }, "material": "smoke" },
            { "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -0.8] }] }
        ],
        "lights": [{ "point": { "at": [0.5, 1.2, 1], "spectrum": "E", "luminous_intensity": 1 } }],
        "render": { "photons": 10000 }
    })
}

#[test]
#[ignore = "slow: a minute of CPU time"]
fn smoke_of_a_hundredfold_range_of_extinction() {
    compare_with_path("smoke", &smoke(1.0), 0.15, [128, 256], &smoke(2.0));
}

#[test]
#[ignore = "slow: 40 seconds of CPU time; media.rs compares the methods along single rays"]
fn tracked_marched_and_exact_smoke_agree() {
    let stated = |way: &str| {
        let mut scene = with_setting(&smoke(1.0), "radius", 0.1);
        scene["media"]["smoke"]["grid"]["transmittance"] = json!(way);
        scene["render"]["march_steps"] = json!(64);
        scene["render"]["forbid"] = json!(["photon-beams", "volume-photons"]);
        measured(&scene, (Integrator::Photon, 96), 0..8)
    };
    let exact = stated("exact");
    for way in ["ratio", "march"] {
        assert_same(&format!("smoke, {way} against exact"), &stated(way), &exact, 1e-2);
    }
}
