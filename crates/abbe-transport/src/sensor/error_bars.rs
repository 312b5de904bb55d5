//! Error bars of a film: noise and bias of each pixel, by the number of passes.
//!
//! *Noise* is the standard error of Y, from the means of the replicates. Eight replicates give an
//! uncertain estimate for pixels with rare bright samples, so the seven degrees of freedom of a
//! pixel are combined with two of its neighbours (empirical Bayes: Smyth, "Linear models and
//! empirical Bayes methods", 2004), which preserves the mean variance over the picture.
//!
//! *Bias* is that of the kernel density estimates, measured with two kernels in the same query. A
//! single estimate is as noisy as the pixel, but the even and the odd replicates give two with
//! independent noise. The mean of their product over the neighbourhood of a pixel estimates the
//! mean square bias without noise. Where a kernel crosses an edge of the illumination, the bias
//! changes its sign from pixel to pixel, and the estimate is above zero but too low: the two
//! kernels have the same radius, so they measure only the curvature of the illumination. Pixels
//! near an edge are marked.

use super::error_distribution::{TRIMMED, dark_square, typical_squares};
use abbe_spectra::math::random::REPLICATES;

/// The measured means of a pixel over passes, in cd/m².
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelMeans {
    /// Y of each replicate. The value is meaningless for replicates without passes.
    pub(super) y: [f64; REPLICATES],
    /// The mean bias of Y over the even and the odd replicates, meaningless without passes.
    pub(super) bias: [f64; 2],
}

/// Pixel by pixel, in cd/m². Pixels without light have none.
#[derive(Debug)]
pub(super) struct ErrorBars {
    pub(super) noise: Vec<Option<f32>>,
    /// The magnitude of the estimated bias of Y, if it is known.
    pub(super) bias: Vec<Option<f32>>,
    /// An edge is within reach of a kernel, so the bias is probably larger than estimated.
    pub(super) edge: Vec<Option<bool>>,
    /// The mean variance of the kernel estimates in (cd/m²)².
    kernel_noise: f64,
}

/// The parts of the squared relative error of a picture, by their dependence on the passes n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSquares {
    /// The squared bias. It falls as n^(−2/3) in smooth illumination, and more slowly at edges.
    pub bias: f64,
    /// The variance of the kernel estimates. It falls as n^(−2/3), because the kernels shrink.
    pub kernel_noise: f64,
    /// The variance of all else: n⁻¹ for independent samples, and up to n⁻² for stratified ones.
    pub sampling: f64,
}

/// The degrees of freedom of the neighbours in the noise of a pixel.
const NEIGHBOUR_DEGREES: f64 = 2.0;

/// The largest distance (pixels) at which a neighbour contributes to a pixel's noise estimate.
const NOISE_RADIUS_PX: usize = 1;

/// The largest distance (pixels) at which a neighbour contributes to a pixel's bias estimate.
const BIAS_RADIUS_PX: usize = 2;

/// A pixel can be an edge if its squared bias exceeds this factor times the variance of the kernel
/// estimates, which it seldom does under uniform light.
const EDGE_THRESHOLD: f64 = 3.0;

/// The largest distance (pixels) at which a neighbour contributes to any estimate.
const RADIUS_PX: usize = if NOISE_RADIUS_PX > BIAS_RADIUS_PX { NOISE_RADIUS_PX } else { BIAS_RADIUS_PX };

/// The rows that are computed at a time, so that single estimates need little memory.
const ROWS_PER_BLOCK: usize = 64;

/// The squared errors of the pixels that the typical error leaves out, divided by those of all
/// others, above which it may rise.
const MANY_GLINTS: f64 = 10.0;

/// The bias changes its sign at an edge: its mean must be below this fraction of its RMS.
const EDGE_MEAN_FRACTION: f64 = 0.5;

