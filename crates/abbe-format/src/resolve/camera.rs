//! Translates the camera of the scene file to position, axes, field of view and aperture.

use super::context::Resolver;
use crate::{CameraFile, JsonPath, LensFile, LensTransmissionFile, SystemLensFile, ThinLensForm};
use abbe_optics::aperture::Blades;
use abbe_scene::camera::{
    Aperture, ApertureDiffraction, ApertureStop, Camera, LensReflections, SystemLens, look_at_axes,
};
use abbe_scene::motion::{AnimatedLookAt, LookAt};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{hypot, tan};
use glam::DVec3;
use std::sync::Arc;

impl Resolver<'_> {
    /// Resolves the motion of the camera, and the camera at the moment when the shutter opens.
    /// `size` is the film's width and height in pixels.
    pub(super) fn camera(
        &self,
        at: &JsonPath,
        file: &CameraFile,
        size: (u32, u32),
        centre: DVec3,
        notes: &mut Vec<String>,
    ) -> Result<(Camera, Option<AnimatedLookAt>)> {
        let CameraFile { from: _, at: _, up: _, lens, filter, shutter: _, motion: _ } = file;
        let lens_at = at.key("lens");
        let (half_height, aperture, diffracts) = match lens {
            LensFile::Pinhole { fov } => (tan(0.5 * fov.to_radians()), Aperture::Pinhole, false),
            LensFile::Orthographic { height } => (0.5 * height * self.metres, Aperture::Orthographic, false),
            LensFile::Thin(file) => {
                let at = lens_at.key("thin");
                let form = self.at(&at, file.form())?;
                let thin = self.thin_lens(form, blades(file.blades, file.rotation));
                let (tan_half_height, aperture) = self.at(&at, thin)?;
                (tan_half_height, aperture, file.diffraction)
            }
            LensFile::System(file) => {
                let at = lens_at.key("system");
                let system = self.system_lens(&at, file, size, notes)?;
                let tan_half_height = 0.5 * file.sensor_height_mm / system.image_mm();
                (tan_half_height, Aperture::System(Box::new(system)), file.diffraction)
            }
        };
        notes.extend(implausible_size(lens));
        let (LookAt { from, at: target, up }, motion) = self.camera_motion(file, centre);
        let origin = self.point(from.to_array(), centre);
        let mut camera = Camera::new(origin, look_at_axes(target - from, up), half_height, size, aperture);
        camera.diffracts = diffracts;
        let filter = filter.as_ref().map(|filter| self.filter(&at.key("filter"), filter)).transpose()?;
        camera.filter = filter.map(Arc::new);
        notes.extend(missed_diffraction(&camera));
        Ok((camera, motion))
    }

    fn system_lens(
        &self,
        at: &JsonPath,
        file: &SystemLensFile,
        size: (u32, u32),
        notes: &mut Vec<String>,
    ) -> Result<SystemLens> {
        let SystemLensFile { prescription, f_number, sensor_height_mm, transmission, coating, ghosts, .. } = file;
        let open = self.lens(&at.key("prescription"), prescription)?;
        let name = open.name().to_string();
        notes.extend(open.notes().iter().map(|note| format!("camera: {name}: {note}")));
        if file.diffraction && open.surfaces().iter().any(|surface| surface.obscuration_mm > 0.0) {
            let error = Error::input("diffraction at a lens with a central obscuration is not supported yet");
            return self.at(&at.key("diffraction"), Err(error));
        }
        let lens = if let Some(n) = f_number { self.at(&at.key("f_number"), open.stopped_down(*n))? } else { open };
        let half = 0.5 * sensor_height_mm;
        let sensor_radius_mm = hypot(half, half * f64::from(size.0) / f64::from(size.1));
        let lens = self.spectra().lens_coatings(&at.key("coating"), coating.as_ref(), lens)?;
        let reflections = match (ghosts, transmission) {
            (false, Some(LensTransmissionFile::Ideal)) if lens.is_coated() => {
                let what = "found \"ideal\", but the prescription has a coating";
                return Err(self.source.fault(&at.key("transmission"), what, "\"fresnel\", or no `transmission`"));
            }
            (true, _) => LensReflections::Ghosts,
            (false, Some(LensTransmissionFile::Fresnel)) => LensReflections::Lost,
            (false, None) if lens.is_coated() => LensReflections::Lost,
            (false, None | Some(LensTransmissionFile::Ideal)) => LensReflections::Absent,
        };
        let lens = lens.with_blades(blades(file.blades, file.rotation));
        let system = SystemLens::new(lens, file.focus_distance * self.metres, sensor_radius_mm);
        Ok(self.at(&at.key("focus_distance"), system)?.with_reflections(reflections))
    }

    /// The tangent of half the vertical field of view, and the aperture.
    fn thin_lens(&self, form: ThinLensForm, blades: Option<Blades>) -> Result<(f64, Aperture)> {
        let (tan_half_height, radius_m, focus_m) = match form {
            ThinLensForm::Photographic { focal_length_mm, f_number, focus_distance, sensor_height_mm } => {
                let (focal_m, focus_m) = (focal_length_mm * 1e-3, focus_distance * self.metres);
                if focus_m <= focal_m {
                    return Err(Error::input(format!("found a focus distance of {focus_m} m"))
                        .expected(format!("a distance above the focal length of {focal_m} m")));
                }
                // Thin lens: 1/f = 1/u + 1/v. The field of view follows from v, not from f.
                let image_m = focal_m * focus_m / (focus_m - focal_m);
                (0.5 * sensor_height_mm * 1e-3 / image_m, 0.5 * focal_m / f_number, focus_m)
            }
            ThinLensForm::Angular { fov, focus_distance, defocus_angle } => {
                let focus_m = focus_distance * self.metres;
                (tan(0.5 * fov.to_radians()), focus_m * tan(0.5 * defocus_angle.to_radians()), focus_m)
            }
        };
        Ok((tan_half_height, Aperture::ThinLens { stop: ApertureStop { radius_m, blades }, focus_m }))
    }
}

