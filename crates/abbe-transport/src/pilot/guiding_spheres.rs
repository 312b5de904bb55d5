//! The guiding spheres: spheres around the parts of a scene that need many photons.

use abbe_optics::bsdf::{Bsdf, BsdfClass};
use abbe_scene::Scene;
use abbe_scene::sweep::Bounds;
use abbe_spectra::math::sort::sort_by_number;
use abbe_spectra::math::sphere::BoundingSphere;
use std::borrow::Cow;
use std::iter;

/// The largest number of spheres around objects. More objects share them with their neighbours.
const MAX_INNER_SPHERES: usize = 16;

/// The largest number of spheres around these spheres.
const MAX_OUTER_SPHERES: usize = 24;

/// The ratio of the radii of successive spheres around a guiding sphere.
const OUTER_RATIO: f64 = 4.0;

/// The spheres through which lights aim photons, each list with the smallest sphere first.
pub(super) struct GuidingSpheres {
    /// Around the objects that can focus light or are filled with a medium, around the portals, and
    /// around most of the visible points. Lights use only spheres that receive a small fraction of
    /// their power.
    pub(super) inner: Vec<BoundingSphere>,
    /// Larger spheres around these, up to the scene, shared by neighbours.
    ///
    /// Surfaces around the view and around a body of fog scatter light into it. In a large world,
    /// most photons arrive far away, and few of them are scattered there. A photon of a small
    /// sphere is lighter than one of the whole world by many orders of magnitude, so the few heavy
    /// photons would dominate the noise. With these spheres as further strata, the power of a
    /// photon increases in steps with the distance.
    pub(super) outer: Vec<BoundingSphere>,
}

impl GuidingSpheres {
    /// Returns the spheres of a scene. `scenes` contains the scene at several shutter times.
    pub(super) fn new(scenes: &[Cow<'_, Scene>], portals: &[BoundingSphere]) -> Self {
        let mut boxes: Vec<Option<Bounds>> = Vec::new();
        for scene in scenes {
            boxes.resize(scene.objects.len(), None);
            let all = [&scene.geometry, &scene.boundaries].map(|geometry| geometry.object_bounds());
            for (object, bounds) in all.into_iter().flatten().filter(|(object, _)| needs_photons(scene, *object)) {
                let around = &mut boxes[object as usize];
                *around = Some(around.map_or(bounds, |around| union(around, bounds)));
            }
        }
        let mut boxes: Vec<Bounds> = boxes.into_iter().flatten().collect();
        let mut inner = Vec::new();
        cluster(&mut boxes, MAX_INNER_SPHERES, &mut inner);
        inner.extend(portals);
        inner.extend(scenes.first().and_then(|scene| scene.visible_sphere()));
        inner.retain(|inner_sphere| inner_sphere.radius_m.is_finite() && inner_sphere.radius_m > 0.0);
        sort_by_number(&mut inner, |inner_sphere| inner_sphere.radius_m);
        let world_m = scenes.first().map_or(0.0, |scene| scene.radius_m);
        let outer = outer(&inner, world_m);
        Self { inner, outer }
    }
}

fn outer(inner: &[BoundingSphere], world_m: f64) -> Vec<BoundingSphere> {
    let mut spheres = Vec::new();
    for inner_sphere in inner {
        let larger = |sphere: &BoundingSphere| Some(sphere.times(OUTER_RATIO));
        for sphere in iter::successors(larger(inner_sphere), larger).take_while(|sphere| sphere.radius_m < world_m) {
            let replaces = |other: &BoundingSphere| {
                let ratio = other.radius_m / sphere.radius_m;
                ratio * ratio <= OUTER_RATIO && ratio * ratio * OUTER_RATIO >= 1.0 && other.contains(inner_sphere)
            };
            if !inner.iter().chain(&spheres).any(replaces) {
                spheres.push(sphere);
            }
        }
    }
    sort_by_number(&mut spheres, |sphere| sphere.radius_m);
    spheres.truncate(MAX_OUTER_SPHERES);
    spheres
}

fn needs_photons(scene: &Scene, object: u32) -> bool {
    let material = scene.material_of(object);
    let focuses = |class| matches!(class, BsdfClass::Specular | BsdfClass::Glossy);
    material.surface.components().map(Bsdf::class).any(focuses)
        || material.body.as_ref().is_some_and(|b| b.medium.is_some())
}

/// Divides boxes into at most `most` groups of neighbours, and adds a sphere around each group.
fn cluster(boxes: &mut [Bounds], most: usize, inner: &mut Vec<BoundingSphere>) {
    let Some(around) = boxes.iter().copied().reduce(union) else { return };
    if boxes.len() == 1 || most <= 1 {
        inner.push(BoundingSphere::around_box(around.0, around.1));
        return;
    }
    let axis = (around.1 - around.0).max_position();
    sort_by_number(boxes, |(low, high)| (*low + *high)[axis]);
    let (low, high) = boxes.split_at_mut(boxes.len() / 2);
    cluster(low, most / 2, inner);
    cluster(high, most - most / 2, inner);
}

fn union((low, high): Bounds, (from, to): Bounds) -> Bounds {
    (low.min(from), high.max(to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn inner_spheres_cover_all_objects() {
        let at = |i: u32| DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)) * 100.0;
        let boxes: Vec<Bounds> = (0..1000).map(|i| (at(i), at(i) + 1.0)).collect();
        for count in [1, 5, 16, 17, 1000] {
            let mut inner = Vec::new();
            cluster(&mut boxes[..count].to_vec(), MAX_INNER_SPHERES, &mut inner);
            assert_eq!(inner.len(), count.min(MAX_INNER_SPHERES));
            let holds = |inner_sphere: &BoundingSphere, point: DVec3| {
                inner_sphere.centre.distance(point) <= inner_sphere.radius_m * 1.001
            };
            let covered = |(low, high): &Bounds| {
                inner.iter().any(|inner_sphere| holds(inner_sphere, *low) && holds(inner_sphere, *high))
            };
            assert!(boxes[..count].iter().all(covered));
        }
    }

    /// A small sphere in a large world has outer spheres in steps of the ratio. A second one beside
    /// it shares them, and a distant one has its own until they contain both.
    #[test]
    fn neighbouring_inner_spheres_share_outer_spheres() {
        let sphere = |x: f64| BoundingSphere { centre: DVec3::new(x, 0.0, 0.0), radius_m: 1.0 };
        let radii = |inner: &[BoundingSphere]| -> Vec<f64> {
            outer(inner, 1000.0).iter().map(|sphere| sphere.radius_m).collect()
        };
        assert_eq!(radii(&[sphere(0.0)]), [4.0, 16.0, 64.0, 256.0]);
        assert_eq!(radii(&[sphere(0.0), sphere(2.5)]), [4.0, 16.0, 64.0, 256.0]);
        assert_eq!(radii(&[sphere(0.0), sphere(40.0)]), [4.0, 4.0, 16.0, 16.0, 64.0, 256.0]);
    }
}
