//! The modulation transfer function (MTF) and the ray fans of a lens.
//!
//! The MTF is the geometric MTF of the rays of the F, d and C lines, with equal weights, times the
//! MTF of a perfect lens with the same f-number, so that it never exceeds the limit of diffraction.
//! Source: Smith, *Modern Optical Engineering*, §11.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::analysis::{LINES, LensAnalysis, no_light};
use super::field::parallel_ray;
use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay, MonochromaticLens};
use crate::glass::lines;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::acos;
use abbe_spectra::math::rotation::unit_vector;

/// The spatial frequencies of the MTF in cycles/mm.
pub const FREQUENCIES_PER_MM: [f64; 4] = [10.0, 20.0, 40.0, 80.0];

/// The heights of the rays of a fan in the entrance pupil, divided by the radius of the pupil.
pub const FAN_PUPIL: [f64; 9] = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];

/// The MTF at one spatial frequency.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct MtfPoint {
    /// Spatial frequency on the sensor in cycles/mm.
    #[serde(rename = "cycles_per_mm")]
    pub per_mm: f64,
    /// Contrast of lines perpendicular to the meridional plane.
    pub tangential: f64,
    /// Contrast of lines parallel to the meridional plane.
    pub sagittal: f64,
    /// Contrast of a perfect lens with the same f-number, limited by diffraction.
    pub diffraction_limit: f64,
}

/// The ray fans of one spectral line: the transverse ray aberration in mm, from the chief ray of
/// the d line, for each coordinate of [`FAN_PUPIL`], or `None` if the ray is vignetted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayFan {
    /// Name of the line.
    pub line: &'static str,
    /// Aberration along y for rays in the meridional plane.
    pub tangential_mm: [Option<f64>; FAN_PUPIL.len()],
    /// Aberration along x for rays in the sagittal plane.
    pub sagittal_mm: [Option<f64>; FAN_PUPIL.len()],
}

/// The image quality at one field.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageQuality {
    /// Field angle in degrees.
    pub angle_deg: f64,
    /// The MTF at [`FREQUENCIES_PER_MM`].
    pub mtf: [MtfPoint; FREQUENCIES_PER_MM.len()],
    /// The ray fans of the lines F, d and C.
    pub fans: [RayFan; 3],
}

impl ImageQuality {
    /// Computes the image quality at the fields of an analysis, with the sensor at the focus of the
    /// d line for a distant object. Returns an error if no light passes at one of the fields.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Vec<Self>> {
        analysis.fields.iter().map(|field| Self::at(lens, analysis, field.angle_deg)).collect()
    }

    fn at(lens: &Lens, analysis: &LensAnalysis, angle_deg: f64) -> Result<Self> {
        let sensor_z_mm = lens.length_mm() + analysis.paraxial.bfd_mm;
        let at = LINES.map(|(_, nm)| lens.at(nm));
        let [_, d, _] = &at;
        let chief = d.chief_ray(angle_deg)?;
        let mut landed: Vec<DVec2> = Vec::new();
        for at in &at {
            landed.extend(at.landing_points(chief, sensor_z_mm)?);
        }
        if landed.is_empty() {
            return Err(no_light(angle_deg));
        }
        let f_number = analysis.paraxial.f_number.unwrap_or(f64::INFINITY);
        let mtf = FREQUENCIES_PER_MM.map(|per_mm| {
            let diffraction_limit = diffraction_limit(per_mm, f_number);
            let along = |axis: DVec2| diffraction_limit * contrast(&landed, axis * per_mm);
            MtfPoint { per_mm, tangential: along(DVec2::Y), sagittal: along(DVec2::X), diffraction_limit }
        });
        let end = d.trace(chief, TraceDirection::ToSensor, ApertureCheck::Ignored).map_err(|_| no_light(angle_deg))?;
        let reference = end.at_z(sensor_z_mm).truncate();
        let radius_mm = analysis.paraxial.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
        let fans = [0, 1, 2].map(|i| fan(&at[i], LINES[i].0, chief, radius_mm, sensor_z_mm, reference));
        Ok(Self { angle_deg, mtf, fans })
    }
}

/// Returns the modulus of the mean of exp(−2πi f·x) over the points.
fn contrast(landed: &[DVec2], frequency: DVec2) -> f64 {
    let sum = landed.iter().fold(DVec2::ZERO, |sum, point| sum + unit_vector(TAU * point.dot(frequency)));
    sum.length() / landed.len() as f64
}

