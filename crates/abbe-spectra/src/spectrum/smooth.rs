//! Conversion of formulas to piecewise-linear functions.

use super::band::BAND_NM;
use super::continuum::Continuum;
use rayon::prelude::*;

/// The largest error of the linear pieces, relative to the maximum of the function. It is less than
/// half of the promised 10⁻⁶, because a peak may afterwards be scaled to its exact area.
const SAMPLING_TOLERANCE: f64 = 4e-7;

/// The largest depth of the recursion that divides an interval between two initial knots.
const MAX_DIVISIONS: u32 = 12;

/// The largest number of parts into which a step of the recursion divides an interval.
const MAX_PARTS: f64 = 8.0;

/// The number of intervals that a task converts at a time.
const CHUNK: usize = 64;

/// Converts a smooth function to pieces. Knots are all whole nm of the band, the wavelengths
/// `extra`, and more until the error is at most 10⁻⁶ times the function's maximum.
pub(crate) fn sampled(function: &(dyn Fn(f64) -> f64 + Sync), extra: &[f64]) -> Continuum {
    let mut knots: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    knots.extend(extra.iter().filter(|nm| (BAND_NM.0..=BAND_NM.1).contains(*nm)));
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    let values = (0..knots.len()).into_par_iter().with_min_len(CHUNK).map(|i| function(knots[i])).collect::<Vec<_>>();
    let tolerance = SAMPLING_TOLERANCE * values.iter().copied().fold(0.0, f64::max);
    let refined = |i: usize| {
        let (from, to) = ((knots[i - 1], values[i - 1]), (knots[i], values[i]));
        let mut pieces = Vec::new();
        refine(function, [from, to], tolerance, MAX_DIVISIONS, &mut pieces);
        pieces
    };
    let added: Vec<_> = (1..knots.len()).into_par_iter().with_min_len(CHUNK).map(refined).collect();
    let pieces: Vec<(f64, f64)> = std::iter::once((knots[0], values[0])).chain(added.into_iter().flatten()).collect();
    Continuum::from_knots(&pieces)
}

/// Appends the knots after `from`, up to and including `to`.
fn refine(
    function: &dyn Fn(f64) -> f64,
    [from, to]: [(f64, f64); 2],
    tolerance: f64,
    divisions: u32,
    knots: &mut Vec<(f64, f64)>,
) {
    let at = |t: f64| from.0 + t * (to.0 - from.0);
    let error = |t: f64| (function(at(t)) - (from.1 + t * (to.1 - from.1))).abs();
    let worst = error(0.25).max(error(0.5)).max(error(0.75));
    if worst <= tolerance || divisions == 0 {
        knots.push(to);
        return;
    }
    // The error of linear interpolation is proportional to the square of the width.
    let parts = (worst / tolerance).sqrt().ceil().clamp(2.0, MAX_PARTS);
    let mut lower = from;
    for part in 1..=parts as u32 {
        let nm = at(f64::from(part) / parts);
        let upper = if nm < to.0 { (nm, function(nm)) } else { to };
        if upper.0 > lower.0 {
            refine(function, [lower, upper], tolerance, divisions - 1, knots);
        }
        lower = upper;
    }
}

/// Integrates the function itself, not its linear pieces, by Simpson's rule on each piece.
pub(crate) fn integral_of(function: impl Fn(f64) -> f64, pieces: &Continuum) -> f64 {
    pieces
        .pieces()
        .map(|piece| {
            let middle = function(0.5 * (piece.nm.0 + piece.nm.1));
            (piece.nm.1 - piece.nm.0) / 6.0 * (piece.values.0 + 4.0 * middle + piece.values.1)
        })
        .sum()
}
