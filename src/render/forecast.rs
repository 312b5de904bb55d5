//! How the error of a picture will fall if it goes on: what more accuracy would cost.
//!
//! The square of the error is a sum of parts that fall with the number of passes n each in its own way. Under kernels whose radius shrinks as the plan has it, the
//! variance falls as n^(−2/3) (Knaus & Zwicker 2011); so does the square of the bias where light is smooth, but beside an edge, where the width
//! of the strip that the kernel blurs matters, it falls as n^(−1/6): n^(−1/2) is what pictures show that have both. The noise of all else falls as 1/n where samples are
//! independent (photons connected to the camera), and up to 1/n² where they are stratified (the outline of a lamp within a pixel); which of the two a
//! picture has is told by its own history. Samples are stratified within a replicate, and passes go to the replicates in turn: the tenth pass
//! is the second of one of them, and the first news of the slope.

use crate::math::random::REPLICATES;
use crate::sensor::ErrorSquares;
use serde::{Deserialize, Serialize};

/// How the noise of a replicate falls before a picture's history says so: −d ln(variance)/d ln(its passes).
const USUAL_SLOPE: f64 = 1.36;

/// How much that counts beside the history, as a sum of squares of the replicates' ln(passes). From 8 passes to 10 history has 0.015,
/// over two doublings about 2. That first news of a small film is good to ±0.3 only.
const WEIGHT_OF_USUAL: f64 = 0.03;

/// History goes back to this share of the passes: what falls fast loses its say.
const MEMORY: f64 = 0.25;

/// What was measured of a picture's error, and at how many passes.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    points: Vec<(u64, ErrorSquares)>,
}

/// The law error(t) of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// At how many passes it was made.
    passes: f64,
    /// The parts then; that of the sampling by the line through the history.
    squares: ErrorSquares,
    /// How the sampling's part falls within a replicate.
    slope: f64,
    /// What was measured then.
    error: f64,
    /// Seconds before the first pass.
    seconds_before: f64,
    seconds_a_pass: f64,
}

/// When an error will be reached.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Milestone {
    /// The relative error.
    pub error: f64,
    /// After how many passes in all.
    pub passes: f64,
    /// After how many seconds in all.
    pub seconds: f64,
}

impl History {
    /// Adds what was measured after so many passes, more than before.
    pub(super) fn add(&mut self, passes: u64, squares: ErrorSquares) {
        self.points.retain(|&(before, _)| before != passes);
        self.points.push((passes, squares));
    }

    /// The error measured last.
    pub(super) fn latest(&self) -> Option<f64> {
        self.points.last().map(|(_, squares)| squares.relative())
    }

    /// The law of a run that took so many seconds in all for so many passes, of them some before the first pass.
    pub(super) fn forecast(&self, (done, seconds, before): (u64, f64, f64)) -> Option<Forecast> {
        let &(passes, squares) = self.points.last()?;
        let passes = passes as f64;
        let (sampling, slope) = self.sampling_at(passes);
        Some(Forecast {
            passes,
            squares: ErrorSquares { sampling, ..squares },
            slope,
            error: squares.relative(),
            seconds_before: before,
            seconds_a_pass: (seconds - before).max(0.0) / done.max(1) as f64,
        })
    }

    /// The sampling's part after so many passes and how it falls: a straight line through the history in logarithms, drawn a little towards the usual slope.
    fn sampling_at(&self, passes: f64) -> (f64, f64) {
        let recent = |&&(n, squares): &&(u64, ErrorSquares)| n as f64 >= MEMORY * passes && squares.sampling > 0.0;
        // Of a single pass, by the passes of a replicate.
        let logarithms = |&(n, squares): &(u64, ErrorSquares)| (strata(n as f64), (squares.sampling * n as f64).ln());
        let points = || self.points.iter().filter(recent).map(logarithms);
        let count = points().count() as f64;
        if count == 0.0 {
            return (0.0, USUAL_SLOPE);
        }
        let (x, y) = points().fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x / count, sum.1 + y / count));
        let across = points().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>();
        let along = points().map(|point| (point.0 - x).powi(2)).sum::<f64>();
        let gain = ((USUAL_SLOPE - 1.0) * WEIGHT_OF_USUAL - across) / (WEIGHT_OF_USUAL + along);
        let gain = gain.clamp(0.0, 1.0);
        ((y - gain * (strata(passes) - x)).exp() / passes, 1.0 + gain)
    }
}

/// The logarithm of how many strata each replicate has after so many passes in all, in the mean over the replicates.
fn strata(passes: f64) -> f64 {
    let each = (passes / REPLICATES as f64).max(1.0);
    let whole = each.floor();
    let more = each - whole;
    (1.0 - more) * whole.ln() + more * (whole + 1.0).ln()
}

impl Forecast {
    /// The law where nothing but its end is known of a run: of how many passes, how many seconds in all, and how many of them before the first pass.
    pub fn without_history(squares: ErrorSquares, run: (u64, f64, f64)) -> Option<Self> {
        let mut history = History::default();
        history.add(run.0, squares);
        history.forecast(run)
    }

    /// The relative error after so many passes in all.
    pub fn error_after_passes(&self, passes: f64) -> f64 {
        let ratio = passes / self.passes;
        let ErrorSquares { bias, under_kernels, sampling } = self.squares;
        let kernels = bias * ratio.powf(-0.5) + under_kernels * ratio.powf(-2.0 / 3.0);
        let gain = (self.slope - 1.0) * (strata(passes) - strata(self.passes));
        (kernels + sampling / ratio * (-gain).exp()).sqrt()
    }

    /// The relative error after so many seconds in all.
    pub fn error_after_seconds(&self, seconds: f64) -> f64 {
        self.error_after_passes((seconds - self.seconds_before) / self.seconds_a_pass)
    }

