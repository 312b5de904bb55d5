//! Refinements of random scenes: coatings, textures, gratings, ratio tracking, dyes, and cameras
//! inside glass.

use crate::random::Pcg;
use crate::spectra;
use serde_json::{Value, json};

/// The first seed whose scene is refined.
pub(crate) const FIRST_SEED: u64 = 128;

/// Refines a scene. If `smooth` is true, the path tracer finds all light by way of ideally smooth
/// surfaces. `scale` is the length in scene units that belongs to a length of 1 of the generator.
pub(crate) fn refine(scene: &mut Value, rng: &mut Pcg, smooth: bool, scale: f64) {
    if let Some(materials) = scene["materials"].as_object_mut() {
        materials.values_mut().for_each(|material| refine_material(material, rng, smooth));
    }
    if let Some(media) = scene["media"].as_object_mut() {
        media.values_mut().for_each(|medium| refine_medium(medium, rng, scale));
    }
    if smooth && scene["camera"]["motion"].is_null() && rng.chance(0.4) {
        surround_camera(scene, rng, scale);
    }
}

fn refine_material(material: &mut Value, rng: &mut Pcg, smooth: bool) {
    for kind in ["dielectric", "conductor"] {
        if material[kind].is_object() && rng.chance(0.4) {
            material[kind]["coating"] =
                json!({ "layers": [{ "ior": "MgF2", "thickness_nm": rng.between(60.0, 400.0) }] });
        }
    }
    if material["diffuse"].is_object() && rng.chance(0.5) {
        let old = material["diffuse"]["reflectance"].take();
        let pattern = rng.pick(&["checker", "stripes"]);
        material["diffuse"]["reflectance"] =
            json!({ pattern: { "a": old, "b": spectra::reflectance(rng, 0.8), "scale": rng.between(2.0, 6.0) } });
    }
    let may_be_grating = ["thin_dielectric", "mirror", "translucent"].iter().any(|kind| material[kind].is_object());
    if smooth && may_be_grating && rng.chance(0.7) {
        *material = json!({ "grating": {
            "lines_per_mm": rng.log_between(100.0, 1000.0), "transmittance": 0.6, "reflectance": 0.3,
            "angle": rng.between(0.0, 180.0)
        } });
    }
}

fn refine_medium(medium: &mut Value, rng: &mut Pcg, scale: f64) {
    if medium["grid"].is_object() {
        medium["grid"]["transmittance"] = json!("ratio");
    }
    for kind in ["homogeneous", "grid"] {
        if medium[kind].is_object() && medium[kind]["emission"].is_null() && rng.chance(0.4) {
            let absorption = rng.log_between(0.1, 2.0) / scale;
            medium[kind]["dye"] = json!({
                "absorption": { "table": { "nm": [360, 480, 520], "values": [absorption, absorption, 0] } },
                "emission": { "gaussian": { "peak_nm": 550, "fwhm_nm": 60 } }, "quantum_yield": 0.9
            });
        }
    }
}

/// Puts the camera into a ball of glass, away from its centre.
fn surround_camera(scene: &mut Value, rng: &mut Pcg, scale: f64) {
    let shift = rng.direction();
    let from = scene["camera"]["from"].clone();
    let centre = [0, 1, 2].map(|i: usize| from[i].as_f64().expect("a coordinate") + 0.05 * scale * shift[i]);
    scene["materials"]["around the camera"] = json!({ "dielectric": { "ior": spectra::index(rng), "priority": 3 } });
    let ball = json!({
        "shape": { "sphere": { "radius": 0.15 * scale } }, "material": "around the camera",
        "transform": [{ "translate": centre }]
    });
    scene["objects"].as_array_mut().expect("the objects").push(ball);
}
