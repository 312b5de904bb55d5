//! Queries: bounding boxes, the distance to the nearest surface, flat objects, convex bodies.

use super::build::is_similarity;
use super::primitive::{PlacedSolid, Primitive};
use super::shape::Solid;
use super::world::Geometry;
use glam::DVec3;
use std::collections::BTreeMap;

impl Geometry {
    /// Returns the axis-aligned bounding boxes (smallest and largest coordinates in m, relative to
    /// the centre) of all objects that have surfaces in this geometry, by object number.
    pub fn object_bounds(&self) -> BTreeMap<u32, (DVec3, DVec3)> {
        let mut boxes = BTreeMap::new();
        for primitive in &self.primitives.list {
            let object = match primitive {
                Primitive::Analytic(index) => self.primitives.analytic[*index as usize].object,
                Primitive::Triangle(triangle) => self.primitives.meshes[triangle.mesh as usize].object,
                Primitive::Instance(index) => self.primitives.instances.list[*index as usize].object,
            };
            let (low, high) = self.primitives.bounds(primitive);
            let around = boxes.entry(object).or_insert((low, high));
            *around = (around.0.min(low), around.1.max(high));
        }
        boxes
    }

    /// Returns a lower bound of the distance in m from a point to the nearest surface.
    pub fn clearance_m(&self, point: DVec3) -> f64 {
        let boxes = self.primitives.list.iter().map(|primitive| self.primitives.bounds(primitive));
        boxes.map(|(low, high)| (low - point).max(point - high).max(DVec3::ZERO).length()).fold(f64::INFINITY, f64::min)
    }

    /// Iterates over the rectangles and disks.
    pub fn flat_objects(&self) -> impl Iterator<Item = u32> + '_ {
        let flat = self.primitives.analytic.iter().filter(|analytic| matches!(analytic.solid, Solid::Flat(_)));
        flat.map(|analytic| analytic.object)
    }

    /// Iterates over the convex bodies.
    pub fn convex_bodies(&self) -> impl Iterator<Item = ConvexBody<'_>> {
        let convex = self.primitives.analytic.iter().filter(|analytic| match analytic.solid {
            Solid::Sphere(_) | Solid::Polyhedron(_) | Solid::Cylinder(_) => true,
            Solid::Flat(_) | Solid::Lens(_) => false,
        });
        convex.map(|analytic| ConvexBody { object: analytic.object, analytic })
    }
}

/// A convex body of a geometry.
#[derive(Debug, Clone, Copy)]
pub struct ConvexBody<'a> {
    pub object: u32,
    analytic: &'a PlacedSolid,
}

impl ConvexBody<'_> {
    /// Returns true if the body contains all corners of a box, and therefore the box.
    pub fn contains_box(&self, (low, high): (DVec3, DVec3)) -> bool {
        let analytic = self.analytic;
        let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
        (0..8).all(|i| analytic.solid.contains(analytic.to_local * (corner(i) - analytic.position)))
    }

    /// Returns an upper bound of the distance in m between two points of the body.
    pub fn diameter_m(&self) -> f64 {
        let PlacedSolid { solid, to_world, .. } = self.analytic;
        match solid.sphere_radius().filter(|_| is_similarity(to_world)) {
            Some(radius) => 2.0 * radius * to_world.x_axis.length() * (1.0 + 1e-9),
            None => {
                let (low, high) = solid.bounds(to_world);
                (high - low).length()
            }
        }
    }
}
