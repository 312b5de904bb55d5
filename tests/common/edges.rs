//! A mask of pixels that are close to an edge of a surface. Density estimates are biased there by
//! design, so comparisons leave these pixels out.

use abbe_scene::Scene;
use abbe_scene::geometry::{Hit, Ray};
use glam::{DVec2, DVec3};

/// Returns for each pixel whether the visible surface (at the pixel's corners and centre) continues
/// for `reach` metres in all directions without an object on it.
pub(crate) fn away_from_edges(scene: &Scene, reach: f64) -> Vec<bool> {
    let width = scene.camera.width();
    let places = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let pixel = |index: usize| {
        let corner = DVec2::new((index % width) as f64, (index / width) as f64);
        places.iter().all(|&place| {
            let ray = scene.camera.ray(corner + DVec2::from(place), [0.5; 2]);
            let hit = scene.geometry.intersect(&ray, None, f64::INFINITY);
            hit.is_some_and(|hit| goes_on(scene, &ray, &hit, reach))
        })
    };
    (0..scene.camera.pixel_count()).map(pixel).collect()
}

fn goes_on(scene: &Scene, ray: &Ray, hit: &Hit, reach: f64) -> bool {
    const AROUND: usize = 12;
    let geometry = &scene.geometry;
    let up = if ray.direction.dot(hit.normal) < 0.0 { hit.normal } else { -hit.normal };
    let right = up.any_orthonormal_vector();
    let ahead = up.cross(right);
    let lifted = hit.position + up * (0.25 * reach);
    (0..AROUND).all(|i| {
        let (sin, cos) = (i as f64 / AROUND as f64 * std::f64::consts::TAU).sin_cos();
        let way: DVec3 = right * cos + ahead * sin;
        let free = geometry.intersect(&Ray::new(lifted, way), None, reach).is_none();
        let down = Ray::new(lifted + way * reach, -up);
        free && geometry.intersect(&down, None, reach).is_some_and(|below| below.object == hit.object)
    })
}
