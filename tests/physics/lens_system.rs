//! A camera lens of real glass: the centre of the picture is as bright as through a pinhole, and
//! photon and path renders agree.

use crate::common::compare::{Measured, assert_same};
use crate::common::{colour_blocks, diffuse, glass, render};
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// Uniform light of 100/π cd/m² from every direction.
fn uniform(lens: &Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "lens": lens },
        "film": { "width": 30, "height": 20 },
        "materials": { "grey": diffuse(0.5) },
        "objects": [ { "shape": { "sphere": { "radius": 0.1, "center": [0, 0, 5] } }, "material": "grey" } ],
        "lights": [ { "environment": { "spectrum": "D65", "illuminance": 100 } } ],
        "render": { "photons": 100 }
    })
}

fn system(prescription: &str, f_number: f64) -> Value {
    json!({ "system": { "prescription": prescription, "focus_distance": 3, "f_number": f_number, "sensor_height_mm": 12 } })
}

/// Returns the mean Y of the pixels around the middle, where cos⁴ falls by 0.2 %, and of the
/// corners.
fn middle_and_corners(scene: &Value, integrator: Integrator) -> [f64; 2] {
    let picture = render(scene, integrator, 2000).picture;
    let y = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
        let count = (columns.len() * rows.len()) as f64;
        rows.flat_map(|row| columns.clone().map(move |column| row * 30 + column))
            .map(|i| picture.xyz[i][1])
            .sum::<f64>()
            / count
    };
    let corners = [y(0..3, 0..3), y(27..30, 0..3), y(0..3, 17..20), y(27..30, 17..20)];
    [y(11..19, 6..14), corners.iter().sum::<f64>() / 4.0]
}

#[test]
#[ignore = "slow: half a minute of CPU time"]
fn a_wall_is_equally_bright_through_every_kind_of_lens() {
    let wall = 100.0 / std::f64::consts::PI;
    let thin =
        json!({ "thin": { "focal_length_mm": 100, "f_number": 4, "focus_distance": 3, "sensor_height_mm": 12 } });
    let lenses = [
        ("pinhole", json!({ "pinhole": { "fov": 10 } })),
        ("thin lens", thin),
        ("double Gauss", system("double-gauss", 4.0)),
        ("Tessar", system("tessar", 8.0)),
        ("double Gauss with five blades", {
            let mut lens = system("double-gauss", 4.0);
            lens["system"]["blades"] = json!(5);
            lens
        }),
    ];
    // Thin lenses of all zoom settings give equal brightness.
    let zoom = |focal_mm: f64| json!({ "thin": { "focal_length_mm": focal_mm, "f_number": 4, "focus_distance": 22, "sensor_height_mm": 24 } });
    let zooms = [("50 mm", zoom(50.0)), ("135 mm", zoom(135.0)), ("300 mm", zoom(300.0))];
    let lenses = lenses.into_iter().chain(zooms);
    for (name, lens) in lenses {
        for integrator in [Integrator::Photon, Integrator::Path] {
            let [middle, corner] = middle_and_corners(&uniform(&lens), integrator).map(|y| y / wall);
            println!("uniform wall through {name}, {integrator:?}: middle {middle:.4}, corners {corner:.4}");
            assert!((middle - 1.0).abs() < 0.005, "{name}, {integrator:?}: {middle}");
            assert!(corner < 1.005 && corner > 0.8, "{name}, {integrator:?}: {corner}");
        }
    }
}

#[test]
fn four_blades_blur_a_point_to_a_square() {
    let corner_light = |rotation: f64| {
        let mut lens = system("double-gauss", 4.0);
        lens["system"]["blades"] = json!(4);
        lens["system"]["rotation"] = json!(rotation);
        lens["system"]["sensor_height_mm"] = json!(2.4);
        let scene = json!({
            "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "lens": lens },
            "film": { "width": 48, "height": 48 },
            "materials": { "black": diffuse(0.0) },
            "objects": [ { "shape": { "sphere": { "radius": 0.004, "center": [0, 0, -6] } }, "material": "black",
                           "emission": { "spectrum": { "lines": [{ "nm": 587.6, "power": 1 }] }, "luminance": 1000 } } ],
            "render": { "photons": 100 }
        });
        let picture = render(&scene, Integrator::Path, 128).picture;
        let from_middle = |i: usize| (i as f64 + 0.5 - 24.0).abs();
        let light = picture.xyz.iter().enumerate().map(|(i, xyz)| (from_middle(i % 48), from_middle(i / 48), xyz[1]));
        // A point 6 m away is spread over a circle of 0.43 mm diameter, 8.6 pixels. Half the side
        // of the square inscribed in it is 3.0 pixels.
        let [mut corners, mut all] = [0.0; 2];
        for (x, y, light) in light {
            all += light;
            corners += if x.min(y) > 2.0 { light } else { 0.0 };
        }
        corners / all
    };
    let [upright, on_its_corner] = [45.0, 0.0].map(corner_light);
    println!("light near the upright square's corners: upright {upright:.4}, on its corner {on_its_corner:.4}");
    assert!(upright > 2.0 * on_its_corner && upright > 0.05, "{upright} and {on_its_corner}");
}

#[test]
#[ignore = "slow: 25 seconds of CPU time"]
fn photon_and_path_renders_agree_through_a_lens_system() {
    let scene = json!({
        "camera": { "from": [0, 0.5, 3], "at": [0, 0, 0], "lens": system("double-gauss", 2.0) },
        "film": { "width": 24, "height": 16 },
        "materials": { "grey": diffuse(0.5), "flint": glass("SF10"), "black": "absorber" },
        "objects": [
            { "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "grey", "transform": [ { "translate": [0, -0.3, 0] } ] },
            { "shape": { "sphere": { "radius": 0.08, "center": [-0.05, -0.1, 0] } }, "material": "flint" },
            { "shape": { "disk": { "radius": 0.8 } }, "material": "black", "emission": { "spectrum": "D65", "luminance": 100 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 1.2, 0] } ] }
        ],
        "render": { "photons": 20000 }
    });
    let take = colour_blocks(8);
    let path = Measured::new(&scene, (Integrator::Path, 512), 100..108, &take);
    let photon = Measured::new(&scene, (Integrator::Photon, 128), 0..8, &take);
    assert_same("through a double Gauss, photon against path", &photon, &path, 0.01);
}
