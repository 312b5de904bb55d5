//! Moving objects, lights and cameras: closed forms of motion blur, agreement of two integrators,
//! and cases that must not change at all.

use crate::common::compare::{Comparison, Measured, assert_differs, assert_same, compare};
use crate::common::edges::away_from_edges;
use crate::common::{all_y, block_means, diffuse, glass, job, overhead_camera, render, with_setting};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};
use std::borrow::Cow;

/// Columns of the strip that the edge crosses, and its width in m.
const COLUMNS: usize = 32;
const WIDTH: f64 = 2.0;

/// A strip of floor seen from above. The shutter is open from 0.1 s to 0.9 s.
fn strip(objects: Value, lights: Value) -> Value {
    let mut camera = overhead_camera([0.0, 0.0], 10.0, WIDTH / 8.0);
    camera["shutter"] = json!({ "open": 0.1, "close": 0.9 });
    json!({
        "camera": camera, "film": { "width": COLUMNS, "height": 4 },
        "materials": { "black": "absorber", "white": diffuse(0.8) },
        "objects": objects, "lights": lights, "render": { "photons": 100 }
    })
}

/// Keyframes of a uniform motion along x from 0 s to 1 s.
fn along_x(from: f64, to: f64) -> Value {
    json!([{ "time": 0, "transform": [{ "translate": [from, 0, 0] }] }, { "time": 1, "transform": [{ "translate": [to, 0, 0] }] }])
}

/// Returns the mean Y of each column.
fn columns(rendered: &Rendered) -> Vec<f64> {
    let y = all_y(rendered);
    let rows = y.len() / COLUMNS;
    (0..COLUMNS).map(|x| (0..rows).map(|row| y[row * COLUMNS + x]).sum::<f64>() / rows as f64).collect()
}

/// Returns the mean of a function of x over each column.
fn over_columns(f: impl Fn(f64) -> f64) -> Vec<f64> {
    const STEPS: usize = 200;
    let at = |i: usize| ((i as f64 + 0.5) / (COLUMNS * STEPS) as f64 - 0.5) * WIDTH;
    (0..COLUMNS).map(|x| (x * STEPS..(x + 1) * STEPS).map(|i| f(at(i))).sum::<f64>() / STEPS as f64).collect()
}

fn against(measured: &Measured, truth: Vec<f64>) -> Comparison {
    compare(measured, &Measured::from_runs(vec![truth; 8]))
}

/// A light of 10 cd/m² with an edge at x = 0 that extends far to the left.
fn lamp(motion: Value) -> Value {
    json!({ "name": "lamp", "shape": { "rectangle": { "width": 8, "height": 2 } }, "material": "black",
            "emission": { "spectrum": "D65", "luminance": 10 }, "transform": [{ "translate": [-4, 0, 0] }], "motion": motion })
}

#[test]
fn a_moving_edge_or_camera_gives_a_linear_ramp() {
    // The edge moves from −0.75 m to 0.75 m in one second, and from −0.6 m to 0.6 m while the
    // shutter is open.
    let edge = strip(json!([lamp(along_x(-0.75, 0.75))]), json!([]));
    let ramp = over_columns(|x| 10.0 * (0.5 - x / 1.2).clamp(0.0, 1.0));
    let mut panned = strip(json!([lamp(json!([]))]), json!([]));
    let at = |x: f64, time: f64| json!({ "time": time, "from": [x, 10, 0], "at": [x, 0, 0] });
    panned["camera"]["motion"] = json!([at(0.75, 0.0), at(-0.75, 1.0)]);
    for (name, scene, integrator) in [
        ("edge, photon", &edge, Integrator::Photon),
        ("edge, path", &edge, Integrator::Path),
        ("camera, photon", &panned, Integrator::Photon),
    ] {
        let measured = Measured::new(scene, (integrator, 96), 0..8, columns);
        let found = against(&measured, ramp.clone());
        println!("{name}: {found}");
        assert!(found.is_equal() && measured.relative_error() < 0.01);
    }
    // If the shutter were open for the whole second, the ramp would be flatter.
    let longer = over_columns(|x| 10.0 * (0.5 - x / 1.5).clamp(0.0, 1.0));
    assert!(!against(&Measured::new(&edge, (Integrator::Path, 96), 0..8, columns), longer).is_equal());
}