/// The blades of a polygonal aperture, or `None` for a round one.
fn blades(count: Option<u32>, rotation_deg: f64) -> Option<Blades> {
    count.map(|count| Blades { count, rotation: rotation_deg.to_radians() })
}

/// Returns a remark if diffraction that the scene does not enable would be visible.
fn missed_diffraction(camera: &Camera) -> Option<String> {
    let diffraction = ApertureDiffraction::of(camera).filter(|it| it.matters() && !camera.diffracts)?;
    let pixels = diffraction.airy_diameter_px();
    Some(format!(
        "camera: diffraction at the opening would spread a point over {pixels:.1} pixels; \"diffraction\": true of the lens simulates it"
    ))
}

/// Returns a remark about an aperture or a sensor of unusual size, which probably has a wrong unit.
fn implausible_size(lens: &LensFile) -> Option<String> {
    const OPENING_MM: std::ops::RangeInclusive<f64> = 0.05..=300.0;
    const SENSOR_MM: std::ops::RangeInclusive<f64> = 1.0..=300.0;
    let LensFile::Thin(file) = lens else { return None };
    let opening_mm = file.focal_length_mm.zip(file.f_number).map(|(focal_mm, f_number)| focal_mm / f_number);
    let odd = |what: &str, mm: Option<f64>, usual: std::ops::RangeInclusive<f64>| {
        let mm = mm.filter(|mm| !usual.contains(mm))?;
        Some(format!("camera: {what} of {mm} mm is unusual; most have {} to {} mm", usual.start(), usual.end()))
    };
    odd("an aperture diameter", opening_mm, OPENING_MM)
        .or_else(|| odd("a sensor height", file.sensor_height_mm, SENSOR_MM))
}
