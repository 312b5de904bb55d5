//! Minimal scenes of the faults that the search found.

use crate::common::{diffuse, render};
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// A camera that sees the dark back of a rectangular light, far off the origin, and nothing else.
fn dark_back(material: Value, rotation: f64, offset: f64) -> Value {
    let at = [offset * 0.71, offset * 0.37, -offset * 0.53];
    let from = [at[0], at[1] + 1.0, at[2]];
    json!({
        "camera": { "from": from, "at": at, "up": [0, 0, 1], "lens": { "pinhole": { "fov": 20 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "surface": material },
        "objects": [{
            "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": "surface",
            "emission": { "spectrum": "E", "luminance": 1000 },
            "transform": [
                { "rotate": { "axis": [1, 0.3, 0.2], "degrees": 180.0 + rotation } }, { "translate": at }
            ]
        }],
        "render": { "photons": 1000 }
    })
}

/// Rounding puts a point of the rectangle above or below the rectangle's plane. From above, the
/// rectangle would subtend half of all directions.
#[test]
fn a_flat_light_does_not_light_its_own_surface() {
    for (rotation, offset) in [(0.0, 1.0), (11.0, 1.0), (23.0, 100.0), (-17.0, 1e4)] {
        for material in [diffuse(0.5), json!({ "glossy": { "reflectance": 0.3, "ior": 1.5, "roughness": 0.3 } })] {
            let scene = dark_back(material, rotation, offset);
            for integrator in [Integrator::Photon, Integrator::Path] {
                let seen = render(&scene, integrator, 16).picture.mean_y();
                assert!(seen == 0.0, "{integrator:?}, {rotation}° at {offset} m: {seen} cd/m²");
            }
        }
    }
}

/// The light shines outwards, and the camera is inside the shell.
#[test]
fn a_shell_of_light_does_not_shine_through_itself() {
    let scene = json!({
        "camera": { "from": [70, 30, 11], "at": [70.3, 30.2, 11.5], "lens": { "pinhole": { "fov": 60 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "paper": { "translucent": { "reflectance": 0.3, "transmittance": 0.6 } } },
        "objects": [{
            "shape": { "sphere": { "center": [70, 30, 11], "radius": 0.7 } }, "material": "paper",
            "emission": { "spectrum": "E", "luminance": 1000 }
        }],
        "render": { "photons": 1000 }
    });
    for integrator in [Integrator::Photon, Integrator::Path] {
        let seen = render(&scene, integrator, 16).picture.mean_y();
        assert!(seen == 0.0, "{integrator:?}: {seen} cd/m²");
    }
}
