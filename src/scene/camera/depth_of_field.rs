//! What a lens keeps sharp, by geometrical optics.
//!
//! A point at distance u spreads, on the plane in focus at u_f, over a disk of 2R·|u − u_f|/u, R being the opening's radius; sharp is what
//! spreads over less than a pixel there.

use super::{Aperture, Camera};

/// What an open lens keeps sharp. Distances are in m along the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthOfField {
    /// The plane in focus.
    pub focus_m: f64,
    /// From here on the blur is less than a pixel.
    pub near_m: f64,
    /// Up to here; infinite from the hyperfocal distance on.
    pub far_m: f64,
    /// Focused here, everything beyond half of it is sharp.
    pub hyperfocal_m: f64,
    /// Over how many pixels a point at infinity spreads.
    pub blur_at_infinity_px: f64,
}

impl DepthOfField {
    /// Of a camera with an open lens; `None` for a pinhole, to which everything is sharp.
    pub fn of(camera: &Camera) -> Option<Self> {
        let (radius_m, focus_m) = match camera.aperture() {
            Aperture::Pinhole => return None,
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
    use crate::scene::camera::Stop;
    use glam::DVec3;

    fn camera(radius_m: f64, focus_m: f64) -> Camera {
        let aperture = Aperture::ThinLens { stop: Stop { radius_m, blades: None }, focus_m };
        Camera::new(DVec3::ZERO, (DVec3::NEG_Z, DVec3::Y), 0.25, (100, 100), aperture)
    }

    #[test]
    fn the_blur_at_the_limits_is_a_pixel() {
        let camera = camera(0.1, 2.0);
        let depth = DepthOfField::of(&camera).unwrap();
        let blur_px = |u: f64| 2.0 * 0.1 * (u - 2.0).abs() / u / (2.0 * camera.pixel_angle());
        assert!((blur_px(depth.near_m) - 1.0).abs() < 1e-12 && (blur_px(depth.far_m) - 1.0).abs() < 1e-12);
        assert!((blur_px(1e12) - depth.blur_at_infinity_px).abs() < 1e-9);
    }

    #[test]
    fn focused_at_the_hyperfocal_distance_all_is_sharp_from_half_of_it() {
        let hyperfocal = DepthOfField::of(&camera(0.1, 2.0)).unwrap().hyperfocal_m;
        let depth = DepthOfField::of(&camera(0.1, hyperfocal)).unwrap();
        assert!((depth.near_m - 0.5 * hyperfocal).abs() < 1e-9 && depth.far_m > 1e9, "{depth:?}");
    }
}
