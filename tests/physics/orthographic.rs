//! Orthographic cameras: the area of a picture, and photons against camera paths.

use crate::common::render;
use crate::textures::{assert_integrators_agree, ball_under_a_lamp};
use abbe_session::render::Integrator;
use serde_json::json;

/// A luminous disk covers the same part of the picture at each distance: its area divided by that
/// of the picture.
#[test]
fn an_orthographic_picture_shows_true_areas() {
    for distance in [0.5, 50.0] {
        let scene = json!({
            "camera": { "from": [0, 0, distance], "at": [0, 0, 0], "lens": { "orthographic": { "height": 2 } } },
            "film": { "width": 48, "height": 32 },
            "materials": { "black": "absorber" },
            "objects": [{ "shape": { "disk": { "radius": 0.8 } }, "material": "black",
                "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }],
                "emission": { "spectrum": "D65", "luminance": 100 } }],
            "render": { "photons": 100 }
        });
        let picture = render(&scene, Integrator::Photon, 64).picture;
        let mean = picture.xyz.iter().map(|xyz| xyz[1]).sum::<f64>() / picture.xyz.len() as f64;
        let expected = 100.0 * std::f64::consts::PI * 0.8 * 0.8 / (3.0 * 2.0);
        assert!((mean / expected - 1.0).abs() < 0.003, "{distance}: {mean} for {expected}");
    }
}

/// A glass ball focuses the light of a lamp onto a floor. Photons are connected to the camera along
/// its axis.
#[test]
#[ignore = "slow: 4 seconds of CPU time"]
fn photons_and_paths_agree_in_orthographic_pictures() {
    let mut scene = ball_under_a_lamp();
    scene["camera"] = json!({ "from": [0.2, 4, 5], "at": [0.2, 0.6, 0], "lens": { "orthographic": { "height": 3 } } });
    assert_integrators_agree("orthographic camera", &scene);
}

/// The left half of the picture starts inside of absorbing glass, and the right half beside it: the
/// bodies differ from ray to ray.
#[test]
fn an_orthographic_picture_may_start_inside_of_a_body_in_part() {
    let scene = json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "lens": { "orthographic": { "height": 2 } } },
        "film": { "width": 4, "height": 4 },
        "materials": { "grey": { "dielectric": { "ior": 1, "absorption": 0.5 } } },
        "objects": [{ "shape": { "box": { "size": [4, 4, 4] } }, "material": "grey", "transform": [{ "translate": [-2, 0, 0] }] }],
        "lights": [{ "environment": { "spectrum": "E", "luminance": 1 } }], "render": { "photons": 1000 }
    });
    for integrator in [Integrator::Photon, Integrator::Path] {
        let rendered = render(&scene, integrator, 64);
        for (pixel, xyz) in rendered.picture.xyz.iter().enumerate() {
            let known = if pixel % 4 < 2 { (-1.0_f64).exp() } else { 1.0 };
            assert!((xyz[1] / known - 1.0).abs() < 0.02, "{integrator:?}, pixel {pixel}: {} for {known}", xyz[1]);
        }
    }
}
