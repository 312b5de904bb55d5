//! Photon paths as coloured lines over the picture.

use super::loaded_scene::LoadedScene;
use abbe_session::render::{Job, PathQuery, PhotonPaths, PointUnder, RecordedSegment};
use abbe_spectra::math::sphere::BoundingSphere;
use glam::DVec2;
use serde::Deserialize;
use serde_json::{Value, json};

/// The largest number of drawn paths.
const MOST_PATHS: usize = 1000;

/// The search for paths to a point ends after this many photons.
const MOST_TRACED: u64 = 1 << 21;

/// Paths reach a point if they arrive within this number of pixel widths.
const RADIUS_PX: f64 = 4.0;

/// The paths that the page asks for.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PhotonQuery {
    /// The largest number of paths.
    count: usize,
    /// The number of the light. All lights if absent.
    light: Option<usize>,
    /// The column of a pixel. Only paths that reach the surface in the pixel are shown.
    x: Option<u32>,
    y: Option<u32>,
}

/// Returns the visible parts of photon paths as JSON, or `None` for a wrong query.
pub(crate) fn paths(loaded: &LoadedScene, scene: u64, query: PhotonQuery) -> Option<Value> {
    let PhotonQuery { count, light, x, y } = query;
    let job = &loaded.job;
    let film = &job.scene.film;
    let is_inside = |(x, y): (u32, u32)| x < film.width && y < film.height;
    if count > MOST_PATHS || light.is_some_and(|light| light >= job.scene.lights.len()) || x.is_some() != y.is_some() {
        return None;
    }
    let pixel = x.zip(y);
    if pixel.is_some_and(|pixel| !is_inside(pixel)) {
        return None;
    }
    let point = pixel.map(|(x, y)| job.point_under(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)));
    // A pixel without a surface has no paths.
    let found = match point {
        Some(None) => PhotonPaths::default(),
        Some(Some(PointUnder { position: centre, pixel_width_m, .. })) => {
            let target = Some(BoundingSphere { centre, radius_m: RADIUS_PX * pixel_width_m });
            job.photon_paths(&PathQuery { light, count, target, most_traced: MOST_TRACED })
        }
        None => job.photon_paths(&PathQuery { light, count, target: None, most_traced: MOST_TRACED }),
    };
    let mut lines: Vec<[f64; 7]> = Vec::new();
    for path in &found.paths {
        let mut from = path.origin;
        for segment in &path.segments {
            let [x, y, z] = colour(job, segment);
            let parts = job.visible_parts(from, segment.end);
            lines.extend(
                parts
                    .iter()
                    .map(|[a, b]| [a.x, a.y, b.x, b.y].map(hundredths))
                    .map(|[a, b, c, d]| [a, b, c, d, x, y, z]),
            );
            from = segment.end;
        }
    }
    let centre = job.scene.centre;
    let point = point.flatten().map(|point| (point.position + centre).to_array());
    Some(json!({
        "scene": scene,
        "paths": found.paths.len(),
        "traced": found.traced,
        "pixel": pixel,
        "point": point,
        "lines": lines,
    }))
}

/// Returns the XYZ of the light on a segment. The largest component is 1.
fn colour(job: &Job, segment: &RecordedSegment) -> [f64; 3] {
    let observer = job.scene.film.observer;
    let mut xyz = [0.0; 3];
    for (nm, power_w) in segment.wavelengths.active().iter().zip(segment.power_w) {
        let bar = observer.xyz_bar(*nm);
        (0..3).for_each(|c| xyz[c] += power_w * bar[c]);
    }
    let most = xyz.iter().fold(0.0_f64, |most, value| most.max(*value));
    if most > 0.0 { xyz.map(|value| (value / most * 1e4).round() / 1e4) } else { [0.0; 3] }
}

fn hundredths(position: f64) -> f64 {
    (position * 100.0).round() / 100.0
}
