//! Surfaces that touch: in which order a ray passes them, whatever rounding says.
//!
//! A prism stands on a floor; two lenses are cemented. Where two surfaces coincide, the computed distances to them
//! differ by rounding, or agree, and an order taken from them would now and then pass the floor from inside the
//! glass, or miss it. So crossings that are as near to each other as rounding is coarse are ordered by meaning
//! instead: first bodies are left, then sheets (rectangles, disks, open meshes) are passed, then bodies are
//! entered, and like things go by their number. A sheet thus lies just outside a body that it touches. The order is
//! total, so a path works through a stack of touching surfaces once, in either direction, and without a loop: a
//! ray that starts on one of them meets exactly those that come later in the order for its own direction.

use glam::DVec3;

use super::primitive::{Candidate, Primitives};
use super::{Ray, SurfaceId};

/// Surfaces nearer to each other than this many roundings of their coordinates coincide.
const ROUNDINGS: f64 = 64.0;

/// Place in the order of passage of surfaces at one point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    passage: Passage,
    object: u32,
    primitive: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Passage {
    Leave,
    Sheet,
    Enter,
}

impl Primitives {
    fn rank(&self, surface: SurfaceId, cos: f64) -> Rank {
        let passage = match (self.is_closed(surface.primitive), cos > 0.0) {
            (false, _) => Passage::Sheet,
            (true, true) => Passage::Leave,
            (true, false) => Passage::Enter,
        };
        Rank { passage, object: self.object(surface.primitive), primitive: surface.primitive }
    }

    /// How near two surfaces at a point must be to count as one: the rounding of the coordinates there.
    fn tolerance(&self, point: DVec3, surfaces: [SurfaceId; 2]) -> f64 {
        let reach = surfaces
            .into_iter()
            .fold(point.abs().max_element(), |reach, surface| reach.max(self.reach(surface.primitive)));
        ROUNDINGS * f64::EPSILON * reach
    }

    /// Whether a crossing with |t| below the scene's `near` is a real one for a ray that starts on `from`.
    #[cold]
    pub(super) fn follows_start(&self, ray: &Ray, from: SurfaceId, candidate: &Candidate) -> bool {
        let other = candidate.surface;
        let cos = ray.direction.dot(self.normal(other, ray.origin));
        if (candidate.t * cos).abs() > self.tolerance(ray.origin, [from, other]) {
            return candidate.t > 0.0;
        }
        let start_cos = ray.direction.dot(self.normal(from, ray.origin));
        if self.mesh(from.primitive).is_some() && self.mesh(from.primitive) == self.mesh(other.primitive) {
            // A neighbour in the same mesh: the ray has just passed this surface in this direction.
            return candidate.t > 0.0 && (cos > 0.0) != (start_cos > 0.0);
        }
        self.rank(other, cos) > self.rank(from, start_cos)
    }

    /// Whether `first` is passed before `second`, which lies within `near` of it.
    #[cold]
    pub(super) fn precedes(&self, ray: &Ray, first: &Candidate, second: &Candidate) -> bool {
        let point = ray.at(second.t);
        let cos = ray.direction.dot(self.normal(first.surface, point));
        let other_cos = ray.direction.dot(self.normal(second.surface, point));
        let apart = (first.t - second.t).abs() * cos.abs().min(other_cos.abs());
        if apart > self.tolerance(point, [first.surface, second.surface]) {
            return first.t < second.t;
        }
        if self.object(first.surface.primitive) == self.object(second.surface.primitive) && first.t != second.t {
            return first.t < second.t;
        }
        self.rank(first.surface, cos) < self.rank(second.surface, other_cos)
    }
}
