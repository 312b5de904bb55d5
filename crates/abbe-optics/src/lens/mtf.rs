//! The modulation transfer function (MTF) against spatial frequency and through focus.
//!
//! The MTF is the geometric MTF of the rays of all wavelengths, with equal weights, times the MTF
//! of a perfect lens with the same f-number, so that it never exceeds the limit of diffraction.
//! Source: Smith, *Modern Optical Engineering*, §11.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::analysis::{FieldBundle, LensAnalysis};
use super::prescription::Lens;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::acos;
use abbe_spectra::math::rotation::unit_vector;

/// The spatial frequencies of the tables in cycles/mm.
pub const FREQUENCIES_PER_MM: [f64; 4] = [10.0, 20.0, 40.0, 80.0];

/// The MTF of one field along an axis of frequency or of focus.
#[derive(Debug, Clone, PartialEq)]
pub struct MtfCurve {
    /// Field angle in degrees.
    pub angle_deg: f64,
    /// Contrast of lines perpendicular to the meridional plane.
    pub tangential: Vec<f64>,
    /// Contrast of lines parallel to the meridional plane.
    pub sagittal: Vec<f64>,
}

/// The MTF on the sensor against spatial frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct MtfCurves {
    /// Spatial frequencies on the sensor in cycles/mm, from 0.
    pub per_mm: Vec<f64>,
    /// The contrast of a perfect lens with the same f-number at the reference wavelength.
    pub diffraction_limit: Vec<f64>,
    /// The fields of the analysis.
    pub fields: Vec<MtfCurve>,
}

/// The MTF at one spatial frequency against the position of the sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct ThroughFocusMtf {
    /// Spatial frequency in cycles/mm.
    pub per_mm: f64,
    /// Distances in mm from the sensor of the analysis, positive away from the lens.
    pub shifts_mm: Vec<f64>,
    /// The contrast of a perfect lens with the same f-number, in focus.
    pub diffraction_limit: f64,
    /// The fields of the analysis.
    pub fields: Vec<MtfCurve>,
}

/// The axis of frequency ends at the first of these values in cycles/mm at which no field has more
/// than this contrast.
const ENDS_PER_MM: [f64; 7] = [20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0];
const END_CONTRAST: f64 = 0.1;
const FREQUENCY_STEPS: u32 = 100;
/// The frequency through focus is the highest of the table at which the mean contrast of all fields
/// in the best focus reaches this value.
const FOCUS_CONTRAST: f64 = 0.3;
const FOCUS_STEPS: u32 = 80;

impl MtfCurves {
    /// Computes the MTF from 0 to a frequency that shows the fall of all curves. Returns an error
    /// if no light passes at one of the fields.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Self> {
        let bundles = bundles(lens, analysis)?;
        let fields: Vec<(f64, &FieldBundle)> = bundles.iter().map(|bundle| (bundle.angle_deg, bundle)).collect();
        Ok(Self::with_limit(
            &fields,
            |bundle, per_mm| contrasts(bundle, 0.0, per_mm),
            |per_mm| diffraction_limit(analysis, per_mm),
        ))
    }

    /// Multiplies the tangential and the sagittal contrast of fields with an angle by a limit, both
    /// at a frequency in cycles/mm.
    pub(super) fn with_limit<T>(
        fields: &[(f64, T)],
        contrasts: impl Fn(&T, f64) -> [f64; 2],
        limit: impl Fn(f64) -> f64,
    ) -> Self {
        let both = |field: &T, per_mm: f64| contrasts(field, per_mm).map(|contrast| limit(per_mm) * contrast);
        let highest = |per_mm: f64| fields.iter().flat_map(|(_, field)| both(field, per_mm)).fold(0.0, f64::max);
        let [.., last] = ENDS_PER_MM;
        let end = ENDS_PER_MM.into_iter().find(|end| highest(*end) <= END_CONTRAST).unwrap_or(last);
        let per_mm: Vec<f64> = (0..=FREQUENCY_STEPS).map(|i| end * f64::from(i) / f64::from(FREQUENCY_STEPS)).collect();
        let curve =
            |(angle_deg, field): &(f64, T)| MtfCurve::of(*angle_deg, per_mm.iter().map(|per_mm| both(field, *per_mm)));
        Self {
            fields: fields.iter().map(curve).collect(),
            diffraction_limit: per_mm.iter().map(|per_mm| limit(*per_mm)).collect(),
            per_mm,
        }
    }
}

