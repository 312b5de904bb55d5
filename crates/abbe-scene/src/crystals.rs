//! Crystals: their axes in the world, and what they may contain.

use super::builder::{ObjectSet, Placement, SceneError, ScenePart};
use super::{Material, Scene};
use crate::geometry::Ray;
use crate::geometry::shape::Shape;
use abbe_optics::bsdf::Bsdf;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::sobol::Sobol;

impl ObjectSet {
    /// Returns the number of the material with its optic axis, if it is a crystal, in the frame of
    /// the world instead of the object.
    pub(super) fn turned_crystal(&mut self, number: usize, shape: &Shape, placement: &Placement) -> Result<usize> {
        let Some(material) = self.materials.get(number) else { return Ok(number) };
        let Some(crystal) = material.surface.crystal() else { return Ok(number) };
        if placement.motion.is_some() {
            return Err(Error::input("the object moves and is a crystal").expected("a crystal that does not move"));
        }
        if matches!(shape, Shape::Rectangle { .. } | Shape::Disk { .. }) {
            return Err(Error::input("found a flat shape of a crystal").expected("a shape that encloses a space"));
        }
        let axis = (placement.to_world.matrix3 * crystal.axis).normalize();
        let surface = Bsdf::crystal_surface(crystal.extraordinary.clone(), axis);
        let turned = Material { surface, ..material.clone() };
        Ok(self.add_material(turned))
    }
}

impl Scene {
    /// Returns an error if a surface lies inside a crystal, because only the faces of a crystal
    /// know its two waves. Rays through the crystals search for such surfaces, and may miss small
    /// ones.
    pub(super) fn check_crystals(&self) -> std::result::Result<(), SceneError> {
        let crystals = (0..self.objects.len() as u32)
            .filter(|&object| self.materials[self.objects[object as usize].material].surface.crystal().is_some());
        for crystal in crystals {
            if let Some(other) = self.surface_inside(crystal) {
                let [other, crystal] = [other, crystal].map(|object| &self.objects[object as usize].name);
                let error = Error::input(format!("the object \"{other}\" reaches into the crystal \"{crystal}\""));
                return Err(ScenePart::Objects.error(error.expected("crystals that contain no surfaces")));
            }
        }
        Ok(())
    }

    /// Returns an object whose surface a ray through the crystal meets.
    fn surface_inside(&self, crystal: u32) -> Option<u32> {
        const RAYS: u32 = 256;
        /// Surfaces this near to the faces of the crystal touch it, as a fraction of the scene's
        /// radius.
        const TOUCHING: f64 = 1e-9;
        let (sobol, margin) = (Sobol::new(7), TOUCHING * self.radius_m);
        (0..RAYS).find_map(|i| {
            let sample = self.geometry.sample_area(crystal, [0, 1, 2].map(|dimension| sobol.at(i, dimension)));
            let ray = Ray { origin: sample.position - margin * sample.normal, direction: -sample.normal };
            let hit = self.geometry.intersect(&ray, None, f64::INFINITY);
            let length_m = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
            let boundary = self.boundaries.intersect(&ray, None, length_m - margin);
            let inner =
                hit.filter(|hit| hit.object != crystal && self.medium_stack_at(ray.at(0.5 * hit.t)).contains(crystal));
            boundary.or(inner).map(|hit| hit.object)
        })
    }
}
