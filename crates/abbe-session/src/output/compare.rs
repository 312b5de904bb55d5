//! Numerical comparison of two pictures.

use serde::Serialize;

use super::block_test;
use super::selection::Selection;
use abbe_spectra::colour::{RgbSpace, delta_e_2000, lab};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::{hypot, log2};
use abbe_transport::sensor::error_distribution::{TRIMMED, typical_squares};
use abbe_transport::sensor::{Picture, exposure};

/// Colour differences ΔE2000 over the selected pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DeltaE {
    pub mean: f64,
    pub p95: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ZTest {
    /// The fraction of pixels with |z| < 1.96, for the difference z in Y divided by its standard
    /// error. 0.95 are expected for the same scene and normally distributed errors, slightly fewer
    /// if the standard errors come from few replicates.
    #[serde(rename = "share")]
    pub fraction: f64,
    /// The probability that noise alone causes a block of 8 × 8 pixels with a difference as large
    /// as the largest one, by Student's t-test of each block with Šidák's correction.
    pub p: f64,
    /// The number of pixels whose standard error is known in both pictures.
    pub pixels: usize,
}

/// A test of the error that picture A reports. The error consists of noise and bias.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IntervalCoverage {
    /// The fraction of pixels where B lies in the 95 % interval of A, with the noise of B if known.
    #[serde(rename = "share")]
    pub fraction: f64,
    /// The number of pixels whose error is known in A.
    pub pixels: usize,
}

/// The difference between a picture A and a reference B over the selected pixels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The mean of (a − b)² / (b² + 0.01 m²) over the channels X, Y, Z and all selected pixels, for
    /// the values a of A and b of B, and the mean m of the channel over the whole reference.
    pub relative_mse: f64,
    /// The relative mean square error without the 2 % of the pixels that have the largest errors.
    pub relative_mse_trimmed: f64,
    /// The error of a typical pixel of A, if B is right: the root mean square of the relative
    /// differences of Y of all pixels except the worst 2 %. If B reports its own error, its part is
    /// subtracted. `abbe render` predicts this error.
    pub typical_error: f64,
    /// The same without the subtraction.
    pub typical_difference: f64,
    /// The root mean square difference of Y in cd/m².
    pub rmse: f64,
    /// The mean Y of A divided by the mean Y of B.
    pub mean_ratio: f64,
    /// CIEDE2000 between A and B, both with the exposure of the comparison. The white point is D65.
    pub delta_e_2000: DeltaE,
    /// The exposure of ΔE2000 and of the comparison page, in stops.
    pub exposure_ev: f64,
    /// The z test, if both pictures contain standard errors.
    pub z: Option<ZTest>,
    /// The test of the 95 % intervals of A, if A contains error layers.
    pub covered: Option<IntervalCoverage>,
    /// The pixels whose error is unknown in A, without light or without error layers.
    pub unknown_pixels: usize,
    pub pixels: usize,
    /// The selected pixels whose value is not finite in A or B, and whose error is infinite.
    pub non_finite_pixels: usize,
}

/// Compares at the automatic exposure of the reference; see [`compare_at`].
pub fn compare(picture: &Picture, reference: &Picture, selection: &Selection) -> Result<Comparison> {
    compare_at(picture, reference, selection, exposure::automatic(reference))
}

/// Compares a picture with a reference, with the colour differences at an exposure in 1/(cd/m²).
/// Returns an input error if the sizes differ, if a region is empty or extends beyond the picture,
/// or if no pixel is selected.
pub fn compare_at(picture: &Picture, reference: &Picture, selection: &Selection, exposure: f64) -> Result<Comparison> {
    let selected = selection.selected(picture, reference)?;
    let scale = ErrorScale::of(reference);
    let errors: Vec<f64> = selected.iter().map(|&i| scale.relative_square(picture.xyz[i], reference.xyz[i])).collect();
    let count = selected.len() as f64;
    let squares: f64 = selected.iter().map(|&i| (picture.xyz[i][1] - reference.xyz[i][1]).powi(2)).sum();
    let mean_y = |of: &Picture| selected.iter().map(|&i| of.xyz[i][1]).sum::<f64>() / count;
    let finite = |of: &Picture, i: usize| of.xyz[i].iter().all(|value| value.is_finite());
    let differences = delta_e_map(picture, reference, exposure);
    let typical = typical(picture, reference, &selected, &scale);
    Ok(Comparison {
        typical_error: (typical.square * (1.0 - typical.of_reference)).max(0.0).sqrt(),
        typical_difference: typical.square.sqrt(),
        relative_mse: errors.iter().sum::<f64>() / count,
        relative_mse_trimmed: trimmed_mean(errors),
        rmse: (squares / count).sqrt(),
        mean_ratio: mean_y(picture) / mean_y(reference),
        delta_e_2000: delta_e(selected.iter().map(|&i| differences[i]).collect()),
        exposure_ev: log2(exposure),
        z: z_test(picture, reference, &selected, block_test::probability(picture, reference, selection)),
        covered: covered(picture, reference, &selected),
        unknown_pixels: selected.iter().filter(|&&i| picture.error(i).is_none()).count(),
        pixels: selected.len(),
        non_finite_pixels: selected.iter().filter(|&&i| !(finite(picture, i) && finite(reference, i))).count(),
    })
}

