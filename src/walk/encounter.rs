//! A ray's way to the next surface that matters to it.

use super::scatter::Scattered;
use super::stretch::{Stretch, stretches};
use crate::math::frame::Frame;
use crate::optics::surface::{Event, Sides, Surface};
use crate::scene::Scene;
use crate::scene::geometry::{Hit, Ray, SurfaceId};
use crate::scene::interior::Interior;
use glam::DVec3;
use std::ops::ControlFlow;

/// Where a leg starts: the ray, the surface it leaves, and the bodies it is inside of.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    /// The ray.
    pub ray: Ray,
    /// The surface that it leaves, which it does not hit again at distance 0.
    pub from: Option<SurfaceId>,
    /// The bodies around its origin.
    pub interior: Interior,
}

/// A surface met by a path, with all that scattering there needs.
#[derive(Debug, Clone, Copy)]
pub struct Encounter<'a> {
    /// The hit.
    pub hit: Hit,
    /// The way from the last event, in m; all of it lies in one body.
    pub distance: f64,
    /// The direction in which the path came.
    pub incoming: DVec3,
    /// The material's number.
    pub material: usize,
    /// The surface: of a mix, the component drawn.
    pub surface: &'a Surface,
    /// The frame in which it scatters ([`Hit::frame`]).
    pub frame: Frame,
    /// The direction back along the path, in the frame.
    pub wo: DVec3,
    /// The bodies on this side of the surface.
    pub here: Interior,
    /// The bodies on its other side.
    pub there: Interior,
    /// The refractive indices on this side and on the other.
    pub sides: Sides<'a>,
    /// Whether the way here led through faces that no event marks (they lie inside a body of higher priority). Shadow rays
    /// stop at such faces, so a path that crossed one is not among those that shadow rays count.
    pub crossed_hidden: bool,
}

/// How a leg of a path ends: broken off on its way, or at a surface that matters (or, without one, outside the scene).
pub type Leg<'a> = ControlFlow<(), Option<Encounter<'a>>>;

/// Follows the ray to the next surface that matters; `None` where it leaves the scene. `component` draws the component of mixed surfaces.
/// What lies between surfaces is not looked at.
#[inline]
pub fn next<'a>(scene: &'a Scene, start: Start, component: f64) -> Option<Encounter<'a>> {
    let mut way = Way { at: start, distance: 0.0, crossed_hidden: false };
    loop {
        let hit = scene.geometry.intersect(&way.at.ray, way.at.from, f64::INFINITY)?;
        if let Some(encounter) = way.meet(scene, hit, component) {
            return Some(encounter);
        }
    }
}

/// The same where nothing has an inside: every face is a surface that shows, with air on both sides.
#[inline(always)]
pub fn next_in_air<'a>(scene: &'a Scene, start: Start, component: f64) -> Option<Encounter<'a>> {
    let ray = start.ray;
    let hit = scene.geometry.intersect(&ray, start.from, f64::INFINITY)?;
    Some(Encounter::new(scene, ray.direction, hit, (Interior::AIR, Interior::AIR), component))
}

/// As [`next`], with a look at every stretch of the way, from one body into the next; the way ends where `along` breaks it off.
pub fn travel<'a>(
    scene: &'a Scene,
    start: Start,
    component: f64,
    mut along: impl FnMut(&Stretch<'a>) -> ControlFlow<()>,
) -> Leg<'a> {
    let mut way = Way { at: start, distance: 0.0, crossed_hidden: false };
    loop {
        let hit = scene.geometry.intersect(&way.at.ray, way.at.from, f64::INFINITY);
        let length_m = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
        way.at.interior = stretches(scene, way.at, length_m, &mut along)?;
        let Some(hit) = hit else {
            return ControlFlow::Continue(None);
        };
        if let Some(encounter) = way.meet(scene, hit, component) {
            return ControlFlow::Continue(Some(encounter));
        }
    }
}

/// How far a leg has come.
struct Way {
    at: Start,
    distance: f64,
    crossed_hidden: bool,
}

