//! The geometry of a whole scene, as its users see it.

use glam::DVec3;

use super::bvh::Bvh;
use super::hit::{Hit, SurfaceId};
use super::object::ObjectSurfaces;
use super::primitive::Primitives;
use abbe_spectra::math::frame::Frame;

/// All objects of a scene at one moment, in a bounding volume hierarchy.
#[derive(Debug, Clone)]
pub struct Geometry {
    pub(super) bvh: Bvh,
    pub(super) primitives: Primitives,
    pub(super) objects: ObjectSurfaces,
    /// Two crossings whose distances differ by more than this value never coincide, and neither
    /// does a crossing with a larger |t| with the surface on which the ray starts.
    pub(super) coincidence_range_m: f64,
}

impl Geometry {
    /// Returns the extreme coordinates in m of all surfaces, +∞ and −∞ for an empty scene.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bvh.bounds()
    }

    /// The radius in m of a ball about the origin around all surfaces, 1 if there are none.
    pub fn radius_m(&self) -> f64 {
        let (low, high) = self.bounds();
        let farthest_m = low.abs().max(high.abs()).length();
        // With the margin, all surfaces lie strictly inside the ball.
        if farthest_m.is_finite() { farthest_m * (1.0 + 1e-6) } else { 1.0 }
    }

    /// Returns the texture coordinates at a hit: in [0, 1] on analytic shapes, interpolated if a
    /// mesh has them, or else barycentric weights. [`Hit`] lacks them because few surfaces need
    /// them.
    pub fn uv(&self, hit: &Hit) -> [f64; 2] {
        self.uv_at(hit.surface, hit.position)
    }

    /// Returns the texture coordinates at a point of a surface; see [`Self::uv`].
    pub fn uv_at(&self, surface: SurfaceId, position: DVec3) -> [f64; 2] {
        self.primitives.uv(surface, position)
    }

    /// Returns the change of the texture coordinates from a hit by `offset` (m) along the surface.
    /// Where a face closes around an axis, the azimuth changes the shorter way.
    pub fn uv_step(&self, hit: &Hit, offset: DVec3) -> [f64; 2] {
        let (from, to) = (self.uv(hit), self.primitives.uv(hit.surface, hit.position + offset));
        let [u, v] = [to[0] - from[0], to[1] - from[1]];
        [if self.primitives.closes_around_axis(hit.surface) { u - u.round() } else { u }, v]
    }

    /// Returns the derivatives of the position by u and v in m, or `None` if undetermined.
    pub fn uv_tangents(&self, hit: &Hit) -> Option<[DVec3; 2]> {
        /// The length in m of the steps that measure how fast the texture coordinates vary.
        const PROBE_M: f64 = 1e-6;
        /// The change of the texture coordinates over which they are taken as linear.
        const CHANGE: f64 = 1e-4;
        let frame = Frame::new(hit.normal);
        let axes = [DVec3::X, DVec3::Y].map(|axis| frame.to_world(axis));
        let change = axes.map(|axis| self.uv_step(hit, PROBE_M * axis)).into_iter().flatten();
        let change = change.fold(0.0_f64, |largest, step| largest.max(step.abs()));
        let [x, y] = axes.map(|axis| axis * (PROBE_M * CHANGE / change));
        let ([xu, xv], [yu, yv]) = (self.uv_step(hit, x), self.uv_step(hit, y));
        let determinant = xu * yv - xv * yu;
        let tangents = [(yv * x - xv * y) / determinant, (xu * y - yu * x) / determinant];
        tangents.iter().all(|tangent| tangent.is_finite()).then_some(tangents)
    }

    pub fn is_empty(&self) -> bool {
        self.primitives.list.is_empty()
    }

    /// The number of analytic shapes and triangles.
    pub fn primitive_count(&self) -> usize {
        let instances = &self.primitives.instances;
        self.primitives.list.len() - instances.list.len() + instances.triangle_count()
    }

    pub fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes() + self.primitives.memory_bytes() + self.objects.memory_bytes()
    }
}