impl ThroughFocusMtf {
    /// Computes the MTF on both sides of the sensor, far enough to include the best focus and the
    /// fall of the contrast. Returns an error if no light passes at one of the fields.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Self> {
        let bundles = bundles(lens, analysis)?;
        let best_mm = analysis.best_focus_shift_mm - analysis.focus_shift_mm;
        let mean = |per_mm: f64| {
            let both = bundles.iter().flat_map(|bundle| contrasts(bundle, best_mm, per_mm));
            diffraction_limit(analysis, per_mm) * both.sum::<f64>() / (2.0 * bundles.len() as f64)
        };
        let [least, ..] = FREQUENCIES_PER_MM;
        let per_mm = FREQUENCIES_PER_MM.into_iter().rev().find(|per_mm| mean(*per_mm) >= FOCUS_CONTRAST);
        let per_mm = per_mm.unwrap_or(least);
        // The contrast of a blur disc of the diameter d first vanishes at d = 1.22 / frequency.
        let f_number = analysis.paraxial.f_number.unwrap_or(1.0);
        let half_mm = 2.0 * f_number / per_mm + 1.2 * best_mm.abs();
        let step = |i: u32| (2.0 * f64::from(i) / f64::from(FOCUS_STEPS) - 1.0) * half_mm;
        let shifts_mm: Vec<f64> = (0..=FOCUS_STEPS).map(step).collect();
        let limit = diffraction_limit(analysis, per_mm);
        let curve = |bundle: &FieldBundle| {
            let points = shifts_mm.iter().map(|shift_mm| contrasts(bundle, *shift_mm, per_mm).map(|c| limit * c));
            MtfCurve::of(bundle.angle_deg, points)
        };
        Ok(Self { per_mm, fields: bundles.iter().map(curve).collect(), diffraction_limit: limit, shifts_mm })
    }
}

impl MtfCurve {
    fn of(angle_deg: f64, points: impl Iterator<Item = [f64; 2]>) -> Self {
        let (tangential, sagittal) = points.map(|[tangential, sagittal]| (tangential, sagittal)).unzip();
        Self { angle_deg, tangential, sagittal }
    }
}

/// Returns the bundles of the fields of an analysis on its sensor.
pub(super) fn bundles(lens: &Lens, analysis: &LensAnalysis) -> Result<Vec<FieldBundle>> {
    let (at, reference) = (analysis.at(lens), analysis.conditions.reference());
    let bundle = |angle_deg| FieldBundle::of(&at, reference, angle_deg, analysis.sensor_z_mm);
    analysis.fields.iter().map(|field| bundle(field.angle_deg)).collect()
}

/// Returns the tangential and the sagittal geometric contrast on a plane `shift_mm` behind the
/// sensor.
pub(super) fn contrasts(bundle: &FieldBundle, shift_mm: f64, per_mm: f64) -> [f64; 2] {
    [DVec2::Y, DVec2::X].map(|axis| contrast(bundle.points(shift_mm), axis * per_mm))
}

/// Returns the modulus of the mean of exp(−2πi f·x) over the points.
pub(super) fn contrast(points: impl Iterator<Item = DVec2>, frequency: DVec2) -> f64 {
    let add = |(sum, count): (DVec2, usize), point: DVec2| (sum + unit_vector(TAU * point.dot(frequency)), count + 1);
    let (sum, count) = points.fold((DVec2::ZERO, 0), add);
    sum.length() / count as f64
}

/// Returns the MTF of a perfect lens with a round stop and the f-number of the analysis, at the
/// reference wavelength, for an object at infinity.
pub(super) fn diffraction_limit(analysis: &LensAnalysis, per_mm: f64) -> f64 {
    let nm = analysis.conditions.lines()[analysis.conditions.reference()].nm;
    perfect_contrast(per_mm * nm * 1e-6 * analysis.paraxial.f_number.unwrap_or(f64::INFINITY))
}

