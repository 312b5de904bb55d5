//! Converts the lights of glTF files: KHR_lights_punctual and EXT_lights_ies.

use super::node::{PlacedNode, steps};
use ::gltf::Document;
use ::gltf::khr_lights_punctual::{Kind, Light};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Converts a light: intensities in cd or illuminances in lx, which the colour scales.
pub(super) fn punctual_light(light: &Light, placed: &PlacedNode) -> Value {
    let (spectrum, luminance) = coloured(light.color().map(f64::from));
    let strength = f64::from(light.intensity()) * luminance;
    let (at, direction) = pose(placed);
    let (kind, mut form) = match light.kind() {
        Kind::Point => ("point", json!({"at": at, "spectrum": spectrum, "luminous_intensity": strength})),
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            let outer = f64::from(outer_cone_angle).clamp(1e-3, 0.5 * PI);
            let inner = f64::from(inner_cone_angle).clamp(0.0, outer);
            let to = (DVec3::from(at) + direction).to_array();
            let form = json!({
                "at": at, "to": to, "half_angle": outer.to_degrees(), "penumbra": (outer - inner).to_degrees(),
                "falloff": "square", "spectrum": spectrum, "luminous_intensity": strength
            });
            ("spot", form)
        }
        Kind::Directional => {
            let form = json!({"toward": direction.to_array(), "spectrum": spectrum, "illuminance": strength});
            ("directional", form)
        }
    };
    add_motion(&mut form, placed);
    json!({ kind: form })
}

/// Converts a light of EXT_lights_ies. Returns the name of its profile and the light, or why it is
/// left out. `folder` is the path from the scene file to the folder of the glTF file.
pub(super) fn ies_light<'d>(
    extension: &Value,
    document: &'d Document,
    folder: &str,
    placed: &PlacedNode,
) -> Result<(Option<&'d str>, Value), String> {
    let profiles = document.extension_value("EXT_lights_ies").and_then(|it| it["lights"].as_array());
    let number = extension["light"].as_u64().and_then(|number| usize::try_from(number).ok());
    let profile = profiles.zip(number).and_then(|(profiles, number)| profiles.get(number));
    let profile = profile.ok_or("its profile does not exist")?;
    let uri = profile["uri"].as_str().ok_or("its profile is inside the glTF file; write it to a file of its own")?;
    if uri.starts_with("data:") {
        return Err("its profile is inside the glTF file; write it to a file of its own".to_owned());
    }
    let path = abbe_format::mesh::decoded_address(uri).ok_or("the address of its profile is not valid")?;
    let multiplier = extension["multiplier"].as_f64().unwrap_or(1.0);
    let colour: Vec<f64> = extension["color"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    let colour = <[f64; 3]>::try_from(colour).unwrap_or([1.0; 3]);
    let (spectrum, luminance) = coloured(colour);
    if (multiplier * luminance - 1.0).abs() > 1e-6 {
        return Err(format!(
            "its intensity is {} times that of the profile; add the light `ies` with its luminous flux by an overlay",
            multiplier * luminance
        ));
    }
    let (at, direction) = pose(placed);
    let mut form = json!({
        "at": at, "toward": direction.to_array(), "path": format!("{folder}{path}"), "spectrum": spectrum
    });
    add_motion(&mut form, placed);
    Ok((profile["name"].as_str(), json!({ "ies": form })))
}

/// Returns the spectrum of a linear sRGB colour, and the luminance of the colour relative to white.
fn coloured(colour: [f64; 3]) -> (Value, f64) {
    let [r, g, b] = colour.map(|c| c.max(0.0));
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    (if luminance > 0.0 { json!({"rgb": [r, g, b]}) } else { json!("D65") }, luminance)
}

/// Returns the position of a light and the direction of its axis. If the light moves, both are
/// those before the keyframes. A glTF light shines along −z of its node.
fn pose(placed: &PlacedNode) -> ([f64; 3], DVec3) {
    let own = &placed.own;
    (own.translation.to_array(), own.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z))
}

/// Adds the keyframes of a node without their scale, which does not affect a light.
fn add_motion(form: &mut Value, placed: &PlacedNode) {
    if placed.motion.is_empty() {
        return;
    }
    let keyframe = |(time, at): &(f64, DAffine3)| {
        let (_, rotation, _) = at.to_scale_rotation_translation();
        json!({"time": time, "transform": steps(&DAffine3::from_rotation_translation(rotation, at.translation))})
    };
    form["motion"] = placed.motion.iter().map(keyframe).collect();
}
