//! Ray segments inside one body of glass, liquid or fog.

use super::ray_state::RayState;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::medium::Medium;
use abbe_scene::medium_stack::MediumStack;
use abbe_spectra::spectrum::Spectrum;
use std::ops::ControlFlow;

/// A part of a ray inside one body, or in the air between bodies.
#[derive(Debug, Clone, Copy)]
pub struct MediumSegment<'a> {
    /// The ray, with its origin at the start of the segment.
    pub ray: Ray,
    /// The length in m. It is infinite if the ray leaves the scene.
    pub length_m: f64,
    pub medium_stack: MediumStack,
    pub medium: Option<NumberedMedium<'a>>,
    /// The absorption coefficient (1/m) of the clear body that fills the segment.
    pub absorption: Option<&'a Spectrum>,
}

#[derive(Debug, Clone, Copy)]
pub struct NumberedMedium<'a> {
    /// The index into `Scene::media`.
    pub number: usize,
    pub medium: &'a Medium,
}

/// A boundary face coincides with a surface within this fraction of the scene's radius.
const COINCIDENT: f64 = 1e-9;

/// Calls `visit` for each segment of the ray's first `length_m` metres, which no surface may
/// interrupt. Adjacent segments join at the faces of medium boundaries. Returns the medium stack at
/// the end.
///
/// A boundary may coincide with a surface, for example if a box of fog stands on a floor, and
/// rounding must not decide whether the ray crosses it. Faces that coincide with the surface at the
/// end of the ray are therefore ignored, and for faces at its start the direction of the ray
/// decides on which side it continues.
pub fn for_each_segment<'a>(
    scene: &'a Scene,
    ray_state: RayState,
    length_m: f64,
    visit: &mut impl FnMut(&MediumSegment<'a>) -> ControlFlow<()>,
) -> ControlFlow<(), MediumStack> {
    let RayState { mut ray, from, mut medium_stack } = ray_state;
    let mut left_m = length_m;
    if !scene.boundaries.is_empty() {
        let margin = COINCIDENT * scene.radius_m;
        let mut boundary = None;
        if from.is_some() {
            ray.origin -= margin * ray.direction;
            left_m += margin;
        }
        while let Some(hit) = scene.boundaries.intersect(&ray, boundary, left_m - margin) {
            visit(&MediumSegment::new(scene, ray, hit.t, medium_stack))?;
            medium_stack = scene.across(&medium_stack, &ray, &hit);
            ray.origin = hit.position;
            boundary = Some(hit.surface);
            left_m -= hit.t;
        }
    }
    visit(&MediumSegment::new(scene, ray, left_m, medium_stack))?;
    ControlFlow::Continue(medium_stack)
}

impl<'a> MediumSegment<'a> {
    fn new(scene: &'a Scene, ray: Ray, length_m: f64, medium_stack: MediumStack) -> Self {
        let numbered = |number| NumberedMedium { number, medium: &scene.media[number] };
        let medium = scene.medium_in(&medium_stack).map(numbered);
        Self { ray, length_m, medium_stack, medium, absorption: scene.absorption_in(&medium_stack) }
    }
}
