//! Queries: bounding boxes, the distance to the nearest surface, flat objects, convex bodies.

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

    /// Iterates over the convex bodies, each with a test whether it contains an axis-aligned box.
    pub fn convex_bodies(&self) -> impl Iterator<Item = (u32, impl Fn((DVec3, DVec3)) -> bool + '_)> {
        let convex = self.primitives.analytic.iter().filter(|analytic| match analytic.solid {
            Solid::Sphere(_) | Solid::Polyhedron(_) | Solid::Cylinder(_) => true,
            Solid::Flat(_) | Solid::Lens(_) => false,
        });
        convex.map(|analytic| (analytic.object, move |around| analytic.contains_box(around)))
    }
}

impl PlacedSolid {
    /// Returns true if the convex body contains all corners of a box, and therefore the box.
    fn contains_box(&self, (low, high): (DVec3, DVec3)) -> bool {
        let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
        (0..8).all(|i| self.solid.contains(self.to_local * (corner(i) - self.position)))
    }
}
