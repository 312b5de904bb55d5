//! Kernels beside walls: light does not pass through thin walls, and pixels as large as a wall are
//! neither too dark nor too bright.

use crate::common::{diffuse, mean_y, render};
use abbe_session::render::Integrator;
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

/// A spot of light that is much smaller than the kernels. In pass i, counted from 0, the kernel in
/// the middle of the spot has the value 2/(π r_i²). The radius follows r²_{i+1} = r²_i (i + 5/3)/(i
/// + 2) (Knaus & Zwicker 2011).
#[test]
fn the_middle_of_a_small_spot_grows_as_kernels_shrink() {
    let (reflectance, first_radius) = (0.5, 0.2_f64);
    let pane = |y: f64| json!({ "shape": { "box": { "size": [1, 0.02, 1] } }, "material": "clear", "transform": [{ "translate": [0, y, 0] }] });
    let scene = json!({
        "camera": { "from": [0, 0.6, 0], "at": [0, 0, 0], "up": [0, 0, -1], "lens": { "pinhole": { "fov": 0.2 } } },
        "film": { "width": 2, "height": 2 },
        "materials": { "grey": diffuse(reflectance), "clear": { "dielectric": { "ior": 1 } } },
        "objects": [{ "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey" }, pane(0.3), pane(0.8)],
        "lights": [{ "beam": { "from": [0, 1, 0], "to": [0, 0, 0], "radius": 0.002, "spectrum": "E", "luminous_flux": 1 } }],
        "render": { "photons": 2000, "radius": first_radius }
    });
    let passes = 64;
    let (mut square, mut sum) = (first_radius * first_radius, 0.0);
    for i in 0..passes {
        sum += 2.0 / (std::f64::consts::PI * square);
        square *= (i as f64 + 5.0 / 3.0) / (i as f64 + 2.0);
    }
    let truth = reflectance / std::f64::consts::PI * sum / passes as f64;
    let ratio = mean_y(&render(&scene, Integrator::Photon, passes))[0] / truth;
    println!("small spot: {ratio:.4} of the closed form");
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

/// A cube of 4 m on a film of 1, 4 and 16 pixels.
#[test]
#[ignore = "nightly: 4 seconds of CPU time"]
fn a_pixel_may_be_as_large_as_a_wall() {
    for size in [1, 2, 4] {
        let scene = json!({
            "camera": { "from": [0, 0, 1.5], "at": [0.3, 0.2, -2], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 90 } } },
            "film": { "width": size, "height": size },
            "materials": { "white": diffuse(0.6) },
            "objects": [{ "shape": { "box": { "size": [4, 4, 4] } }, "material": "white" }],
            "lights": [{ "point": { "at": [0.5, 1, 0.2], "spectrum": "E", "luminous_flux": 20000 } }],
            "render": { "photons": 5000 }
        });
        let photon = mean_y(&render(&scene, Integrator::Photon, 256 / (size * size)))[0];
        let path = mean_y(&render(&scene, Integrator::Path, 16384 / (size * size)))[0];
        println!("cube on {size} × {size} pixels: photon/path {:.4}", photon / path);
        assert!((photon / path - 1.0).abs() < 0.02, "{size}: {photon} and {path}");
    }
}
