//! Forecasts the error of a picture after additional passes.
//!
//! The squared error is a sum of three terms, which fall at different rates with the number of
//! passes n:
//!
//! - The variance of kernel estimates falls as n^(−2/3), because the kernel radius shrinks (Knaus &
//!   Zwicker 2011).
//! - The squared bias of kernel estimates falls as n^(−2/3) in smooth illumination, but only as
//!   n^(−1/6) near an edge, where the width of the blurred strip shrinks. Pictures contain both,
//!   and n^(−1/2) fits their squared bias.
//! - The variance of all other samples falls as 1/n if they are independent (for example, photons
//!   connected to the camera), and as fast as 1/n² if they are stratified (for example, in a pixel
//!   that contains the edge of a light). The error history of the picture decides.
//!
//! Samples are stratified within a replicate, and the passes go to the eight replicates in turn.
//! The ninth pass, the second of a replicate, therefore gives the first information about the rate.
//!
//! A forecast has an interval. It contains the scatter of the measured errors about the fit, which
//! is large if rare bright samples cause them, and the uncertainty of the rate, which matters more
//! the farther the forecast reaches. Where few pixels with rare bright samples have almost all of
//! the error, more of them may appear and raise the error of a typical pixel, so the rate is
//! unknown.

use abbe_spectra::math::elementary::{exp, ln, log10, powf};
use abbe_spectra::math::random::REPLICATES;
use abbe_transport::pass::StageSeconds;
use abbe_transport::sensor::{ErrorSquares, PictureErrors};
use serde::{Deserialize, Serialize};

/// The prior of the slope −d ln(variance)/d ln(passes) of a replicate.
const PRIOR_SLOPE: f64 = 1.36;

/// The weight of the prior, where the history has the sum of (x − mean of x)² for the logarithm x
/// of the passes of a replicate: 0.015 from 8 to 10 passes, and about 2 after two doublings. For a
/// small film, the slope from 8 to 10 passes is accurate only to ±0.3.
const PRIOR_WEIGHT: f64 = 0.03;

/// The fraction of the passes, at the beginning, whose errors the fit ignores.
const FIT_START: f64 = 0.25;

/// The standard deviation of the logarithm of a measured error, before measurements show it.
const PRIOR_SCATTER: f64 = 0.15;

/// The number of measurements that the prior of the scatter is worth.
const SCATTER_WEIGHT: f64 = 2.0;

/// The standard deviation of the rate −d ln(error)/d ln(passes) with the prior alone, and after
/// many measurements: the rates of the terms hold only approximately.
const RATE_UNCERTAINTY: [f64; 2] = [0.15, 0.03];

/// The same if few pixels have almost all of the error: that of a typical pixel may stay or rise.
const RATE_UNCERTAINTY_OF_GLINTS: f64 = 1.0;

#[derive(Debug, Clone, Default)]
pub(super) struct ErrorHistory {
    points: Vec<(u64, PictureErrors)>,
}

/// The forecasts of both errors of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecasts {
    /// Of the error of a typical pixel.
    pub typical: Forecast,
    /// Of the root mean square error, divided by the mean of Y.
    pub whole: Forecast,
}

#[derive(Debug, Clone, Copy)]
pub struct RunTimes {
    pub passes: u64,
    pub total_s: f64,
    pub before_first_pass_s: f64,
}

impl RunTimes {
    pub(super) fn of(passes: u64, seconds: &StageSeconds) -> Self {
        Self { passes, total_s: seconds.total, before_first_pass_s: seconds.pilot }
    }
}

/// The half width of a 95 % interval, in standard deviations.
const TWO_SIGMA: f64 = 2.0;

/// A model of the relative error as a function of passes and time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    passes: f64,
    /// At the last measurement. The sampling term comes from the fit.
    squares: ErrorSquares,
    /// The slope of the sampling term within a replicate.
    slope: f64,
    error: f64,
    /// The standard deviation of the logarithm of the present error.
    scatter: f64,
    /// The standard deviation of the rate at which the error falls.
    rate_uncertainty: f64,
    /// The time before the first pass in s.
    seconds_before: f64,
    /// The time of a pass in s.
    seconds_per_pass: f64,
}

