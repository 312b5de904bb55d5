//! The mean of the two halves, its return to the original where the filter is wrong, and its error
//! bars.

use crate::features::Surfaces;
use crate::half::{Half, Spread};
use crate::planes::mean_around;
use crate::samples::Samples;
use crate::{Denoised, REPLICATES};
use rayon::prelude::*;

/// The distance (pixels) over which the errors of the filter are pooled.
const GUARD_RADIUS_PX: usize = 3;

/// The distance (pixels) over which the squared bias is averaged.
const BIAS_RADIUS_PX: usize = 2;

/// The degrees of freedom of the neighbours in the noise of a pixel.
const NEIGHBOUR_DEGREES: f32 = 2.0;

/// Y of each replicate in one pixel.
type Values = [f32; REPLICATES];

/// Joins two halves, of which the half with the number h holds the filtered replicates of the
/// other.
pub(crate) fn combine(samples: &Samples, surfaces: &Surfaces, halves: &[Half; 2]) -> Denoised {
    let (size, spread) = (samples.size(), Spread::new(samples.passes));
    let original = |i: usize| -> Values { std::array::from_fn(|r| samples.y[r][i]) };
    let filtered =
        |i: usize| -> Values { std::array::from_fn(|r| halves[1 - r % 2].luma[r / 2][i] * surfaces.divisor[i][1]) };
    let errors: Vec<(f32, f32)> =
        (0..size.count()).into_par_iter().map(|i| removed_and_added(&spread, original(i), filtered(i))).collect();
    let (removed, added): (Vec<f32>, Vec<f32>) = errors.into_iter().unzip();
    let [removed, added] = [removed, added].map(|plane| {
        // Twice, so that a bright pixel has no square around it.
        let once = mean_around(&plane, size, GUARD_RADIUS_PX, 1);
        mean_around(&once, size, GUARD_RADIUS_PX, 1)
    });
    let guarded = |i: usize| -> Values {
        let (original, filtered) = (original(i), filtered(i));
        let trust = trust(removed[i], added[i]);
        std::array::from_fn(|r| original[r] + trust * (filtered[r] - original[r]))
    };
    let own: Vec<(f32, f32)> = (0..size.count())
        .into_par_iter()
        .map(|i| {
            let values = guarded(i);
            (spread.variance(values), squared_bias(&spread, original(i), values))
        })
        .collect();
    let (variance, square): (Vec<f32>, Vec<f32>) = own.into_iter().unzip();
    let around = mean_around(&variance, size, 1, 1);
    let degrees = spread.degrees;
    let pooled =
        |(own, around): (&f32, &f32)| (degrees * own + NEIGHBOUR_DEGREES * around) / (degrees + NEIGHBOUR_DEGREES);
    // The half 0 holds the odd replicates.
    let of_halves = [1, 0].map(|first| spread.weights.iter().skip(first).step_by(2).sum::<f32>());
    let xyz = |i: usize| {
        let y = spread.mean(guarded(i));
        let of_half = |half: &Half, c: usize| half.other_groups.mean(half.colour.each_ref().map(|group| group[c][i]));
        let colour = [0, 1, 2].map(|c| of_halves[0] * of_half(&halves[0], c) + of_halves[1] * of_half(&halves[1], c));
        // The colour is that of the wider means, at the luminance of the narrower ones.
        let scale = if colour[1] > 0.0 { y / (surfaces.divisor[i][1] * colour[1]) } else { 1.0 };
        [surfaces.divisor[i][0] * colour[0] * scale, y, surfaces.divisor[i][2] * colour[2] * scale]
    };
    Denoised {
        xyz: (0..size.count()).into_par_iter().map(xyz).collect(),
        noise: variance.iter().zip(&around).map(pooled).map(f32::sqrt).collect(),
        bias: mean_around(&square, size, BIAS_RADIUS_PX, 1).into_iter().map(|square| square.max(0.0).sqrt()).collect(),
    }
}

/// Returns estimates of the variance of the original that the filter removes, and of the mean
/// square of its change.
///
/// With the original mean m, its error e, and the filtered mean f, the mean square error of
/// m + t (f − m) is least for t = E[e (m − f)] / E[(m − f)²]. Since m has no bias, the numerator is
/// Var(m) − Cov(m, f).
fn removed_and_added(spread: &Spread<REPLICATES>, original: Values, filtered: Values) -> (f32, f32) {
    let change = spread.mean(std::array::from_fn(|r| filtered[r] - original[r]));
    (spread.variance(original) - spread.covariance(original, filtered), change * change)
}

/// Returns the largest fraction t of the filter's change, up to 1, that does not make the picture
/// worse. Since the mean square error is quadratic in t, it is equal to that of the original at
/// twice the t of the least error.
fn trust(removed: f32, added: f32) -> f32 {
    if added > 0.0 { (2.0 * removed.max(0.0) / added).min(1.0) } else { 1.0 }
}

/// Returns the product of the mean changes in both halves. They have independent noise, so its mean
/// is the squared bias.
fn squared_bias(spread: &Spread<REPLICATES>, original: Values, filtered: Values) -> f32 {
    let change = |half: usize| {
        let own = (half..REPLICATES).step_by(2);
        let passes: f32 = own.clone().map(|r| spread.weights[r]).sum();
        own.map(|r| spread.weights[r] * (filtered[r] - original[r])).sum::<f32>() / passes
    };
    change(0) * change(1)
}
