//! Light in bright cavities, where paths are long.

use crate::common::{diffuse, mean_y, render, with_setting};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// The luminous flux of the light in the sphere, in lm.
const FLUX: f64 = 1000.0;

/// A diffuse sphere of radius 1 m around a point light, seen from inside.
fn sphere(reflectance: f64) -> Value {
    json!({
        "camera": { "from": [0.3, 0.1, 0.2], "at": [1, 0.2, 0.1], "lens": { "pinhole": { "fov": 60 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "white": diffuse(reflectance) },
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "white" }],
        "lights": [{ "point": { "at": [0, 0, 0], "spectrum": "E", "luminous_flux": FLUX } }],
        "render": { "photons": 5000, "radius": 0.2 }
    })
}

/// Returns the luminance (cd/m²) of the wall: L = ρ Φ / (4π² (1 − ρ)).
fn sphere_luminance(reflectance: f64) -> f64 {
    FLUX / (4.0 * PI * PI) * reflectance / (1.0 - reflectance)
}

/// A sphere of reflectance ρ multiplies direct light by 1/(1 − ρ). No setting limits the paths.
#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn a_white_sphere_keeps_all_reflections() {
    for (reflectance, passes) in [(0.95, (16, 128)), (0.985, (64, 256))] {
        for (integrator, passes) in [(Integrator::Photon, passes.0), (Integrator::Path, passes.1)] {
            let rendered = render(&sphere(reflectance), integrator, passes);
            let ratio = mean_y(&rendered)[0] / sphere_luminance(reflectance);
            println!("sphere, ρ = {reflectance}, {integrator:?}: {ratio:.4} of the closed form");
            assert!((ratio - 1.0).abs() < 0.01, "ρ = {reflectance}, {integrator:?}: {ratio}");
            assert_eq!(rendered.ledger.depth_limit, 0.0);
            assert!(rendered.stats.notes.is_empty());
        }
    }
}

/// The light beyond a stated depth is missing in the picture, and the bias bars contain it.
#[test]
fn a_stated_depth_is_in_the_bias_bars() {
    let scene = with_setting(&sphere(0.9), "max_depth", 6);
    for (integrator, passes) in [(Integrator::Photon, 32), (Integrator::Path, 512)] {
        let Rendered { picture, stats, .. } = render(&scene, integrator, passes);
        let truth = sphere_luminance(0.9);
        let bias: f64 = picture.bias.iter().flatten().map(|&bias| f64::from(bias)).sum();
        let (shown, missing) = (picture.mean_y() / truth, bias / picture.bias.len() as f64 / truth);
        println!("depth 6, ρ = 0.9, {integrator:?}: picture {shown:.3}, bias {missing:.3}");
        assert!(shown < 0.7, "{shown}");
        assert!((shown + missing - 1.0).abs() < 0.03, "{integrator:?}: {shown} + {missing}");
        assert!(stats.notes[0].contains("max_depth"), "{:?}", stats.notes);
    }
}

/// Glass without absorption traps a part of the light inside a cube for ever. The render ends, and
/// books this light.
#[test]
fn trapped_light_ends_at_the_cap_and_is_booked() {
    let scene = json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 4, "height": 4 },
        "materials": { "glass": { "dielectric": { "ior": 1.5 } }, "grey": diffuse(0.5) },
        "objects": [
            { "shape": { "box": { "size": [1, 1, 1] } }, "material": "glass" },
            { "shape": { "rectangle": { "width": 9, "height": 9 } }, "material": "grey",
              "transform": [{ "translate": [0, -2, 0] }] }
        ],
        "lights": [{ "point": { "at": [0.11, 0.07, -0.03], "spectrum": 1, "power": 1 } }],
        "render": { "photons": 2000 }
    });
    let Rendered { ledger, stats, .. } = render(&scene, Integrator::Photon, 4);
    assert!(ledger.balance().abs() < 1e-12);
    assert!(ledger.depth_limit > 0.0 && ledger.depth_limit_indirect == 0.0, "{ledger:?}");
    assert!(stats.notes[0].contains("cap of 10000 events"), "{:?}", stats.notes);
}
