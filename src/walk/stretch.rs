//! The stretches of a ray: from one body of glass, water or fog into the next.

use super::encounter::Start;
use crate::scene::Scene;
use crate::scene::geometry::Ray;
use crate::scene::interior::Interior;
use crate::scene::medium::Medium;
use crate::spectrum::Spectrum;
use std::ops::ControlFlow;

/// A piece of a ray all of which lies in one body.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<'a> {
    /// The ray from the stretch's start on.
    pub ray: Ray,
    /// Its length in m; infinite where the ray leaves the scene.
    pub length_m: f64,
    /// The bodies around it.
    pub interior: Interior,
    /// The number of the medium that fills it, and the medium.
    pub medium: Option<(usize, &'a Medium)>,
    /// The clear absorption of the body that fills it, in 1/m.
    pub absorption: Option<&'a Spectrum>,
}

/// Faces that lie this close (as a share of the scene's radius) to the surface that a ray leaves or comes to are taken to lie in it.
const COINCIDENT: f64 = 1e-9;

/// Calls `along` with every stretch of the ray's first `length_m`, on which no surface stands, and returns the bodies around its end. Only the faces of
/// boundaries part such a way.
///
/// Where a boundary coincides with a surface (a box of fog that stands on a floor) rounding must not decide whether it was crossed: on the way to a
/// surface such faces do not count, and on the way from it the direction alone says on which side of them the ray is.
pub fn stretches<'a>(
    scene: &'a Scene,
    start: Start,
    length_m: f64,
    along: &mut impl FnMut(&Stretch<'a>) -> ControlFlow<()>,
) -> ControlFlow<(), Interior> {
    let Start { mut ray, from, mut interior } = start;
    let mut left_m = length_m;
    if !scene.boundaries.is_empty() {
        let margin = COINCIDENT * scene.radius_m;
        let mut boundary = None;
        if from.is_some() {
            ray.origin -= margin * ray.direction;
            left_m += margin;
        }
        while let Some(hit) = scene.boundaries.intersect(&ray, boundary, left_m - margin) {
            along(&Stretch::new(scene, ray, hit.t, interior))?;
            interior = scene.across(&interior, &ray, &hit);
            ray.origin = hit.position;
            boundary = Some(hit.surface);
            left_m -= hit.t;
        }
    }
    along(&Stretch::new(scene, ray, left_m, interior))?;
    ControlFlow::Continue(interior)
}

impl<'a> Stretch<'a> {
    fn new(scene: &'a Scene, ray: Ray, length_m: f64, interior: Interior) -> Self {
        let medium = scene.medium_in(&interior).map(|number| (number, &scene.media[number]));
        Self { ray, length_m, interior, medium, absorption: scene.absorption_in(&interior) }
    }
}
