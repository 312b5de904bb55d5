//! Checks the stop rules of a run.

use super::forecast::{ErrorHistory, Forecasts, RunTimes};
use super::job::Job;
use super::monitor::Progress;
use super::request::StopRules;
use super::run::Run;
use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::PictureErrors;
use std::time::Duration;
use web_time::Instant;

/// The time of a run, without that between an interruption and the continuation.
#[derive(Debug)]
pub(super) struct RunClock {
    start: Instant,
    /// The time in s that the run took before this process started or continued it.
    before_s: f64,
}

impl RunClock {
    pub(super) fn start(run: &Run) -> Self {
        Self { start: Instant::now(), before_s: run.sums.seconds.total }
    }

    pub(super) fn started(&self) -> Instant {
        self.start
    }

    pub(super) fn update(&self, run: &mut Run) {
        run.sums.seconds.total = self.before_s + self.start.elapsed().as_secs_f64();
    }
}

/// The stop rules of a run, and the measurements for them.
#[derive(Debug)]
pub(super) struct StopConditions {
    rules: StopRules,
    /// The passes of this run's part at which the render stops, or `None` without limit.
    wanted: Option<u64>,
    error: ErrorTracker,
}

impl StopConditions {
    /// Creates the stop rules of a request. Writes the number of wanted passes into the run.
    pub(super) fn new(job: &Job, rules: StopRules, run: &mut Run) -> Self {
        run.wanted = rules.passes_wanted(&job.budget);
        let wanted = run.wanted.map(|passes| run.part.count_of(passes));
        Self { rules, wanted, error: ErrorTracker::default() }
    }

    /// Returns an input error if the part has no passes, or if the run has too many.
    pub(super) fn check(&self, run: &Run) -> Result<()> {
        let (part, wanted) = (run.part, self.wanted.unwrap_or(u64::MAX));
        if wanted == 0 {
            return Err(Error::input(format!("part {part} contains none of the passes"))
                .expected("more passes, or fewer parts"));
        }
        if run.done > wanted {
            let what = format!("the saved run has {} passes already", run.done);
            let least = part.pass(run.done - 1) + 1;
            return Err(Error::input(what).expected(format!("at least {least} passes")));
        }
        Ok(())
    }

    /// Returns true if a stop rule is satisfied, and measures the error if that is due.
    pub(super) fn hold(&mut self, run: &Run) -> bool {
        let elapsed = elapsed(run);
        let target = self.rules.target_error.filter(|_| ErrorTracker::decides_after(run.done));
        self.error.update(run, elapsed, target.is_some());
        self.wanted.is_some_and(|wanted| run.done >= wanted)
            || self.rules.time.is_some_and(|limit| elapsed >= limit || elapsed + mean_pass(run) > limit + OVERRUN)
            || target
                .zip(self.error.history.latest())
                .is_some_and(|(target, errors)| errors.typical.relative() <= target)
    }

    pub(super) fn progress(&self, run: &Run) -> Progress {
        Progress {
            passes: run.done,
            passes_wanted: self.wanted,
            elapsed: elapsed(run),
            time_wanted: self.rules.time,
            photons_per_second: run.sums.tally.photons as f64 / run.sums.seconds.total,
            relative_error: self.error.history.latest().map(|errors| errors.whole.relative()),
            typical_error: self.error.history.latest().map(|errors| errors.typical.relative()),
            error_wanted: self.rules.target_error,
            forecast: self.error.forecast(run).map(|forecasts| forecasts.typical),
        }
    }

    /// `errors` are the final squared errors, if they are known.
    pub(super) fn forecast_at_end(&mut self, run: &Run, errors: Option<PictureErrors>) -> Option<Forecasts> {
        self.error.history.add(run.done, errors?);
        self.error.forecast(run)
    }
}

/// A time limit ends the render before a pass that would exceed the limit by more than this time.
const OVERRUN: Duration = Duration::from_millis(500);

/// Returns the mean time of a pass, which the next pass is expected to take.
fn mean_pass(run: &Run) -> Duration {
    let RunTimes { passes, total_s, before_first_pass_s } = RunTimes::of(run.done, &run.sums.seconds);
    Duration::try_from_secs_f64((total_s - before_first_pass_s) / passes.max(1) as f64).unwrap_or_default()
}

fn elapsed(run: &Run) -> Duration {
    Duration::try_from_secs_f64(run.sums.seconds.total).unwrap_or_default()
}

/// Measures the error of the picture from time to time. This develops the picture, so all
/// measurements together may take only a fraction of the run's time, more at first, so that a
/// forecast is soon available.
#[derive(Debug, Default)]
struct ErrorTracker {
    history: ErrorHistory,
    next_pass: u64,
    /// The next measurement is due at this time or later.
    next_time: Duration,
}

impl ErrorTracker {
    /// Returns true if the error may stop the run after this many passes.
    fn decides_after(passes: u64) -> bool {
        passes > 0 && StopRules::next_decision(passes - 1) == passes
    }

    /// Measures the error if a stop rule needs the error, or if a measurement is due.
    fn update(&mut self, run: &Run, elapsed: Duration, needed: bool) {
        /// One pass per replicate. Fewer would underestimate the noise of stratified samples.
        const FIRST: u64 = 8;
        let due = run.done >= self.next_pass.max(FIRST) && elapsed >= self.next_time;
        if needed || due {
            let start = Instant::now();
            run.errors().into_iter().for_each(|errors| self.history.add(run.done, errors));
            let pause = start.elapsed() * if run.done < FIRST + 2 { 5 } else { 50 };
            self.next_pass = run.done + (run.done / 8).max(1);
            self.next_time = elapsed + pause;
        }
    }

    fn forecast(&self, run: &Run) -> Option<Forecasts> {
        self.history.forecast(RunTimes::of(run.done, &run.sums.seconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_decides_after_whole_rounds_of_the_replicates() {
        let deciding: Vec<u64> = (0..48).filter(|&passes| ErrorTracker::decides_after(passes)).collect();
        assert_eq!(deciding, [16, 24, 32, 40]);
    }
}
