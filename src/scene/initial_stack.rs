//! The medium stacks in which camera rays and emitted rays start.

use super::Scene;
use super::light::{Light, RepresentativePoint};
use super::medium_stack::MediumStack;
use crate::geometry::{Hit, Ray, SurfaceId};
use glam::DVec3;

impl Scene {
    /// Finds the bodies that contain the camera and each light.
    pub(super) fn find_medium_stacks(&mut self) {
        self.camera.medium_stack = self.medium_stack_at(self.camera.origin());
        let medium_stacks: Vec<MediumStack> =
            self.lights.iter().map(|light| self.medium_stack_of_light(light)).collect();
        self.lights.iter_mut().zip(medium_stacks).for_each(|(light, medium_stack)| light.medium_stack = medium_stack);
    }

    fn medium_stack_of_light(&self, light: &Light) -> MediumStack {
        match light.representative_point(&self.geometry) {
            None => MediumStack::AIR,
            Some(RepresentativePoint { position, surface: None }) => self.medium_stack_at(position),
            Some(RepresentativePoint { position, surface: Some((surface, normal)) }) => {
                self.medium_stack_along(Ray { origin: position, direction: normal }, Some(surface))
            }
        }
    }

    /// The bodies that contain a point (m, relative to the scene's centre).
    pub fn medium_stack_at(&self, point: DVec3) -> MediumStack {
        // Any direction is correct. This one is unlikely to be parallel to a face of the scene.
        let direction = DVec3::new(0.391_827, 0.803_153, 0.448_713).normalize();
        self.medium_stack_along(Ray { origin: point, direction }, None)
    }

    /// The bodies that contain the origin of a ray. The ray leaves each of these bodies more often
    /// than it enters the body. The last body that the ray leaves is the outermost.
    fn medium_stack_along(&self, ray: Ray, from: Option<SurfaceId>) -> MediumStack {
        let mut open: Vec<(u32, i32, f64)> = Vec::new();
        let mut count = |hit: &Hit| {
            if self.body_of(hit.object).is_none() {
                return;
            }
            let leaves = if ray.direction.dot(hit.normal) > 0.0 { 1 } else { -1 };
            match open.iter_mut().find(|(object, _, _)| *object == hit.object) {
                Some(entry) => {
                    entry.1 += leaves;
                    entry.2 = hit.t;
                }
                None => open.push((hit.object, leaves, hit.t)),
            }
        };
        self.geometry.for_each_hit(&ray, from, &mut count);
        self.boundaries.for_each_hit(&ray, None, &mut count);
        open.retain(|&(_, balance, _)| balance > 0);
        open.sort_by(|a, b| b.2.total_cmp(&a.2));
        open.iter().fold(MediumStack::AIR, |medium_stack, &(object, _, _)| medium_stack.entered(object))
    }
}
