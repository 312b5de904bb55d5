//! Runs the renders of a study, and stores their results.

use std::time::Duration;

use super::convergence::ConvergenceMonitor;
use super::monitor::StudyError;
use super::monitor::StudyMonitor;
use super::reference::ReferencePicture;
use super::step_cache::{StepCache, StepResult};
use super::study_scene::StudyScene;
use abbe_session::output::hash::IdentityHash;
use abbe_session::render::{Integrator, Request, StopRules, current_threads};
use abbe_transport::sensor::Picture;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct RenderStep {
    pub(super) name: String,
    /// The description in progress reports.
    pub(super) label: String,
    /// Changes of the scene in the form `PATH=JSON`.
    pub(super) changes: Vec<String>,
    /// The integrator and the stop rules.
    pub(super) request: Request,
}

impl RenderStep {
    /// Creates a render of about `seconds` by photon mapping with the scene's own settings.
    pub(super) fn new(name: &str, label: &str, seconds: f64) -> Self {
        let stop = StopRules { time: Some(Duration::from_secs_f64(seconds)), ..StopRules::default() };
        let request = Request { integrator: Integrator::Photon, stop };
        Self { name: name.to_string(), label: label.to_string(), changes: Vec::new(), request }
    }

    /// Selects another integrator.
    pub(super) fn with_integrator(mut self, integrator: Integrator) -> Self {
        self.request.integrator = integrator;
        self
    }

    /// Replaces the time limit of the render by a limit on the number of passes.
    pub(super) fn with_passes(mut self, passes: u64) -> Self {
        self.request.stop = StopRules { passes: Some(passes), ..StopRules::default() };
        self
    }

    pub(super) fn with_changes(mut self, changes: impl IntoIterator<Item = String>) -> Self {
        self.changes.extend(changes);
        self
    }
}

/// The result of a step, and the picture of the step.
#[derive(Debug, Clone)]
pub(super) struct FinishedStep {
    pub(super) result: StepResult,
    pub(super) picture: Picture,
}

/// Runs the steps of a study, each at most once.
pub(super) struct Runner<'a> {
    pub(super) study_scene: &'a StudyScene,
    pub(super) step_cache: StepCache,
    pub(super) monitor: &'a mut (dyn StudyMonitor + Send),
    /// The changes of the scene that set the film size, once it is chosen.
    pub(super) film_changes: Vec<String>,
    pub(super) steps_done: usize,
    pub(super) steps_total: usize,
    /// The total time of all steps in seconds, including cached steps of former runs.
    pub(super) seconds_spent: f64,
}

impl Runner<'_> {
    /// Renders a step, or loads its cached result. Measures the error against `reference`, a
    /// picture and its identity, if given.
    pub(super) fn render(
        &mut self,
        step: &RenderStep,
        reference: Option<(&ReferencePicture, &str)>,
    ) -> Result<FinishedStep, StudyError> {
        self.steps_done += 1;
        let changes: Vec<String> = self.film_changes.iter().chain(&step.changes).cloned().collect();
        let identity = self.identity(step, &changes, reference.map(|(_, identity)| identity));
        let cached = self.step_cache.find(&step.name, &identity);
        let label = format!("{}/{} {}", self.steps_done, self.steps_total, step.label);
        self.monitor.begin(&label, cached.is_some());
        let (result, picture) = match cached {
            Some(cached) => cached,
            None => {
                let (result, picture) = self.rendered(step, &changes, reference.map(|(picture, _)| picture))?;
                self.step_cache.store(&step.name, &identity, result, &picture)?
            }
        };
        self.seconds_spent += result.stats.seconds.total;
        Ok(FinishedStep { result, picture })
    }

    fn rendered(
        &mut self,
        step: &RenderStep,
        changes: &[String],
        reference: Option<&ReferencePicture>,
    ) -> Result<(StepResult, Picture), StudyError> {
        let job = self.study_scene.job(changes)?;
        let passes_wanted = job.budget.passes;
        let mut monitor = ConvergenceMonitor::new(&mut *self.monitor, reference, passes_wanted);
        let mut rendered =
            job.render(step.request, &mut monitor).map_err(|error| error.in_file(&self.study_scene.path))?;
        if rendered.interrupted {
            return Err(StudyError::Interrupted);
        }
        monitor.measure(rendered.stats.passes, &rendered.picture);
        let ConvergenceMonitor { points, measuring, .. } = monitor;
        rendered.stats.seconds.total -= measuring.as_secs_f64();
        let stats = rendered.stats;
        let events = |name: &str| stats.effects.get(name).map_or(0, |effect| effect.events);
        let stored = stats.photons_stored + events("volume-photons") + events("photon-beams");
        let memory_bytes = job.budget.memory_keeping(stored / stats.passes.max(1));
        Ok((StepResult { points, stats, memory_bytes, passes_wanted }, rendered.picture))
    }

    /// Hashes all inputs of a step, also the number of threads, which affects the measured times.
    pub(super) fn identity(&self, step: &RenderStep, changes: &[String], reference: Option<&str>) -> String {
        let mut hash = IdentityHash::default();
        let parts = [
            env!("CARGO_PKG_VERSION"),
            "with the error of a typical pixel",
            &self.study_scene.hash,
            &step.name,
            &format!("{:?}", step.request),
            &format!("{} threads", current_threads()),
            reference.unwrap_or("nothing"),
        ];
        parts.into_iter().chain(changes.iter().map(String::as_str)).for_each(|part| hash.add_part(part.as_bytes()));
        hash.hex()
    }
}
