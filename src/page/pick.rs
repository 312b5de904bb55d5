//! The object under a pixel, which the reader can then move.

use super::loaded_scene::LoadedScene;
use glam::DVec2;
use serde::Deserialize;
use serde_json::{Value, json};

/// A pixel of the picture.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PickQuery {
    x: u32,
    y: u32,
}

/// Returns the object under a pixel as JSON: its index and name, the visible point in m, and the
/// width of a pixel there in m. The value is `null` where there is no surface. Returns `None` for a
/// wrong query.
pub(crate) fn pick(loaded: &LoadedScene, PickQuery { x, y }: PickQuery) -> Option<Value> {
    let scene = &loaded.job.scene;
    if x >= scene.film.width || y >= scene.film.height {
        return None;
    }
    let Some(under) = loaded.job.point_under(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)) else {
        return Some(Value::Null);
    };
    Some(json!({
        "object": under.object,
        "name": scene.objects[under.object].name,
        "point_m": (under.position + scene.centre).to_array(),
        "pixel_width_m": under.pixel_width_m,
    }))
}
