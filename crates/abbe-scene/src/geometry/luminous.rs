//! The places and the directions of luminous objects.

use glam::DVec3;

use super::hit::SurfaceId;
use super::object::ObjectSurface;
use super::primitive::Primitive;
use super::shape::Solid;
use super::world::Geometry;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuminousFace {
    /// The lowest corner of a box around the triangle in m, relative to the scene's centre.
    pub low: DVec3,
    pub high: DVec3,
    pub normal: DVec3,
    /// The middle of the random numbers with which [`Geometry::sample_area`] and
    /// [`Geometry::sample_solid_angle`] select this triangle.
    pub selecting: f64,
    /// The probability of this selection: the triangle's fraction of the object's area.
    pub probability: f64,
}

impl Geometry {
    /// Returns the corners of an axis-aligned box around an object, or `None` if it has no surface.
    pub fn bounds_of(&self, object: u32) -> Option<(DVec3, DVec3)> {
        let ObjectSurface { faces, instances, .. } = self.objects.get(object)?;
        let boxes = faces.iter().map(|face| self.bounds_of_primitive(face.surface));
        boxes
            .chain(instances.iter().map(|&instance| self.primitives.instances.bounds(instance)))
            .reduce(|(low, high), (from, to)| (low.min(from), high.max(to)))
    }

    fn bounds_of_primitive(&self, surface: SurfaceId) -> (DVec3, DVec3) {
        self.primitives.bounds(&self.primitives.list[surface.primitive as usize])
    }

    /// Returns the normal of a rectangle or a disk, and `None` for all other objects.
    pub fn normal_of_flat(&self, object: u32) -> Option<DVec3> {
        let [face] = self.objects.get(object)?.faces.as_slice() else { return None };
        let Primitive::Analytic(index) = self.primitives.list[face.surface.primitive as usize] else { return None };
        let analytic = &self.primitives.analytic[index as usize];
        let is_flat = matches!(analytic.solid, Solid::Flat(_));
        is_flat.then(|| self.primitives.normal(face.surface, analytic.position))
    }

    /// Returns the number of triangles of a mesh, and 0 for other shapes.
    pub fn triangle_count(&self, object: u32) -> usize {
        let faces = self.objects.get(object).map_or(&[][..], |object| &object.faces);
        let is_mesh = faces.first().is_some_and(|face| self.is_triangle(face.surface));
        if is_mesh { faces.len() } else { 0 }
    }

    fn is_triangle(&self, surface: SurfaceId) -> bool {
        matches!(self.primitives.list[surface.primitive as usize], Primitive::Triangle(_))
    }

    /// Iterates over the triangles of a mesh. Other shapes have none.
    pub fn luminous_faces(&self, object: u32) -> impl Iterator<Item = LuminousFace> + '_ {
        let surface = self.objects.get(object).filter(|_| self.triangle_count(object) > 0);
        surface
            .into_iter()
            .flat_map(move |surface| (0..surface.faces.len()).map(move |number| self.luminous_face(surface, number)))
    }

    fn luminous_face(&self, object: &ObjectSurface, number: usize) -> LuminousFace {
        let face = object.faces[number];
        let below = if number == 0 { 0.0 } else { object.faces[number - 1].area_so_far };
        let (low, high) = self.bounds_of_primitive(face.surface);
        LuminousFace {
            low,
            high,
            normal: self.primitives.normal(face.surface, low),
            selecting: 0.5 * (below + face.area_so_far) / object.area,
            probability: (face.area_so_far - below) / object.area,
        }
    }

    /// Returns the position of a surface in [`Self::luminous_faces`].
    pub fn number_of_face(&self, object: u32, surface: SurfaceId) -> Option<usize> {
        // The faces are in the order of their primitives.
        let faces = &self.objects.get(object)?.faces;
        faces.binary_search_by_key(&surface.primitive, |face| face.surface.primitive).ok()
    }
}