impl Way {
    /// Goes on to a hit: the encounter there, or `None` where the face does not show and is passed.
    #[inline]
    fn meet<'a>(&mut self, scene: &'a Scene, hit: Hit, component: f64) -> Option<Encounter<'a>> {
        self.distance += hit.t;
        let Start { ray, interior, .. } = self.at;
        let there = scene.across(&interior, &ray, &hit);
        if scene.is_hidden(&hit, &interior, &there) {
            let ray = Ray { origin: hit.position, ..ray };
            self.at = Start { ray, from: Some(hit.surface), interior: there };
            self.crossed_hidden = true;
            return None;
        }
        let mut encounter = Encounter::new(scene, ray.direction, hit, (interior, there), component);
        (encounter.distance, encounter.crossed_hidden) = (self.distance, self.crossed_hidden);
        Some(encounter)
    }
}

impl<'a> Encounter<'a> {
    #[inline(always)]
    fn new(scene: &'a Scene, incoming: DVec3, hit: Hit, (here, there): (Interior, Interior), component: f64) -> Self {
        let material = scene.objects[hit.object as usize].material;
        let surface = scene.materials[material].surface.pick(component);
        let frame = hit.frame(incoming);
        Self {
            distance: hit.t,
            crossed_hidden: false,
            incoming,
            material,
            surface,
            wo: frame.to_local(-incoming),
            frame,
            here,
            there,
            sides: Sides { here: scene.index_in(&here), there: scene.index_in(&there) },
            hit,
        }
    }

    /// The frame of the geometric normal, for scattered directions that an interpolated normal sends to the wrong side of the surface,
    /// and the direction back along the path in it.
    #[inline(always)]
    pub(super) fn seen_truly(&self) -> (Frame, DVec3) {
        let frame = Frame::new(self.hit.normal);
        (frame, frame.to_local(-self.incoming))
    }

    /// Where a ray from here towards `direction` starts.
    #[inline]
    pub fn leave(&self, direction: DVec3, interior: Interior) -> Start {
        Start { ray: Ray { origin: self.hit.position, direction }, from: Some(self.hit.surface), interior }
    }

    /// Whether `direction` leads back to the side from which the path came.
    #[inline]
    pub fn leads_back(&self, direction: DVec3) -> bool {
        self.hit.leads_back(self.incoming, direction)
    }

    /// Whether a scattered direction leads to the side that its event says.
    #[inline]
    pub fn agrees(&self, direction: DVec3, event: Event) -> bool {
        self.leads_back(direction) == (event == Event::Reflection)
    }

    /// The bodies around a ray after this event.
    #[inline]
    pub fn interior_after(&self, event: Event) -> Interior {
        match event {
            Event::Reflection => self.here,
            Event::Transmission => self.there,
        }
    }

    /// Where the way after a scattering event here starts.
    #[inline]
    pub fn after(&self, scattered: &Scattered) -> Start {
        self.leave(scattered.direction, self.interior_after(scattered.event))
    }

    /// The refractive indices seen from the side to which `direction` leads.
    pub fn sides_towards(&self, direction: DVec3) -> Sides<'a> {
        if self.leads_back(direction) { self.sides } else { Sides { here: self.sides.there, there: self.sides.here } }
    }

    /// The bodies on the side to which `direction` leads.
    pub fn interior_towards(&self, direction: DVec3) -> Interior {
        if self.leads_back(direction) { self.here } else { self.there }
    }

    /// Whether nothing stands between here and a light along `direction`, at `distance`, on the surface `target`.
    #[inline(always)]
    pub fn sees(&self, scene: &Scene, direction: DVec3, distance: f64, target: Option<SurfaceId>) -> bool {
        let ray = Ray { origin: self.hit.position, direction };
        !scene.geometry.occluded(&ray, Some(self.hit.surface), target, distance)
    }

    /// See [`Hit::adjoint_correction`].
    #[inline]
    pub fn adjoint_correction(&self, to_light: DVec3, to_camera: DVec3) -> f64 {
        self.hit.adjoint_correction(&self.frame, to_light, to_camera)
    }
}
