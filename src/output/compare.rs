//! How far two pictures are apart.

use serde::Serialize;

use crate::colour::{RgbSpace, delta_e_2000, lab};
use crate::error::{Error, Result};
use crate::sensor::{Development, Picture, exposure};

/// A rectangle of pixels: columns from `x0` up to but not including `x1`, rows likewise, counted from the top left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub x0: usize,
    /// First row.
    pub y0: usize,
    /// The column after the last.
    pub x1: usize,
    /// The row after the last.
    pub y1: usize,
}

/// Which pixels count; without regions and without a mask all do.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Selection {
    /// A pixel counts if it is in any of these.
    pub regions: Vec<Region>,
    /// And only if it is true here, rows from the top.
    pub mask: Option<Vec<bool>>,
}

/// Colour differences over the pixels that count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DeltaE {
    /// Their mean.
    pub mean: f64,
    /// What 95 % of them do not exceed.
    pub p95: f64,
}

/// A test of the differences against their standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ZTest {
    /// The share of pixels with |z| < 1.96: 0.95 for pictures of the same scene with normal errors, a little less
    /// where the standard errors come from few replicates.
    pub share: f64,
    /// Pixels whose error both pictures know.
    pub pixels: usize,
}

/// A test of the error that A reports, noise and bias.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Covered {
    /// The share of pixels where B lies in A's 95 % interval, widened by B's own noise where that is known.
    pub share: f64,
    /// Pixels whose error A knows.
    pub pixels: usize,
}

/// How far a picture A is from a reference B, over the pixels that count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Mean over X, Y, Z and pixels of (a − b)² / (b² + 0.01 m²), m the channel's mean over all of B.
    pub relative_mse: f64,
    /// The same without the worst 2 % of the pixels.
    pub relative_mse_trimmed: f64,
    /// Root of the mean square difference of Y, cd/m².
    pub rmse: f64,
    /// Mean Y of A over mean Y of B.
    pub mean_ratio: f64,
    /// CIEDE2000 at B's automatic exposure, D65 white.
    pub delta_e_2000: DeltaE,
    /// Where both pictures hold their standard errors.
    pub z: Option<ZTest>,
    /// Where A holds its error.
    pub covered: Option<Covered>,
    /// Those whose error A does not know: no light reached them, or the file has no such layers.
    pub unknown_pixels: usize,
    /// Pixels that count.
    pub pixels: usize,
    /// Those of them where either picture is not finite; they are infinitely wrong.
    pub non_finite_pixels: usize,
}

/// The share of pixels that the trimmed error leaves out.
const TRIMMED: f64 = 0.02;

/// Compares a picture with a reference.
///
/// # Errors
/// The input's: different sizes, a region that is empty or reaches out of the picture, a selection without pixels.
pub fn compare(picture: &Picture, reference: &Picture, selection: &Selection) -> Result<Comparison> {
    let counted = selection.counted(picture, reference)?;
    let scale = Scale::of(reference);
    let errors: Vec<f64> = counted.iter().map(|&i| scale.relative_square(picture.xyz[i], reference.xyz[i])).collect();
    let count = counted.len() as f64;
    let squares: f64 = counted.iter().map(|&i| (picture.xyz[i][1] - reference.xyz[i][1]).powi(2)).sum();
    let mean_y = |of: &Picture| counted.iter().map(|&i| of.xyz[i][1]).sum::<f64>() / count;
    let finite = |of: &Picture, i: usize| of.xyz[i].iter().all(|value| value.is_finite());
    let differences = delta_e_map(picture, reference);
    Ok(Comparison {
        relative_mse: errors.iter().sum::<f64>() / count,
        relative_mse_trimmed: trimmed_mean(errors),
        rmse: (squares / count).sqrt(),
        mean_ratio: mean_y(picture) / mean_y(reference),
        delta_e_2000: delta_e(counted.iter().map(|&i| differences[i]).collect()),
        z: z_test(picture, reference, &counted),
        covered: covered(picture, reference, &counted),
        unknown_pixels: counted.iter().filter(|&&i| picture.error(i).is_none()).count(),
        pixels: counted.len(),
        non_finite_pixels: counted.iter().filter(|&&i| !(finite(picture, i) && finite(reference, i))).count(),
    })
}

