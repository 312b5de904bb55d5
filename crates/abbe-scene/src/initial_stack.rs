//! The medium stacks in which rays start, and those beyond the capacity of a stack.

use super::Scene;
use super::light::{Light, RepresentativePoint};
use super::medium_stack::MediumStack;
use super::meter::Sensor;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::{ConvexBody, Hit, Ray, SurfaceId};
use glam::{DAffine3, DVec3};
use smallvec::SmallVec;
use std::collections::BTreeMap;

impl Scene {
    /// Finds the bodies around the camera, each sensor and each light, all in air at first.
    pub(super) fn find_medium_stacks(&mut self) {
        if self.objects.iter().all(|object| self.materials[object.material].body.is_none()) {
            return;
        }
        self.camera.medium_stack = self.medium_stack_at(self.camera.origin());
        self.find_medium_stacks_of_sensors();
        let bodies = BodiesInSpace::of(self);
        let around = self.camera.viewpoint_bounds();
        let crosses_bodies = around.0 != around.1 && bodies.differ_within(around, |_| true);
        let of_light = |light: &Light| (self.medium_stack_of_light(light), bodies.cross(self, light));
        let of_lights: Vec<(MediumStack, bool)> = self.lights.iter().map(of_light).collect();
        self.camera.crosses_bodies = crosses_bodies;
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
        let mut crossings: SmallVec<[Crossing; 8]> = SmallVec::new();
        let mut count = |hit: &Hit| {
            if self.body_of(hit.object).is_some() {
                let leaves = if ray.direction.dot(hit.normal) > 0.0 { 1 } else { -1 };
                crossings.push(Crossing { object: hit.object, leaves, t: hit.t, found: crossings.len() });
            }
        };
        self.geometry.for_each_hit(&ray, from[0], &mut count);
        self.boundaries.for_each_hit(&ray, from[1], &mut count);
        // The sort is stable, so the last crossing found of an object stays the last one.
        crossings.sort_by_key(|crossing| crossing.object);
        let mut open: SmallVec<[Crossing; 8]> = SmallVec::new();
        for crossing in crossings {
            match open.last_mut().filter(|last| last.object == crossing.object) {
                Some(last) => (last.leaves, last.t) = (last.leaves + crossing.leaves, crossing.t),
                None => open.push(crossing),
            }
        }
        open.retain(|body| body.leaves > 0);
        open.sort_by(|a, b| b.t.total_cmp(&a.t).then(a.found.cmp(&b.found)));
        let times = |body: &Crossing| {
            let overlaps = self.objects[body.object as usize].overlaps_itself;
            std::iter::repeat_n(body.object, if overlaps { body.leaves as usize } else { 1 })
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

/// One or several crossings of a ray with the surface of a body.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    object: u32,
    /// How often the ray leaves the body minus how often it enters it.
    leaves: i32,
    /// Of the crossing found last.
    t: f64,
    /// The number of crossings that were found before.
    found: usize,
}

/// All bodies of a scene, to find those around a light or the camera.
struct BodiesInSpace<'a> {
    /// The boxes of the objects with surfaces.
    object_bounds: BTreeMap<u32, (DVec3, DVec3)>,
    /// The object of each body, and the body if it is convex.
    bodies: Vec<(u32, Option<ConvexBody<'a>>)>,
    boxes: BoxTree,
}

impl<'a> BodiesInSpace<'a> {
    fn of(scene: &'a Scene) -> Self {
        let convex = scene.geometry.convex_bodies().chain(scene.boundaries.convex_bodies());
        let convex: BTreeMap<u32, ConvexBody<'a>> = convex.map(|body| (body.object, body)).collect();
        let object_bounds = scene.geometry.object_bounds();
        let all = object_bounds.iter().map(|(&object, &around)| (object, around));
        let all = all.chain(scene.boundaries.object_bounds()).filter(|(object, _)| scene.body_of(*object).is_some());
        let body = |(object, around)| ((object, convex.get(&object).copied()), (around, 0.0));
        let (bodies, boxes): (Vec<_>, Vec<_>) = all.map(body).unzip();
        Self { boxes: BoxTree::new(&boxes), object_bounds, bodies }
    }

    fn cross(&self, scene: &Scene, light: &Light) -> bool {
        let own_medium = light.medium_name();
        let around = match own_medium {
            Some(_) => light.box_of_medium().map(|map| box_around(&map)),
            None => light.bounds(&self.object_bounds),
        };
        let counts = |object| {
            let medium = scene.body_of(object).and_then(|body| body.medium);
            // A glowing medium emits only inside its own body.
            medium.is_none_or(|number| own_medium != Some(scene.media[number].name.as_str()))
        };
        around.is_some_and(|around| self.differ_within(around, counts))
    }

    /// Returns true unless every body that counts and whose box touches this box is convex and
    /// contains the whole box; the bodies may then differ from point to point.
    fn differ_within(&self, around: (DVec3, DVec3), counts: impl Fn(u32) -> bool) -> bool {
        self.boxes.any_touching(around, |body| {
            let (object, convex) = self.bodies[body as usize];
            counts(object) && !convex.is_some_and(|body| body.contains_box(around))
        })
    }
}

/// The lowest and the highest corner of a box around a transformed unit cube.
fn box_around(from_unit: &DAffine3) -> (DVec3, DVec3) {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2 & 1));
    (0..8)
        .map(|i| from_unit.transform_point3(corner(i)))
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |around, point| (around.0.min(point), around.1.max(point)))
}