/// The means of X, Y and Z over a reference. These means limit the relative error of dark pixels.
#[derive(Debug, Clone, Copy)]
pub struct ErrorScale([f64; 3]);

impl ErrorScale {
    pub fn of(reference: &Picture) -> Self {
        let count = reference.xyz.len() as f64;
        Self([0, 1, 2].map(|c| reference.xyz.iter().map(|xyz| xyz[c]).filter(|v| v.is_finite()).sum::<f64>() / count))
    }

    /// Returns the mean over X, Y, Z of (a − b)² / (b² + 0.01 m²), or infinity for NaN.
    pub fn relative_square(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let one = |c: usize| {
            let difference = (a[c] - b[c]).powi(2);
            let square = difference / self.unit(b[c], c).powi(2);
            // A channel that is black in the whole reference has unit 0. Equal values give 0/0 and
            // count as no difference; any other difference is infinite.
            if difference == 0.0 {
                0.0
            } else if square.is_nan() {
                f64::INFINITY
            } else {
                square
            }
        };
        (one(0) + one(1) + one(2)) / 3.0
    }

    /// Returns the divisor for the relative difference in channel `c`.
    pub fn unit(&self, reference: f64, c: usize) -> f64 {
        (reference.powi(2) + 0.01 * self.0[c].powi(2)).sqrt()
    }
}

/// The typical difference of two pictures.
struct TypicalDifference {
    /// The mean square of the relative differences of Y, without the worst.
    square: f64,
    /// The fraction of it that is the error of the reference.
    of_reference: f64,
}

fn typical(picture: &Picture, reference: &Picture, selected: &[usize], scale: &ErrorScale) -> TypicalDifference {
    let part = |error: f64, unit: f64| if error == 0.0 { 0.0 } else { (error / unit).powi(2) };
    let square = |&i: &usize| {
        let (a, b) = (picture.xyz[i][1], reference.xyz[i][1]);
        let unit = scale.unit(b, 1);
        let square = part(a - b, unit);
        let reported = |of: &Picture| of.error(i).map_or(0.0, |error| part(error, unit));
        [if square.is_nan() { f64::INFINITY } else { square }, reported(picture), reported(reference)]
    };
    let squares = selected.iter().map(square).collect();
    let [square, of_picture, of_reference] = typical_squares(squares, |[square, ..]| *square).unwrap_or_default();
    // If A reports its error too, its part of the differences is known better than their size: the
    // worst differences, which are left out, belong to both pictures.
    let all = if of_picture > 0.0 { of_picture + of_reference } else { square };
    TypicalDifference { square, of_reference: if all > 0.0 { (of_reference / all).min(1.0) } else { 0.0 } }
}

/// Returns the mean without the fraction [`TRIMMED`] of largest values, rounded down in number.
fn trimmed_mean(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let kept = values.len() - (values.len() as f64 * TRIMMED) as usize;
    values[..kept].iter().sum::<f64>() / kept as f64
}

/// Returns CIEDE2000 for every pixel, with the luminances times `exposure` and a white point of the
/// chromaticity of D65 and the luminance 1.
pub fn delta_e_map(picture: &Picture, reference: &Picture, exposure: f64) -> Vec<f64> {
    let white = RgbSpace::Srgb.white();
    let seen = |xyz: &[f64; 3]| lab(xyz.map(|value| value * exposure), white);
    picture.xyz.iter().zip(&reference.xyz).map(|(a, b)| delta_e_2000(seen(a), seen(b))).collect()
}

fn delta_e(mut values: Vec<f64>) -> DeltaE {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.sort_by(f64::total_cmp);
    let rank = ((values.len() as f64 * 0.95).ceil() as usize).clamp(1, values.len());
    DeltaE { mean, p95: values[rank - 1] }
}

/// Tests the pixels. `p` is the result of the test of the blocks.
fn z_test(picture: &Picture, reference: &Picture, selected: &[usize], p: Option<f64>) -> Option<ZTest> {
    let (mut pixels, mut within) = (0_usize, 0_usize);
    for &i in selected {
        let Some((a, b)) = picture.noise[i].zip(reference.noise[i]) else { continue };
        pixels += 1;
        let difference = (picture.xyz[i][1] - reference.xyz[i][1]).abs();
        let sigma = hypot(f64::from(a), f64::from(b));
        // Two equal values agree even if both standard errors are 0.
        within += usize::from(difference == 0.0 || difference < 1.96 * sigma);
    }
    p.map(|p| ZTest { fraction: within as f64 / pixels as f64, p, pixels })
}