/// Returns the MTF of a perfect lens with a round stop, for the d line and an object at infinity.
fn diffraction_limit(per_mm: f64, f_number: f64) -> f64 {
    let fraction = per_mm * lines::D_NM * 1e-6 * f_number;
    if fraction >= 1.0 { 0.0 } else { 2.0 / PI * (acos(fraction) - fraction * (1.0 - fraction * fraction).sqrt()) }
}

fn fan(
    at: &MonochromaticLens<'_>,
    line: &'static str,
    chief: LensRay,
    radius_mm: f64,
    sensor_z_mm: f64,
    reference: DVec2,
) -> RayFan {
    let aberration = |ray: LensRay| {
        let out = at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).ok()?;
        Some(out.at_z(sensor_z_mm).truncate() - reference)
    };
    // Just inside the rim, so that rounding does not block the outermost ray.
    let inside_mm = radius_mm * (1.0 - 1e-9);
    // The pupil is perpendicular to the axis, and the offset is perpendicular to the chief ray.
    let up = |p: f64| aberration(parallel_ray(chief, 0.0, p * inside_mm * chief.direction.z));
    let aside = |p: f64| aberration(parallel_ray(chief, p * inside_mm, 0.0));
    RayFan {
        line,
        tangential_mm: FAN_PUPIL.map(|p| up(p).map(|aberration| aberration.y)),
        sagittal_mm: FAN_PUPIL.map(|p| aside(p).map(|aberration| aberration.x)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::catalogue;

    /// For a uniform line of length L it is |sinc(L f)|, for points d apart |cos(π d f)|.
    #[test]
    fn the_contrast_of_known_point_sets_is_exact() {
        let pair = [DVec2::new(0.0, 0.01), DVec2::new(0.0, -0.01)];
        assert!((contrast(&pair, DVec2::Y * 10.0) - (PI * 0.02 * 10.0).cos()).abs() < 1e-12);
        assert!((contrast(&pair, DVec2::X * 10.0) - 1.0).abs() < 1e-12);
        let line: Vec<DVec2> = (0..1000).map(|i| DVec2::new((f64::from(i) + 0.5) / 1e5, 3.0)).collect();
        let x = PI * 0.01 * 80.0;
        assert!((contrast(&line, DVec2::X * 80.0) - x.sin() / x).abs() < 1e-5);
    }

    #[test]
    fn a_perfect_lens_loses_all_contrast_at_the_cutoff() {
        // The cutoff of f/10 at the d line is 1/(587.56 nm · 10) = 170.2 cycles/mm.
        assert!((diffraction_limit(0.0, 10.0) - 1.0).abs() < 1e-12);
        assert!(diffraction_limit(170.1, 10.0) > 0.0 && diffraction_limit(170.3, 10.0) == 0.0);
        assert!((diffraction_limit(85.1, 10.0) - 0.391).abs() < 1e-3, "half the cutoff");
    }

    /// Stopping down raises contrast and shrinks the fans, odd and equal on the axis.
    #[test]
    fn the_quality_of_a_singlet_rises_when_it_is_stopped_down() {
        let open = catalogue::find("singlet").unwrap();
        let quality = |lens: &Lens| {
            let analysis = LensAnalysis::of(lens, Some(1.0)).unwrap();
            ImageQuality::of(lens, &analysis).unwrap().swap_remove(0)
        };
        let open_f = LensAnalysis::of(open, Some(1.0)).unwrap().paraxial.f_number.unwrap();
        let (wide, narrow) = (quality(open), quality(&open.stopped_down(4.0 * open_f).unwrap()));
        assert!(narrow.mtf[1].tangential > wide.mtf[1].tangential + 0.2, "{wide:?} {narrow:?}");
        for quality in [&wide, &narrow] {
            assert!(quality.mtf.iter().all(|it| it.tangential <= it.diffraction_limit));
            assert!((quality.mtf[0].tangential - quality.mtf[0].sagittal).abs() < 1e-9);
            let fan = quality.fans[1];
            for i in 0..FAN_PUPIL.len() {
                let (up, down) = (fan.tangential_mm[i].unwrap(), fan.tangential_mm[FAN_PUPIL.len() - 1 - i].unwrap());
                assert!((up + down).abs() < 1e-9 && (up - fan.sagittal_mm[i].unwrap()).abs() < 1e-9);
            }
        }
        let rim = |quality: &ImageQuality| quality.fans[1].tangential_mm[8].unwrap().abs();
        // Third-order spherical aberration grows as the cube of the aperture.
        assert!((rim(&wide) / rim(&narrow) / 64.0 - 1.0).abs() < 0.2, "{} {}", rim(&wide), rim(&narrow));
    }
}
