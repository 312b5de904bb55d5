//! When a run stops: at the first rule that holds.

use super::{Job, Progress, Run, StopRules};
use crate::error::{Error, Result};
use crate::sensor::Film;
use std::time::{Duration, Instant};

/// Counts a run's time, over breaks.
#[derive(Debug)]
pub(super) struct Clock {
    start: Instant,
    /// Seconds of the run before this start.
    before: f64,
}

impl Clock {
    pub(super) fn start(run: &Run) -> Self {
        Self { start: Instant::now(), before: run.seconds.total }
    }

    /// Tells the run how long it has taken.
    pub(super) fn tell(&self, run: &mut Run) {
        run.seconds.total = self.before + self.start.elapsed().as_secs_f64();
    }
}

/// The stop rules of a run, and what they look at.
#[derive(Debug)]
pub(super) struct Rules {
    stop: StopRules,
    /// Passes of this run, if a number was given.
    wanted: Option<u64>,
    measured: ErrorWatch,
}

impl Rules {
    /// The rules of a request; the run is told how many passes are wanted.
    pub(super) fn new(job: &Job, stop: StopRules, run: &mut Run) -> Self {
        run.wanted = stop.passes_wanted(&job.budget);
        let wanted = run.wanted.map(|passes| run.part.count_of(passes));
        Self { stop, wanted, measured: ErrorWatch::default() }
    }

    /// Refuses a number of passes that leaves the run none, or fewer than it has.
    pub(super) fn check(&self, run: &Run) -> Result<()> {
        let (part, wanted) = (run.part, self.wanted.unwrap_or(u64::MAX));
        if wanted == 0 {
            return Err(
                Error::input(format!("part {part} has none of so few passes")).expected("more passes, or fewer parts")
            );
        }
        if run.done > wanted {
            let what = format!("the run that was saved has {} passes already", run.done);
            let least = part.pass(run.done - 1) + 1;
            return Err(Error::input(what).expected(format!("--passes {least} or more")));
        }
        Ok(())
    }

    /// Whether a rule holds after a pass.
    pub(super) fn hold(&mut self, run: &Run) -> bool {
        let elapsed = Duration::try_from_secs_f64(run.seconds.total).unwrap_or_default();
        let error = self.measured.update(&run.film, run.done, elapsed, self.stop.target_error.is_some());
        self.wanted.is_some_and(|wanted| run.done >= wanted)
            || self.stop.time.is_some_and(|limit| elapsed >= limit)
            || self.stop.target_error.zip(error).is_some_and(|(target, error)| error <= target)
    }

    /// How the run stands, for a monitor.
    pub(super) fn progress(&self, run: &Run) -> Progress {
        Progress {
            passes: run.done,
            passes_wanted: self.wanted,
            elapsed: Duration::try_from_secs_f64(run.seconds.total).unwrap_or_default(),
            time_wanted: self.stop.time,
            photons_per_second: run.tally.photons as f64 / run.seconds.total,
            relative_error: self.measured.latest,
            error_wanted: self.stop.target_error,
        }
    }
}

/// Measures the error now and then: developing costs time, so it may take no more than a small share of it.
#[derive(Debug, Default)]
struct ErrorWatch {
    latest: Option<f64>,
    next: Duration,
}

impl ErrorWatch {
    fn update(&mut self, film: &Film, passes: u64, elapsed: Duration, wanted: bool) -> Option<f64> {
        /// Fewer passes than two in each replicate say little about noise.
        const FIRST: u64 = 16;
        if passes >= FIRST && passes.is_multiple_of(8) && (wanted || elapsed >= self.next) {
            let begun = Instant::now();
            self.latest = film.develop().error_means().relative;
            self.next = elapsed + begun.elapsed() * 50;
        }
        self.latest
    }
}