/// The passes and the time after which the render reaches a relative error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorMilestone {
    /// The relative error.
    pub error: f64,
    /// The number of passes from the beginning.
    pub passes: f64,
    /// The time from the beginning in s.
    pub seconds: f64,
    /// The 95 % interval of the time from the beginning in s. `None` means that the history of the
    /// error does not tell when the error is reached.
    #[serde(default)]
    pub seconds_interval: Option<[f64; 2]>,
}

impl ErrorHistory {
    /// Adds the error after this many passes, or replaces it.
    pub(super) fn add(&mut self, passes: u64, errors: PictureErrors) {
        self.points.retain(|&(before, _)| before != passes);
        self.points.push((passes, errors));
    }

    /// Returns the errors at the last measurement.
    pub(super) fn latest(&self) -> Option<PictureErrors> {
        self.points.last().map(|&(_, errors)| errors)
    }

    /// Fits the forecasts. Returns `None` if no error was measured.
    pub(super) fn forecast(&self, times: RunTimes) -> Option<Forecasts> {
        let of = |norm: fn(&PictureErrors) -> ErrorSquares| {
            let points: Vec<(u64, ErrorSquares)> = self.points.iter().map(|(n, errors)| (*n, norm(errors))).collect();
            Forecast::of(&points, self.points.last()?.1.has_glints, times)
        };
        Some(Forecasts { typical: of(|errors| errors.typical)?, whole: of(|errors| errors.whole)? })
    }
}

impl Forecasts {
    /// Returns the forecasts from the last errors alone.
    pub(super) fn without_history(errors: PictureErrors, times: RunTimes) -> Option<Self> {
        let mut history = ErrorHistory::default();
        history.add(times.passes, errors);
        history.forecast(times)
    }
}

/// A straight line through the logarithms of the sampling term.
struct SamplingFit {
    /// The sampling term at the last measurement.
    sampling: f64,
    slope: f64,
    /// The standard deviation of the logarithm of the measured errors about the line.
    scatter: f64,
    rate_uncertainty: f64,
}

impl Forecast {
    /// Fits a forecast to errors after numbers of passes. Returns `None` without errors.
    fn of(points: &[(u64, ErrorSquares)], has_glints: bool, times: RunTimes) -> Option<Self> {
        let RunTimes { passes: done, total_s, before_first_pass_s } = times;
        let &(passes, squares) = points.last()?;
        let passes = passes as f64;
        let SamplingFit { sampling, slope, scatter, rate_uncertainty } = SamplingFit::of(points, passes);
        Some(Self {
            passes,
            squares: ErrorSquares { sampling, ..squares },
            slope,
            error: squares.relative(),
            scatter,
            rate_uncertainty: if has_glints { RATE_UNCERTAINTY_OF_GLINTS } else { rate_uncertainty },
            seconds_before: before_first_pass_s,
            seconds_per_pass: (total_s - before_first_pass_s).max(0.0) / done.max(1) as f64,
        })
    }
}

impl SamplingFit {
    /// Fits the sampling term after this many passes. The slope of the line has a prior.
    fn of(all: &[(u64, ErrorSquares)], passes: f64) -> Self {
        let recent = |&&(n, squares): &&(u64, ErrorSquares)| n as f64 >= FIT_START * passes && squares.sampling > 0.0;
        // ln(strata per replicate), and ln(variance of a single pass).
        let logarithms = |&(n, squares): &(u64, ErrorSquares)| (ln_strata(n as f64), ln(squares.sampling * n as f64));
        let points = || all.iter().filter(recent).map(logarithms);
        let count = points().count() as f64;
        let [of_prior, least] = RATE_UNCERTAINTY;
        if count == 0.0 {
            let rate_uncertainty = of_prior + least;
            return Self { sampling: 0.0, slope: PRIOR_SLOPE, scatter: PRIOR_SCATTER, rate_uncertainty };
        }
        let (x, y) = points().fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x / count, sum.1 + y / count));
        let across = points().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>();
        let along = points().map(|point| (point.0 - x).powi(2)).sum::<f64>();
        let gain = ((PRIOR_SLOPE - 1.0) * PRIOR_WEIGHT - across) / (PRIOR_WEIGHT + along);
        let gain = gain.clamp(0.0, 1.0);
        // Half of the logarithm of a variance is that of an error.
        let rest = |point: (f64, f64)| (0.5 * (point.1 - y + gain * (point.0 - x))).powi(2);
        let squares = points().map(rest).sum::<f64>() + SCATTER_WEIGHT * PRIOR_SCATTER.powi(2);
        Self {
            sampling: exp(y - gain * (ln_strata(passes) - x)) / passes,
            slope: 1.0 + gain,
            scatter: (squares / (count + SCATTER_WEIGHT)).sqrt(),
            rate_uncertainty: of_prior * (PRIOR_WEIGHT / (PRIOR_WEIGHT + along)).sqrt() + least,
        }
    }
}

