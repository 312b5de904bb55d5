//! The figures of the image quality for tables: the modulation transfer function (MTF) at some
//! frequencies, and the ray fans at some heights in the pupil.

use std::borrow::Cow;

use super::analysis::{FieldBundle, LensAnalysis};
use super::mtf::{FREQUENCIES_PER_MM, bundles, contrasts, diffraction_limit};
use super::prescription::Lens;
use super::ray_fans::{FanBench, FanPlane};
use abbe_spectra::error::Result;

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

/// The ray fans of one wavelength: the transverse ray aberration in mm, from the chief ray of the
/// reference wavelength, for each coordinate of [`FAN_PUPIL`], or `None` if the ray is vignetted.
#[derive(Debug, Clone, PartialEq)]
pub struct RayFan {
    /// Name of the spectral line, or the wavelength in nm as text.
    pub line: Cow<'static, str>,
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
    /// The ray fans of the wavelengths of the analysis.
    pub fans: Vec<RayFan>,
}

impl ImageQuality {
    /// Computes the image quality at the fields of an analysis, on its sensor. Returns an error if
    /// no light passes at one of the fields.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Vec<Self>> {
        bundles(lens, analysis)?.iter().map(|bundle| Self::at(lens, analysis, bundle)).collect()
    }

    fn at(lens: &Lens, analysis: &LensAnalysis, bundle: &FieldBundle) -> Result<Self> {
        let mtf = FREQUENCIES_PER_MM.map(|per_mm| {
            let diffraction_limit = diffraction_limit(analysis, per_mm);
            let [tangential, sagittal] = contrasts(bundle, 0.0, per_mm).map(|contrast| diffraction_limit * contrast);
            MtfPoint { per_mm, tangential, sagittal, diffraction_limit }
        });
        let bench = FanBench::of(lens, analysis, bundle.angle_deg)?;
        let fan = |(i, line): (usize, &super::AnalysisLine)| RayFan {
            line: line.name.clone(),
            tangential_mm: FAN_PUPIL.map(|p| bench.aberration_mm(i, FanPlane::Tangential, p)),
            sagittal_mm: FAN_PUPIL.map(|p| bench.aberration_mm(i, FanPlane::Sagittal, p)),
        };
        let fans = analysis.conditions.lines().iter().enumerate().map(fan).collect();
        Ok(Self { angle_deg: bundle.angle_deg, mtf, fans })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::catalogue;

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
            let fan = &quality.fans[1];
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
