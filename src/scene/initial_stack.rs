//! The medium stacks in which camera rays and emitted rays start, and the medium stacks of paths
//! through more bodies than a stack can hold.

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
                self.medium_stack_along(Ray { origin: position, direction: normal }, [Some(surface), None])
            }
        }
    }

    /// The bodies that contain a point (m, relative to the scene's centre).
    pub fn medium_stack_at(&self, point: DVec3) -> MediumStack {
        // Any direction is correct. This one is unlikely to be parallel to a face of the scene.
        let direction = DVec3::new(0.391_827, 0.803_153, 0.448_713).normalize();
        self.medium_stack_along(Ray { origin: point, direction }, [None; 2])
    }

    /// The bodies that contain the origin of a ray. The ray leaves each of these bodies more often
    /// than it enters the body. The last body that the ray leaves is the outermost. `from` contains
    /// the surface and the face of a boundary on which the ray starts.
    fn medium_stack_along(&self, ray: Ray, from: [Option<SurfaceId>; 2]) -> MediumStack {
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
        self.geometry.for_each_hit(&ray, from[0], &mut count);
        self.boundaries.for_each_hit(&ray, from[1], &mut count);
        open.retain(|&(_, balance, _)| balance > 0);
        open.sort_by(|a, b| b.2.total_cmp(&a.2));
        open.iter().fold(MediumStack::AIR, |medium_stack, &(object, _, _)| self.entered(medium_stack, object))
    }

    fn entered(&self, medium_stack: MediumStack, object: u32) -> MediumStack {
        if medium_stack.is_full() {
            medium_stack.entered_full(object, |object| self.body_priority(object))
        } else {
            medium_stack.entered(object)
        }
    }

    /// Does the same as [`Self::across`] for a full stack. When the path leaves a body, a body that
    /// the stack lacks may become dominant. The rest of the ray then tells which bodies contain it.
    #[cold]
    pub(super) fn across_with_full_stack(&self, medium_stack: &MediumStack, ray: &Ray, hit: &Hit) -> MediumStack {
        if ray.direction.dot(hit.normal) < 0.0 {
            return self.entered(*medium_stack, hit.object);
        }
        let is_boundary = self.material_of(hit.object).is_boundary();
        let from = if is_boundary { [None, Some(hit.surface)] } else { [Some(hit.surface), None] };
        self.medium_stack_along(Ray { origin: hit.position, direction: ray.direction }, from)
    }
}
