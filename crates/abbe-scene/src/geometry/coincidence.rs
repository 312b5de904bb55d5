//! The order in which a ray crosses coincident surfaces.
//!
//! Coincident surfaces are a prism on a floor, two cemented lenses, or a light that is flush with
//! the ceiling. Their computed distances are equal or differ by rounding. If these distances
//! determined the order, a ray would occasionally reach the floor from inside the glass, or miss
//! the floor. If two distances agree to rounding, these rules order the crossings:
//!
//! - First the ray leaves bodies, then it crosses open surfaces (rectangles, disks, open meshes),
//!   then it enters bodies. An open surface that touches a body thus lies just outside the body.
//! - If a ray enters two bodies at a common surface, it first enters the body with the lower
//!   number. If it leaves two bodies there, it first leaves the body with the higher number.
//! - If a ray leaves a shell of an object and enters another shell of it, it enters first: the
//!   object is the union of its shells.
//! - If two open surfaces coincide, the smaller one lies in front of the larger one, seen from the
//!   side that the smaller one faces. A light that is flush with a ceiling is thus visible.
//!
//! The rules order any two crossings, and a ray in the opposite direction crosses the surfaces in
//! reverse order. A ray that starts on one of several coincident surfaces therefore hits exactly
//! the surfaces that follow its start surface in this order.

use std::cmp::Ordering;

use glam::DVec3;

use super::hit::SurfaceId;
use super::primitive::{Candidate, Primitives};
use super::ray::Ray;
use super::world::Geometry;

/// The distance, in rounding errors of the coordinates, below which surfaces coincide.
const ROUNDINGS: f64 = 64.0;

#[derive(Debug, Clone, Copy)]
struct SurfaceCrossing {
    kind: CrossingKind,
    object: u32,
    primitive: u32,
    /// Between the ray and the surface normal.
    cos: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum CrossingKind {
    Exit,
    OpenSurface,
    Entry,
}

impl Primitives {
    /// Returns an upper bound of a position's rounding error in m before centring.
    pub(super) fn centre_rounding(&self) -> f64 {
        ROUNDINGS * f64::EPSILON * self.largest_centre_coordinate
    }

    /// Returns the distance in m below which two surfaces coincide at a point: a multiple of the
    /// rounding error of the coordinates there.
    fn tolerance(&self, point: DVec3, surfaces: [SurfaceId; 2]) -> f64 {
        let largest_coordinate_m =
            surfaces.into_iter().fold(point.abs().max_element(), |largest_coordinate_m, surface| {
                largest_coordinate_m.max(self.largest_coordinate(surface.primitive))
            });
        ROUNDINGS * f64::EPSILON * largest_coordinate_m + self.centre_rounding()
    }
}

impl Geometry {
    fn crossing(&self, surface: SurfaceId, cos: f64) -> SurfaceCrossing {
        let kind = match (self.primitives.is_closed(surface.primitive), cos > 0.0) {
            (false, _) => CrossingKind::OpenSurface,
            (true, true) => CrossingKind::Exit,
            (true, false) => CrossingKind::Entry,
        };
        SurfaceCrossing { kind, object: self.primitives.object(surface.primitive), primitive: surface.primitive, cos }
    }

    /// Returns true if both surfaces are triangles of one mesh, or of one shell.
    fn is_same_mesh(&self, a: SurfaceId, b: SurfaceId) -> bool {
        let mesh = self.primitives.mesh(a.primitive);
        mesh.is_some() && mesh == self.primitives.mesh(b.primitive)
    }

    /// Returns true if crossing `a` precedes crossing `b` where their surfaces coincide.
    fn is_before(&self, a: SurfaceCrossing, b: SurfaceCrossing) -> bool {
        let number = |crossing: SurfaceCrossing| (crossing.object, crossing.primitive);
        match (a.kind, b.kind) {
            (CrossingKind::Entry, CrossingKind::Entry) => number(a) < number(b),
            (CrossingKind::Exit, CrossingKind::Exit) => number(a) > number(b),
            (CrossingKind::OpenSurface, CrossingKind::OpenSurface) => {
                let size = |crossing: SurfaceCrossing| (self.area(crossing.object), number(crossing));
                match size(a).partial_cmp(&size(b)) {
                    Some(Ordering::Less) => a.cos < 0.0,
                    Some(Ordering::Greater) => b.cos >= 0.0,
                    Some(Ordering::Equal) | None => false,
                }
            }
            (CrossingKind::Exit, CrossingKind::Entry) | (CrossingKind::Entry, CrossingKind::Exit)
                if a.object == b.object =>
            {
                a.kind == CrossingKind::Entry
            }
            (CrossingKind::Exit | CrossingKind::OpenSurface | CrossingKind::Entry, _) => a.kind < b.kind,
        }
    }

    /// Returns true if a crossing with |t| below `coincidence_range_m` is valid for a ray from
    /// `from`.
    #[cold]
    pub(super) fn lies_beyond_start(&self, ray: &Ray, from: SurfaceId, candidate: &Candidate) -> bool {
        let other = candidate.surface;
        let primitives = &self.primitives;
        let cos = ray.direction.dot(primitives.normal(other, ray.origin));
        if (candidate.t * cos).abs() > primitives.tolerance(ray.origin, [from, other]) {
            return candidate.t > 0.0;
        }
        let start_cos = ray.direction.dot(primitives.normal(from, ray.origin));
        if self.is_same_mesh(from, other) {
            // Both triangles belong to one mesh. If the ray crosses both into the mesh or both out
            // of it, the second crossing repeats the first one and is not valid.
            return candidate.t > 0.0 && (cos > 0.0) != (start_cos > 0.0);
        }
        self.is_before(self.crossing(from, start_cos), self.crossing(other, cos))
    }

    /// Returns true if the ray crosses `first` before `second`, for distances that differ by less
    /// than `coincidence_range_m`.
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
        let (first_crossing, second_crossing) =
            (self.crossing(first.surface, cos), self.crossing(second.surface, other_cos));
        if self.is_same_mesh(first.surface, second.surface) && first.t != second.t {
            return first.t < second.t;
        }
        self.is_before(first_crossing, second_crossing)
    }
}
