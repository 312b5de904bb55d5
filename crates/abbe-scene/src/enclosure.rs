//! Finds objects enclosed in an opaque body, which no light reaches and no camera sees.

use super::Scene;
use glam::DVec3;
use std::collections::BTreeMap;

impl Scene {
    /// Maps the number of each enclosed object to the number of the enclosing object.
    ///
    /// An object is enclosed if it lies inside an opaque convex body that contains neither a light
    /// nor the camera nor a sensor. The result is empty if anything moves or a medium emits light.
    pub fn enclosures(&self) -> BTreeMap<u32, u32> {
        let mut enclosures = BTreeMap::new();
        let opaque = |object: u32| !self.material_of(object).surface.is_transmissive();
        let mut containers = self.geometry.convex_bodies().filter(|(object, _)| opaque(*object)).peekable();
        if containers.peek().is_none() || self.moves() {
            return enclosures;
        }
        let boxes = self.geometry.object_bounds();
        let Some(open) = self.boxes_of_camera_and_lights(&boxes) else {
            return enclosures;
        };
        for (container, holds) in containers {
            let Some(&(low, high)) = boxes.get(&container) else { continue };
            let clear = |&(from, to): &(DVec3, DVec3)| from.cmpgt(high).any() || to.cmplt(low).any();
            if open.iter().all(clear) {
                let within =
                    |(from, to): (DVec3, DVec3)| from.cmpge(low).all() && to.cmple(high).all() && holds((from, to));
                boxes.iter().filter(|(_, around)| within(**around)).for_each(|(&object, _)| {
                    enclosures.entry(object).or_insert(container);
                });
            }
        }
        enclosures
    }

    /// Boxes of the camera or sensor points, and of local lights; `None` if a light has none.
    fn boxes_of_camera_and_lights(&self, object_bounds: &BTreeMap<u32, (DVec3, DVec3)>) -> Option<Vec<(DVec3, DVec3)>> {
        let boxes_of_views = if self.measures() {
            self.points_of_sensors().into_iter().map(|point| (point, point)).collect()
        } else {
            vec![self.camera.viewpoint_bounds()]
        };
        let local = self.lights.iter().filter(|light| !light.is_distant());
        let of_lights: Option<Vec<_>> = local.map(|light| light.bounds(object_bounds)).collect();
        Some([boxes_of_views, of_lights?].concat())
    }
}
