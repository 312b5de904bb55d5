//! How noisy and how biased each pixel of a film may be, and which part of that falls how fast.
//!
//! *Noise* is the standard error of Y from the means of the replicates. Eight of them say little about a pixel that light reaches in
//! rare bright hits: its own seven degrees of freedom are moderated by two of its neighbours' (empirical Bayes: Smyth, "Linear models and empirical Bayes
//! methods", 2004), which leaves the mean over the picture as it is.
//!
//! *Bias* is that of the kernels, from two of them in the same query. Its estimate is as noisy as the pixel, but over the even and over the odd replicates there
//! are two estimates without noise in common: the mean of their product over a pixel's neighbours is the mean square bias, without a noise of its own to
//! lift it. Where a kernel reaches over an edge of light the bias changes its sign from pixel to pixel; its mean square tells it all the same, but too low:
//! two kernels of one radius tell curvature, and across an edge there is more than that. Such pixels are marked.

use crate::math::random::REPLICATES;

/// What a pixel's bars are made from: means over passes, in cd/m².
#[derive(Debug, Clone, Copy)]
pub(super) struct Measured {
    /// Y by replicate; of no meaning for those without passes.
    pub(super) y: [f64; REPLICATES],
    /// The bias of Y over the even replicates and over the odd ones; of no meaning for a half without passes.
    pub(super) bias: [f64; 2],
}

/// The error bars of a picture, pixel by pixel in cd/m²; −1 where unknown, which is where no light arrived.
#[derive(Debug)]
pub(super) struct ErrorBars {
    /// Standard error of Y.
    pub(super) noise: Vec<f32>,
    /// Estimated bias of Y, as a magnitude.
    pub(super) bias: Vec<f32>,
    /// 1 beside an edge of light within a kernel's reach, where the bias is likely larger than told; else 0.
    pub(super) edge: Vec<f32>,
    /// The mean variance of what kernels bring, (cd/m²)².
    under_kernels: f64,
}

/// The square of a picture's relative error, by how its parts fall with the number of passes n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSquares {
    /// That of the bias: as n^(−2/3) where light is smooth, slower at edges.
    pub bias: f64,
    /// That of the noise of what kernels bring: they shrink, and it falls as n^(−2/3).
    pub under_kernels: f64,
    /// That of all other noise: as n⁻¹, and up to n⁻² where sampling is stratified.
    pub sampling: f64,
}

/// Degrees of freedom that a pixel's noise takes from its neighbours.
const FROM_NEIGHBOURS: f64 = 2.0;

/// Noise is moderated by pixels up to this far away.
const NOISE_REACH: usize = 1;

/// Bias is smoothed over pixels up to this far away.
const BIAS_REACH: usize = 2;

/// An edge is told where the square of the bias is this many times the variance of what kernels bring: in even light a mean of products of two halves, whose own
/// variances are twice that, seldom is.
const TOLD: f64 = 3.0;

/// Beside an edge the mean bias around a pixel is below this share of its root mean square: it changes its sign.
const ONE_SIDED: f64 = 0.5;

impl ErrorBars {
    /// The bars of a picture `width` wide, from what its lit pixels measured and the passes by replicate.
    pub(super) fn new(
        (width, count): (usize, usize),
        measured: impl Fn(usize) -> Option<Measured>,
        passes: [u64; REPLICATES],
    ) -> Self {
        let replicates = passes.iter().filter(|&&passes| passes > 0).count();
        let half = |parity: usize| passes.iter().skip(parity).step_by(2).any(|&passes| passes > 0);
        let halves = [half(0), half(1)];
        let (mut variances, mut squares) = (vec![None; count], vec![None; count]);
        let (mut signed, mut noise_of_bias) = (vec![None; count], vec![None; count]);
        let (mut under_kernels, mut lit) = (0.0, 0_usize);
        for pixel in 0..count {
            let Some(measured) = measured(pixel) else { continue };
            variances[pixel] = measured.variance(passes);
            squares[pixel] = measured.square_bias(halves);
            let variance = measured.variance_under_kernels(halves);
            under_kernels += variance;
            (signed[pixel], noise_of_bias[pixel]) = (Some(0.5 * (measured.bias[0] + measured.bias[1])), Some(variance));
            lit += 1;
        }
        let own = replicates.saturating_sub(1) as f64;
        let noise = |pixel: usize| {
            let around = mean_around(&variances, width, pixel, NOISE_REACH);
            variances[pixel].map(|variance| (own * variance + FROM_NEIGHBOURS * around) / (own + FROM_NEIGHBOURS))
        };
        let around = |values: &[Option<f64>], pixel: usize| mean_around(values, width, pixel, BIAS_REACH);
        let smooth: Vec<Option<f64>> =
            (0..count).map(|pixel| squares[pixel].map(|_| around(&squares, pixel))).collect();
        let bias = |pixel: usize| smooth[pixel];
        let edge = |pixel: usize| {
            smooth[pixel].map_or(-1.0, |square| {
                let is_told = halves == [true; 2] && square > TOLD * around(&noise_of_bias, pixel);
                let is_edge = is_told && around(&signed, pixel).powi(2) < ONE_SIDED * ONE_SIDED * square;
                f32::from(u8::from(is_edge))
            })
        };
        let edge = (0..count).map(edge).collect();
        let bars = |of: &dyn Fn(usize) -> Option<f64>| {
            (0..count).map(|pixel| of(pixel).map_or(-1.0, |square| square.max(0.0).sqrt() as f32)).collect()
        };
        Self { noise: bars(&noise), bias: bars(&bias), edge, under_kernels: under_kernels / lit.max(1) as f64 }
    }

