//! The number of surface events on a path means the same to photons and to camera paths.

use crate::common::compare::{Measured, assert_same};
use crate::common::{diffuse, glass, with_setting};
use crate::meters::{measure, readings};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// A closed white room of 2 m with a lamp under the ceiling, seen from inside.
fn room(content: &[Value], medium: Option<Value>) -> Value {
    let mut objects = vec![
        json!({ "name": "room", "shape": { "box": { "size": [2, 2, 2] } }, "material": "white" }),
        json!({ "name": "lamp", "shape": { "disk": { "radius": 0.4 } }, "material": "black",
                "emission": { "spectrum": "E", "luminance": 10 },
                "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0.1, 0.9, 0] }] }),
    ];
    objects.extend(content.iter().cloned());
    let mut scene = json!({
        "camera": { "from": [0.3, 0.1, 0.9], "at": [0, -0.3, 0], "lens": { "pinhole": { "fov": 70 } } },
        "film": { "width": 12, "height": 12 },
        "materials": { "white": diffuse(0.8), "black": "absorber", "glass": glass(1.5),
                       "mirror": { "mirror": { "reflectance": 0.9 } },
                       "rough": { "conductor": { "metal": "aluminium", "roughness": 0.3 } } },
        "objects": objects,
        "render": { "photons": 4000, "radius": 0.05, "camera_samples": 4 }
    });
    if let Some(medium) = medium {
        scene["media"] = json!({ "fog": medium });
        scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
        scene["objects"]
            .as_array_mut()
            .expect("objects")
            .push(json!({ "name": "fog", "shape": { "box": { "size": [1.7, 1.7, 1.7] } }, "material": "fog" }));
    }
    scene
}

fn ball(material: &str) -> Value {
    json!({ "name": "ball", "shape": { "sphere": { "radius": 0.4, "center": [0, -0.3, 0] } }, "material": material })
}

fn fog(scattering: f64) -> Value {
    json!({ "homogeneous": { "absorption": 0.05, "scattering": scattering, "phase": "isotropic" } })
}

fn scenes() -> Vec<(&'static str, Value)> {
    vec![
        ("ball", room(&[ball("glass")], None)),
        ("mirror", room(&[ball("mirror")], None)),
        ("rough", room(&[ball("rough")], None)),
        ("thin fog", room(&[ball("glass")], Some(fog(0.3)))),
        ("dense fog", room(&[], Some(fog(3.0)))),
    ]
}

/// Returns the luminance of the picture.
fn shown(rendered: &Rendered) -> Vec<f64> {
    vec![rendered.picture.mean_y()]
}

fn compare_at(name: &str, scene: &Value, depth: u64, (photon, path): (u64, u64)) {
    let scene = with_setting(scene, "max_depth", depth);
    let photon = Measured::new(&scene, (Integrator::Photon, photon), 0..8, shown);
    let path = Measured::new(&scene, (Integrator::Path, path), 100..108, shown);
    assert_same(&format!("{name}, depth {depth}"), &photon, &path, 0.015);
}

#[test]
fn photons_and_paths_count_the_same_events() {
    for depth in [2, 3] {
        compare_at("ball", &room(&[ball("glass")], None), depth, (4, 128));
    }
}

#[test]
#[ignore = "slow: minutes of CPU time"]
fn photons_and_paths_agree_at_every_depth() {
    for (name, scene) in scenes() {
        for depth in 1..=6 {
            compare_at(name, &scene, depth, (16, 256));
        }
    }
}

/// A meter counts the events of photons and of paths alike, also of panes on the way.
#[test]
#[ignore = "nightly: 10 seconds of CPU time"]
fn meters_count_the_same_events() {
    let pane = json!({ "name": "pane", "shape": { "rectangle": { "width": 1.6, "height": 1.6 } }, "material": "pane",
                       "transform": [{ "translate": [0, 0.5, 0] }] });
    let mut scene = room(&[pane], None);
    scene["render"].as_object_mut().expect("settings").remove("radius");
    scene["materials"]["pane"] = json!({ "thin_dielectric": { "ior": 1.5 } });
    scene["meters"] = json!([{ "name": "floor", "points": [[0.2, -0.99, 0.3]] }]);
    for depth in 1..=5 {
        let scene = with_setting(&scene, "max_depth", depth);
        let [photon, path] = [(Integrator::Photon, 64), (Integrator::Path, 1000)]
            .map(|(integrator, passes)| readings(&measure(&scene, Some(integrator), passes))[0]);
        println!("meter below a pane, depth {depth}: {photon:?}, {path:?}");
        let error = photon[1].hypot(path[1]);
        assert!((photon[0] - path[0]).abs() < 4.0 * error && error < 0.03 * path[0], "{photon:?}, {path:?}");
    }
}
