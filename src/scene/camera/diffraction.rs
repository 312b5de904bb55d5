//! How far a lens's opening spreads light by diffraction.

use super::{Aperture, Camera};
use crate::optics::aperture::Blades;

/// The wavelength in nm at which one number stands for all.
const GREEN_NM: f64 = 550.0;

/// The pattern that a lens's opening makes of a point in focus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diffraction {
    /// The opening's shape.
    pub blades: Option<Blades>,
    /// λN in pixels, for each nm of wavelength; N is the working f-number (image distance over the opening's diameter) of the circle around
    /// the opening.
    pub spread_px_per_nm: f64,
}

impl Diffraction {
    /// At a camera's opening, whether it is to be simulated or not; `None` for a pinhole, which is a mathematical point.
    pub fn of(camera: &Camera) -> Option<Self> {
        let (blades, per_metre) = match camera.aperture() {
            Aperture::Pinhole => return None,
            // λ over the diameter is an angle, and so is a pixel.
            Aperture::ThinLens { stop, .. } => (stop.blades, 0.5 / (stop.radius_m * camera.pixel_angle())),
            Aperture::System(system) => {
                let pixel_m = 1e-3 * system.image_mm() * camera.pixel_angle();
                (system.blades(), system.working_f_number() / pixel_m)
            }
        };
        per_metre.is_finite().then_some(Self { blades, spread_px_per_nm: 1e-9 * per_metre })
    }

    /// The diameter in pixels of the first dark ring around a point in green light, if the opening is round: 2.44 λN.
    pub fn airy_diameter_px(&self) -> f64 {
        2.44 * GREEN_NM * self.spread_px_per_nm
    }

    /// Whether it reaches beyond a pixel.
    pub fn matters(&self) -> bool {
        self.airy_diameter_px() > 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::camera::Stop;
    use glam::DVec3;

    #[test]
    fn the_airy_disk_of_a_photographic_lens_is_2_44_wavelengths_times_its_working_f_number() {
        // f = 50 mm at f/8, focused at 5 m; pixels of 4 µm.
        let (focal_m, focus_m, pixel_m) = (0.05, 5.0, 4e-6);
        let image_m = focal_m * focus_m / (focus_m - focal_m);
        let aperture = Aperture::ThinLens { stop: Stop { radius_m: focal_m / 16.0, blades: None }, focus_m };
        let camera = Camera::new(DVec3::ZERO, (DVec3::NEG_Z, DVec3::Y), 50.0 * pixel_m / image_m, (100, 100), aperture);
        let found = Diffraction::of(&camera).unwrap();
        let working = 8.0 * image_m / focal_m;
        assert!((found.airy_diameter_px() / (2.44 * 550e-9 * working / pixel_m) - 1.0).abs() < 1e-12);
        assert!(found.matters());
    }
}
