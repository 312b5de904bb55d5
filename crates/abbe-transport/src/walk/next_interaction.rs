//! The next visible surface along a ray.

use super::medium_segment::{MediumSegment, for_each_segment};
use super::ray_state::RayState;
use super::surface_interaction::{SurfaceInteraction, SurfaceLookup};
use abbe_optics::bsdf::{InterfaceIors, LocalBsdf};
use abbe_scene::Scene;
use abbe_scene::geometry::{Hit, Ray};
use abbe_scene::medium_stack::MediumStack;
use std::ops::ControlFlow;

/// The end of a path segment. `Break`: the callback ended the segment inside a medium.
/// `Continue(Some)`: a visible surface. `Continue(None)`: the ray left the scene.
pub type SegmentEnd<'a> = ControlFlow<(), Option<SurfaceInteraction<'a>>>;

/// Finds the next visible surface along the ray, if there is one, and ignores media.
#[inline]
pub fn next_interaction<'a>(
    scene: &'a Scene,
    ray_state: RayState,
    lookup: SurfaceLookup,
) -> Option<SurfaceInteraction<'a>> {
    let mut search = InteractionSearch { ray_state, distance_m: 0.0, crossed_hidden_face: false };
    loop {
        let hit = scene.geometry.intersect(&search.ray_state.ray, search.ray_state.from, f64::INFINITY)?;
        if let Some(interaction) = search.process_hit(scene, hit, lookup) {
            return Some(interaction);
        }
    }
}

/// Like [`next_interaction`], without bodies: all faces are visible, between air.
#[inline(always)]
pub fn next_interaction_in_air<'a>(
    scene: &'a Scene,
    ray_state: RayState,
    lookup: SurfaceLookup,
) -> Option<SurfaceInteraction<'a>> {
    let ray = ray_state.ray;
    let hit = scene.geometry.intersect(&ray, ray_state.from, f64::INFINITY)?;
    let sides = InterfaceIors { here: &scene.air, there: &scene.air };
    Some(SurfaceInteraction::new(scene, ray.direction, hit, [MediumStack::AIR; 2], sides, lookup))
}

/// Like [`next_interaction`], but calls `visit` for each medium segment on the way. If `visit`
/// returns `Break`, the search ends at that segment.
pub fn next_interaction_through_media<'a>(
    scene: &'a Scene,
    ray_state: RayState,
    lookup: SurfaceLookup,
    mut visit: impl FnMut(&MediumSegment<'a>) -> ControlFlow<()>,
) -> SegmentEnd<'a> {
    let mut search = InteractionSearch { ray_state, distance_m: 0.0, crossed_hidden_face: false };
    loop {
        let hit = scene.geometry.intersect(&search.ray_state.ray, search.ray_state.from, f64::INFINITY);
        let length_m = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
        search.ray_state.medium_stack = for_each_segment(scene, search.ray_state, length_m, &mut visit)?;
        let Some(hit) = hit else { return ControlFlow::Continue(None) };
        if let Some(interaction) = search.process_hit(scene, hit, lookup) {
            return ControlFlow::Continue(Some(interaction));
        }
    }
}

/// The state of a search for the next visible surface. The search passes through hidden faces.
struct InteractionSearch {
    ray_state: RayState,
    distance_m: f64,
    crossed_hidden_face: bool,
}

impl InteractionSearch {
    /// Advances to a hit. Returns `None` if the face is hidden.
    #[inline]
    fn process_hit<'a>(&mut self, scene: &'a Scene, hit: Hit, lookup: SurfaceLookup) -> Option<SurfaceInteraction<'a>> {
        self.distance_m += hit.t;
        let RayState { ray, medium_stack, .. } = self.ray_state;
        let there = scene.across(&medium_stack, &ray, &hit);
        let is_body = scene.body_of(hit.object).is_some();
        let dielectric_here = scene.dominant_dielectric(&medium_stack);
        let dielectric_there = if is_body { scene.dominant_dielectric(&there) } else { dielectric_here };
        // A hidden face lies inside a body of higher priority. This body dominates on both sides.
        let is_hidden = is_body && dielectric_there == dielectric_here;
        if is_hidden && scene.objects[hit.object as usize].light.is_none() {
            let ray = Ray { origin: hit.position, ..ray };
            self.ray_state = RayState { ray, from: Some(hit.surface), medium_stack: there };
            self.crossed_hidden_face = true;
            return None;
        }
        let sides = InterfaceIors { here: scene.index_of(dielectric_here), there: scene.index_of(dielectric_there) };
        let stacks = [medium_stack, there];
        let mut interaction = SurfaceInteraction::new(scene, ray.direction, hit, stacks, sides, lookup);
        (interaction.distance_m, interaction.crossed_hidden_face) = (self.distance_m, self.crossed_hidden_face);
        if is_hidden {
            // The whole surface of a lamp emits light, so the path must meet it here too.
            interaction.bsdf = LocalBsdf::PLAIN_INTERFACE;
        }
        Some(interaction)
    }
}