/// Returns the mean of ln(strata) over the replicates, which have as many strata as passes.
fn ln_strata(passes: f64) -> f64 {
    let each = (passes / REPLICATES as f64).max(1.0);
    let whole = each.floor();
    let more = each - whole;
    (1.0 - more) * ln(whole) + more * ln(whole + 1.0)
}

impl Forecast {
    /// Returns the forecast from the last error alone, with the slope of the prior.
    pub fn without_history(squares: ErrorSquares, times: RunTimes) -> Option<Self> {
        Self::of(&[(times.passes, squares)], false, times)
    }

    /// Returns the relative error after this many passes from the beginning.
    pub fn error_after_passes(&self, passes: f64) -> f64 {
        let ratio = passes / self.passes;
        let ErrorSquares { bias, kernel_noise, sampling } = self.squares;
        let kernels = bias * powf(ratio, -0.5) + kernel_noise * powf(ratio, -2.0 / 3.0);
        let gain = (self.slope - 1.0) * (ln_strata(passes) - ln_strata(self.passes));
        (kernels + sampling / ratio * exp(-gain)).sqrt()
    }

    /// Returns the relative error at a time in s from the beginning of the run.
    pub fn error_after_seconds(&self, seconds: f64) -> f64 {
        self.error_after_passes((seconds - self.seconds_before) / self.seconds_per_pass)
    }

    /// Returns when the relative error falls to `error`, at least one pass after the last
    /// measurement, or `None` after more than 10¹⁵ passes.
    pub fn milestone(&self, error: f64) -> Option<ErrorMilestone> {
        let passes = self.passes_to(error, 0.0)?;
        let seconds = |passes: f64| self.seconds_before + passes * self.seconds_per_pass;
        let interval = self.passes_to(error, -TWO_SIGMA).zip(self.passes_to(error, TWO_SIGMA));
        let seconds_interval = interval.map(|(least, most)| [seconds(least), seconds(most)]);
        Some(ErrorMilestone { error, passes, seconds: seconds(passes), seconds_interval })
    }

    /// Returns the passes after which the error, which is larger than expected by this number of
    /// standard deviations, falls to `error`.
    fn passes_to(&self, error: f64, deviations: f64) -> Option<f64> {
        const FARTHEST: f64 = 1e15;
        const HALVINGS: usize = 60;
        let is_above = |passes: f64| {
            let spread = (self.scatter.powi(2) + (self.rate_uncertainty * ln(passes / self.passes)).powi(2)).sqrt();
            self.error_after_passes(passes) * exp(deviations * spread) > error
        };
        let (mut low, mut high) = (self.passes + 1.0, FARTHEST);
        if is_above(high) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = (low * high).sqrt();
            if is_above(middle) { low = middle } else { high = middle }
        }
        Some(high)
    }

    /// Returns the two largest round errors (50, 20, 10, 5, 2, 1, 0.5 … %) below the present error.
    pub fn milestones(&self) -> impl Iterator<Item = ErrorMilestone> {
        let errors = (self.error > 0.0).then(|| round_errors_below(self.error));
        errors.into_iter().flatten().filter_map(|error| self.milestone(error))
    }
}