impl ErrorBars {
    /// `measured` returns the means of a lit pixel, and `passes` counts each replicate.
    pub(super) fn new(
        (width, count): (usize, usize),
        measured: impl Fn(usize) -> Option<PixelMeans>,
        passes: [u64; REPLICATES],
    ) -> Self {
        let replicates = passes.iter().filter(|&&passes| passes > 0).count();
        let half = |parity: usize| passes.iter().skip(parity).step_by(2).any(|&passes| passes > 0);
        let halves = [half(0), half(1)];
        let degrees = replicates.saturating_sub(1) as f64;
        let (noise, bias, edge) = (Vec::with_capacity(count), Vec::with_capacity(count), Vec::with_capacity(count));
        let mut bars = Self { noise, bias, edge, kernel_noise: 0.0 };
        let (rows, mut lit) = (count / width.max(1), 0_usize);
        for first in (0..rows).step_by(ROWS_PER_BLOCK) {
            let own = first..(first + ROWS_PER_BLOCK).min(rows);
            let around = own.start.saturating_sub(RADIUS_PX)..(own.end + RADIUS_PX).min(rows);
            let estimates =
                PixelEstimates::new(width, (around.start * width..around.end * width).map(&measured), |m| {
                    (m.variance(passes), m.squared_bias(halves), m.kernel_variance(halves))
                });
            for pixel in (own.start - around.start) * width..(own.end - around.start) * width {
                if let Some(variance) = estimates.noise_of_bias[pixel] {
                    bars.kernel_noise += variance;
                    lit += 1;
                }
                let bar = |square: f64| square.max(0.0).sqrt() as f32;
                bars.noise.push(estimates.noise(pixel, degrees).map(bar));
                let square = estimates.smooth_square(pixel);
                bars.bias.push(square.map(bar));
                bars.edge.push(square.map(|square| halves == [true; 2] && estimates.is_edge(pixel, square)));
            }
        }
        bars.kernel_noise /= lit.max(1) as f64;
        bars
    }

    /// Returns the errors of a picture with these colours. `None` if the error is unknown.
    pub(super) fn errors(&self, xyz: &[[f64; 3]]) -> Option<PictureErrors> {
        let mean_y = xyz.iter().map(|xyz| xyz[1]).sum::<f64>() / xyz.len() as f64;
        let whole = self.squares(mean_y)?;
        let bars = self.noise.iter().zip(&self.bias).zip(xyz).filter_map(|((noise, bias), xyz)| {
            let squares = [(*noise)?, bias.unwrap_or(0.0)].map(|bar| f64::from(bar).powi(2));
            Some(squares.map(|square| square / (xyz[1].powi(2) + dark_square(mean_y))))
        });
        let bars: Vec<[f64; 2]> = bars.collect();
        let (lit, all) = (bars.len() as f64, bars.iter().flatten().sum::<f64>());
        let [noise, bias] = typical_squares(bars, |[noise, bias]| noise + bias)?;
        let kept = (lit - (TRIMMED * lit).floor()) * (noise + bias);
        let has_glints = all - kept > MANY_GLINTS * kept;
        // The variance of the kernel estimates is known only for all pixels together.
        let of_noise = whole.kernel_noise / (whole.kernel_noise + whole.sampling).max(f64::MIN_POSITIVE);
        let kernel_noise = of_noise * noise;
        let typical = ErrorSquares { bias, kernel_noise, sampling: noise - kernel_noise };
        Some(PictureErrors { whole, typical, has_glints })
    }

    /// `mean_y` is that of the picture. `None` if the error is unknown.
    fn squares(&self, mean_y: f64) -> Option<ErrorSquares> {
        let known = self.noise.iter().flatten().count();
        if known == 0 || mean_y <= 0.0 {
            return None;
        }
        let mean_square = |bars: &[Option<f32>]| {
            bars.iter().map(|bar| f64::from(bar.unwrap_or(0.0)).powi(2)).sum::<f64>() / known as f64 / (mean_y * mean_y)
        };
        let noise = mean_square(&self.noise);
        let kernel_noise = (self.kernel_noise / (mean_y * mean_y)).min(noise);
        let squares = ErrorSquares { bias: mean_square(&self.bias), kernel_noise, sampling: noise - kernel_noise };
        // Lit pixels that all have the error 0 do not represent those without light yet.
        (squares.relative() > 0.0 || known == self.noise.len()).then_some(squares)
    }
}

