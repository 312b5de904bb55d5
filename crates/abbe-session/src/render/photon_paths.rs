//! Photon paths of a job, as lines over its picture.

use super::job::Job;
use abbe_optics::bsdf::BsdfClass;
use abbe_scene::Scene;
use abbe_scene::camera::Camera;
use abbe_scene::geometry::{Ray, SurfaceId};
use abbe_transport::pass::{PassContext, StageSeconds};
use abbe_transport::photon_paths::{PathQuery, PhotonPaths, photon_paths};
use abbe_transport::pilot::find_portals;
use glam::{DVec2, DVec3};

/// The lengths of visible parts are found to this number of pixels.
const PIXELS_PER_STEP: f64 = 3.0;

const STEPS: (f64, f64) = (4.0, 96.0);

/// Surfaces hide points that are farther from the camera by more than this fraction of the
/// distance.
const HIDDEN_FRACTION: f64 = 1e-4;

/// A surface that the camera sees.
#[derive(Debug, Clone, Copy)]
pub struct PointUnder {
    /// The index of the object.
    pub object: usize,
    /// The position in m, relative to the centre of the scene.
    pub position: DVec3,
    /// The width of a pixel in m at this distance.
    pub pixel_width_m: f64,
}

impl Job {
    /// Traces photons and records their paths on the current thread pool.
    pub fn photon_paths(&self, query: &PathQuery) -> PhotonPaths {
        let context = self.pass_context();
        let portals = find_portals(&context, &mut StageSeconds::default());
        photon_paths(&PassContext { portals: &portals, ..context }, query)
    }

    /// Returns the first surface under a film position in pixels.
    pub fn point_under(&self, film: DVec2) -> Option<PointUnder> {
        let camera = &self.scene.camera;
        let ray = camera.ray(film, [0.5; 2]);
        let hit = self.scene.geometry.intersect(&ray, None, f64::INFINITY)?;
        let pixel_width_m = camera.pixel_width_m(hit.t);
        Some(PointUnder { object: hit.object as usize, position: hit.position, pixel_width_m })
    }

    /// Returns the parts of a segment that the camera sees, as film positions in pixels. Glass
    /// neither hides points behind it, nor moves them.
    pub fn visible_parts(&self, from: DVec3, to: DVec3) -> Vec<[DVec2; 2]> {
        let camera = &self.scene.camera;
        let size = DVec2::new(camera.width() as f64, (camera.pixel_count() / camera.width()) as f64);
        let Some([from, to]) = in_front(camera, from, to) else { return Vec::new() };
        let ends = [from, to].map(|point| camera.project(point));
        let [Some(first), Some(last)] = ends else { return Vec::new() };
        let outside = first.max(last).cmplt(DVec2::ZERO).any() || first.min(last).cmpgt(size).any();
        if outside || !first.is_finite() || !last.is_finite() {
            return Vec::new();
        }
        let steps = (first.distance(last) / PIXELS_PER_STEP).clamp(STEPS.0, STEPS.1) as usize;
        let (mut parts, mut begin): (Vec<[DVec2; 2]>, Option<DVec2>) = (Vec::new(), None);
        let at = |step: f64| from.lerp(to, step / steps as f64);
        let mut end = first;
        for step in 0..steps {
            let next = camera.project(at(step as f64 + 1.0)).unwrap_or(end);
            let middle = at(step as f64 + 0.5);
            if is_visible(&self.scene, camera.viewpoint_of(middle), middle) {
                begin = begin.or(Some(end));
            } else if let Some(begin) = begin.take() {
                parts.push([begin, end]);
            }
            end = next;
        }
        parts.extend(begin.map(|begin| [begin, end]));
        parts
    }
}

/// Returns the part of a segment in front of the camera, a little before the lens plane.
fn in_front(camera: &Camera, from: DVec3, to: DVec3) -> Option<[DVec3; 2]> {
    let is_seen = |point: DVec3| camera.project(point).is_some();
    let last_seen = |seen: DVec3, unseen: DVec3| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if is_seen(seen.lerp(unseen, middle)) { low = middle } else { high = middle }
        }
        seen.lerp(unseen, 0.999 * low)
    };
    match (is_seen(from), is_seen(to)) {
        (true, true) => Some([from, to]),
        (true, false) => Some([from, last_seen(from, to)]),
        (false, true) => Some([last_seen(to, from), to]),
        (false, false) => None,
    }
}

/// Returns whether no opaque surface lies between the camera and a point.
fn is_visible(scene: &Scene, camera: DVec3, point: DVec3) -> bool {
    /// A line of sight through more surfaces counts as hidden.
    const MOST_SURFACES: usize = 64;
    let distance = camera.distance(point);
    let direction = (point - camera) / distance;
    let mut ray = Ray { origin: camera, direction };
    let mut from: Option<SurfaceId> = None;
    for _ in 0..MOST_SURFACES {
        let left = camera.distance(point) - camera.distance(ray.origin) - HIDDEN_FRACTION * distance;
        let Some(hit) = scene.geometry.intersect(&ray, from, left) else { return true };
        let surface = &scene.material_of(hit.object).surface;
        if !(surface.is_transmissive() && surface.class() < BsdfClass::Diffuse) {
            return false;
        }
        (ray.origin, from) = (hit.position, Some(hit.surface));
    }
    false
}
