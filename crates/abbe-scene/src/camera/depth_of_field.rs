//! The depth of field of a lens, computed by geometrical optics.
//!
//! Let R be the radius of the aperture, and u_f the distance of the plane in focus. A point at
//! distance u is blurred to a disk whose diameter on the plane in focus is 2R·|u − u_f|/u. The
//! point is sharp if this diameter is less than a pixel.

use super::{Aperture, Camera};

/// The depth of field. All distances are in m along the optical axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthOfField {
    /// The distance of the plane in focus.
    pub focus_m: f64,
    pub near_m: f64,
    /// Infinite if the lens is focused at or beyond the hyperfocal distance.
    pub far_m: f64,
    /// If the lens is focused at this distance, everything from half of it to infinity is sharp.
    pub hyperfocal_m: f64,
    /// The diameter of the disk of a point at infinity, in pixels.
    pub blur_at_infinity_px: f64,
}

impl DepthOfField {
    /// Computes the depth of field, or `None` for pinhole and orthographic cameras.
    pub fn of(camera: &Camera) -> Option<Self> {
        let (radius_m, focus_m) = match camera.aperture() {
            Aperture::Pinhole | Aperture::Orthographic => return None,
            Aperture::ThinLens { stop, focus_m } => (stop.radius_m, *focus_m),
            Aperture::System(system) => (system.pupil_radius_m(), system.focus_m()),
        };
        let opening = 2.0 * radius_m;
        let pixel = camera.pixel_angle() * focus_m;
        (opening > 0.0).then(|| Self {
            focus_m,
            near_m: opening * focus_m / (opening + pixel),
            far_m: if opening > pixel { opening * focus_m / (opening - pixel) } else { f64::INFINITY },
            hyperfocal_m: opening / camera.pixel_angle(),
            blur_at_infinity_px: opening / pixel,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::ApertureStop;
    use glam::DVec3;

    fn camera(radius_m: f64, focus_m: f64) -> Camera {
        let aperture = Aperture::ThinLens { stop: ApertureStop { radius_m, blades: None }, focus_m };
        Camera::new(DVec3::ZERO, (DVec3::NEG_Z, DVec3::Y), 0.25, (100, 100), aperture)
    }

    #[test]
    fn the_blur_at_the_limits_is_one_pixel() {
        let camera = camera(0.1, 2.0);
        let depth = DepthOfField::of(&camera).unwrap();
        let blur_px = |u: f64| 2.0 * 0.1 * (u - 2.0).abs() / u / (2.0 * camera.pixel_angle());
        assert!((blur_px(depth.near_m) - 1.0).abs() < 1e-12 && (blur_px(depth.far_m) - 1.0).abs() < 1e-12);
        assert!((blur_px(1e12) - depth.blur_at_infinity_px).abs() < 1e-9);
    }

    #[test]
    fn hyperfocal_focus_is_sharp_from_half_the_distance_on() {
        let hyperfocal = DepthOfField::of(&camera(0.1, 2.0)).unwrap().hyperfocal_m;
        let depth = DepthOfField::of(&camera(0.1, hyperfocal)).unwrap();
        assert!((depth.near_m - 0.5 * hyperfocal).abs() < 1e-9 && depth.far_m > 1e9, "{depth:?}");
    }
}
