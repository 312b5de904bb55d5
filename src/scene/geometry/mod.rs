//! Everything that stands in the scene, in the world: where does a ray meet it next, what is there, and how is a
//! point on a light drawn.
//!
//! All positions are double precision, relative to a centre that the caller chooses (DESIGN: numbers near 0 keep
//! their digits wherever the scene stands). No test uses a fixed epsilon: a ray says on which face it starts
//! ([`SurfaceId`]), and that face's crossing at t = 0 is left out by construction; a convex body is left by another
//! face than it was entered by; and surfaces that touch (a prism standing on a floor, cemented faces) are passed
//! in one fixed order, see `coincidence`. Scaling the whole scene therefore changes nothing.

mod build;
mod coincidence;
mod enclosure;
mod object;
mod primitive;
mod sample;
mod spherical_rectangle;
mod trace;

use crate::math::frame::Frame;
use glam::DVec3;

use super::bvh::Tree;
use object::Objects;
use primitive::Primitives;

/// A ray: where it starts and where it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start, relative to the scene's centre, in m.
    pub origin: DVec3,
    /// Unit vector along which it travels.
    pub direction: DVec3,
}

impl Ray {
    /// A ray from `origin` along the unit vector `direction`.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction }
    }

    /// The point at distance t.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// One smooth piece of surface: a face of a primitive. A ray that starts on a surface carries it, so that rounding
/// cannot make it meet that surface again at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SurfaceId {
    /// The primitive: an analytic shape or a single triangle.
    pub primitive: u32,
    /// Its face: sphere, rectangle and disk 0; box −x +x −y +y −z +z; cylinder side, top, bottom; prism right leg,
    /// left leg, base, −z, +z; lens front, back, edge; triangle 0.
    pub face: u32,
}

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray in m; 0 only where the ray starts on a surface that this one touches.
    pub t: f64,
    /// The point, snapped to the surface (its error is that of rounding, whatever t is).
    pub position: DVec3,
    /// Geometric unit normal: outwards on closed shapes, the facing side of rectangles and disks, on meshes by
    /// the winding.
    pub normal: DVec3,
    /// Unit normal for shading: interpolated on meshes with normals, on the same side as `normal`.
    pub shading_normal: DVec3,
    /// The object it belongs to.
    pub object: u32,
    /// Where it is; a ray that goes on from here starts with it.
    pub surface: SurfaceId,
}

impl Hit {
    /// The frame in which the surface scatters what comes along `incoming`: of the shading normal, unless that is seen from the wrong side,
    /// where it would let light through.
    #[inline]
    pub fn frame(&self, incoming: DVec3) -> Frame {
        let agree = incoming.dot(self.shading_normal) * incoming.dot(self.normal) > 0.0;
        Frame::new(if agree { self.shading_normal } else { self.normal })
    }

    /// Whether `direction` leads back to the side from which a ray along `incoming` came.
    #[inline]
    pub fn leads_back(&self, incoming: DVec3, direction: DVec3) -> bool {
        direction.dot(self.normal) * incoming.dot(self.normal) < 0.0
    }

    /// The correction of a photon's power where the frame is not that of the true normal (Veach 1997, eq. 5.19):
    /// |ω_i·n_s||ω_o·n_g| / (|ω_i·n_g||ω_o·n_s|), ω_i towards the light, ω_o towards the camera.
    #[inline]
    pub fn adjoint_correction(&self, frame: &Frame, to_light: DVec3, to_camera: DVec3) -> f64 {
        let (n_s, n_g) = (frame.normal(), self.normal);
        if n_s == n_g {
            return 1.0;
        }
        let denominator = to_light.dot(n_g) * to_camera.dot(n_s);
        if denominator == 0.0 { 0.0 } else { (to_light.dot(n_s) * to_camera.dot(n_g) / denominator).abs() }
    }
}

/// A point drawn on an object's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSample {
    /// The point, relative to the scene's centre, in m.
    pub position: DVec3,
    /// Geometric unit normal, the same convention as in [`Hit`].
    pub normal: DVec3,
    /// Where it is.
    pub surface: SurfaceId,
    /// Density with which `sample_area` draws the point, per m².
    pub pdf_area: f64,
}

/// All objects of a scene, frozen at one time, in a tree.
#[derive(Debug, Clone)]
pub struct Geometry {
    tree: Tree,
    primitives: Primitives,
    objects: Objects,
    /// Beyond this |t| two crossings, or a crossing and a ray's start, are apart for certain.
    near: f64,
}

impl Geometry {
    /// Least and largest coordinates, relative to the centre, in m. Of an empty scene the least are +∞.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.tree.bounds()
    }

    /// The radius of a ball around the origin that holds everything, in m; 1 of an empty scene.
    pub fn radius_m(&self) -> f64 {
        let (low, high) = self.bounds();
        let reach = low.abs().max(high.abs()).length();
        // A hair more, so that no surface touches it.
        if reach.is_finite() { reach * (1.0 + 1e-6) } else { 1.0 }
    }

    /// Texture coordinates where a ray hit; in [0, 1] on the analytic shapes, the mesh's own or barycentric weights on meshes.
    /// Worked out only for those who ask: most surfaces have no texture.
    pub fn uv(&self, hit: &Hit) -> [f64; 2] {
        self.primitives.uv(hit.surface, hit.position)
    }

    /// Whether there is nothing to hit.
    pub fn is_empty(&self) -> bool {
        self.primitives.list.is_empty()
    }

    /// How many primitives there are: analytic shapes and triangles.
    pub fn primitive_count(&self) -> usize {
        self.primitives.list.len()
    }

    /// Memory that the geometry holds, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.tree.memory_bytes() + self.primitives.memory_bytes() + self.objects.memory_bytes()
    }

    /// How many triangles without area were left out, to the rounding of their placed corners.
    pub fn dropped_triangles(&self) -> usize {
        self.primitives.dropped
    }
}

#[cfg(test)]
mod tests;