/// The squared relative errors of a picture in two norms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureErrors {
    /// The mean square error of all pixels, divided by the squared mean of Y. A few glints may
    /// dominate it.
    pub whole: ErrorSquares,
    /// The error of a typical pixel; see [`typical_squares`].
    pub typical: ErrorSquares,
    /// The pixels that the typical error leaves out have more than ten times the squared errors of
    /// all others together. If one more tenth of such pixels appears, the typical error rises, so
    /// its history does not tell how it goes on.
    pub has_glints: bool,
}

impl ErrorSquares {
    pub fn relative(&self) -> f64 {
        (self.bias + self.kernel_noise + self.sampling).sqrt()
    }

    /// Returns the factor, at least 1, on the noise in intervals after a rule ended the passes at
    /// the relative error `target`.
    ///
    /// The rule ends at the first estimate below the target, and eight replicates often estimate
    /// too little. With the estimates as they are, 91 % to 94 % of the intervals contain the truth;
    /// with noise that makes the error equal to the target, 93 % to 98 %. An estimate far below the
    /// target was not selected: for seven degrees of freedom, an error above the target is
    /// estimated as less than half of it in only 3 % of the renders (the χ² distribution).
    pub fn widening(&self, target: f64) -> f64 {
        const LARGEST: f64 = 2.0;
        let noise = self.kernel_noise + self.sampling;
        let factor = ((target * target - self.bias) / noise).sqrt();
        if self.relative() <= target && (1.0..LARGEST).contains(&factor) { factor } else { 1.0 }
    }
}

impl PixelMeans {
    /// Returns the variance of the mean of Y, from the means of all replicates with passes,
    /// weighted by these. `None` for fewer than two replicates.
    pub(super) fn variance(&self, passes: [u64; REPLICATES]) -> Option<f64> {
        let means = || passes.into_iter().zip(self.y).filter(|(n, _)| *n > 0).map(|(n, mean)| (n as f64, mean));
        let degrees = means().count().checked_sub(1).filter(|&degrees| degrees > 0)?;
        let total: f64 = means().map(|(n, _)| n).sum();
        let mean = means().map(|(n, m)| n * m).sum::<f64>() / total;
        let spread: f64 = means().map(|(n, m)| n * (m - mean) * (m - mean)).sum();
        // With the variance σ² of one pass, the mean m of a replicate with n passes has σ²/n. For R
        // replicates, Σ n (m − mean)² estimates (R − 1) σ². The mean of all passes has σ²/Σn.
        Some(spread / degrees as f64 / total)
    }

    /// Returns the squared bias, unbiased if both halves have passes. Otherwise (in some parts of a
    /// picture), it contains the variance of the measured bias.
    pub(super) fn squared_bias(&self, halves: [bool; 2]) -> Option<f64> {
        let [even, odd] = self.bias;
        match halves {
            [true, true] => Some(even * odd),
            [true, false] => Some(even * even),
            [false, true] => Some(odd * odd),
            [false, false] => None,
        }
    }

    /// Returns the variance of the kernel estimates: that of the measured bias. In two dimensions,
    /// they are equal, because ∫k² is 4/(3πr²) both for the Epanechnikov kernel kₑ and for the bias
    /// kernel 2(kᵤ − kₑ), with the uniform kernel kᵤ. In one dimension, the variance of the bias is
    /// 3/8 of that of the kernel estimate.
    fn kernel_variance(&self, halves: [bool; 2]) -> f64 {
        let [even, odd] = self.bias;
        if halves == [true; 2] { (0.5 * (even - odd)).powi(2) } else { 0.0 }
    }
}

/// The estimates of single pixels in some rows. Pixels without light have none.
struct PixelEstimates {
    width: usize,
    variances: Vec<Option<f64>>,
    squares: Vec<Option<f64>>,
    signed: Vec<Option<f64>>,
    noise_of_bias: Vec<Option<f64>>,
}

impl PixelEstimates {
    /// `estimates` returns the variances of the mean and of the kernels, and the squared bias.
    fn new(
        width: usize,
        pixels: impl Iterator<Item = Option<PixelMeans>>,
        estimates: impl Fn(&PixelMeans) -> (Option<f64>, Option<f64>, f64),
    ) -> Self {
        let [variances, squares, signed, noise_of_bias] = [(); 4].map(|()| Vec::new());
        let mut all = Self { width, variances, squares, signed, noise_of_bias };
        for measured in pixels {
            let found = measured.as_ref().map(&estimates);
            all.variances.push(found.and_then(|(variance, ..)| variance));
            all.squares.push(found.and_then(|(_, square, _)| square));
            all.noise_of_bias.push(found.map(|(.., variance)| variance));
            all.signed.push(measured.map(|measured| 0.5 * (measured.bias[0] + measured.bias[1])));
        }
        all
    }

