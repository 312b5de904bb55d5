//! Surface points: ray hits and sampled points.

use glam::DVec3;

use abbe_spectra::math::frame::Frame;

/// A face of a primitive: one smooth piece of surface. If a ray starts on a surface, the identifier
/// of this surface is passed with the ray, so that rounding cannot make the ray hit the surface
/// again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SurfaceId {
    /// Index of the primitive: an analytic shape or a single triangle.
    pub primitive: u32,
    /// Face of the primitive. Sphere, rectangle, disk and triangle: 0. Box: −x, +x, −y, +y, −z, +z.
    /// Cylinder: side, top, bottom. Prism: right leg, left leg, base, −z, +z. Lens: front, back,
    /// edge.
    pub face: u32,
}

/// The intersection of a ray with a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray in m. The distance is 0 only if this surface touches the surface on
    /// which the ray starts.
    pub t: f64,
    /// Position, projected onto the surface. The error of the position is the rounding error of the
    /// coordinates, independent of `t`.
    pub position: DVec3,
    /// Geometric unit normal. On closed shapes, the normal points outwards. On rectangles and
    /// disks, it points to the side that the shape faces. On meshes, it points to the side from
    /// which the vertices appear counter-clockwise.
    pub normal: DVec3,
    /// Unit normal for shading, on the same side as `normal`. If a mesh has normals, this normal is
    /// interpolated from them. Otherwise it equals `normal`.
    pub shading_normal: DVec3,
    /// Number of the object.
    pub object: u32,
    /// The surface that was hit. A continued ray starts on this surface.
    pub surface: SurfaceId,
}

impl Hit {
    /// Returns the local frame in which light arriving along `incoming` is scattered. The frame
    /// uses the shading normal. If the shading normal and the geometric normal disagree about the
    /// side from which the light arrives, the frame uses the geometric normal. No light then leaks
    /// through the surface.
    #[inline]
    pub fn frame(&self, incoming: DVec3) -> Frame {
        let agree = incoming.dot(self.shading_normal) * incoming.dot(self.normal) > 0.0;
        Frame::new(if agree { self.shading_normal } else { self.normal })
    }

    /// Returns whether `direction` points back to the side from which a ray along `incoming`
    /// arrived.
    #[inline]
    pub fn leads_back(&self, incoming: DVec3, direction: DVec3) -> bool {
        direction.dot(self.normal) * incoming.dot(self.normal) < 0.0
    }

    /// Returns the factor that corrects a photon's power for shading normals (Veach 1997, equation
    /// 5.19). The factor is |ω_i·n_s||ω_o·n_g| / (|ω_i·n_g||ω_o·n_s|). The vector ω_i points
    /// towards the light, and ω_o points towards the camera.
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

/// A sampled point on the surface of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSample {
    /// Position relative to the scene's centre, in m.
    pub position: DVec3,
    /// Geometric unit normal. It points to the same side as the normal of a [`Hit`] at this point.
    pub normal: DVec3,
    /// The surface that contains the point.
    pub surface: SurfaceId,
    /// Probability density, per m², with which `sample_area` samples this point.
    pub pdf_area: f64,
}
