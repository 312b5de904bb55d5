//! A camera lens of real glass: it takes as much light as a pinhole in the middle of the picture, and photons and paths paint the same through it.

use crate::common::compare::{Measured, assert_same};
use crate::common::{colour_blocks, diffuse, glass, render};
use abbe::render::Integrator;
use serde_json::{Value, json};

/// Light from everywhere, of 100/π cd/m² in every direction.
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

/// Mean Y of the pixels around the middle, over which cos⁴ falls by 0.2 %, and of those in the corners.
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
fn a_uniform_wall_has_the_same_luminance_through_pinhole_thin_lens_and_real_glass() {
    let wall = 100.0 / std::f64::consts::PI;
    let thin =
        json!({ "thin": { "focal_length_mm": 100, "f_number": 4, "focus_distance": 3, "sensor_height_mm": 12 } });
    let lenses = [
        ("pinhole", json!({ "pinhole": { "fov": 10 } })),
        ("thin lens", thin),
        ("double Gauss", system("double-gauss", 4.0)),
        ("Tessar", system("tessar", 8.0)),
    ];
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
fn through_a_lens_of_real_glass_photons_and_paths_paint_the_same() {
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
