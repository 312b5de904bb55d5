//! Which objects are flat, boxes around objects, and which of them lie wholly inside a convex body.

use super::Geometry;
use super::primitive::{Analytic, Primitive};
use crate::scene::shape::Solid;
use glam::DVec3;
use std::collections::BTreeMap;

impl Geometry {
    /// The least box along the axes around each object that has surfaces here, by object number: least and largest coordinates
    /// relative to the centre, in m.
    pub fn object_boxes(&self) -> BTreeMap<u32, (DVec3, DVec3)> {
        let mut boxes = BTreeMap::new();
        for primitive in &self.primitives.list {
            let object = match primitive {
                Primitive::Analytic(index) => self.primitives.analytic[*index as usize].object,
                Primitive::Triangle(triangle) => self.primitives.meshes[triangle.mesh as usize].object,
            };
            let (low, high) = self.primitives.bounds(primitive);
            let around = boxes.entry(object).or_insert((low, high));
            *around = (around.0.min(low), around.1.max(high));
        }
        boxes
    }

    /// A distance in m that every surface keeps from a point, at least.
    pub fn clearance_m(&self, point: DVec3) -> f64 {
        let boxes = self.primitives.list.iter().map(|primitive| self.primitives.bounds(primitive));
        boxes.map(|(low, high)| (low - point).max(point - high).max(DVec3::ZERO).length()).fold(f64::INFINITY, f64::min)
    }

    /// The objects that are flat: rectangles and disks.
    pub fn flat_objects(&self) -> impl Iterator<Item = u32> + '_ {
        let flat = self.primitives.analytic.iter().filter(|analytic| matches!(analytic.solid, Solid::Sheet(_)));
        flat.map(|analytic| analytic.object)
    }

    /// The objects that are convex bodies, each with a test of whether it holds all of a box along the axes.
    pub fn convex_bodies(&self) -> impl Iterator<Item = (u32, impl Fn((DVec3, DVec3)) -> bool + '_)> {
        let convex = self.primitives.analytic.iter().filter(|analytic| match analytic.solid {
            Solid::Sphere(_) | Solid::Polyhedron(_) | Solid::Cylinder(_) => true,
            Solid::Sheet(_) | Solid::Lens(_) => false,
        });
        convex.map(|analytic| (analytic.object, move |around| analytic.holds_box(around)))
    }
}

impl Analytic {
    /// Whether all corners of a box along the axes lie inside the convex body, and so the whole box.
    fn holds_box(&self, (low, high): (DVec3, DVec3)) -> bool {
        let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
        (0..8).all(|i| self.solid.holds(self.to_local * (corner(i) - self.position)))
    }
}
