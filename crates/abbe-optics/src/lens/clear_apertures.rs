//! Semi-apertures and field angles that a prescription lacks, from the rays that pass the stop.

use super::field::parallel_ray;
use super::prescription::{ApertureSpec, Lens, Prescription, crossing_mm};
use super::profile::{SurfaceProfile, TraceDirection};
use super::trace::{ApertureCheck, LensRay};
use crate::glass::lines;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{atan, sin_cos};
use glam::DVec3;
use std::f64::consts::TAU;

/// Wavelengths in nm of the rays that determine the semi-apertures.
const NM: [f64; 3] = [lines::F_NM, lines::D_NM, lines::C_NM];
/// Each divided by half of the field of view.
const FIELDS: [f64; 5] = [-1.0, -0.7, 0.0, 0.7, 1.0];
const RIM_RAYS: u32 = 16;
/// The height in mm of a ray that is nearly paraxial.
const NEAR_AXIS_MM: f64 = 1e-4;

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
        self.infer_stop()?;
        let lens = self.open_lens()?;
        let stop = lens.stop();
        let mut heights_mm = vec![0.0_f64; self.surfaces.len()];
        for (field, nm) in FIELDS.into_iter().flat_map(|field| NM.map(|nm| (field, nm))) {
            let angle_deg = field * self.half_field_deg.unwrap_or(0.0);
            for ray in rim_rays(&lens, angle_deg)? {
                let visit = |i: usize, point: DVec3| heights_mm[i] = heights_mm[i].max(point.truncate().length());
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

    /// Sets the size of a stop that has none: the widest bundle along the axis, by its paraxial
    /// heights, that all stated semi-apertures let pass. Adds a note.
    fn infer_stop(&mut self) -> Result<()> {
        let Some(stop) = self.stop.filter(|stop| self.surfaces.get(*stop).is_some_and(|s| s.semi_aperture_mm == 0.0))
        else {
            return Ok(());
        };
        if self.opening != ApertureSpec::Stop {
            return Ok(());
        }
        let lens = self.bare_lens()?;
        let ray = LensRay { origin: DVec3::new(0.0, NEAR_AXIS_MM, -1.0), direction: DVec3::Z };
        let mut heights_mm = vec![0.0_f64; self.surfaces.len()];
        let visit = |i: usize, point: DVec3| heights_mm[i] = point.y.abs();
        if lens.at(lines::D_NM).trace_through(ray, TraceDirection::ToSensor, ApertureCheck::Ignored, visit).is_err() {
            return Ok(());
        }
        let sizes =
            self.surfaces.iter().zip(&heights_mm).filter(|(s, height)| s.semi_aperture_mm > 0.0 && **height > 0.0);
        let scale = sizes.map(|(s, height)| s.semi_aperture_mm / height).fold(f64::INFINITY, f64::min);
        let semi_mm = scale * heights_mm[stop];
        if semi_mm > 0.0 && semi_mm.is_finite() {
            self.surfaces[stop].semi_aperture_mm = semi_mm;
            self.notes.push(format!(
                "the lens file does not state the size of the stop; the widest bundle along the axis that the other \
                 semi-diameters let pass gives it a semi-diameter of {semi_mm:.4} mm"
            ));
        }
        Ok(())
    }

    /// Reduces semi-apertures, except that of the stop, to where a surface ends or meets the next
    /// one. Returns the changed surfaces with their new semi-apertures in mm.
    pub(super) fn limit_apertures(&mut self) -> Vec<(usize, f64)> {
        let before: Vec<f64> = self.surfaces.iter().map(|surface| surface.semi_aperture_mm).collect();
        for surface in &mut self.surfaces {
            let SurfaceProfile { curvature_per_mm, conic, .. } = surface.profile;
            let edge_mm = 1.0 / (curvature_per_mm.abs() * (1.0 + conic).max(0.0).sqrt());
            surface.semi_aperture_mm = surface.semi_aperture_mm.min(edge_mm * (1.0 - 1e-9));
        }
        for i in 1..self.surfaces.len() {
            while let Some(crossing_mm) = crossing_mm(&self.surfaces[i - 1..=i]) {
                let [first, second] = [i - 1, i].map(|i| self.surfaces[i].semi_aperture_mm);
                let smaller = if first < second { i - 1 } else { i };
                // The heights of the search are 64ths, so the one before does not cross.
                let reduced_mm = crossing_mm - first.min(second) / 64.0;
                let useful = reduced_mm > 0.0 && reduced_mm < first.min(second) && Some(smaller) != self.stop;
                if !useful {
                    break;
                }
                self.surfaces[smaller].semi_aperture_mm = reduced_mm;
            }
        }
        let changed = self.surfaces.iter().zip(before).enumerate();
        changed
            .filter(|(_, (now, before))| now.semi_aperture_mm < *before)
            .map(|(i, (now, _))| (i, now.semi_aperture_mm))
            .collect()
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
        let explicit_stop = self.stop.filter(|_| self.opening == ApertureSpec::Stop);
        let Some(stop) = explicit_stop else { return self.bare_lens() };
        let explicit = self.surfaces.get(stop).map_or(0.0, |surface| surface.semi_aperture_mm);
        if explicit == 0.0 {
            let what = "the size of the stop is not stated";
            let expected = "a semi-diameter of the stop (DIAM), an entrance pupil (ENPD) or an f-number (FNUM)";
            return Err(Error::input(what).expected(expected).on_path(format!("surfaces[{stop}]")));
        }
        let mut open = self.bare();
        open.surfaces[stop].semi_aperture_mm = explicit;
        Lens::new(open)
    }

    /// Returns the lens with tiny semi-apertures, also that of an explicit stop.
    fn bare_lens(&self) -> Result<Lens> {
        Lens::new(self.bare())
    }

    fn bare(&self) -> Self {
        let mut open = self.clone();
        for surface in &mut open.surfaces {
            // A small value, which the rays ignore, keeps neighbouring surfaces from crossing.
            surface.semi_aperture_mm = 1e-6 * surface.profile.curvature_per_mm.abs().recip().min(1.0);
            surface.obscuration_mm = 0.0;
        }
        open.half_field_deg = None;
        open
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
