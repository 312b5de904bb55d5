//! A test of two pictures for differences that their noise does not explain.

use super::selection::Selection;
use abbe_spectra::math::elementary::{atan, exp_m1, hypot, ln_1p, sin_cos};
use abbe_transport::sensor::Picture;

/// The side of a block in pixels.
const BLOCK: usize = 8;

/// Returns the probability that the largest difference between the blocks of two pictures is at
/// least as large as measured, if both show the same scene without bias. `None` if no pixel's noise
/// is known in both pictures.
///
/// Each block of 8 × 8 pixels is tested with Student's t: the mean difference in Y, divided by the
/// mean standard error of the difference, an upper bound of the block's standard error for any
/// correlation between its pixels. Šidák's correction combines the blocks, so the result is too
/// large rather than too small.
pub(super) fn probability(picture: &Picture, reference: &Picture, selection: &Selection) -> Option<f64> {
    let (width, height) = (reference.width, reference.height);
    let corners = (0..height).step_by(BLOCK).flat_map(|y| (0..width).step_by(BLOCK).map(move |x| (x, y)));
    let tests = corners.filter_map(|(x0, y0)| {
        let (mut difference, mut sigma, mut pixels) = (0.0, 0.0, 0_usize);
        for y in y0..(y0 + BLOCK).min(height) {
            for x in x0..(x0 + BLOCK).min(width) {
                let i = y * width + x;
                let Some((a, b)) = picture.noise[i].zip(reference.noise[i]) else { continue };
                if selection.selects(x, y, width) {
                    difference += picture.xyz[i][1] - reference.xyz[i][1];
                    sigma += hypot(f64::from(a), f64::from(b));
                    pixels += 1;
                }
            }
        }
        (pixels > 0).then_some(if difference == 0.0 { 1.0 } else { two_sided_p(difference / sigma) })
    });
    let (least, count) = tests.fold((1.0_f64, 0), |(least, count), p| (least.min(p), count + 1));
    // Šidák: 1 − (1 − p)ⁿ, without cancellation for small p.
    (count > 0).then(|| -exp_m1(f64::from(count) * ln_1p(-least)))
}

/// Returns the probability that Student's t with 9 degrees of freedom, those of a pixel's noise, is
/// at least |t| on either side (the closed form for odd numbers in Abramowitz and Stegun, 26.7.3),
/// or 0 for NaN.
fn two_sided_p(t: f64) -> f64 {
    if t.is_nan() {
        return 0.0;
    }
    let angle = atan(t.abs() / 3.0);
    let (sin, cos) = sin_cos(angle);
    let square = cos * cos;
    let series = cos * (1.0 + square * (2.0 / 3.0 + square * (8.0 / 15.0 + square * 48.0 / 105.0)));
    (1.0 - 2.0 / std::f64::consts::PI * (angle + sin * series)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::hash64;

    #[test]
    fn student_s_t_has_the_tabulated_quantiles() {
        for (t, p) in [(0.0, 1.0), (1.833_113, 0.1), (2.262_157, 0.05), (3.249_836, 0.01), (4.780_913, 0.001)] {
            assert!((two_sided_p(t) - p).abs() < 1e-6 && (two_sided_p(-t) - p).abs() < 1e-6, "{t}");
        }
    }

    /// Returns a 32 × 32 picture of luminance 1 with Gaussian noise of standard error 0.03, which
    /// all pixels of a cell of `cell` × `cell` pixels share.
    fn noisy(seed: u64, cell: usize) -> Picture {
        let mut picture = Picture::black(32, 32);
        picture.noise.fill(Some(0.03));
        for i in 0..32 * 32 {
            let place = (i / 32 / cell * 32 + i % 32 / cell) as u64;
            let uniform = |k: u64| hash64([seed, place, k]) as f64 / u64::MAX as f64;
            let normal = (0..12).map(uniform).sum::<f64>() - 6.0;
            picture.xyz[i] = [1.0 + 0.03 * normal; 3];
        }
        picture
    }

    #[test]
    fn noise_is_not_a_difference_even_if_it_is_correlated() {
        for cell in [1, 8] {
            let p = |seed: u64| probability(&noisy(2 * seed, cell), &noisy(2 * seed + 1, cell), &Selection::default());
            let alarms = (0..100).filter(|&seed| p(seed).unwrap() < 0.01).count();
            assert!(alarms <= 2, "{alarms} false alarms in 100 pairs, cell {cell}");
        }
    }

    #[test]
    fn a_wrong_block_is_a_difference() {
        let (mut picture, reference) = (noisy(1, 1), noisy(2, 1));
        (0..8).for_each(|i| picture.xyz[(8 + i) * 32 + 16..][..8].iter_mut().for_each(|xyz| xyz[1] += 0.6));
        let p = |selection: &Selection| probability(&picture, &reference, selection).unwrap();
        assert!(p(&Selection::default()) < 0.01, "{}", p(&Selection::default()));
        let elsewhere = Selection { mask: Some((0..1024).map(|i| i < 256).collect()), ..Selection::default() };
        assert!(p(&elsewhere) > 0.01);
        assert_eq!(probability(&Picture::black(4, 4), &Picture::black(4, 4), &Selection::default()), None);
        assert_eq!(probability(&reference, &reference, &Selection::default()), Some(1.0));
    }
}
