//! The size of the diffraction pattern of a lens's aperture.

use super::{Aperture, Camera};
use abbe_optics::aperture::Blades;
use abbe_spectra::spectrum::REFERENCE_NM;

/// The diffraction pattern of a point in focus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApertureDiffraction {
    /// `None` for a round aperture.
    pub blades: Option<Blades>,
    /// The scale λN of the pattern divided by the wavelength λ, in pixels per nm. N is the working
    /// f-number: the image distance divided by the diameter of the circle around the aperture.
    pub spread_px_per_nm: f64,
}

impl ApertureDiffraction {
    /// Computes the pattern of a camera's aperture, whether or not the scene enables diffraction.
    /// `None` for pinhole and orthographic cameras, which have no lens.
    pub fn of(camera: &Camera) -> Option<Self> {
        let (blades, per_metre) = match camera.aperture() {
            Aperture::Pinhole | Aperture::Orthographic => return None,
            // Both λ divided by the diameter and the size of a pixel are angles.
            Aperture::ThinLens { stop, .. } => (stop.blades, 0.5 / (stop.radius_m * camera.pixel_angle())),
            Aperture::System(system) => {
                let pixel_m = 1e-3 * system.image_mm() * camera.pixel_angle();
                (system.blades(), system.working_f_number() / pixel_m)
            }
        };
        per_metre.is_finite().then_some(Self { blades, spread_px_per_nm: 1e-9 * per_metre })
    }

    /// The diameter 2.44 λN of the Airy disk of a round aperture at 550 nm, in pixels.
    pub fn airy_diameter_px(&self) -> f64 {
        2.44 * REFERENCE_NM * self.spread_px_per_nm
    }

    /// Returns true if the Airy disk at 550 nm is larger than a pixel.
    pub fn matters(&self) -> bool {
        self.airy_diameter_px() > 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::ApertureStop;
    use glam::DVec3;

    #[test]
    fn the_airy_disk_follows_from_the_working_f_number() {
        // A lens with f = 50 mm at f/8, focused at 5 m, and pixels of 4 µm.
        let (focal_m, focus_m, pixel_m) = (0.05, 5.0, 4e-6);
        let image_m = focal_m * focus_m / (focus_m - focal_m);
        let aperture = Aperture::ThinLens { stop: ApertureStop { radius_m: focal_m / 16.0, blades: None }, focus_m };
        let camera = Camera::new(DVec3::ZERO, (DVec3::NEG_Z, DVec3::Y), 50.0 * pixel_m / image_m, (100, 100), aperture);
        let found = ApertureDiffraction::of(&camera).unwrap();
        let working = 8.0 * image_m / focal_m;
        assert!((found.airy_diameter_px() / (2.44 * 550e-9 * working / pixel_m) - 1.0).abs() < 1e-12);
        assert!(found.matters());
    }
}
