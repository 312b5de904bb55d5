//! Semi-apertures and field angles that a prescription lacks, from the rays that pass the stop.

use super::field::parallel_ray;
use super::prescription::{Lens, Prescription};
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay};
use crate::glass::lines;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{atan, sin_cos};
use std::f64::consts::TAU;

/// Wavelengths in nm of the rays that determine the semi-apertures.
const NM: [f64; 3] = [lines::F_NM, lines::D_NM, lines::C_NM];
/// Each divided by half of the field of view.
const FIELDS: [f64; 5] = [-1.0, -0.7, 0.0, 0.7, 1.0];
const RIM_RAYS: u32 = 16;

impl Prescription {
    /// Computes the missing semi-apertures, whose value is 0: the largest height at which a ray of
    /// the field that fills the entrance pupil crosses the surface. Returns an error if the size of
    /// the stop itself is missing, or if a ray misses a surface.
    pub(super) fn complete_apertures(&mut self) -> Result<()> {
        let missing: Vec<usize> =
            (0..self.surfaces.len()).filter(|i| self.surfaces[*i].semi_aperture_mm == 0.0).collect();
        if missing.is_empty() {
            return Ok(());
        }
        let lens = self.open_lens()?;
        let stop = lens.stop();
        let mut heights_mm = vec![0.0_f64; self.surfaces.len()];
        for (field, nm) in FIELDS.into_iter().flat_map(|field| NM.map(|nm| (field, nm))) {
            let angle_deg = field * self.half_field_deg.unwrap_or(0.0);
            for ray in rim_rays(&lens, angle_deg)? {
                let visit = |i: usize, point: glam::DVec3| heights_mm[i] = heights_mm[i].max(point.truncate().length());
                let traced = lens.at(nm).trace_through(ray, TraceDirection::ToSensor, ApertureCheck::Ignored, visit);
                traced.map_err(|_| {
                    let what = format!("the semi-diameters cannot be computed: a ray at {angle_deg}° misses a surface");
                    Error::input(what).expected("semi-diameters (DIAM), or a smaller field or aperture")
                })?;
            }
        }
        for i in missing {
            // The rim ray itself must pass in spite of rounding.
            let height_mm =
                if i == stop { lens.surfaces()[stop].semi_aperture_mm } else { heights_mm[i] * (1.0 + 1e-9) };
            self.surfaces[i].semi_aperture_mm = height_mm;
        }
        Ok(())
    }

    /// Sets the field of view from a distant object's image height; without focal length, an error.
    pub(super) fn set_field_of_image(&mut self, height_mm: f64) -> Result<()> {
        let focal_mm = self.open_lens()?.at(lines::D_NM).paraxial()?.efl_mm;
        self.half_field_deg = Some(atan((height_mm / focal_mm).abs()).to_degrees());
        Ok(())
    }

    /// Sets the field of view from the height and the distance of the object: the angle at which it
    /// appears from the entrance pupil. Returns an error if the object or the pupil is at infinity.
    pub(super) fn set_field_of_object(&mut self, height_mm: f64, object_mm: f64) -> Result<()> {
        let pupil = self.open_lens()?.at(lines::D_NM).paraxial()?.entrance_pupil;
        let distance_mm = object_mm + pupil.map_or(f64::INFINITY, |pupil| pupil.z_mm);
        if !(distance_mm.is_finite() && distance_mm > 0.0) {
            let what = "found fields as heights on an object without a finite distance";
            return Err(Error::input(what).expected("fields as angles (FTYP 0) or image heights (FTYP 2)"));
        }
        self.half_field_deg = Some(atan((height_mm / distance_mm).abs()).to_degrees());
        Ok(())
    }

    /// Returns the lens with the explicit stop, for rays that ignore all other apertures.
    fn open_lens(&self) -> Result<Lens> {
        let mut open = self.clone();
        for surface in &mut open.surfaces {
            // A small value, which the rays ignore, keeps neighbouring surfaces from crossing.
            surface.semi_aperture_mm = 1e-6 * surface.profile.curvature_per_mm.abs().recip().min(1.0);
            surface.obscuration_mm = 0.0;
        }
        if let Some((stop, true)) = self.stop.map(|stop| (stop, self.opening == super::ApertureSpec::Stop)) {
            let explicit = self.surfaces.get(stop).map_or(0.0, |surface| surface.semi_aperture_mm);
            if explicit == 0.0 {
                let what = "the size of the stop is not stated";
                let expected = "a semi-diameter of the stop (DIAM), an entrance pupil (ENPD) or an f-number (FNUM)";
                return Err(Error::input(what).expected(expected).on_path(format!("surfaces[{stop}]")));
            }
            open.surfaces[stop].semi_aperture_mm = explicit;
        }
        open.half_field_deg = None;
        Lens::new(open)
    }
}

/// Returns rays on the rim of the entrance pupil, and the chief ray, at a field angle.
fn rim_rays(lens: &Lens, angle_deg: f64) -> Result<Vec<LensRay>> {
    let d = lens.at(lines::D_NM);
    let chief = d.chief_ray(angle_deg)?;
    let radius_mm = d.paraxial()?.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
    // The bundle fills the pupil, which is perpendicular to the axis.
    let cosine = chief.direction.z;
    let rim = (0..RIM_RAYS).map(|i| TAU * f64::from(i) / f64::from(RIM_RAYS));
    let rim = rim.map(|angle| {
        let (sin, cos) = sin_cos(angle);
        parallel_ray(chief, radius_mm * cos, radius_mm * sin * cosine)
    });
    Ok(rim.chain([chief]).collect())
}
