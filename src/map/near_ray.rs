//! The spatial index along rays: which boxes does a narrow cone around a ray touch?
//!
//! A binary tree of boxes (parallel locally-ordered clustering); the boxes are widened by the cone's radius only when they are tested, so that every
//! pixel may look with a cone of its own.

use crate::scene::geometry::Ray;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// A piece of a ray with a radius that may grow along it.
#[derive(Debug, Clone, Copy)]
pub struct Cone {
    /// The ray.
    pub ray: Ray,
    /// How far it goes, in m.
    pub length_m: f64,
    /// The radius at its origin, in m.
    pub radius_m: f64,
    /// How much it grows per distance.
    pub slope: f64,
}

/// How wide the kernels along a camera path are.
#[derive(Debug, Clone, Copy)]
pub enum Width {
    /// The same everywhere: this radius in m.
    Stated(f64),
    /// This radius per distance from the camera.
    PerDistance(f64),
}

impl Cone {
    /// The first `length_m` of a ray of a camera path, whose start is `behind_m` (along the path) behind the ray's origin.
    pub fn of_camera(ray: Ray, length_m: f64, behind_m: f64, width: Width) -> Self {
        let (radius_m, slope) = match width {
            Width::Stated(radius_m) => (radius_m, 0.0),
            Width::PerDistance(slope) => (slope * behind_m, slope),
        };
        Self { ray, length_m, radius_m, slope }
    }

    /// The radius at a distance along the ray, in m.
    pub fn radius_at(&self, t: f64) -> f64 {
        self.radius_m + self.slope * t
    }
}

/// Boxes by place.
#[derive(Default)]
pub(super) struct NearRay {
    tree: Option<Bvh2>,
}

impl std::fmt::Debug for NearRay {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let boxes = self.tree.as_ref().map_or(0, |tree| tree.primitive_indices.len());
        f.debug_struct("NearRay").field("boxes", &boxes).finish()
    }
}

/// Boxes of one node that are still to be opened, deep enough for any tree of 2³² boxes that clustering makes.
const STACK: usize = 192;

impl NearRay {
    /// Builds the index over boxes (least and largest coordinates in m, relative to the scene's centre); box number i is `boxes[i]`.
    pub(super) fn build(boxes: &[(Vec3, Vec3)]) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        let boxes: Vec<Aabb> = boxes.iter().map(|&(low, high)| Aabb::new(low.into(), high.into())).collect();
        let indices = (0..boxes.len() as u32).collect();
        let search = PlocSearchDistance::Low;
        let tree = PlocBuilder::with_capacity(boxes.len()).build(search, &boxes, indices, SortPrecision::U64, 0);
        Self { tree: Some(tree) }
    }

    /// Calls `visit` with the number of every box that the cone may touch.
    #[inline]
    pub(super) fn visit(&self, cone: &Cone, mut visit: impl FnMut(u32)) {
        let Some(tree) = &self.tree else { return };
        let slabs = Slabs::new(cone);
        let mut open = [0_u32; STACK];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let node = &tree.nodes[open[count] as usize];
            if !slabs.touch(&node.aabb) {
                continue;
            }
            if node.prim_count > 0 {
                let first = node.first_index as usize;
                tree.primitive_indices[first..first + node.prim_count as usize].iter().for_each(|&i| visit(i));
            } else if count + 2 <= STACK {
                open[count] = node.first_index;
                open[count + 1] = node.first_index + 1;
                count += 2;
            }
        }
    }
}

/// The cone in single precision, ready to be tested against boxes.
struct Slabs {
    origin: Vec3A,
    inverse: Vec3A,
    length: f32,
    radius: f32,
    slope: f32,
}

impl Slabs {
    fn new(cone: &Cone) -> Self {
        let tiny = |x: f64| if x.abs() < 1e-12 { 1e-12_f64.copysign(x) } else { x };
        let direction = cone.ray.direction;
        let inverse = DVec3::new(tiny(direction.x), tiny(direction.y), tiny(direction.z)).recip();
        Self {
            origin: cone.ray.origin.as_vec3a(),
            inverse: inverse.as_vec3a(),
            length: cone.length_m as f32,
            radius: cone.radius_m as f32,
            slope: cone.slope as f32,
        }
    }

    /// Whether the cone may touch the box; wide by rounding, never narrow.
    #[inline]
    fn touch(&self, aabb: &Aabb) -> bool {
        let (centre, half) = (0.5 * (aabb.min + aabb.max), 0.5 * (aabb.max - aabb.min));
        let offset = centre - self.origin;
        let far = self.length.min(offset.length() + half.length());
        let rounding = 4.0 * f32::EPSILON * (offset.abs() + half).max_element();
        let wide = half + Vec3A::splat(1.01 * (self.radius + self.slope * far) + rounding);
        let (a, b) = ((offset - wide) * self.inverse, (offset + wide) * self.inverse);
        let enter = a.min(b).max_element().max(0.0);
        let exit = a.max(b).min_element().min(self.length * (1.0 + 1e-6));
        enter <= exit * (1.0 + 1e-6) + f32::MIN_POSITIVE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{Purpose, Stream};
    use crate::math::warp;

    #[test]
    fn every_box_that_a_cone_touches_is_found() {
        let mut stream = Stream::new(3, Purpose::Pilot, 0, 0);
        let mut point = || DVec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 0.5;
        let places: Vec<DVec3> = (0..3000).map(|_| point()).collect();
        let boxes: Vec<(Vec3, Vec3)> = places.iter().map(|p| (p.as_vec3(), p.as_vec3())).collect();
        let index = NearRay::build(&boxes);
        let mut stream = Stream::new(4, Purpose::Pilot, 0, 0);
        let mut found_any = 0;
        for i in 0..200 {
            let direction = if i % 4 == 0 { DVec3::X } else { warp::sphere(stream.pair()) };
            let cone =
                Cone { ray: Ray::new(point_of(&mut stream), direction), length_m: 0.8, radius_m: 0.02, slope: 0.02 };
            let mut found = Vec::new();
            index.visit(&cone, |i| found.push(i as usize));
            for (i, place) in places.iter().enumerate() {
                let offset = *place - cone.ray.origin;
                let t = offset.dot(direction);
                let near = (offset - t * direction).length() <= cone.radius_at(t);
                if near && t > 0.0 && t < cone.length_m {
                    found_any += 1;
                    assert!(found.contains(&i), "{place}");
                }
            }
        }
        assert!(found_any > 200);
    }

    fn point_of(stream: &mut Stream) -> DVec3 {
        DVec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 0.5
    }
}
