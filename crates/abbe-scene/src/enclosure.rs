//! Finds objects enclosed in an opaque body, which no light reaches and no camera sees.

use super::Scene;
use crate::geometry::ConvexBody;
use crate::geometry::box_tree::BoxTree;
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
        let mut containers = self.geometry.convex_bodies().filter(|body| opaque(body.object)).peekable();
        if containers.peek().is_none() || self.moves() {
            return enclosures;
        }
        let boxes = self.geometry.object_bounds();
        let Some(open) = self.boxes_of_camera_and_lights(&boxes) else {
            return enclosures;
        };
        let open = BoxTree::new(&open.into_iter().map(|around| (around, 0.0)).collect::<Vec<_>>());
        let placed = containers.filter_map(|body| Some((body, *boxes.get(&body.object)?)));
        let closed = placed.filter(|&(_, around)| !open.any_touching(around, |_| true));
        let (bodies, of_bodies): (Vec<ConvexBody<'_>>, Vec<_>) =
            closed.map(|(body, around)| (body, (around, body.diameter_m()))).unzip();
        let tree = BoxTree::new(&of_bodies);
        for (&object, &(low, high)) in &boxes {
            let holds = |body: u32| bodies[body as usize].contains_box((low, high));
            if let Some(first) = tree.first_around((low, high), (high - low).length(), holds) {
                enclosures.insert(object, bodies[first as usize].object);
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
