//! The medium stacks in which rays start, and those beyond the capacity of a stack.

use super::light::{Light, RepresentativePoint};
use super::medium_stack::MediumStack;
use super::meter::Sensor;
use super::{Body, Scene};
use crate::geometry::{Hit, Ray, SurfaceId};
use glam::{DAffine3, DVec3};
use smallvec::SmallVec;

impl Scene {
    /// Finds the bodies around the camera, each sensor and each light, all in air at first.
    pub(super) fn find_medium_stacks(&mut self) {
        if self.objects.iter().all(|object| self.materials[object.material].body.is_none()) {
            return;
        }
        self.camera.medium_stack = self.medium_stack_at(self.camera.origin());
        let around = self.camera.viewpoint_bounds();
        self.camera.crosses_bodies = around.0 != around.1 && self.bodies_differ_within(around, |_| true);
        self.find_medium_stacks_of_sensors();
        let of_light = |light: &Light| (self.medium_stack_of_light(light), self.crosses_bodies(light));
        let of_lights: Vec<(MediumStack, bool)> = self.lights.iter().map(of_light).collect();
        for (light, (medium_stack, crosses_bodies)) in self.lights.iter_mut().zip(of_lights) {
            (light.medium_stack, light.crosses_bodies) = (medium_stack, crosses_bodies);
        }
    }

    fn find_medium_stacks_of_sensors(&mut self) {
        let around = |sensor: &Sensor| match sensor.position() {
            Some(position) => Sensor { medium_stack: self.medium_stack_at(position), ..*sensor },
            None => *sensor,
        };
        let sensors = self.camera.sensors().iter().map(around).collect();
        self.camera.set_sensors(sensors);
    }

    /// The bodies that contain the origin of a ray that starts on this surface.
    pub fn medium_stack_on(&self, ray: Ray, surface: SurfaceId) -> MediumStack {
        self.medium_stack_along(ray, [Some(surface), None])
    }

    /// The bodies that contain the origin of a ray emitted from the surface `from`, if any.
    #[inline]
    pub fn medium_stack_of_emission(&self, light: &Light, ray: Ray, from: Option<SurfaceId>) -> MediumStack {
        if light.crosses_bodies { self.medium_stack_along(ray, [from, None]) } else { light.medium_stack }
    }

    /// The bodies that contain the origin of a camera ray.
    #[inline]
    pub fn medium_stack_of_camera(&self, ray: Ray) -> MediumStack {
        if self.camera.crosses_bodies { self.medium_stack_along(ray, [None; 2]) } else { self.camera.medium_stack }
    }

    fn crosses_bodies(&self, light: &Light) -> bool {
        let own_medium = light.medium_name();
        let around = match own_medium {
            Some(_) => light.box_of_medium().map(|map| box_around(&map)),
            None => light.bounds(&self.geometry.object_bounds()),
        };
        // A glowing medium emits only inside its own body.
        let is_own =
            |body: &Body| body.medium.is_some_and(|number| own_medium == Some(self.media[number].name.as_str()));
        around.is_some_and(|around| self.bodies_differ_within(around, |body| !is_own(body)))
    }

    /// Returns true unless every body that counts and whose box touches this box is convex and
    /// contains the whole box; the bodies may then differ from point to point.
    fn bodies_differ_within(&self, (low, high): (DVec3, DVec3), counts: impl Fn(&Body) -> bool) -> bool {
        let touches = |(from, to): (DVec3, DVec3)| from.cmple(high).all() && to.cmpge(low).all();
        let boxes = self.geometry.object_bounds().into_iter().chain(self.boundaries.object_bounds());
        let mut bodies =
            boxes.filter(|(object, bounds)| self.body_of(*object).is_some_and(&counts) && touches(*bounds));
        let convex = || self.geometry.convex_bodies().chain(self.boundaries.convex_bodies());
        bodies.any(|(object, _)| !convex().any(|(body, contains)| body == object && contains((low, high))))
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
        // Any direction is correct; this one is unlikely to be parallel to a face.
        let direction = DVec3::new(0.391_827, 0.803_153, 0.448_713).normalize();
        self.medium_stack_along(Ray { origin: point, direction }, [None; 2])
    }

    /// The bodies that a ray leaves more often than it enters, of which the last is the outermost.
    /// `from` is the surface, and the face of a boundary, of its start.
    fn medium_stack_along(&self, ray: Ray, from: [Option<SurfaceId>; 2]) -> MediumStack {
        let mut open: SmallVec<[(u32, i32, f64); 8]> = SmallVec::new();
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
        open.retain(|&mut (_, balance, _)| balance > 0);
        open.sort_by(|a, b| b.2.total_cmp(&a.2));
        let times = |&(object, balance, _): &(u32, i32, f64)| {
            let overlaps = self.objects[object as usize].overlaps_itself;
            std::iter::repeat_n(object, if overlaps { balance as usize } else { 1 })
        };
        open.iter().flat_map(times).fold(MediumStack::AIR, |medium_stack, object| self.entered(medium_stack, object))
    }

    #[inline]
    pub(super) fn entered(&self, medium_stack: MediumStack, object: u32) -> MediumStack {
        if medium_stack.is_full() {
            medium_stack.entered_full(object, |object| self.body_priority(object))
        } else if self.objects[object as usize].overlaps_itself {
            medium_stack.entered_again(object)
        } else {
            medium_stack.entered(object)
        }
    }

    /// Does the same as [`Self::across`] for a full stack. When the path leaves a body, a body that
    /// the stack lacks may become dominant; the rest of the ray tells which bodies contain it.
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

/// The lowest and the highest corner of a box around a transformed unit cube.
fn box_around(from_unit: &DAffine3) -> (DVec3, DVec3) {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2 & 1));
    (0..8)
        .map(|i| from_unit.transform_point3(corner(i)))
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |around, point| (around.0.min(point), around.1.max(point)))
}