    /// The parts of the square of the relative error of a picture with this mean Y; `None` while it is unknown.
    pub(super) fn squares(&self, mean_y: f64) -> Option<ErrorSquares> {
        let known = self.noise.iter().filter(|&&noise| noise >= 0.0).count();
        if known == 0 || mean_y <= 0.0 {
            return None;
        }
        let mean_square = |bars: &[f32]| {
            bars.iter().map(|&bar| f64::from(bar.max(0.0)).powi(2)).sum::<f64>() / known as f64 / (mean_y * mean_y)
        };
        let noise = mean_square(&self.noise);
        let under_kernels = (self.under_kernels / (mean_y * mean_y)).min(noise);
        let squares = ErrorSquares { bias: mean_square(&self.bias), under_kernels, sampling: noise - under_kernels };
        // Pixels that are known exactly say nothing about those that no light has reached yet.
        (squares.relative() > 0.0 || known == self.noise.len()).then_some(squares)
    }
}

impl ErrorSquares {
    /// The relative error.
    pub fn relative(&self) -> f64 {
        (self.bias + self.under_kernels + self.sampling).sqrt()
    }
}

impl Measured {
    /// The variance of the mean of Y, from the means of the replicates that have passes; `None` with fewer than two. Unequal numbers of passes
    /// weigh accordingly.
    fn variance(&self, passes: [u64; REPLICATES]) -> Option<f64> {
        let means = || passes.into_iter().zip(self.y).filter(|(n, _)| *n > 0).map(|(n, mean)| (n as f64, mean));
        let degrees = means().count().checked_sub(1).filter(|&degrees| degrees > 0)?;
        let total: f64 = means().map(|(n, _)| n).sum();
        let mean = means().map(|(n, m)| n * m).sum::<f64>() / total;
        let spread: f64 = means().map(|(n, m)| n * (m - mean) * (m - mean)).sum();
        // Each replicate mean has variance σ²/n; Σ n (m − mean)² estimates (R − 1) σ², and the mean's variance is σ²/Σn.
        Some(spread / degrees as f64 / total)
    }

    /// An estimate of the square of the bias: without bias of its own from two halves. Where all passes are in one (some parts of a picture
    /// have such), its noise counts with it.
    fn square_bias(&self, halves: [bool; 2]) -> Option<f64> {
        let [even, odd] = self.bias;
        match halves {
            [true, true] => Some(even * odd),
            [true, false] => Some(even * even),
            [false, true] => Some(odd * odd),
            [false, false] => None,
        }
    }

    /// The variance of what kernels bring to the pixel. On the disk, the bias by two kernels has the variance of Epanechnikov's estimate itself:
    /// ∫k² = 4/(3πr²) for both. (On the line it has 3/8 of it.)
    fn variance_under_kernels(&self, halves: [bool; 2]) -> f64 {
        let [even, odd] = self.bias;
        if halves == [true; 2] { (0.5 * (even - odd)).powi(2) } else { 0.0 }
    }
}

