//! Objects that no light reaches and no camera sees, since an opaque body is closed around them.

use super::Scene;
use super::light::Emitter;
use glam::DVec3;
use std::collections::BTreeMap;

impl Scene {
    /// The objects inside opaque convex bodies that hold neither a light nor the camera, each with the body's number. Nothing is said of scenes
    /// in which something moves, or a medium glows.
    pub fn enclosures(&self) -> BTreeMap<u32, u32> {
        let mut enclosures = BTreeMap::new();
        let opaque = |object: u32| !self.material_of(object).surface.lets_through();
        let mut containers = self.geometry.convex_bodies().filter(|(object, _)| opaque(*object)).peekable();
        if containers.peek().is_none() || self.moves() {
            return enclosures;
        }
        let boxes = self.geometry.object_boxes();
        let Some(open) = self.open_places(&boxes) else {
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

    /// Boxes around the camera and all near lights; `None` where a light has no such box.
    fn open_places(&self, boxes: &BTreeMap<u32, (DVec3, DVec3)>) -> Option<Vec<(DVec3, DVec3)>> {
        let camera = self.camera.origin();
        let mut places = vec![(camera, camera)];
        for light in &self.lights {
            let around = |centre: DVec3, radius: f64| Some((centre - radius, centre + radius));
            let place = match &light.emitter {
                Emitter::Directional(_) | Emitter::Environment(_) => continue,
                Emitter::Point(point) => around(point.at, 0.0),
                Emitter::Spot(spot) => around(spot.at(), 0.0),
                Emitter::Beam(beam) => around(beam.centre(), beam.radius_m()),
                Emitter::Area(area) => boxes.get(&area.object).copied(),
                Emitter::Volume(_) => None,
            };
            places.push(place?);
        }
        Some(places)
    }
}
