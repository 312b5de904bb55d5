//! Surfaces that touch: in which order a ray passes them, whatever rounding says.
//!
//! A prism stands on a floor; two lenses are cemented; a lamp is flush with the ceiling. Where two surfaces
//! coincide, the computed distances to them differ by rounding, or agree, and an order taken from them would now
//! and then pass the floor from inside the glass, or miss it. So crossings that are as near to each other as
//! rounding is coarse are ordered by meaning instead, as if the surfaces lay in layers:
//!
//! - first bodies are left, then sheets (rectangles, disks, open meshes) are met, then bodies are entered: a sheet
//!   lies just outside a body that it touches;
//! - of two bodies with a common surface the one with the lower number is outside;
//! - of two sheets the smaller lies on the side it faces, so that a lamp in a ceiling shines.
//!
//! The order is total, and backwards along the opposite direction, so that a path works through a stack of touching
//! surfaces as through a real one: a ray that starts on one of them meets exactly those that lie beyond.

use std::cmp::Ordering;

use glam::DVec3;

use super::primitive::{Candidate, Primitives};
use super::{Geometry, Ray, SurfaceId};

/// Surfaces nearer to each other than this many roundings of their coordinates coincide.
const ROUNDINGS: f64 = 64.0;

/// A surface that a ray passes.
#[derive(Debug, Clone, Copy)]
struct Passed {
    passage: Passage,
    object: u32,
    primitive: u32,
    /// Cosine between the ray and the surface's normal.
    cos: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Passage {
    Leave,
    Sheet,
    Enter,
}

impl Primitives {
    /// By how much positions may have been rounded before the scene's centre was subtracted from them.
    pub(super) fn centre_rounding(&self) -> f64 {
        ROUNDINGS * f64::EPSILON * self.centre_reach
    }

    /// How near two surfaces at a point must be to count as one: the rounding of the coordinates there.
    fn tolerance(&self, point: DVec3, surfaces: [SurfaceId; 2]) -> f64 {
        let reach = surfaces
            .into_iter()
            .fold(point.abs().max_element(), |reach, surface| reach.max(self.reach(surface.primitive)));
        ROUNDINGS * f64::EPSILON * reach + self.centre_rounding()
    }
}

impl Geometry {
    fn passed(&self, surface: SurfaceId, cos: f64) -> Passed {
        let passage = match (self.primitives.is_closed(surface.primitive), cos > 0.0) {
            (false, _) => Passage::Sheet,
            (true, true) => Passage::Leave,
            (true, false) => Passage::Enter,
        };
        Passed { passage, object: self.primitives.object(surface.primitive), primitive: surface.primitive, cos }
    }

    /// Whether `a` is passed before `b` where they coincide.
    fn is_before(&self, a: Passed, b: Passed) -> bool {
        let number = |passed: Passed| (passed.object, passed.primitive);
        match (a.passage, b.passage) {
            (Passage::Enter, Passage::Enter) => number(a) < number(b),
            (Passage::Leave, Passage::Leave) => number(a) > number(b),
            (Passage::Sheet, Passage::Sheet) => {
                let size = |passed: Passed| (self.area(passed.object), number(passed));
                match size(a).partial_cmp(&size(b)) {
                    Some(Ordering::Less) => a.cos < 0.0,
                    Some(Ordering::Greater) => b.cos >= 0.0,
                    Some(Ordering::Equal) | None => false,
                }
            }
            (Passage::Leave | Passage::Sheet | Passage::Enter, _) => a.passage < b.passage,
        }
    }

    /// Whether a crossing with |t| below the scene's `near` is a real one for a ray that starts on `from`.
    #[cold]
    pub(super) fn follows_start(&self, ray: &Ray, from: SurfaceId, candidate: &Candidate) -> bool {
        let other = candidate.surface;
        let primitives = &self.primitives;
        let cos = ray.direction.dot(primitives.normal(other, ray.origin));
        if (candidate.t * cos).abs() > primitives.tolerance(ray.origin, [from, other]) {
            return candidate.t > 0.0;
        }
        let start_cos = ray.direction.dot(primitives.normal(from, ray.origin));
        if primitives.mesh(from.primitive).is_some()
            && primitives.mesh(from.primitive) == primitives.mesh(other.primitive)
        {
            // A neighbour in the same mesh: the ray has just passed this surface in this direction.
            return candidate.t > 0.0 && (cos > 0.0) != (start_cos > 0.0);
        }
        self.is_before(self.passed(from, start_cos), self.passed(other, cos))
    }

    /// Whether `first` is passed before `second`, which lies within `near` of it.
    #[cold]
    pub(super) fn precedes(&self, ray: &Ray, first: &Candidate, second: &Candidate) -> bool {
        let primitives = &self.primitives;
        let point = ray.at(second.t);
        let cos = ray.direction.dot(primitives.normal(first.surface, point));
        let other_cos = ray.direction.dot(primitives.normal(second.surface, point));
        let apart = (first.t - second.t).abs() * cos.abs().min(other_cos.abs());
        if apart > primitives.tolerance(point, [first.surface, second.surface]) {
            return first.t < second.t;
        }
        let (first_passed, second_passed) = (self.passed(first.surface, cos), self.passed(second.surface, other_cos));
        if first_passed.object == second_passed.object && first.t != second.t {
            return first.t < second.t;
        }
        self.is_before(first_passed, second_passed)
    }
}