impl Region {
    /// Whether a pixel lies within.
    pub fn contains(&self, x: usize, y: usize) -> bool {
        (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y)
    }

    fn check(&self, width: usize, height: usize) -> Result<()> {
        let Self { x0, y0, x1, y1 } = *self;
        if x0 < x1 && y0 < y1 && x1 <= width && y1 <= height {
            return Ok(());
        }
        let what = format!("the region {x0},{y0},{x1},{y1} in a picture of {width} × {height} pixels");
        Err(Error::input(what).expected(format!("x0 < x1 ≤ {width} and y0 < y1 ≤ {height}")))
    }
}

impl Selection {
    /// The numbers of the pixels that count.
    fn counted(&self, picture: &Picture, reference: &Picture) -> Result<Vec<usize>> {
        let (width, height) = (reference.width, reference.height);
        if (picture.width, picture.height) != (width, height) {
            let what = format!("pictures of {} × {} and {width} × {height} pixels", picture.width, picture.height);
            return Err(Error::input(what).expected("two pictures of the same size"));
        }
        self.regions.iter().try_for_each(|region| region.check(width, height))?;
        let counted: Vec<usize> = (0..width * height).filter(|&i| self.counts(i % width, i / width, width)).collect();
        if counted.is_empty() {
            return Err(Error::input("no pixel counts").expected("at least one pixel in the mask and the regions"));
        }
        Ok(counted)
    }

    /// Whether a pixel of a picture of this width counts.
    pub fn counts(&self, x: usize, y: usize, width: usize) -> bool {
        let in_region = self.regions.is_empty() || self.regions.iter().any(|region| region.contains(x, y));
        in_region && self.mask.as_ref().is_none_or(|mask| mask[y * width + x])
    }
}

/// The means of X, Y, Z over the whole reference, by which dark pixels are judged.
#[derive(Debug, Clone, Copy)]
pub struct Scale([f64; 3]);

impl Scale {
    /// That of a reference.
    pub fn of(reference: &Picture) -> Self {
        let count = reference.xyz.len() as f64;
        Self([0, 1, 2].map(|c| reference.xyz.iter().map(|xyz| xyz[c]).filter(|v| v.is_finite()).sum::<f64>() / count))
    }