/// The mean of the values that are known around a pixel, up to `reach` pixels away in each direction; 0 if none is.
fn mean_around(values: &[Option<f64>], width: usize, pixel: usize, reach: usize) -> f64 {
    let (x, y) = (pixel % width, pixel / width);
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for row in y.saturating_sub(reach)..(y + reach + 1).min(values.len() / width) {
        let columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
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

    fn steady(y: f64, bias: [f64; 2]) -> Measured {
        Measured { y: [y; REPLICATES], bias }
    }

    /// Replicates that lie `spread` above and below `y` in turn: the standard error is spread/√7.
    fn noisy(y: f64, spread: f64) -> Measured {
        let sign = |r: usize| if r.is_multiple_of(2) { 1.0 } else { -1.0 };
        Measured { y: std::array::from_fn(|r| y + sign(r) * spread), bias: [0.0; 2] }
    }

    #[test]
    fn noise_is_moderated_by_neighbours_and_keeps_its_mean_square() {
        let pixels = [noisy(1.0, 0.1), noisy(1.0, 0.2), noisy(1.0, 0.3)];
        let bars = ErrorBars::new((3, 3), |i| Some(pixels[i]), EVEN);
        let own = |spread: f64| spread * spread / 7.0;
        let middle = (7.0 * own(0.2) + 2.0 * (own(0.1) + own(0.2) + own(0.3)) / 3.0) / 9.0;
        assert!((f64::from(bars.noise[1]) - middle.sqrt()).abs() < 1e-7);
        let flat = ErrorBars::new((4, 8), |_| Some(noisy(1.0, 0.2)), EVEN);
        assert!(flat.noise.iter().all(|&noise| (f64::from(noise) - own(0.2).sqrt()).abs() < 1e-7));
    }

    #[test]
    fn a_bias_whose_halves_agree_counts_and_one_whose_halves_do_not_is_noise() {
        let agree = ErrorBars::new((5, 25), |_| Some(steady(1.0, [0.03, 0.03])), EVEN);
        assert!(agree.bias.iter().all(|&bias| (bias - 0.03).abs() < 1e-7));
        assert_eq!(agree.under_kernels, 0.0);
        assert!(agree.edge.iter().all(|&edge| edge == 0.0), "an even bias is none of an edge");
        let noise = ErrorBars::new((5, 25), |_| Some(steady(1.0, [0.03, -0.03])), EVEN);
        assert!(noise.bias.iter().all(|&bias| bias == 0.0));
        assert!((noise.under_kernels - 9e-4).abs() < 1e-12);
    }

    #[test]
    fn a_bias_that_changes_its_sign_at_an_edge_does_not_vanish() {
        let side = |i: usize| if i % 6 < 3 { 0.1 } else { -0.1 };
        let bars = ErrorBars::new((6, 36), |i| Some(steady(1.0, [side(i); 2])), EVEN);
        assert!(bars.bias.iter().all(|&bias| (bias - 0.1).abs() < 1e-6), "{:?}", bars.bias);
        let beside = |x: usize| bars.edge.iter().skip(x).step_by(6).all(|&edge| edge == 1.0);
        assert!(beside(2) && beside(3) && !beside(0) && !beside(5), "{:?}", bars.edge);
    }

    #[test]
    fn what_no_light_reached_is_unknown_and_lends_nothing_to_its_neighbours() {
        let pixel = |i: usize| (i != 4).then(|| Measured { bias: [0.05; 2], ..noisy(1.0, 0.1) });
        let bars = ErrorBars::new((3, 9), pixel, EVEN);
        assert_eq!((bars.noise[4], bars.bias[4], bars.edge[4]), (-1.0, -1.0, -1.0));
        let others = || (0..9).filter(|&i| i != 4);
        assert!(others().all(|i| (bars.noise[i] - bars.noise[0]).abs() < 1e-7 && (bars.bias[i] - 0.05).abs() < 1e-7));
        assert_eq!(ErrorBars::new((3, 9), |_| None, EVEN).squares(1.0), None);
    }

    #[test]
    fn one_replicate_tells_no_noise_and_one_half_tells_a_bias_with_its_noise() {
        let first = |n: [usize; 2]| std::array::from_fn(|r| u64::from(n.contains(&r)));
        let one = ErrorBars::new((1, 1), |_| Some(steady(1.0, [0.2, 0.0])), first([0, 0]));
        assert_eq!((one.noise[0], one.bias[0]), (-1.0, 0.2));
        assert_eq!(one.squares(1.0), None);
        let both_even = ErrorBars::new((1, 1), |_| Some(steady(1.0, [0.2, 0.0])), first([0, 4]));
        assert_eq!((both_even.noise[0], both_even.bias[0]), (0.0, 0.2));
    }
}