fn covered(picture: &Picture, reference: &Picture, selected: &[usize]) -> Option<IntervalCoverage> {
    let (mut pixels, mut within) = (0_usize, 0_usize);
    for &i in selected {
        let Some(half) = picture.half_interval_95(i, f64::from(reference.noise[i].unwrap_or(0.0))) else { continue };
        pixels += 1;
        within += usize::from((picture.xyz[i][1] - reference.xyz[i][1]).abs() <= half);
    }
    (pixels > 0).then(|| IntervalCoverage { fraction: within as f64 / pixels as f64, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::selection::Region;

    fn grey(width: usize, height: usize, y: f64) -> Picture {
        let mut picture = Picture::black(width, height);
        picture.xyz.fill(RgbSpace::Srgb.white().map(|value| value * y));
        picture
    }

    fn all(picture: &Picture, reference: &Picture) -> Comparison {
        compare(picture, reference, &Selection::default()).unwrap()
    }

    #[test]
    fn a_picture_does_not_differ_from_itself() {
        let same = all(&grey(4, 4, 3.0), &grey(4, 4, 3.0));
        assert_eq!((same.relative_mse, same.rmse, same.mean_ratio), (0.0, 0.0, 1.0));
        assert_eq!(same.delta_e_2000, DeltaE { mean: 0.0, p95: 0.0 });
        assert_eq!((same.z, same.pixels, same.non_finite_pixels), (None, 16, 0));
    }

    #[test]
    fn a_known_difference_has_the_expected_values() {
        // The picture is 10 % too bright everywhere: (0.1 b)² / (b² + 0.01 b²).
        let brighter = all(&grey(8, 8, 2.2), &grey(8, 8, 2.0));
        assert!((brighter.relative_mse - 0.01 / 1.01).abs() < 1e-12);
        assert!((brighter.relative_mse_trimmed - 0.01 / 1.01).abs() < 1e-12);
        assert!((brighter.rmse - 0.2).abs() < 1e-12);
        assert!((brighter.mean_ratio - 1.1).abs() < 1e-12);
        // The automatic exposure maps the grey of the reference to Y = 0.5 with L* = 76.069 (CIE
        // 15), and the grey that is 10 % brighter has L* = 79.041. ΔE2000 is their difference
        // divided by S_L at the mean lightness (Sharma et al. 2005).
        let (low, high) = (116.0 * 0.5_f64.cbrt() - 16.0, 116.0 * 0.55_f64.cbrt() - 16.0);
        let offset = (0.5 * (low + high) - 50.0).powi(2);
        let known = (high - low) / (1.0 + 0.015 * offset / (20.0 + offset).sqrt());
        assert!((brighter.delta_e_2000.mean - known).abs() < 1e-9, "{brighter:?}");
        assert!((brighter.delta_e_2000.p95 - known).abs() < 1e-9);
    }

    #[test]
    fn the_trimmed_error_ignores_two_percent_of_the_pixels() {
        let reference = grey(10, 10, 1.0);
        let mut fireflies = reference.clone();
        for i in [3, 77] {
            fireflies.xyz[i] = [1000.0; 3];
        }
        let two = all(&fireflies, &reference);
        assert!(two.relative_mse > 1e4 && two.relative_mse_trimmed == 0.0, "{two:?}");
        fireflies.xyz[50] = [1000.0; 3];
        assert!(all(&fireflies, &reference).relative_mse_trimmed > 1e3);
    }

    /// The noise of the reference is not an error of the picture.
    #[test]
    fn the_typical_error_is_that_of_the_picture_alone() {
        let reference = grey(20, 20, 1.0);
        let noisy = |sigma: f64, signs: fn(usize) -> bool| {
            let mut picture = reference.clone();
            (picture.noise, picture.bias) = (vec![Some(sigma as f32); 400], vec![Some(0.0); 400]);
            (0..400).for_each(|i| picture.xyz[i][1] *= 1.0 + if signs(i) { sigma } else { -sigma });
            picture
        };
        let picture = noisy(0.03, |i| i % 2 == 0);
        let unit = 1.01_f64.sqrt();
        let exact = all(&picture, &reference);
        assert!((exact.typical_error - 0.03 / unit).abs() < 1e-6 && exact.typical_difference == exact.typical_error);
        // The differences are ±0.01 and ±0.07.
        let found = all(&picture, &noisy(0.04, |i| i % 4 < 2));
        assert!((found.typical_difference / (0.0025_f64 / 1.01).sqrt() - 1.0).abs() < 0.1, "{found:?}");
        assert!((found.typical_error / (0.03 / unit) - 1.0).abs() < 0.1, "{found:?}");
        let same = all(&picture, &picture);
        assert_eq!((same.typical_error, same.typical_difference), (0.0, 0.0));
    }

    #[test]
    fn regions_and_mask_limit_the_pixels_but_not_the_scale() {
        let mut reference = grey(10, 10, 1.0);
        reference.xyz[0] = [0.0; 3];
        let mut picture = reference.clone();
        picture.xyz[0] = [0.5; 3];
        let corner = Region { x0: 0, y0: 0, x1: 1, y1: 2 };
        let selection = Selection { regions: vec![corner], mask: None };
        let found = compare(&picture, &reference, &selection).unwrap();
        assert_eq!(found.pixels, 2);
        let mean = |c: usize| 0.99 * RgbSpace::Srgb.white()[c];
        let known: f64 = (0..3).map(|c| 0.25 / (0.01 * mean(c).powi(2))).sum::<f64>() / 3.0 / 2.0;
        assert!((found.relative_mse / known - 1.0).abs() < 1e-12, "{found:?}");

        let mask = (0..100).map(|i| i > 0).collect();
        let masked = Selection { regions: vec![corner], mask: Some(mask) };
        assert_eq!(compare(&picture, &reference, &masked).unwrap().relative_mse, 0.0);
        let nothing = Selection { regions: Vec::new(), mask: Some(vec![false; 100]) };
        assert_eq!(compare(&picture, &reference, &nothing).unwrap_err().exit_status(), 2);
    }

    #[test]
    fn sizes_and_regions_must_fit() {
        let message = compare(&grey(4, 5, 1.0), &grey(5, 4, 1.0), &Selection::default()).unwrap_err().to_string();
        assert!(message.contains("4 × 5 and 5 × 4"), "{message}");
        for (x0, y0, x1, y1) in [(0, 0, 6, 1), (2, 0, 2, 1), (0, 3, 1, 2)] {
            let selection = Selection { regions: vec![Region { x0, y0, x1, y1 }], mask: None };
            assert!(compare(&grey(5, 4, 1.0), &grey(5, 4, 1.0), &selection).is_err());
        }
    }

    #[test]
    fn the_z_test_weighs_differences_by_both_errors() {
        let (mut a, mut b) = (grey(2, 2, 1.0), grey(2, 2, 1.0));
        a.noise = vec![Some(0.3), Some(0.3), None, Some(0.0)];
        b.noise = [0.4, 0.4, 0.4, 0.0].map(Some).to_vec();
        a.xyz[0][1] += 1.96 * 0.5 * 0.999;
        a.xyz[1][1] += 1.96 * 0.5 * 1.001;
        a.xyz[2][1] += 100.0;
        let z = all(&a, &b).z.unwrap();
        assert_eq!((z.fraction, z.pixels), (2.0 / 3.0, 3));
    }

    /// An interval includes noise and bias, and pixels with unknown errors have none.
    #[test]
    fn an_interval_combines_noise_and_bias() {
        let (mut a, b) = (grey(2, 2, 1.0), grey(2, 2, 1.0));
        a.noise = vec![Some(0.3), Some(0.3), None, Some(0.0)];
        a.bias = vec![Some(0.4), Some(0.4), None, Some(0.0)];
        a.xyz[0][1] += (0.4 + 1.833 * 0.3) * 0.999;
        a.xyz[1][1] += (0.4 + 1.833 * 0.3) * 1.001;
        let found = all(&a, &b);
        assert_eq!(
            (found.covered, found.unknown_pixels),
            (Some(IntervalCoverage { fraction: 2.0 / 3.0, pixels: 3 }), 1)
        );
        let known = Picture { noise: vec![Some(0.1); 4], ..b };
        assert_eq!(
            all(&a, &known).covered,
            Some(IntervalCoverage { fraction: 1.0, pixels: 3 }),
            "the reference is noisy too"
        );
    }

    #[test]
    fn nan_pixels_have_an_infinite_error() {
        let reference = grey(3, 1, 1.0);
        let mut broken = reference.clone();
        broken.xyz[1][0] = f64::NAN;
        let found = all(&broken, &reference);
        assert_eq!((found.relative_mse, found.non_finite_pixels), (f64::INFINITY, 1));
        assert_eq!(all(&Picture::black(2, 2), &Picture::black(2, 2)).relative_mse, 0.0);
        assert_eq!(all(&grey(2, 2, 1.0), &Picture::black(2, 2)).relative_mse, f64::INFINITY);
    }
}
