//! The frame in which a surface with a shading normal scatters light.

use abbe_spectra::math::frame::Frame;
use glam::DVec3;

/// The frame of the shading normal n_s, folded at the surface.
///
/// The planes of n_s and of the geometric normal n_g bound two wedges: the directions above one
/// plane and below the other. In the frame of n_s alone, a part of the lobe lies below the surface,
/// and the directions of the other wedge receive nothing. The mirror that swaps both normals swaps
/// the wedges, so this frame maps each direction of a wedge to its mirror image. It is a map of the
/// sphere onto itself that preserves solid angles and the sides of the surface: sampling,
/// evaluation and density follow from one BSDF, which is reciprocal if the BSDF in the frame is,
/// and no energy is lost below the surface.
#[derive(Debug, Clone, Copy)]
pub struct ShadingFrame {
    axes: Frame,
    /// The unit normal of the mirror, or 0 if both normals are equal.
    mirror: DVec3,
    is_folded: bool,
}

impl ShadingFrame {
    /// Takes unit vectors on the same side of the surface.
    #[inline]
    pub fn new(shading_normal: DVec3, normal: DVec3) -> Self {
        let is_folded = shading_normal != normal;
        let mirror = if is_folded { (shading_normal - normal).normalize_or_zero() } else { DVec3::ZERO };
        Self { axes: Frame::new(shading_normal), mirror, is_folded }
    }

    /// Returns the shading normal.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.axes.normal()
    }

    /// Returns true if the shading normal differs from the geometric normal.
    #[inline]
    pub fn is_folded(&self) -> bool {
        self.is_folded
    }

    /// Returns the axes, for vectors in the surface. Use [`Self::to_local`] for directions of
    /// light.
    #[inline]
    pub fn axes(&self) -> &Frame {
        &self.axes
    }

    /// Returns a direction of light in this frame. Its third component is positive on the side of
    /// the surface to which the normals point.
    #[inline]
    pub fn to_local(&self, direction: DVec3) -> DVec3 {
        self.axes.to_local(self.fold(direction))
    }

    /// Returns the direction of light with these components: the inverse of [`Self::to_local`].
    #[inline]
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        self.fold(self.axes.to_world(local))
    }

    /// Replaces a direction in a wedge by its mirror image, which lies in the other wedge.
    #[inline(always)]
    fn fold(&self, direction: DVec3) -> DVec3 {
        if !self.is_folded {
            return direction;
        }
        let image = direction - 2.0 * direction.dot(self.mirror) * self.mirror;
        // The component of the image along n_s is that of the direction along n_g.
        if direction.dot(self.normal()) * image.dot(self.normal()) < 0.0 { image } else { direction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions() -> impl Iterator<Item = DVec3> {
        (0..2000).map(|i| {
            let (z, azimuth) = ((f64::from(i) + 0.5) / 1000.0 - 1.0, f64::from(i) * 2.4);
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * azimuth.cos(), r * azimuth.sin(), z)
        })
    }

    #[test]
    fn a_folded_frame_keeps_the_sides_of_the_surface() {
        for tilt in [1e-9_f64, 0.3, 1.2] {
            let frame = ShadingFrame::new(DVec3::new(tilt.sin(), 0.0, tilt.cos()), DVec3::Z);
            for direction in directions() {
                let local = frame.to_local(direction);
                assert!(local.z * direction.z >= 0.0, "{tilt}: {direction}");
                assert!((frame.to_world(local) - direction).length() < 1e-14, "{tilt}: {direction}");
            }
        }
    }

    /// The lobe of a diffuse surface has the same energy in a folded frame.
    #[test]
    fn a_folded_lobe_loses_no_energy() {
        let frame = ShadingFrame::new(DVec3::new(0.9_f64.sin(), 0.0, 0.9_f64.cos()), DVec3::Z);
        let above = directions().filter(|direction| direction.z > 0.0);
        let sum: f64 = above.map(|direction| frame.to_local(direction).z).sum();
        assert!((sum / 1000.0 - 0.5).abs() < 2e-3, "{sum}");
    }

    #[test]
    fn equal_normals_change_nothing() {
        let normal = DVec3::new(0.6, 0.0, 0.8);
        let (frame, plain) = (ShadingFrame::new(normal, normal), Frame::new(normal));
        assert!(!frame.is_folded());
        directions().for_each(|direction| assert_eq!(frame.to_local(direction), plain.to_local(direction)));
    }
}
