//! Dispersive glass near the critical angle, seen from inside: closed forms for each wavelength.

use crate::common::compare::Measured;
use crate::common::{diffuse, glass, mean_y};
use abbe_optics::fresnel;
use abbe_optics::glass::RefractiveIndex;
use abbe_session::render::Integrator;
use abbe_spectra::spectrum::Observer;
use serde_json::json;

/// The direction of view in the middle of the picture, and half of the angle of view, in degrees
/// from the normal: just beyond the critical angle of 550 nm, where only red light leaves the
/// glass.
const VIEW_DEG: f64 = 34.15;
const HALF_VIEW_DEG: f64 = 0.1;

/// Returns the luminance that the camera sees through the surface, for surroundings of luminance 1:
/// n² (1 − R), weighted by ȳ, in the mean over the angles of the picture.
fn seen_from_inside(index: &RefractiveIndex) -> f64 {
    let observer = Observer::cie1931();
    let (mut seen, mut all) = (0.0, 0.0);
    for nm in (360..=830).map(f64::from) {
        let (n, weight) = (index.n(nm), observer.xyz_bar(nm)[1]);
        for step in 0..2000 {
            let degrees = VIEW_DEG + HALF_VIEW_DEG * ((f64::from(step) + 0.5) / 1000.0 - 1.0);
            seen += weight * n * n * (1.0 - fresnel::dielectric(degrees.to_radians().cos(), n, 1.0));
        }
        all += 2000.0 * weight;
    }
    seen / all
}

#[test]
fn red_light_leaves_glass_beyond_the_critical_angle_of_green_light() {
    let (sin, cos) = VIEW_DEG.to_radians().sin_cos();
    let scene = json!({
        "camera": { "from": [0, 0, 0], "at": [sin, cos, 0], "up": [0, 0, 1],
                    "lens": { "pinhole": { "fov": 2.0 * HALF_VIEW_DEG } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "flint": glass("SF11"), "black": diffuse(0) },
        "objects": [{ "shape": { "box": { "size": [40, 4, 40] } }, "material": "flint" },
                    { "shape": { "rectangle": { "width": 39, "height": 39 } }, "material": "black",
                      "transform": [{ "translate": [0, -0.5, 0] }] }],
        "lights": [{ "environment": { "spectrum": "E", "luminance": 1 } }], "render": { "photons": 500 }
    });
    let index = RefractiveIndex::catalogue("SF11").expect("a glass of the catalogue");
    let known = seen_from_inside(&index);
    let reference = fresnel::dielectric(VIEW_DEG.to_radians().cos(), index.n(550.0), 1.0);
    assert!(reference == 1.0 && known > 0.05, "{reference}, {known}");
    for (integrator, passes) in [(Integrator::Photon, 128), (Integrator::Path, 128)] {
        let seen = Measured::new(&scene, (integrator, passes), 0..4, mean_y);
        let (ratio, error) = (seen.mean(0) / known, seen.error(0) / known);
        println!("beyond the critical angle, {integrator:?}: {ratio:.3} ± {error:.3} of the closed form");
        assert!(error < 0.03, "too noisy to tell");
        assert!((ratio - 1.0).abs() < 4.0 * error + 0.01, "{integrator:?}: {ratio} ± {error}");
    }
}