#[test]
fn a_shutter_that_opens_and_closes_slowly_weighs_the_ramp() {
    let mut scene = strip(json!([lamp(along_x(-0.75, 0.75))]), json!([]));
    scene["camera"]["shutter"]["curve"] = json!([[0, 0], [0.5, 1], [1, 0]]);
    // The light that a triangular shutter curve has transmitted by the share s of its time.
    let passed = |s: f64| if s < 0.5 { 2.0 * s * s } else { 1.0 - 2.0 * (1.0 - s) * (1.0 - s) };
    let truth = over_columns(|x| 10.0 * (1.0 - passed((x / 1.2 + 0.5).clamp(0.0, 1.0))));
    let found = against(&Measured::new(&scene, (Integrator::Path, 96), 0..8, columns), truth);
    println!("edge, triangular shutter: {found}");
    assert!(found.is_equal());
}

#[test]
fn a_moving_lamp_lights_each_place_for_its_time() {
    let floor = json!({ "name": "floor", "shape": { "rectangle": { "width": 8, "height": 2 } }, "material": "white" });
    let point = json!({ "point": { "at": [0, 0.5, 0], "spectrum": "D65", "luminous_intensity": 10, "motion": along_x(-1.0, 1.0) } });
    let scene = strip(json!([floor]), json!([point]));
    // (ρ/π)·I·h/d³ over the light's path from −0.8 m to 0.8 m, with ∫ du/(q² + u²)^{3/2} =
    // u/(q²√(q² + u²)) and q² = h² + z², averaged over the rows of the strip.
    let along = |q2: f64, u: f64| u / (q2 * (q2 + u * u).sqrt());
    let row =
        |x: f64, q2: f64| 0.8 / std::f64::consts::PI * 10.0 * 0.5 * (along(q2, x + 0.8) - along(q2, x - 0.8)) / 1.6;
    let z = |i: i32| (f64::from(i) + 0.5) / 16.0 * WIDTH / 16.0;
    let truth = over_columns(|x| (0..16).map(|i| row(x, 0.25 + z(i).powi(2))).sum::<f64>() / 16.0);
    for integrator in [Integrator::Photon, Integrator::Path] {
        let measured = Measured::new(&scene, (integrator, 256), 0..8, columns);
        let found = against(&measured, truth.clone());
        println!("lamp, {}: {found}", integrator.word());
        assert!(found.is_equal() && measured.relative_error() < 5e-3);
    }
}

/// If the wavelengths of a pass depended on its time, places that a light reaches only for a part
/// of the time would keep a false colour.
#[test]
fn a_ramp_of_motion_blur_has_the_colour_of_its_light() {
    let mut edge = lamp(along_x(-0.75, 0.75));
    edge["emission"]["spectrum"] = json!("E");
    let scene = strip(json!([edge]), json!([]));
    for integrator in [Integrator::Photon, Integrator::Path] {
        let picture = render(&scene, integrator, 512).picture;
        let (mut sum, mut count) = (0.0, 0.0);
        for (pixel, [x, y, z]) in picture.xyz.iter().enumerate() {
            if (10..22).contains(&(pixel % COLUMNS)) {
                sum += (x / y - 1.0).powi(2) + (z / y - 1.0).powi(2);
                count += 2.0;
            }
        }
        let off = f64::sqrt(sum / count);
        println!("colour of the ramp, {}: off by {off:.5}", integrator.word());
        assert!(off < 0.01, "{}: {off}", integrator.word());
    }
}

