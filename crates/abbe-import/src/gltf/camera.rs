//! Converts the cameras of glTF files.

use super::node::{PlacedNode, subdivided};
use ::gltf::camera::Projection;
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

/// The ratio of width to height if the file states none.
pub(super) const DEFAULT_ASPECT: f64 = 1.5;

/// The vertical field of view (degrees) of the camera if the file has none.
const DEFAULT_FOV: f64 = 35.0;

/// Returns a camera of the scene file, and the ratio of the film's width to its height. Returns
/// `None` for an orthographic camera without extent.
pub(super) fn file_camera(projection: &Projection, placed: &PlacedNode) -> Option<(Value, f64)> {
    let (lens, aspect) = match projection {
        Projection::Perspective(lens) => {
            let aspect = lens.aspect_ratio().map_or(DEFAULT_ASPECT, f64::from);
            (json!({"pinhole": {"fov": f64::from(lens.yfov()).to_degrees()}}), aspect)
        }
        Projection::Orthographic(lens) => {
            let [width, height] = [lens.xmag(), lens.ymag()].map(|half| 2.0 * f64::from(half).abs());
            if !(width > 0.0 && height > 0.0) {
                return None;
            }
            (json!({"orthographic": {"height": height}}), width / height)
        }
    };
    let aspect = aspect.clamp(0.05, 20.0);
    let mut camera = pose(&placed.at_start());
    camera["lens"] = lens;
    if !placed.motion.is_empty() {
        let keyframe = |(time, at): &(f64, DAffine3)| {
            let mut pose = pose(&(*at * placed.own));
            pose["time"] = json!(time);
            pose
        };
        camera["motion"] = subdivided(&placed.motion).iter().map(keyframe).collect();
    }
    Some((camera, aspect))
}

/// Returns the pose of a camera, which looks along −z of its node in glTF, with +y up.
fn pose(to_world: &DAffine3) -> Value {
    let from = to_world.translation;
    let direction = |local: DVec3| to_world.transform_vector3(local).normalize_or(local);
    let at = from + direction(DVec3::NEG_Z);
    json!({"from": from.to_array(), "at": at.to_array(), "up": direction(DVec3::Y).to_array()})
}

/// Returns the direction of light from above (+y), over the left shoulder of the camera.
pub(super) fn light_from_behind(camera: &Value) -> DVec3 {
    let point = |key: &str| DVec3::from_array(std::array::from_fn(|i| camera[key][i].as_f64().unwrap_or(0.0)));
    let view = point("at") - point("from");
    let ahead = DVec3::new(view.x, 0.0, view.z).try_normalize().unwrap_or(DVec3::NEG_Z);
    let right = ahead.cross(DVec3::Y);
    (ahead + right - 1.4 * DVec3::Y).normalize()
}

/// Returns a camera that sees a box, from the front and slightly from above.
pub(super) fn whole_view((low, high): (DVec3, DVec3)) -> Value {
    let is_box = low.cmple(high).all() && low.is_finite() && high.is_finite();
    let (low, high) = if is_box { (low, high) } else { (DVec3::NEG_ONE, DVec3::ONE) };
    let (centre, radius) = (0.5 * (low + high), 0.5 * (high - low).length().max(f64::MIN_POSITIVE));
    let distance = 1.1 * radius / abbe_spectra::math::elementary::sin(0.5 * DEFAULT_FOV.to_radians());
    let from = centre + distance * DVec3::new(0.4, 0.35, 1.0).normalize();
    json!({ "from": from.to_array(), "at": centre.to_array(), "lens": { "pinhole": { "fov": DEFAULT_FOV } } })
}
