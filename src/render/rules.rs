//! When a run stops: at the first rule that holds.

use super::forecast::{Forecast, History};
use super::{Job, Progress, Run, StopRules};
use crate::error::{Error, Result};
use crate::sensor::ErrorSquares;
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
    watch: ErrorWatch,
}

impl Rules {
    /// The rules of a request; the run is told how many passes are wanted.
    pub(super) fn new(job: &Job, stop: StopRules, run: &mut Run) -> Self {
        run.wanted = stop.passes_wanted(&job.budget);
        let wanted = run.wanted.map(|passes| run.part.count_of(passes));
        Self { stop, wanted, watch: ErrorWatch::default() }
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
        let elapsed = elapsed(run);
        let target = self.stop.target_error.filter(|_| ErrorWatch::decides_after(run.done));
        self.watch.look(run, elapsed, target.is_some());
        self.wanted.is_some_and(|wanted| run.done >= wanted)
            || self.stop.time.is_some_and(|limit| elapsed >= limit)
            || target.zip(self.watch.history.latest()).is_some_and(|(target, error)| error <= target)
    }

    /// How the run stands, for a monitor.
    pub(super) fn progress(&self, run: &Run) -> Progress {
        Progress {
            passes: run.done,
            passes_wanted: self.wanted,
            elapsed: elapsed(run),
            time_wanted: self.stop.time,
            photons_per_second: run.tally.photons as f64 / run.seconds.total,
            relative_error: self.watch.history.latest(),
            error_wanted: self.stop.target_error,
            forecast: self.watch.forecast(run),
        }
    }

    /// How the error would fall from the end on, where it was measured as this.
    pub(super) fn forecast_at_end(&mut self, run: &Run, squares: Option<ErrorSquares>) -> Option<Forecast> {
        self.watch.history.add(run.done, squares?);
        self.watch.forecast(run)
    }
}

fn elapsed(run: &Run) -> Duration {
    Duration::try_from_secs_f64(run.seconds.total).unwrap_or_default()
}

/// Measures the error now and then: developing costs time, so it may take no more than a small share of it, and a larger one only for the first forecast.
#[derive(Debug, Default)]
struct ErrorWatch {
    history: History,
    /// When it is measured next: not before so many passes, and not before that time.
    next: (u64, Duration),
}

impl ErrorWatch {
    /// Whether the error may end the run after so many passes: as often as not to depend on how fast they were, and only when each replicate has
    /// two passes; fewer say little about noise.
    fn decides_after(passes: u64) -> bool {
        passes >= 16 && passes.is_multiple_of(8)
    }

    /// Measures the error if that is needed, or not too early.
    fn look(&mut self, run: &Run, elapsed: Duration, needed: bool) {
        /// Fewer passes than one in each replicate would underrate the noise of stratified samples.
        const FIRST: u64 = 8;
        let due = run.done >= self.next.0.max(FIRST) && elapsed >= self.next.1;
        if needed || due {
            let begun = Instant::now();
            let (_, squares) = run.film.develop_and_judge();
            squares.into_iter().for_each(|squares| self.history.add(run.done, squares));
            let pause = begun.elapsed() * if run.done < FIRST + 2 { 5 } else { 50 };
            self.next = (run.done + (run.done / 8).max(1), elapsed + pause);
        }
    }

    fn forecast(&self, run: &Run) -> Option<Forecast> {
        self.history.forecast((run.done, run.seconds.total, run.seconds.pilot))
    }
}
