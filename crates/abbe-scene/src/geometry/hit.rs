//! Surface points: ray hits and sampled points.

use super::shading_frame::ShadingFrame;
use glam::DVec3;

/// A face of a primitive: one smooth piece of surface. A ray that starts on a face carries its
/// identifier, so that rounding cannot make the ray hit the face again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SurfaceId {
    /// Index of the primitive: an analytic shape or a single triangle.
    pub primitive: u32,
    /// Face of the primitive. Sphere, rectangle, disk, triangle: 0. Box: −x, +x, −y, +y, −z, +z.
    /// Cylinder: side, top, bottom. Prism: right leg, left leg, base, −z, +z. Lens: front, back,
    /// edge.
    pub face: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray in m: 0 only if this surface touches that of the ray's start.
    pub t: f64,
    /// Position, projected onto the surface: only as inaccurate as its coordinates, for any `t`.
    pub position: DVec3,
    /// Geometric unit normal: outwards on closed shapes, to the side that a rectangle or a disk
    /// faces, and on meshes to the side from which the vertices appear counter-clockwise.
    pub normal: DVec3,
    /// Unit normal for shading on the side of `normal`, interpolated on a mesh with normals.
    pub shading_normal: DVec3,
    pub object: u32,
    pub surface: SurfaceId,
}

impl Hit {
    /// Returns the local frame in which the surface scatters light.
    #[inline]
    pub fn frame(&self) -> ShadingFrame {
        ShadingFrame::new(self.shading_normal, self.normal)
    }

    /// Returns true if `direction` points back to the side from which `incoming` arrived.
    #[inline]
    pub fn leads_back(&self, incoming: DVec3, direction: DVec3) -> bool {
        direction.dot(self.normal) * incoming.dot(self.normal) < 0.0
    }

    /// Returns the factor |cos θ_i||ω_o·n_g| / (|ω_i·n_g||cos θ_o|) on a photon's power for shading
    /// normals (Veach 1997, equation 5.19), where ω_i points to the light and ω_o to the camera,
    /// and the cosines are those in the frame.
    #[inline]
    pub fn adjoint_correction(&self, frame: &ShadingFrame, to_light: DVec3, to_camera: DVec3) -> f64 {
        if !frame.is_folded() {
            return 1.0;
        }
        let cosine = |direction| frame.to_local(direction).z;
        let denominator = to_light.dot(self.normal) * cosine(to_camera);
        if denominator == 0.0 { 0.0 } else { (cosine(to_light) * to_camera.dot(self.normal) / denominator).abs() }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSample {
    /// Position relative to the scene's centre, in m.
    pub position: DVec3,
    /// Geometric unit normal, on the same side as that of a [`Hit`] at this point.
    pub normal: DVec3,
    pub surface: SurfaceId,
    /// Probability density, per m², with which `sample_area` samples this point.
    pub pdf_area: f64,
}