    /// Returns the squared noise of a pixel, whose own variance has some degrees of freedom.
    fn noise(&self, pixel: usize, degrees: f64) -> Option<f64> {
        let around = mean_around(&self.variances, self.width, pixel, NOISE_RADIUS_PX);
        self.variances[pixel]
            .map(|variance| (degrees * variance + NEIGHBOUR_DEGREES * around) / (degrees + NEIGHBOUR_DEGREES))
    }

    fn smooth_square(&self, pixel: usize) -> Option<f64> {
        self.squares[pixel].map(|_| mean_around(&self.squares, self.width, pixel, BIAS_RADIUS_PX))
    }

    /// Tells whether a pixel with this mean squared bias around it is an edge.
    fn is_edge(&self, pixel: usize, square: f64) -> bool {
        let around = |values: &[Option<f64>]| mean_around(values, self.width, pixel, BIAS_RADIUS_PX);
        square > EDGE_THRESHOLD * around(&self.noise_of_bias)
            && around(&self.signed).powi(2) < EDGE_MEAN_FRACTION * EDGE_MEAN_FRACTION * square
    }
}

/// Returns the mean of the known values up to `radius` pixels away, 0 without any.
fn mean_around(values: &[Option<f64>], width: usize, pixel: usize, radius: usize) -> f64 {
    let (x, y) = (pixel % width, pixel / width);
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for row in y.saturating_sub(radius)..(y + radius + 1).min(values.len() / width) {
        let columns = x.saturating_sub(radius)..(x + radius + 1).min(width);
        for value in values[row * width..][columns].iter().flatten() {
            sum += value;
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVEN: [u64; REPLICATES] = [2; REPLICATES];

    fn steady(y: f64, bias: [f64; 2]) -> PixelMeans {
        PixelMeans { y: [y; REPLICATES], bias }
    }

    /// Returns means that alternate between `y` ± `spread`: the standard error is `spread`/√7.
    fn noisy(y: f64, spread: f64) -> PixelMeans {
        let sign = |r: usize| if r.is_multiple_of(2) { 1.0 } else { -1.0 };
        PixelMeans { y: std::array::from_fn(|r| y + sign(r) * spread), bias: [0.0; 2] }
    }

    #[test]
    fn neighbours_moderate_noise_and_keep_its_mean_square() {
        let pixels = [noisy(1.0, 0.1), noisy(1.0, 0.2), noisy(1.0, 0.3)];
        let bars = ErrorBars::new((3, 3), |i| Some(pixels[i]), EVEN);
        let own = |spread: f64| spread * spread / 7.0;
        let middle = (7.0 * own(0.2) + 2.0 * (own(0.1) + own(0.2) + own(0.3)) / 3.0) / 9.0;
        assert!((f64::from(bars.noise[1].unwrap()) - middle.sqrt()).abs() < 1e-7);
        let flat = ErrorBars::new((4, 8), |_| Some(noisy(1.0, 0.2)), EVEN);
        assert!(flat.noise.iter().flatten().all(|&noise| (f64::from(noise) - own(0.2).sqrt()).abs() < 1e-7));
    }

    #[test]
    fn blocks_of_rows_have_no_seams() {
        const WIDTH: usize = 3;
        let rows = 2 * ROWS_PER_BLOCK + 20;
        let value = |pixel: usize| ((pixel * 37 % 101) as f64 - 50.0) * 1e-3;
        let pixel = |pixel: usize| {
            let y = std::array::from_fn(|r| 1.0 + value(pixel + 7 * r));
            (!pixel.is_multiple_of(11)).then(|| PixelMeans { y, bias: [value(pixel), value(pixel + 3)] })
        };
        let whole = ErrorBars::new((WIDTH, WIDTH * rows), pixel, EVEN);
        let cut = ROWS_PER_BLOCK / 2;
        let part = ErrorBars::new((WIDTH, WIDTH * (rows - cut)), |i| pixel(i + WIDTH * cut), EVEN);
        // The rows at the cut lack neighbours.
        for i in WIDTH * RADIUS_PX..WIDTH * (rows - cut) {
            let of = |bars: &ErrorBars, i: usize| (bars.noise[i], bars.bias[i], bars.edge[i]);
            assert_eq!(of(&part, i), of(&whole, i + WIDTH * cut), "pixel {i}");
        }
        assert_eq!(whole.noise.len(), WIDTH * rows);
    }

    /// A bias counts as bias only if the even and the odd replicates agree, and else as noise.
    #[test]
    fn only_a_bias_whose_halves_agree_counts() {
        let agree = ErrorBars::new((5, 25), |_| Some(steady(1.0, [0.03, 0.03])), EVEN);
        assert!(agree.bias.iter().flatten().all(|&bias| (bias - 0.03).abs() < 1e-7));
        assert_eq!(agree.kernel_noise, 0.0);
        assert!(agree.edge.iter().all(|&edge| edge == Some(false)), "a uniform bias is not an edge");
        let noise = ErrorBars::new((5, 25), |_| Some(steady(1.0, [0.03, -0.03])), EVEN);
        assert!(noise.bias.iter().all(|&bias| bias == Some(0.0)));
        assert!((noise.kernel_noise - 9e-4).abs() < 1e-12);
    }

    #[test]
    fn a_bias_that_changes_its_sign_at_an_edge_does_not_vanish() {
        let side = |i: usize| if i % 6 < 3 { 0.1 } else { -0.1 };
        let bars = ErrorBars::new((6, 36), |i| Some(steady(1.0, [side(i); 2])), EVEN);
        assert!(bars.bias.iter().flatten().all(|&bias| (bias - 0.1).abs() < 1e-6), "{:?}", bars.bias);
        let beside = |x: usize| bars.edge.iter().skip(x).step_by(6).all(|&edge| edge == Some(true));
        assert!(beside(2) && beside(3) && !beside(0) && !beside(5), "{:?}", bars.edge);
    }

    #[test]
    fn unlit_pixels_are_unknown_and_do_not_influence_neighbours() {
        let pixel = |i: usize| (i != 4).then(|| PixelMeans { bias: [0.05; 2], ..noisy(1.0, 0.1) });
        let bars = ErrorBars::new((3, 9), pixel, EVEN);
        assert_eq!((bars.noise[4], bars.bias[4], bars.edge[4]), (None, None, None));
        let [noise, bias] =
            [&bars.noise, &bars.bias].map(|layer| layer.iter().flatten().copied().collect::<Vec<f32>>());
        assert_eq!((noise.len(), bias.len()), (8, 8));
        assert!(noise.iter().all(|value| (value - noise[0]).abs() < 1e-7));
        assert!(bias.iter().all(|value| (value - 0.05).abs() < 1e-7));
        assert_eq!(ErrorBars::new((3, 9), |_| None, EVEN).squares(1.0), None);
    }

    #[test]
    fn few_pixels_with_most_of_the_errors_are_glints() {
        let has_glints = |spread: f64| {
            let pixel = |i: usize| noisy(1.0, if i % 500 == 250 { spread } else { 0.01 });
            ErrorBars::new((20, 1000), |i| Some(pixel(i)), EVEN).errors(&[[1.0; 3]; 1000]).unwrap().has_glints
        };
        assert!(has_glints(1.0) && !has_glints(0.5));
    }

    /// One replicate has no noise, and the even replicates alone have a bias.
    #[test]
    fn one_replicate_gives_no_noise_and_one_half_gives_bias() {
        let first = |n: [usize; 2]| std::array::from_fn(|r| u64::from(n.contains(&r)));
        let one = ErrorBars::new((1, 1), |_| Some(steady(1.0, [0.2, 0.0])), first([0, 0]));
        assert_eq!((one.noise[0], one.bias[0]), (None, Some(0.2)));
        assert_eq!(one.squares(1.0), None);
        let both_even = ErrorBars::new((1, 1), |_| Some(steady(1.0, [0.2, 0.0])), first([0, 4]));
        assert_eq!((both_even.noise[0], both_even.bias[0]), (Some(0.0), Some(0.2)));
    }
}
