//! Refinements of random scenes: coatings, textures, gratings, ratio tracking, dyes, cameras inside
//! glass, and glowing bodies that overlap other bodies.

use crate::random::Pcg;
use crate::spectra;
use serde_json::{Value, json};

/// The first seed whose scene is refined.
pub(crate) const FIRST_SEED: u64 = 128;

/// The first seed whose glowing bodies overlap other bodies.
pub(crate) const FIRST_OVERLAP: u64 = 300;

/// Gives glowing media a priority, fills some of them into glass, and adds another body over each.
pub(crate) fn overlap_glowing_bodies(scene: &mut Value, rng: &mut Pcg, smooth: bool, scale: f64) {
    let media = scene["media"].as_object().cloned().unwrap_or_default();
    let glowing: Vec<String> = media
        .iter()
        .filter(|(_, medium)| !medium["homogeneous"]["emission"].is_null())
        .map(|(name, _)| name.clone())
        .collect();
    for name in glowing {
        scene["media"][&name]["homogeneous"]["priority"] = json!(rng.below(3) as i32 - 1);
        let filled = |material: &Value| material["boundary"]["medium"] == json!(name);
        let Some(material) = scene["materials"].as_object().and_then(|all| all.iter().find(|(_, m)| filled(m))) else {
            continue;
        };
        let material = material.0.clone();
        let objects = scene["objects"].as_array().expect("the objects");
        let Some(mut other) = objects.iter().find(|object| object["material"] == json!(material)).cloned() else {
            continue;
        };
        if smooth && rng.chance(0.5) {
            scene["materials"][&material] = json!({ "dielectric": { "ior": spectra::index(rng), "medium": name } });
        }
        let over = format!("over {name}");
        let priority = rng.below(3) as i32 - 1;
        scene["materials"][&over] = if smooth && rng.chance(0.5) {
            json!({ "dielectric": { "ior": spectra::index(rng), "priority": priority } })
        } else {
            let coefficient = rng.log_between(0.1, 2.0) / scale;
            scene["media"][&over] = json!({ "homogeneous": {
                "scattering": coefficient, "absorption": 0.3 * coefficient, "phase": "isotropic", "priority": priority
            } });
            json!({ "boundary": { "medium": over } })
        };
        other["material"] = json!(over);
        let shift = rng.direction().map(|x| 0.15 * scale * x);
        match other["transform"].as_array_mut() {
            Some(steps) => steps.push(json!({ "translate": shift })),
            None => other["transform"] = json!([{ "translate": shift }]),
        }
        other["motion"] = json!([]);
        scene["objects"].as_array_mut().expect("the objects").push(other);
    }
}

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
