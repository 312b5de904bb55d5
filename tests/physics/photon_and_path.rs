//! Photon mapping and path tracing share no estimator except direct lighting, so they must agree
//! where both apply. The comparison must also detect named faults.

use crate::common::compare::{Measured, assert_differs, assert_same};
use crate::common::edges::away_from_edges;
use crate::common::{all_y, block_means, diffuse, glass, job};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// Pixels per side.
const FILM: usize = 32;

/// Returns Y in blocks of `side` × `side` pixels without the masked edges.
fn blocks(mask: &[bool], side: usize) -> impl Fn(&Rendered) -> Vec<f64> + '_ {
    move |rendered| block_means(&all_y(rendered), FILM, side, mask)
}

/// A white box with a red and a green wall, a white ball, and a light under the ceiling. `albedo`
/// is the reflectance of white.
fn cornell(albedo: f64) -> Value {
    let wall = |name: &str, material: &str, transform: Value| json!({ "name": name, "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": material, "transform": transform });
    json!({
        "camera": { "from": [0, 0, 3.9], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 38 } } },
        "film": { "width": FILM, "height": FILM },
        "materials": {
            "white": diffuse(albedo), "black": "absorber",
            "red": diffuse(json!({ "table": { "nm": [360, 580, 600, 830], "values": [0.06, 0.06, 0.6, 0.6] } })),
            "green": diffuse(json!({ "table": { "nm": [360, 490, 510, 560, 590, 830], "values": [0.1, 0.1, 0.5, 0.5, 0.1, 0.1] } }))
        },
        "objects": [
            wall("floor", "white", json!([{ "translate": [0, -1, 0] }])),
            wall("ceiling", "white", json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 1, 0] }])),
            wall("back", "white", json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -1] }])),
            wall("left", "red", json!([{ "rotate": { "axis": [0, 0, 1], "degrees": -90 } }, { "translate": [-1, 0, 0] }])),
            wall("right", "green", json!([{ "rotate": { "axis": [0, 0, 1], "degrees": 90 } }, { "translate": [1, 0, 0] }])),
            { "name": "ball", "shape": { "sphere": { "radius": 0.35, "center": [0.3, -0.6, 0.1] } }, "material": "white" },
            { "name": "lamp", "shape": { "rectangle": { "width": 0.6, "height": 0.6 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 0.99, 0] } ] }
        ],
        "render": { "photons": 10000 }
    })
}

#[test]
#[ignore = "slow: 15 seconds of CPU time"]
fn a_diffuse_box_and_faults_in_it() {
    const RADIUS: f64 = 0.12;
    let scene = cornell(0.73);
    let mask = away_from_edges(&job(&scene).scene, 2.0 * RADIUS);
    let path = Measured::new(&scene, (Integrator::Path, 64), 100..108, blocks(&mask, 8));
    let photon = Measured::extrapolated_photons(&scene, RADIUS, 16, blocks(&mask, 8));
    assert_same("box, photon against path", &photon, &path, 5e-3);

    let brighter = Measured::new(&cornell(0.73 * 1.02), (Integrator::Path, 64), 100..108, blocks(&mask, 8));
    assert_differs("box, mutant albedo × 1.02", &photon, &brighter);

    let mut direct_only = scene.clone();
    direct_only["render"]["forbid"] = json!(["indirect"]);
    let direct = Measured::new(&direct_only, (Integrator::Photon, 2), 0..8, blocks(&mask, 8));
    let twice = Measured::combine(&[&photon, &direct], |l| l[0] + l[1]);
    assert_differs("box, mutant direct light twice", &twice, &path);
}

/// A ball of glass with a white core, on a floor under a large light.
fn ball(ior: Value) -> Value {
    json!({
        "camera": { "from": [0, 2.2, 5], "at": [0.2, 0.6, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": FILM, "height": FILM },
        "materials": { "grey": diffuse(0.5), "white": diffuse(0.8), "black": "absorber", "glass": glass(ior) },
        "objects": [
            { "name": "floor", "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "grey" },
            { "name": "ball", "shape": { "sphere": { "radius": 1, "center": [0, 1.01, 0] } }, "material": "glass" },
            { "name": "core", "shape": { "sphere": { "radius": 0.4, "center": [0, 1.01, 0] } }, "material": "white" },
            { "name": "lamp", "shape": { "disk": { "radius": 1.8 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.8, 0] } ] }
        ],
        "render": { "photons": 8000 }
    })
}

/// Returns a mask of the pixels that see the middle of the core through the ball.
fn sees_the_core(scene: &Value) -> Vec<bool> {
    let job = job(scene);
    let names = |object: u32| job.scene.objects[object as usize].name.as_str();
    (0..FILM * FILM)
        .map(|pixel| {
            let film = glam::DVec2::new((pixel % FILM) as f64 + 0.5, (pixel / FILM) as f64 + 0.5);
            let ray = job.scene.camera.ray(film, [0.5; 2]);
            let mut seen = false;
            job.scene.geometry.for_each_hit(&ray, None, |hit| seen |= names(hit.object) == "core");
            seen
        })
        .collect()
}

/// Compares the two integrators on a scene after `passes` of each, in blocks of `side` pixels.
fn compare_balls(name: &str, scene: &Value, passes: [u64; 2], side: usize) -> (Measured, Measured) {
    const RADIUS: f64 = 0.1;
    let everything = vec![true; FILM * FILM];
    let path = Measured::new(scene, (Integrator::Path, passes[1]), 100..108, blocks(&everything, side));
    let photon = Measured::extrapolated_photons(scene, RADIUS, passes[0], blocks(&everything, side));
    assert_same(&format!("{name}, photon against path"), &photon, &path, 5e-3);
    (photon, path)
}

/// Compares, and shows that a renderer without the factor n² would fail: radiance inside glass is
/// n² times the radiance outside, so without the factor the core would be darker by n².
fn compare_with_missing_n2(name: &str, passes: [u64; 2], side: usize) {
    let scene = ball(json!(1.5));
    let (photon, path) = compare_balls(name, &scene, passes, side);
    let share: Vec<f64> = sees_the_core(&scene).iter().map(|&core| f64::from(core)).collect();
    let factors: Vec<f64> = share.iter().map(|core| 1.0 + core * (1.5_f64.powi(-2) - 1.0)).collect();
    let factors = block_means(&factors, FILM, side, &vec![true; FILM * FILM]);
    let mutant = Measured::combine(&[&photon, &Measured::from_runs(vec![factors; 8])], |l| l[0] * l[1]);
    assert_differs(&format!("{name}, mutant missing n²"), &mutant, &path);
}

#[test]
#[ignore = "slow: 10 seconds of CPU time"]
fn a_ball_of_glass_with_a_core_and_a_missing_n_squared() {
    compare_with_missing_n2("ball, n = 1.5", [28, 96], 16);
}

#[test]
#[ignore = "slow: two minutes of CPU time; finer blocks than the version above"]
fn a_ball_of_glass_with_a_core_in_small_blocks() {
    compare_with_missing_n2("ball in small blocks, n = 1.5", [512, 1024], 8);
}

#[test]
#[ignore = "slow: three minutes of CPU time"]
fn a_ball_of_dispersive_glass_with_a_core_in_small_blocks() {
    compare_balls("ball in small blocks, SF10", &ball(json!("SF10")), [768, 2048], 8);
}