#[test]
fn a_turning_disk_does_not_shrink() {
    let turned = |time: f64, degrees: f64| json!({ "time": time, "transform": [{ "rotate": { "axis": [0, 1, 0], "degrees": degrees } }] });
    let disk = |motion: Value| {
        let disk = json!({ "name": "disk", "shape": { "disk": { "radius": 0.11 } }, "material": "black",
                           "emission": { "spectrum": "D65", "luminance": 10 }, "motion": motion });
        strip(json!([disk]), json!([]))
    };
    let turning = disk(json!([turned(0.0, 0.0), turned(1.0, 170.0)]));
    assert!(job(&turning).scene.moves());
    let [turning, still] =
        [turning, disk(json!([]))].map(|scene| Measured::new(&scene, (Integrator::Path, 64), 0..8, columns));
    assert_same("turning disk", &turning, &still, 0.05);
}

/// A ball of glass over a floor under a light. The ball has these keyframes, and the shutter is
/// open from 0 s to 1 s.
fn ball(transform: Value, motion: Value) -> Value {
    json!({
        "camera": { "from": [0, 2.2, 5], "at": [0, 0.6, 0], "lens": { "pinhole": { "fov": 32 } }, "shutter": { "open": 0, "close": 1 } },
        "film": { "width": 16, "height": 16 },
        "materials": { "grey": diffuse(0.5), "black": "absorber", "glass": glass("N-BK7") },
        "objects": [
            { "name": "floor", "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "grey" },
            { "name": "ball", "shape": { "sphere": { "radius": 0.5, "center": [0, 1.01, 0] } }, "material": "glass", "transform": transform, "motion": motion },
            { "name": "lamp", "shape": { "disk": { "radius": 1.8 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.8, 0] } ] }
        ],
        "render": { "photons": 2000 }
    })
}

/// Checks that two scenes give bit-identical pictures with both integrators.
#[track_caller]
fn assert_identical(a: &Value, b: &Value) {
    for integrator in [Integrator::Photon, Integrator::Path] {
        let [a, b] = [a, b].map(|scene| render(scene, integrator, 9));
        assert!(a.picture == b.picture);
    }
}

#[test]
fn a_scene_still_during_the_shutter_equals_a_still_scene() {
    let there = json!([{ "rotate": { "axis": [1, 2, 3], "degrees": 40 } }, { "translate": [0.3, 0.1, -0.2] }]);
    let key = |time: f64, transform: &Value| json!({ "time": time, "transform": transform });
    let away = json!([{ "translate": [1, 0, 0] }]);
    let still = ball(there.clone(), json!([]));
    // All keyframes are equal.
    assert_identical(&ball(json!([]), json!([key(0.2, &there), key(0.7, &there)])), &still);
    // A single keyframe, and motion before and after the shutter is open: the first and last poses
    // hold outside the keyframes' times.
    assert_identical(&ball(json!([]), json!([key(0.2, &there)])), &still);
    assert_identical(&ball(json!([]), json!([key(-2.0, &away), key(-1.0, &there)])), &still);
    assert_identical(&ball(json!([]), json!([key(1.0, &there), key(2.0, &away)])), &still);
    // A camera whose keyframes do not move it.
    let mut watched = still.clone();
    watched["camera"]["motion"] = json!([{ "time": 0 }, { "time": 1 }]);
    assert_identical(&watched, &still);
    // Such motion costs nothing: passes have no time of their own, and no scene is rebuilt.
    let rendered = render(&watched, Integrator::Photon, 2);
    assert_eq!((rendered.stats.effects["motion"].events, rendered.stats.seconds.pose), (0, 0.0));
    assert!(matches!(job(&watched).scene.at(0.5), Ok(Cow::Borrowed(_))));
}

#[test]
fn a_shutter_without_length_shows_a_moment() {
    let keys = json!([{ "time": 0, "transform": [] }, { "time": 2, "transform": [{ "translate": [2, 0, 1] }] }]);
    let mut moment = ball(json!([]), keys);
    moment["camera"]["shutter"] = json!({ "open": 0.5, "close": 0.5 });
    assert_identical(&moment, &ball(json!([{ "translate": [0.5, 0, 0.25] }]), json!([])));
}