    /// When the relative error will have fallen to `error`: a pass from now at the soonest. `None` where that is beyond 10¹⁵ passes.
    pub fn when(&self, error: f64) -> Option<Milestone> {
        const FARTHEST: f64 = 1e15;
        const HALVINGS: usize = 60;
        let (mut low, mut high) = (self.passes + 1.0, FARTHEST);
        if self.error_after_passes(high) > error {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = (low * high).sqrt();
            if self.error_after_passes(middle) > error { low = middle } else { high = middle }
        }
        Some(Milestone { error, passes: high, seconds: self.seconds_before + high * self.seconds_a_pass })
    }

    /// When the next two round errors below the present one (of 50, 20, 10, 5, 2, 1, 0.5 … %) will be reached.
    pub fn milestones(&self) -> impl Iterator<Item = Milestone> {
        let errors = (self.error > 0.0).then(|| round_errors_below(self.error));
        errors.into_iter().flatten().filter_map(|error| self.when(error))
    }
}

/// The next two of 1, 2 and 5 times a power of ten below `error`.
fn round_errors_below(error: f64) -> [f64; 2] {
    let decade = error.log10().floor() as i32;
    let steps = (decade - 2..=decade).rev().flat_map(|power| [5.0, 2.0, 1.0].map(|step| (step, power)));
    // Divided, not multiplied: 2/100 is the number that 0.02 is read as.
    let mut below = steps
        .map(|(step, power)| if power < 0 { step / 10_f64.powi(-power) } else { step * 10_f64.powi(power) })
        .filter(|&round| round < error);
    std::array::from_fn(|_| below.next().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A history by the law of each part.
    fn history(passes: &[u64], parts: impl Fn(f64) -> [f64; 3]) -> History {
        let mut history = History::default();
        for &n in passes {
            let [bias, under_kernels, sampling] = parts(n as f64);
            history.add(n, ErrorSquares { bias, under_kernels, sampling });
        }
        history
    }

    const DENSE: [u64; 8] = [8, 9, 10, 12, 14, 16, 18, 20];

    /// The variance of the mean of eight replicates that get n passes in turn, where that of one with m falls as m^−slope.
    fn in_turn(n: f64, slope: f64) -> f64 {
        let of_one = |r: u64| ((n as u64 + r) / 8).max(1) as f64;
        (0..8).map(|r| of_one(r).powf(1.0 - slope)).sum::<f64>() / 8.0 / n
    }

    #[test]
    fn each_part_falls_by_its_own_law() {
        for (slope, parts) in [(1.0, [0.0, 0.0, 1.0]), (1.8, [0.0, 0.0, 1.0]), (1.0, [0.01, 0.02, 0.5])] {
            let at = |n: f64| {
                let [bias, under_kernels, sampling] = parts;
                [bias * n.powf(-0.5), under_kernels * n.powf(-2.0 / 3.0), sampling * in_turn(n, slope)]
            };
            let forecast = history(&DENSE, at).forecast((20, 42.0, 2.0)).unwrap();
            let known = at(80.0).iter().sum::<f64>().sqrt();
            let ratio = forecast.error_after_seconds(162.0) / known;
            // The usual slope draws a little.
            assert!((ratio - 1.0).abs() < 0.05, "slope {slope}: {ratio}");
            let when = forecast.when(forecast.error_after_passes(80.0)).unwrap();
            assert!((when.passes / 80.0 - 1.0).abs() < 1e-6 && (when.seconds / 162.0 - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_first_passes_that_are_the_second_of_their_replicates_tell_the_slope() {
        // The steepest noise that strata allow is told less well than the usual: it is rare.
        for (slope, within) in [(1.0, 0.25), (1.6, 0.25), (1.8, 0.35)] {
            let forecast = history(&[8, 9, 10], |n| [0.0, 0.0, in_turn(n, slope)]).forecast((10, 1.0, 0.0)).unwrap();
            let ratio = forecast.error_after_passes(40.0) / in_turn(40.0, slope).sqrt();
            assert!((ratio - 1.0).abs() < within, "slope {slope}: {ratio}");
            let usual = history(&[10], |n| [0.0, 0.0, in_turn(n, slope)]).forecast((10, 1.0, 0.0)).unwrap();
            let without = usual.error_after_passes(40.0) / in_turn(40.0, slope).sqrt();
            assert!(
                (ratio - 1.0).abs() < (without - 1.0).abs(),
                "slope {slope}: {ratio}, and {without} without history"
            );
        }
    }

    #[test]
    fn without_history_noise_falls_as_usual_and_no_faster_than_the_strata_allow() {
        let one = history(&[16], |_| [0.0, 0.0, 0.01]).forecast((16, 1.6, 0.0)).unwrap();
        assert!((one.error_after_passes(64.0) - 0.1 * 4_f64.powf(-0.5 * USUAL_SLOPE)).abs() < 1e-12);
        let lucky = history(&DENSE, |n| [0.0, 0.0, n.powi(-5)]).forecast((20, 2.0, 0.0)).unwrap();
        assert_eq!(lucky.slope, 2.0);
        assert!(History::default().forecast((8, 1.0, 0.0)).is_none());
    }

    #[test]
    fn milestones_are_the_next_two_round_errors() {
        let below = [0.031, 0.02, 0.26, 1.7, 0.000_51].map(round_errors_below);
        assert_eq!(below, [[0.02, 0.01], [0.01, 0.005], [0.2, 0.1], [1.0, 0.5], [0.0005, 0.0002]]);
        let exact = history(&[8], |_| [0.0; 3]).forecast((8, 1.0, 0.0)).unwrap();
        assert_eq!(exact.milestones().count(), 0, "nothing is left to wait for");
    }
}
