//! The facts about objects that place the meters: names, middles and the size of the scene.

use crate::builder::SceneBuilder;
use glam::DVec3;

impl SceneBuilder {
    pub fn object_names(&self) -> impl Iterator<Item = &str> {
        self.objects.objects.iter().map(|object| object.name.as_str())
    }

    /// The middle of the bounding box of an object in the world, in m, or the scene's centre if it
    /// has no surface.
    pub fn middle_of(&self, object: u32) -> DVec3 {
        let around = self.geometry.object_bounds().get(&object).copied();
        self.centre + around.map_or(DVec3::ZERO, |(low, high)| 0.5 * (low + high))
    }

    /// The radius in m of a sphere around the scene's centre that contains all surfaces.
    pub fn extent_m(&self) -> f64 {
        self.geometry.radius_m()
    }
}