/// Returns the two largest numbers below `error` that are 1, 2 or 5 times a power of ten.
fn round_errors_below(error: f64) -> [f64; 2] {
    let decade = log10(error).floor() as i32;
    let steps = (decade - 2..=decade).rev().flat_map(|power| [5.0, 2.0, 1.0].map(|step| (step, power)));
    // Division gives the double nearest to the decimal number: 2/100 equals the literal 0.02.
    let mut below = steps
        .map(|(step, power)| if power < 0 { step / 10_f64.powi(-power) } else { step * 10_f64.powi(power) })
        .filter(|&round| round < error);
    std::array::from_fn(|_| below.next().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `parts` returns the three terms of the squared error after n passes.
    fn history(passes: &[u64], parts: impl Fn(f64) -> [f64; 3]) -> ErrorHistory {
        let mut history = ErrorHistory::default();
        for &n in passes {
            let [bias, kernel_noise, sampling] = parts(n as f64);
            let squares = ErrorSquares { bias, kernel_noise, sampling };
            let whole = ErrorSquares { bias: 1.0, ..squares };
            history.add(n, PictureErrors { whole, typical: squares, has_glints: false });
        }
        history
    }

    fn times(passes: u64, total_s: f64, before_first_pass_s: f64) -> RunTimes {
        RunTimes { passes, total_s, before_first_pass_s }
    }

    const DENSE: [u64; 8] = [8, 9, 10, 12, 14, 16, 18, 20];

    /// Returns the variance of the mean of eight replicates, to which the n passes go in turn, each
    /// with the variance m^(−slope) after m passes.
    fn variance_of_mean(n: f64, slope: f64) -> f64 {
        let of_one = |r: u64| ((n as u64 + r) / 8).max(1) as f64;
        (0..8).map(|r| of_one(r).powf(1.0 - slope)).sum::<f64>() / 8.0 / n
    }

    #[test]
    fn each_term_falls_at_its_own_rate() {
        for (slope, parts) in [(1.0, [0.0, 0.0, 1.0]), (1.8, [0.0, 0.0, 1.0]), (1.0, [0.01, 0.02, 0.5])] {
            let at = |n: f64| {
                let [bias, kernel_noise, sampling] = parts;
                [bias * n.powf(-0.5), kernel_noise * n.powf(-2.0 / 3.0), sampling * variance_of_mean(n, slope)]
            };
            let forecast = history(&DENSE, at).forecast(times(20, 42.0, 2.0)).unwrap().typical;
            let known = at(80.0).iter().sum::<f64>().sqrt();
            let ratio = forecast.error_after_seconds(162.0) / known;
            // The prior shifts the slope a little.
            assert!((ratio - 1.0).abs() < 0.05, "slope {slope}: {ratio}");
            let milestone = forecast.milestone(forecast.error_after_passes(80.0)).unwrap();
            assert!((milestone.passes / 80.0 - 1.0).abs() < 1e-6 && (milestone.seconds / 162.0 - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn bias_and_kernel_noise_alone_fall_at_their_rates() {
        for (parts, exponent) in [([0.04, 0.0, 0.0], -0.5), ([0.0, 0.04, 0.0], -2.0 / 3.0)] {
            let forecast = history(&[16], |_| parts).forecast(times(16, 1.0, 0.0)).unwrap().typical;
            let squared = forecast.error_after_passes(16.0 * 64.0).powi(2);
            assert!((squared / (0.04 * 64_f64.powf(exponent)) - 1.0).abs() < 1e-12, "{parts:?}: {squared}");
        }
    }

    #[test]
    fn the_present_time_has_the_present_error() {
        let forecast = history(&[20], |_| [0.01, 0.02, 0.03]).forecast(times(20, 42.0, 22.0)).unwrap().typical;
        assert!((forecast.error_after_seconds(42.0) / 0.06_f64.sqrt() - 1.0).abs() < 1e-12);
        assert!((forecast.error_after_seconds(62.0) / forecast.error_after_passes(40.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_second_passes_of_replicates_reveal_the_slope() {
        // The steepest slope is rare and far from the prior, so its tolerance is larger.
        for (slope, within) in [(1.0, 0.25), (1.6, 0.25), (1.8, 0.35)] {
            let forecast = history(&[8, 9, 10], |n| [0.0, 0.0, variance_of_mean(n, slope)])
                .forecast(times(10, 1.0, 0.0))
                .unwrap()
                .typical;
            let ratio = forecast.error_after_passes(40.0) / variance_of_mean(40.0, slope).sqrt();
            assert!((ratio - 1.0).abs() < within, "slope {slope}: {ratio}");
            let usual = history(&[10], |n| [0.0, 0.0, variance_of_mean(n, slope)])
                .forecast(times(10, 1.0, 0.0))
                .unwrap()
                .typical;
            let without = usual.error_after_passes(40.0) / variance_of_mean(40.0, slope).sqrt();
            assert!(
                (ratio - 1.0).abs() < (without - 1.0).abs(),
                "slope {slope}: {ratio}, and {without} without history"
            );
        }
    }

    #[test]
    fn the_slope_is_the_prior_or_limited_by_the_strata() {
        let one = history(&[16], |_| [0.0, 0.0, 0.01]).forecast(times(16, 1.6, 0.0)).unwrap().typical;
        assert!((one.error_after_passes(64.0) - 0.1 * 4_f64.powf(-0.5 * PRIOR_SLOPE)).abs() < 1e-12);
        let lucky = history(&DENSE, |n| [0.0, 0.0, n.powi(-5)]).forecast(times(20, 2.0, 0.0)).unwrap().typical;
        assert_eq!(lucky.slope, 2.0);
        assert!(ErrorHistory::default().forecast(times(8, 1.0, 0.0)).is_none());
    }

    /// The interval contains the truth, is narrow for a regular history, and wide for one in which
    /// rare bright samples raise the error again and again.
    #[test]
    fn an_interval_shows_how_far_a_forecast_can_be_trusted() {
        let at = |n: f64| [0.0, 0.0, variance_of_mean(n, 1.2)];
        let dense: Vec<u64> = (8..=80).step_by(4).collect();
        let interval = |history: &ErrorHistory, passes: u64, error: f64| {
            let forecast = history.forecast(times(passes, passes as f64, 0.0)).unwrap().typical;
            forecast.milestone(error).and_then(|milestone| milestone.seconds_interval)
        };
        let error = variance_of_mean(320.0, 1.2).sqrt();
        let [least, most] = interval(&history(&dense, at), 80, error).unwrap();
        assert!(least < 320.0 && 320.0 < most && most < 3.0 * least, "{least} to {most}");
        let rare = |n: f64| [0.0, 0.0, 1.0 / n * if (n as u64 / 16).is_multiple_of(2) { 1.0 } else { 16.0 }];
        let [least, most] = interval(&history(&dense, rare), 80, 0.02).unwrap_or([1.0, f64::INFINITY]);
        assert!(most > 10.0 * least, "{least} to {most}");
        let [least, most] = interval(&history(&[8], at), 8, variance_of_mean(64.0, 1.2).sqrt()).unwrap();
        assert!(least < 64.0 && 64.0 < most && most > 2.0 * least, "{least} to {most}");
    }

    #[test]
    fn the_time_to_an_error_is_unknown_while_few_pixels_have_most_of_it() {
        let errors =
            |has_glints: bool| PictureErrors { has_glints, ..history(&[10], |_| [0.0, 0.0, 0.01]).points[0].1 };
        let interval = |has_glints: bool| {
            let forecast = Forecasts::without_history(errors(has_glints), times(10, 1.0, 0.0)).unwrap().typical;
            forecast.milestone(0.05).unwrap().seconds_interval
        };
        assert_eq!(interval(true), None);
        assert!(interval(false).is_some());
    }

    #[test]
    fn milestones_are_the_next_two_round_errors() {
        let below = [0.031, 0.02, 0.26, 1.7, 0.000_51].map(round_errors_below);
        assert_eq!(below, [[0.02, 0.01], [0.01, 0.005], [0.2, 0.1], [1.0, 0.5], [0.0005, 0.0002]]);
        let exact = history(&[8], |_| [0.0; 3]).forecast(times(8, 1.0, 0.0)).unwrap().typical;
        assert_eq!(exact.milestones().count(), 0, "the error is already 0");
    }
}