#[test]
fn forced_motion_changes_nothing_and_forbidden_motion_freezes() {
    let still = ball(json!([]), json!([]));
    assert_identical(&with_setting(&still, "force", json!(["motion"])), &still);
    let moving = ball(
        json!([]),
        json!([{ "time": 0, "transform": [] }, { "time": 1, "transform": [{ "translate": [0, 1, 0] }] }]),
    );
    assert_identical(&with_setting(&moving, "forbid", json!(["motion"])), &still);
    assert_eq!(render(&moving, Integrator::Photon, 3).stats.effects["motion"].events, 3);
}

/// Pixels per side.
const FILM: usize = 32;

/// A white box with a red wall whose floor rises while the shutter is open.
fn rising_floor(by: f64) -> Value {
    let wall = |name: &str, material: &str, transform: Value, motion: Value| json!({ "name": name, "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": material, "transform": transform, "motion": motion });
    let still = json!([]);
    let rise = json!([{ "time": 0, "transform": [] }, { "time": 1, "transform": [{ "translate": [0, by, 0] }] }]);
    json!({
        "camera": { "from": [0, 0, 3.9], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 38 } }, "shutter": { "open": 0, "close": 1 } },
        "film": { "width": FILM, "height": FILM },
        "materials": {
            "white": diffuse(0.73), "black": "absorber",
            "red": diffuse(json!({ "table": { "nm": [360, 580, 600, 830], "values": [0.06, 0.06, 0.6, 0.6] } }))
        },
        "objects": [
            wall("floor", "white", json!([{ "translate": [0, -1, 0] }]), rise),
            wall("ceiling", "white", json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 1, 0] }]), still.clone()),
            wall("back", "white", json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -1] }]), still.clone()),
            wall("left", "red", json!([{ "rotate": { "axis": [0, 0, 1], "degrees": -90 } }, { "translate": [-1, 0, 0] }]), still.clone()),
            wall("right", "white", json!([{ "rotate": { "axis": [0, 0, 1], "degrees": 90 } }, { "translate": [1, 0, 0] }]), still),
            { "name": "lamp", "shape": { "rectangle": { "width": 0.6, "height": 0.6 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 0.99, 0] } ] }
        ],
        "render": { "photons": 20000 }
    })
}

#[test]
#[ignore = "slow: a quarter of a minute of CPU time"]
fn photons_on_a_moving_receiver_give_the_path_tracers_picture() {
    const RADIUS: f64 = 0.1;
    let scene = rising_floor(0.25);
    let posed = job(&scene).scene;
    let masks = (0..=16).map(|i| away_from_edges(&posed.at(f64::from(i) / 16.0).unwrap(), 2.0 * RADIUS));
    let mask = masks.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| *a && *b).collect()).unwrap();
    let blocks = |rendered: &Rendered| block_means(&all_y(rendered), FILM, 8, &mask);
    let path = Measured::new(&scene, (Integrator::Path, 128), 100..108, blocks);
    let photon = Measured::extrapolated_photons(&scene, RADIUS, 32, blocks);
    assert_same("rising floor, photon against path", &photon, &path, 5e-3);
    // A renderer that froze the floor at the shutter's opening would fail.
    let frozen = with_setting(&scene, "forbid", json!(["motion"]));
    let frozen = Measured::new(&frozen, (Integrator::Path, 128), 100..108, blocks);
    assert_differs("rising floor, mutant frozen", &photon, &frozen);
}

#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn a_caustic_that_moves_is_that_of_the_path_tracer() {
    let keys = json!([{ "time": 0, "transform": [{ "translate": [-0.5, 0, 0] }] }, { "time": 1, "transform": [{ "translate": [0.7, -0.3, 0.2] }] }]);
    let mut scene = ball(json!([]), keys);
    scene["materials"]["glass"] = glass(1.5);
    let blocks = |rendered: &Rendered| block_means(&all_y(rendered), 16, 4, &[true; 256]);
    let photon = Measured::new(&scene, (Integrator::Photon, 64), 0..8, blocks);
    let path = Measured::new(&scene, (Integrator::Path, 256), 100..108, blocks);
    assert_same("moving caustic, photon against path", &photon, &path, 1e-2);
}
