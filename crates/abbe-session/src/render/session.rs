//! The loop over passes.

use super::denoise::picture_and_errors;
use super::job::Job;
use super::monitor::Monitor;
use super::part::PassPart;
use super::request::{Integrator, Request};
use super::run::Run;
use super::stats::Stats;
use super::stop::{RunClock, StopConditions};
use abbe_spectra::error::{Error, Result};
use abbe_transport::emit::SpectrumCoverage;
use abbe_transport::gather::Portals;
use abbe_transport::map::LightMaps;
use abbe_transport::pass::{PassContext, StageSeconds, path_pass, photon_pass};
use abbe_transport::pilot::{CoarsePicture, Pilot, coarse_path_picture, find_portals, learn_lights};
use abbe_transport::plan::{MotionPlan, WavelengthPlan};
use abbe_transport::sensor::Picture;
use abbe_transport::walk::ledger::Ledger;
use std::borrow::Cow;
use web_time::Instant;

#[derive(Debug)]
pub struct Rendered {
    pub picture: Picture,
    /// The mean energy balance of a pass, in W.
    pub ledger: Ledger,
    pub stats: Stats,
    /// True if the monitor ended the render before a stop rule was satisfied. The run then contains
    /// all whole passes, which may be none.
    pub interrupted: bool,
    /// The sums of all passes, from which the render can continue.
    pub run: Run,
}

impl Job {
    /// Renders passes on the current thread pool until a stop rule is satisfied.
    pub fn render(&self, request: Request, monitor: &mut dyn Monitor) -> Result<Rendered> {
        self.continue_run(request, Run::new(self, PassPart::WHOLE), monitor)
    }

    /// Returns the spectra that a run's shared wavelengths sampled: all if no path has them.
    fn coverage_of(&self, run: &Run, integrator: Integrator) -> SpectrumCoverage {
        if integrator == Integrator::Path || self.plan.wavelengths == WavelengthPlan::Free {
            return SpectrumCoverage::default();
        }
        let (context, mut coverage) = (self.pass_context(), SpectrumCoverage::before_first_pass(&self.scene));
        let mut done = (0..run.done).map(|nth| run.part.pass(nth));
        while let Some(pass) = done.next().filter(|_| !coverage.is_complete()) {
            context.add_wavelengths(pass, &mut coverage);
        }
        coverage
    }

    /// Renders a sketch of this size in the size of the film on the current thread pool, without
    /// bands and errors. `None` if the film is small. Returns an error if the scene cannot be
    /// posed.
    pub fn sketch(&self, size: f64) -> Result<Option<CoarsePicture>> {
        let context = self.pass_context();
        let portals = find_portals(&context, &mut StageSeconds::default());
        Pilot::sketch(&PassContext { portals: &portals, ..context }, size)
    }

    /// Continues a new or saved run until a stop rule is satisfied. The rules count from the
    /// beginning of the run, so a resumed run stops at the same pass as an uninterrupted one.
    /// Returns an input error if the part contains no passes, the run already has more passes than
    /// wanted, the scene cannot be posed, or the radiance of a pixel is too large.
    pub fn continue_run(&self, request: Request, mut run: Run, monitor: &mut dyn Monitor) -> Result<Rendered> {
        let clock = RunClock::start(&run);
        let mut conditions = StopConditions::new(self, request.stop, &mut run);
        conditions.check(&run)?;
        run.coverage = self.coverage_of(&run, request.integrator);
        let mut stopped = run.done > 0 && conditions.hold(&run);
        if request.integrator == Integrator::Path && self.plan.motion == MotionPlan::Still {
            // Each row has random numbers of its own. Photons and shutter times belong to all rows.
            run.sums.film.assume_independent_rows();
        }
        if self.errors_are_unknown(request.integrator) {
            run.sums.film.assume_missing_light();
        }
        let flag = monitor.stop_flag();
        let context = PassContext { stop: &flag, ..self.pass_context() };
        let portals = if stopped { Portals::default() } else { find_portals(&context, &mut run.sums.seconds) };
        let responses = self.responses(&run.sums.film);
        let context = PassContext { portals: &portals, responses: responses.as_ref(), ..context };
        let selector =
            if stopped { Cow::Borrowed(context.selector) } else { learn_lights(&context, &mut run.sums.seconds) };
        let context = PassContext { selector: &selector, ..context };
        // The pilot depends only on the scene, the seed and the size of the passes, which is saved,
        // so that of a resumed run is the same.
        let levels = if run.done == 0 { monitor.coarse_levels() } else { &[] };
        let pilot = match request.integrator {
            Integrator::Photon if !stopped => {
                monitor.before_pilot();
                let show = |coarse: &CoarsePicture| monitor.show_coarse_picture(coarse);
                // The samples of a meter take milliseconds in any case.
                let time = request.stop.time.filter(|_| !self.scene.measures());
                let size = run.pass_size(time, clock.started());
                let pilot = Pilot::run(&context, size, &mut run.sums.seconds, levels, show)?;
                run.largest_work = pilot.largest_work;
                Some(pilot)
            }
            Integrator::Path if !(levels.is_empty() || stopped) => {
                coarse_path_picture(&context)?.inspect(|coarse| monitor.show_coarse_picture(coarse));
                None
            }
            Integrator::Photon | Integrator::Path => None,
        };
        let (mut interrupted, mut light_maps) = (!stopped && flag.is_raised(), LightMaps::default());
        while !(stopped || interrupted) {
            let pass = run.part.pass(run.done);
            let before = (run.sums.seconds, run.sums.tally);
            let is_whole = match &pilot {
                Some(pilot) => photon_pass(context, &pilot.parameters, &mut light_maps, pass, &mut run.sums)?,
                None => path_pass(context, pass, &mut run.sums)?,
            };
            if !is_whole {
                (run.sums.seconds, run.sums.tally) = before;
                interrupted = true;
                break;
            }
            run.done += 1;
            context.add_wavelengths(pass, &mut run.coverage);
            clock.update(&mut run);
            stopped = conditions.hold(&run);
            interrupted = !monitor.after_pass(&conditions.progress(&run)) && !stopped;
            if !(stopped || interrupted) {
                monitor.checkpoint(&mut run);
            }
        }
        if run.sums.film.overflowed() {
            return Err(Error::input("the radiance in a pixel exceeds 9e18 W/m²/sr").expected("lights of lower power"));
        }
        let unlit = pilot.map_or_else(Vec::new, |pilot| pilot.unlit);
        let develop_start = Instant::now();
        let (picture, errors) = picture_and_errors(&run.sums.film);
        let errors = errors.filter(|_| run.coverage.is_complete());
        run.sums.seconds.develop += develop_start.elapsed().as_secs_f64();
        clock.update(&mut run);
        let stats = Stats::new(self, &run, &picture, conditions.forecast_at_end(&run, errors), &unlit);
        let mut ledger = run.sums.ledger.clone();
        ledger.scale(1.0 / run.done.max(1) as f64);
        Ok(Rendered { picture, ledger, stats, interrupted, run })
    }
}
