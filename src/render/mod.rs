//! The loop over passes: pilot, then passes until a stop rule holds; what was measured on the way; saving a run, going on with it and
//! merging several.

mod crowd;
mod diffraction;
mod forecast;
mod harvest;
mod merge;
mod part;
mod pass;
mod pilot;
mod rules;
mod run;
mod saved;
mod stats;
mod threads;

pub use diffraction::Diffracting;
pub use forecast::{Forecast, Milestone};
pub use merge::{Merged, Merging};
pub use part::Part;
pub use run::Run;
pub use saved::{Identity, Saved, Showing};
pub use stats::{ForecastStats, Seconds, Stats};
pub use threads::on_threads;

use crate::emit::LightChoice;
use crate::error::{Error, Result};
use crate::map::LightMaps;
use crate::plan::{Budget, Plan, Row};
use crate::scene::Scene;
use crate::sensor::{Film, Picture};
use crate::walk::ledger::Ledger;
use pilot::Pilot;
use rules::{Clock, Rules};
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

impl Integrator {
    /// `photon` or `path`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Photon => "photon",
            Self::Path => "path",
        }
    }
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

impl StopRules {
    /// How many passes a whole picture is to have, if a number decides.
    pub fn passes_wanted(&self, budget: &Budget) -> Option<u64> {
        let by_default = self.time.is_none() && self.target_error.is_none();
        self.passes.or(by_default.then_some(budget.passes))
    }
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
    /// What diffraction at the camera's opening does to the picture, if the plan has it.
    pub diffraction: Option<Diffracting>,
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
    /// How the error will fall, by when it was last measured.
    pub forecast: Option<Forecast>,
}

/// Watches a render; may end it after a pass.
pub trait Monitor {
    /// Called after every pass; false ends the render.
    fn after_pass(&mut self, progress: &Progress) -> bool;

    /// Called after every pass that another will follow, with all that has been found: a chance to save it.
    fn keep(&mut self, _run: &Run) {}
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
    /// All that going on needs.
    pub run: Run,
}

impl Job {
    /// Plans a scene. Errors name effects that do not exist or cannot be left out, and scenes without visible light.
    pub fn new(mut scene: Scene) -> Result<Self> {
        let (plan, rows) = crate::plan::prepare(&mut scene)?;
        let choice = LightChoice::new(&scene).ok_or_else(|| {
            Error::input("no light in the scene has power within 360–830 nm: there is nothing to see")
        })?;
        let film = &scene.film;
        let diffraction = Diffracting::of(&scene.camera, &plan, &choice);
        let slices = diffraction.as_ref().map_or(0, Diffracting::slices);
        let [width, height, bands] = [film.width, film.height, film.spectral_bands].map(|count| count as usize);
        let film_bytes = Film::memory_bytes(width, height, bands, slices);
        // The sums; and while they are saved their copy in words, and the file.
        let budget = Budget::of(&scene, &plan, (film_bytes as u64).saturating_mul(3));
        Ok(Self { scene, plan, rows, budget, diffraction, choice })
    }

    /// The power of all lights by their closed forms, in W over the band.
    pub fn lamp_power_w(&self) -> f64 {
        self.choice.power_w
    }

    /// Renders all passes on the current thread pool until a stop rule holds.
    pub fn render(&self, request: Request, monitor: &mut dyn Monitor) -> Result<Rendered> {
        self.go_on(request, Run::new(self, Part::WHOLE), monitor)
    }

    /// Goes on with a run, a new one or one that was saved, until a stop rule holds. The rules count from the run's very beginning: a
    /// run that was resumed stops where it would have stopped without the break.
    pub fn go_on(&self, request: Request, mut run: Run, monitor: &mut dyn Monitor) -> Result<Rendered> {
        let clock = Clock::start(&run);
        let mut rules = Rules::new(self, request.stop, &mut run);
        rules.check(&run)?;
        let mut stopped = run.done > 0 && rules.hold(&run);
        // The pilot depends on scene and seed alone: a resumed run finds again what it found before.
        let pilot = match request.integrator {
            Integrator::Photon if !stopped => Some(Pilot::fly(self, &mut run.seconds)?),
            Integrator::Photon | Integrator::Path => None,
        };
        let (mut interrupted, mut light_maps) = (false, LightMaps::default());
        while !(stopped || interrupted) {
            let pass = run.part.pass(run.done);
            match &pilot {
                Some(pilot) => pass::photon_pass(self, pilot, &mut light_maps, (pass, &mut run))?,
                None => pass::path_pass(self, pass, &mut run)?,
            }
            run.done += 1;
            clock.tell(&mut run);
            stopped = rules.hold(&run);
            interrupted = !monitor.after_pass(&rules.progress(&run)) && !stopped;
            if !(stopped || interrupted) {
                monitor.keep(&run);
            }
        }
        if run.film.overflowed() {
            return Err(Error::input("the light in a pixel exceeds 9e18 W/m²/sr: the lamp's power cannot be meant so"));
        }
        let develop = Instant::now();
        let (picture, squares) = run.film.develop_and_judge();
        run.seconds.develop += develop.elapsed().as_secs_f64();
        clock.tell(&mut run);
        let stats = Stats::new(self, &run, &picture, rules.forecast_at_end(&run, squares));
        let mut ledger = run.ledger.clone();
        ledger.scale(1.0 / run.done.max(1) as f64);
        Ok(Rendered { picture, ledger, stats, interrupted, run })
    }
}
