//! The loop over passes: pilot, then passes until a stop rule holds; what was measured on the way.

mod harvest;
mod pass;
mod pilot;
mod stats;
mod threads;

pub use stats::{Seconds, Stats};
pub use threads::on_threads;

use crate::emit::LightChoice;
use crate::error::{Error, Result};
use crate::plan::{Budget, Plan, Row};
use crate::scene::Scene;
use crate::sensor::{Film, Picture};
use crate::walk::Tally;
use crate::walk::ledger::Ledger;
use pilot::Pilot;
use std::time::{Duration, Instant};

/// Who solves the transport.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integrator {
    /// Photon mapping.
    #[default]
    Photon,
    /// The reference path tracer.
    Path,
}

/// When a render stops: at the first that holds. Without any, the budget's passes count.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StopRules {
    /// After this many passes.
    pub passes: Option<u64>,
    /// After this time.
    pub time: Option<Duration>,
    /// When the relative error falls to this.
    pub target_error: Option<f64>,
}

/// What a render is asked to do.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Request {
    /// Who solves the transport.
    pub integrator: Integrator,
    /// When to stop.
    pub stop: StopRules,
}

/// A scene with its plan and budget: all that a render needs.
#[derive(Debug)]
pub struct Job {
    /// The scene.
    pub scene: Scene,
    /// What it calls for.
    pub plan: Plan,
    /// The plan's reasons.
    pub rows: Vec<Row>,
    /// Passes and photons.
    pub budget: Budget,
    /// Its lights as one source.
    choice: LightChoice,
}

/// How a render stands after a pass.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Passes done.
    pub passes: u64,
    /// Passes wanted, if a number was given.
    pub passes_wanted: Option<u64>,
    /// Time since the start.
    pub elapsed: Duration,
    /// Time wanted, if one was given.
    pub time_wanted: Option<Duration>,
    /// Photons per second so far.
    pub photons_per_second: f64,
    /// Relative error, when it was last measured.
    pub relative_error: Option<f64>,
    /// The relative error wanted, if one was given.
    pub error_wanted: Option<f64>,
}

/// Watches a render; may end it after a pass.
pub trait Monitor {
    /// Called after every pass; false ends the render.
    fn after_pass(&mut self, progress: &Progress) -> bool;
}

/// Watches nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Monitor for Unwatched {
    fn after_pass(&mut self, _: &Progress) -> bool {
        true
    }
}

/// A finished (or ended) render.
#[derive(Debug)]
pub struct Rendered {
    /// The picture with its error layers.
    pub picture: Picture,
    /// Where the light went, in the mean over passes.
    pub ledger: Ledger,
    /// What was measured.
    pub stats: Stats,
    /// Whether the monitor ended it before a stop rule held.
    pub interrupted: bool,
}

impl Job {
    /// Plans a scene. Errors name effects that do not exist or cannot be left out, and scenes without visible light.
    pub fn new(mut scene: Scene) -> Result<Self> {
        let (plan, rows) = crate::plan::prepare(&mut scene)?;
        let choice = LightChoice::new(&scene).ok_or_else(|| {
            Error::input("no light in the scene has power within 360–830 nm: there is nothing to see")
        })?;
        let film = &scene.film;
        let film_bytes = Film::memory_bytes(film.width as usize, film.height as usize, film.spectral_bands as usize);
        let budget = Budget::of(&scene, film_bytes as u64);
        Ok(Self { scene, plan, rows, budget, choice })
    }

    /// The power of all lights by their closed forms, in W over the band.
    pub fn lamp_power_w(&self) -> f64 {
        self.choice.power_w
    }

    /// Renders on the current thread pool until a stop rule holds.
    pub fn render(&self, request: Request, monitor: &mut dyn Monitor) -> Result<Rendered> {
        let start = Instant::now();
        let film = &self.scene.film;
        let mut run = Run {
            film: Film::new(film.width as usize, film.height as usize, film.observer, film.spectral_bands as usize),
            ledger: Ledger::new(self.scene.materials.len()),
            tally: Tally::default(),
            seconds: Seconds::default(),
        };
        let pilot = match request.integrator {
            Integrator::Photon => Some(Pilot::fly(self, &mut run.seconds)),
            Integrator::Path => None,
        };
        let wanted = request.stop.passes.or_else(|| {
            let other = request.stop.time.is_some() || request.stop.target_error.is_some();
            (!other).then_some(self.budget.passes)
        });
        let mut measured = ErrorWatch::default();
        let mut interrupted = false;
        let mut pass = 0;
        while wanted.is_none_or(|wanted| pass < wanted) {
            match &pilot {
                Some(pilot) => pass::photon_pass(self, pilot, pass, &mut run),
                None => pass::path_pass(self, pass, &mut run),
            }
            pass += 1;
            let elapsed = start.elapsed();
            let relative_error = measured.update(&run.film, pass, elapsed, request.stop.target_error.is_some());
            let progress = Progress {
                passes: pass,
                passes_wanted: wanted,
                elapsed,
                time_wanted: request.stop.time,
                photons_per_second: run.tally.photons as f64 / elapsed.as_secs_f64(),
                relative_error,
                error_wanted: request.stop.target_error,
            };
            interrupted = !monitor.after_pass(&progress);
            let in_time = request.stop.time.is_none_or(|limit| elapsed < limit);
            let too_noisy = request.stop.target_error.is_none_or(|target| relative_error.is_none_or(|e| e > target));
            if interrupted || !in_time || !too_noisy {
                break;
            }
        }
        let develop = Instant::now();
        let picture = run.film.develop();
        run.seconds.develop += develop.elapsed().as_secs_f64();
        run.seconds.total = start.elapsed().as_secs_f64();
        if run.film.overflowed() {
            return Err(Error::input("the light in a pixel exceeds 9e18 W/m²/sr: the lamp's power cannot be meant so"));
        }
        run.ledger.scale(1.0 / pass.max(1) as f64);
        let stats = Stats::new(self, &run, pass, &picture);
        Ok(Rendered { picture, ledger: run.ledger, stats, interrupted })
    }
}

/// What grows from pass to pass.
#[derive(Debug)]
struct Run {
    film: Film,
    /// Sums over passes.
    ledger: Ledger,
    tally: Tally,
    seconds: Seconds,
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