/// Returns the MTF of a perfect lens at a fraction of its cutoff frequency.
pub(super) fn perfect_contrast(fraction: f64) -> f64 {
    if fraction >= 1.0 { 0.0 } else { 2.0 / PI * (acos(fraction) - fraction * (1.0 - fraction * fraction).sqrt()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glass::lines;
    use crate::lens::{AnalysisConditions, SensorFocus, catalogue};

    /// For a uniform line of length L it is |sinc(L f)|, for points d apart |cos(π d f)|.
    #[test]
    fn the_contrast_of_known_point_sets_is_exact() {
        let pair = [DVec2::new(0.0, 0.01), DVec2::new(0.0, -0.01)];
        assert!((contrast(pair.into_iter(), DVec2::Y * 10.0) - (PI * 0.02 * 10.0).cos()).abs() < 1e-12);
        assert!((contrast(pair.into_iter(), DVec2::X * 10.0) - 1.0).abs() < 1e-12);
        let line = (0..1000).map(|i| DVec2::new((f64::from(i) + 0.5) / 1e5, 3.0));
        let x = PI * 0.01 * 80.0;
        assert!((contrast(line, DVec2::X * 80.0) - x.sin() / x).abs() < 1e-5);
    }

    #[test]
    fn a_perfect_lens_loses_all_contrast_at_the_cutoff() {
        // The cutoff of f/10 at the d line is 1/(587.56 nm · 10) = 170.2 cycles/mm.
        let limit = |per_mm: f64| perfect_contrast(per_mm * lines::D_NM * 1e-6 * 10.0);
        assert!((limit(0.0) - 1.0).abs() < 1e-12);
        assert!(limit(170.1) > 0.0 && limit(170.3) == 0.0);
        assert!((limit(85.1) - 0.391).abs() < 1e-3, "half the cutoff");
    }

    #[test]
    fn the_curves_contain_the_values_of_the_table() {
        let lens = catalogue::find("double-gauss").unwrap();
        let analysis = LensAnalysis::of(lens, None).unwrap();
        let curves = MtfCurves::of(lens, &analysis).unwrap();
        let table = crate::lens::image_quality::ImageQuality::of(lens, &analysis).unwrap();
        assert_eq!((curves.fields.len(), curves.per_mm.len()), (3, 101));
        for (curve, quality) in curves.fields.iter().zip(&table) {
            assert_eq!((curve.tangential[0], curve.sagittal[0]), (1.0, 1.0));
            for point in &quality.mtf {
                let Some(i) = curves.per_mm.iter().position(|per_mm| *per_mm == point.per_mm) else { continue };
                assert_eq!((curve.tangential[i], curve.sagittal[i]), (point.tangential, point.sagittal));
            }
        }
        assert!(table[0].mtf.iter().any(|point| curves.per_mm.contains(&point.per_mm)));
    }

    /// The best focus of a whole field lies at the peak of the mean contrast through focus, within
    /// a part of the depth of focus.
    #[test]
    fn the_contrast_through_focus_peaks_at_the_best_focus() {
        let lens = catalogue::find("cooke").unwrap();
        let best = AnalysisConditions::default().with_focus(SensorFocus::Best);
        let analysis = LensAnalysis::under(lens, best).unwrap();
        let through = ThroughFocusMtf::of(lens, &analysis).unwrap();
        let mean = |i: usize| through.fields.iter().map(|it| it.tangential[i] + it.sagittal[i]).sum::<f64>();
        let count = through.shifts_mm.len();
        let peak = (0..count).max_by(|a, b| mean(*a).total_cmp(&mean(*b))).unwrap();
        let depth_mm = analysis.paraxial.f_number.unwrap() / through.per_mm;
        assert!(through.shifts_mm[peak].abs() < 0.5 * depth_mm, "{} {depth_mm}", through.shifts_mm[peak]);
        assert!(mean(0) < 0.5 * mean(peak) && mean(count - 1) < 0.5 * mean(peak));
    }
}