    /// The mean over X, Y, Z of (a − b)² / (b² + 0.01 m²); infinite where a value is no number.
    pub fn relative_square(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let one = |c: usize| {
            let difference = (a[c] - b[c]).powi(2);
            let square = difference / self.unit(b[c], c).powi(2);
            // In a black channel of a black picture 0/0 is no difference, and anything else infinite.
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

    /// What a difference in channel `c` is relative to.
    pub fn unit(&self, reference: f64, c: usize) -> f64 {
        (reference.powi(2) + 0.01 * self.0[c].powi(2)).sqrt()
    }
}

/// The mean without the largest [`TRIMMED`] share (rounded down in number).
fn trimmed_mean(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let kept = values.len() - (values.len() as f64 * TRIMMED) as usize;
    values[..kept].iter().sum::<f64>() / kept as f64
}

/// CIEDE2000 of every pixel at the reference's automatic exposure, white being sRGB's at the luminance that is shown
/// as white.
pub(super) fn delta_e_map(picture: &Picture, reference: &Picture) -> Vec<f64> {
    let exposure = exposure::automatic(reference, &Development::default());
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

fn z_test(picture: &Picture, reference: &Picture, counted: &[usize]) -> Option<ZTest> {
    let (mut pixels, mut within) = (0_usize, 0_usize);
    for &i in counted {
        let (a, b) = (picture.noise[i], reference.noise[i]);
        if a < 0.0 || b < 0.0 {
            continue;
        }
        pixels += 1;
        let difference = (picture.xyz[i][1] - reference.xyz[i][1]).abs();
        let sigma = f64::from(a).hypot(f64::from(b));
        // Equal values without any error agree.
        within += usize::from(difference == 0.0 || difference < 1.96 * sigma);
    }
    (pixels > 0).then(|| ZTest { share: within as f64 / pixels as f64, pixels })
}

fn covered(picture: &Picture, reference: &Picture, counted: &[usize]) -> Option<Covered> {
    let (mut pixels, mut within) = (0_usize, 0_usize);
    for &i in counted {
        let Some(half) = picture.half_interval_95(i, f64::from(reference.noise[i].max(0.0))) else { continue };
        pixels += 1;
        within += usize::from((picture.xyz[i][1] - reference.xyz[i][1]).abs() <= half);
    }
    (pixels > 0).then(|| Covered { share: within as f64 / pixels as f64, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey picture of the same luminance everywhere.
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
    fn figures_of_a_known_difference() {
        // 10 % too bright everywhere: (0.1 b)² / (b² + 0.01 b²).
        let brighter = all(&grey(8, 8, 2.2), &grey(8, 8, 2.0));
        assert!((brighter.relative_mse - 0.01 / 1.01).abs() < 1e-12);
        assert!((brighter.relative_mse_trimmed - 0.01 / 1.01).abs() < 1e-12);
        assert!((brighter.rmse - 0.2).abs() < 1e-12);
        assert!((brighter.mean_ratio - 1.1).abs() < 1e-12);
        // Automatic exposure shows the grey as Y = 0.5: L* = 76.069 and, 10 % brighter, 79.071 (CIE 15); ΔE2000 is
        // their difference over S_L at the mean lightness (Sharma et al. 2005).
        let (low, high) = (116.0 * 0.5_f64.cbrt() - 16.0, 116.0 * 0.55_f64.cbrt() - 16.0);
        let offset = (0.5 * (low + high) - 50.0).powi(2);
        let known = (high - low) / (1.0 + 0.015 * offset / (20.0 + offset).sqrt());
        assert!((brighter.delta_e_2000.mean - known).abs() < 1e-9, "{brighter:?}");
        assert!((brighter.delta_e_2000.p95 - known).abs() < 1e-9);
    }

    #[test]
    fn the_trimmed_error_forgets_two_percent_of_the_pixels() {
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

    #[test]
    fn regions_and_mask_limit_what_counts_but_not_the_scale() {
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
        a.noise = vec![0.3, 0.3, -1.0, 0.0];
        b.noise = vec![0.4, 0.4, 0.4, 0.0];
        a.xyz[0][1] += 1.96 * 0.5 * 0.999;
        a.xyz[1][1] += 1.96 * 0.5 * 1.001;
        a.xyz[2][1] += 100.0;
        assert_eq!(all(&a, &b).z, Some(ZTest { share: 2.0 / 3.0, pixels: 3 }));
    }

    #[test]
    fn an_interval_is_of_noise_and_bias_and_unknown_pixels_have_none() {
        let (mut a, b) = (grey(2, 2, 1.0), grey(2, 2, 1.0));
        a.noise = vec![0.3, 0.3, -1.0, 0.0];
        a.bias = vec![0.4, 0.4, -1.0, 0.0];
        a.xyz[0][1] += (0.4 + 1.833 * 0.3) * 0.999;
        a.xyz[1][1] += (0.4 + 1.833 * 0.3) * 1.001;
        let found = all(&a, &b);
        assert_eq!((found.covered, found.unknown_pixels), (Some(Covered { share: 2.0 / 3.0, pixels: 3 }), 1));
        let known = Picture { noise: vec![0.1; 4], ..b };
        assert_eq!(all(&a, &known).covered, Some(Covered { share: 1.0, pixels: 3 }), "the reference is noisy too");
    }

    #[test]
    fn pixels_that_are_no_numbers_are_infinitely_wrong() {
        let reference = grey(3, 1, 1.0);
        let mut broken = reference.clone();
        broken.xyz[1][0] = f64::NAN;
        let found = all(&broken, &reference);
        assert_eq!((found.relative_mse, found.non_finite_pixels), (f64::INFINITY, 1));
        assert_eq!(all(&Picture::black(2, 2), &Picture::black(2, 2)).relative_mse, 0.0);
        assert_eq!(all(&grey(2, 2, 1.0), &Picture::black(2, 2)).relative_mse, f64::INFINITY);
    }
}
