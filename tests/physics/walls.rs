//! Kernels beside walls: light does not pass through thin walls, and pixels as large as a wall are
//! neither too dark nor too bright.

use crate::common::{diffuse, mean_y, render};
use abbe::render::Integrator;
use serde_json::{Value, json};

/// A closed room with walls of 0.1 m on a wide ground, and a lamp inside. With `sun`, bright
/// daylight surrounds the room.
fn room(sun: bool) -> Value {
    let wall = |size: [f64; 3], at: [f64; 3]| json!({ "shape": { "box": { "size": size } }, "material": "wall", "transform": [{ "translate": at }] });
    let mut lights = vec![json!({ "point": { "at": [0, 2, 0], "spectrum": "E", "luminous_flux": 1500 } })];
    if sun {
        lights.push(json!({ "directional": { "toward": [0.5, -1, 0.3], "spectrum": "E", "illuminance": 80000,
                                             "angular_diameter": 0.53 } }));
    }
    json!({
        "camera": { "from": [0, 1.4, 2.2], "at": [0, 0.6, -2], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 80 } } },
        "film": { "width": 24, "height": 24 },
        "materials": { "floor": diffuse(0.5), "wall": diffuse(0.7) },
        "objects": [
            { "shape": { "rectangle": { "width": 60, "height": 60 } }, "material": "floor" },
            wall([0.1, 2.6, 5.2], [-2.05, 1.3, 0.0]), wall([0.1, 2.6, 5.2], [2.05, 1.3, 0.0]),
            wall([4.0, 2.6, 0.1], [0.0, 1.3, -2.55]), wall([4.0, 2.6, 0.1], [0.0, 1.3, 2.55]),
            wall([4.2, 0.1, 5.2], [0.0, 2.65, 0.0])
        ],
        "lights": lights, "render": { "photons": 10000 }
    })
}

#[test]
fn daylight_does_not_leak_through_thin_walls() {
    let mean = |sun, integrator, passes| mean_y(&render(&room(sun), integrator, passes))[0];
    let (dark, light) = (mean(false, Integrator::Photon, 16), mean(true, Integrator::Photon, 16));
    let path = mean(false, Integrator::Path, 256);
    println!("closed room: photon/path {:.4}; with the sun outside {:.4}", dark / path, light / path);
    assert!((dark / path - 1.0).abs() < 0.03, "{dark} and {path}");
    assert!((light / path - 1.0).abs() < 0.03, "{light} and {path}");
}

/// A cube of 4 m on a film of 1, 4 and 16 pixels.
#[test]
fn a_pixel_may_be_as_large_as_a_wall() {
    for size in [1, 2, 4] {
        let scene = json!({
            "camera": { "from": [0, 0, 1.5], "at": [0.3, 0.2, -2], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 90 } } },
            "film": { "width": size, "height": size },
            "materials": { "white": diffuse(0.6) },
            "objects": [{ "shape": { "box": { "size": [4, 4, 4] } }, "material": "white" }],
            "lights": [{ "point": { "at": [0.5, 1, 0.2], "spectrum": "E", "luminous_flux": 20000 } }],
            "render": { "photons": 20000 }
        });
        let photon = mean_y(&render(&scene, Integrator::Photon, 512 / (size * size)))[0];
        let path = mean_y(&render(&scene, Integrator::Path, 32768 / (size * size)))[0];
        println!("cube on {size} × {size} pixels: photon/path {:.4}", photon / path);
        assert!((photon / path - 1.0).abs() < 0.02, "{size}: {photon} and {path}");
    }
}
