//! One render of a study: how its error falls as its passes add up.

use std::time::{Duration, Instant};

use super::reference::{Reference, Wrong};
use super::shelf::Shelf;
use super::subject::Subject;
use super::{Audience, Halt};
use crate::output::hash::Hash;
use crate::render::{Integrator, Monitor, Progress, Request, Run, Stats, StopRules};
use crate::sensor::Picture;
use serde::{Deserialize, Serialize};

/// How a render stood after some passes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Passes.
    pub passes: u64,
    /// Seconds of work so far, pilot included; measuring the error is not counted.
    pub seconds: f64,
    /// How wrong its picture was.
    pub wrong: Wrong,
}

/// What a step found, but for its picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Found {
    /// How the error fell, if it was measured.
    pub(super) points: Vec<Point>,
    /// What the render measured of itself.
    pub(super) stats: Stats,
    /// Memory of film, scene and photons, by the number of photons that were kept.
    pub(super) memory_bytes: u64,
    /// Passes that the settings ask for.
    pub(super) passes_wanted: u64,
}

/// A render to be done.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Order {
    /// The name of its files.
    pub(super) name: String,
    /// What it is, for whoever watches.
    pub(super) words: String,
    /// How the scene is changed, `PATH=JSON`.
    pub(super) changes: Vec<String>,
    /// Who solves the transport, and when that ends.
    pub(super) request: Request,
}

impl Order {
    /// A photon-mapped picture by the scene's own settings, to a number of seconds.
    pub(super) fn new(name: &str, words: &str, seconds: f64) -> Self {
        let stop = StopRules { time: Some(Duration::from_secs_f64(seconds)), ..StopRules::default() };
        let request = Request { integrator: Integrator::Photon, stop };
        Self { name: name.to_string(), words: words.to_string(), changes: Vec::new(), request }
    }

    /// By another integrator.
    pub(super) fn by(mut self, integrator: Integrator) -> Self {
        self.request.integrator = integrator;
        self
    }

    /// To a number of passes, however long they take.
    pub(super) fn until(mut self, passes: u64) -> Self {
        self.request.stop = StopRules { passes: Some(passes), ..StopRules::default() };
        self
    }

    /// With changes of the scene.
    pub(super) fn changed(mut self, changes: impl IntoIterator<Item = String>) -> Self {
        self.changes.extend(changes);
        self
    }
}

/// A finished render.
#[derive(Debug, Clone)]
pub(super) struct Done {
    pub(super) found: Found,
    pub(super) picture: Picture,
}

/// Where the study's renders are done, each of them once.
pub(super) struct Workshop<'a> {
    pub(super) subject: &'a Subject,
    pub(super) shelf: Shelf,
    pub(super) audience: &'a mut (dyn Audience + Send),
    /// Changes that all renders share: the film.
    pub(super) film: Vec<String>,
    /// Steps done, and how many there will be.
    pub(super) step: (usize, usize),
    /// Seconds spent on steps, those of former runs too.
    pub(super) spent: f64,
}

impl Workshop<'_> {
    /// Does a render, or takes up what was kept of it. `against` is what its error is measured by, with that reference's identity.
    pub(super) fn render(&mut self, order: &Order, against: Option<(&Reference, &str)>) -> Result<Done, Halt> {
        self.step.0 += 1;
        let changes: Vec<String> = self.film.iter().chain(&order.changes).cloned().collect();
        let identity = self.identity(order, &changes, against.map(|(_, identity)| identity));
        let kept = self.shelf.find(&order.name, &identity);
        let label = format!("{}/{} {}", self.step.0, self.step.1, order.words);
        self.audience.begin(&label, kept.is_some());
        let (found, picture) = match kept {
            Some(kept) => kept,
            None => {
                let (found, picture) = self.rendered(order, &changes, against.map(|(reference, _)| reference))?;
                self.shelf.keep(&order.name, &identity, found, &picture)?
            }
        };
        self.spent += found.stats.seconds.total;
        Ok(Done { found, picture })
    }

    fn rendered(
        &mut self,
        order: &Order,
        changes: &[String],
        against: Option<&Reference>,
    ) -> Result<(Found, Picture), Halt> {
        let job = self.subject.job(changes)?;
        let passes_wanted = job.budget.passes;
        let mut watch = Watch::new(&mut *self.audience, against, passes_wanted);
        let mut rendered = job.render(order.request, &mut watch).map_err(|error| error.in_file(&self.subject.path))?;
        if rendered.interrupted {
            return Err(Halt::Interrupted);
        }
        watch.measure(rendered.stats.passes, &rendered.picture);
        let Watch { points, measuring, .. } = watch;
        rendered.stats.seconds.total -= measuring.as_secs_f64();
        let stats = rendered.stats;
        let events = |name: &str| stats.effects.get(name).map_or(0, |effect| effect.events);
        let kept = stats.photons_stored + events("volume-photons") + events("photon-beams");
        let memory_bytes = job.budget.memory_keeping(kept / stats.passes.max(1));
        Ok((Found { points, stats, memory_bytes, passes_wanted }, rendered.picture))
    }

    /// All that a step depends on.
    pub(super) fn identity(&self, order: &Order, changes: &[String], against: Option<&str>) -> String {
        let mut hash = Hash::default();
        let parts = [
            env!("CARGO_PKG_VERSION"),
            &self.subject.hash,
            &order.name,
            &format!("{:?}", order.request),
            against.unwrap_or("nothing"),
        ];
        parts.into_iter().chain(changes.iter().map(String::as_str)).for_each(|part| hash.add_part(part.as_bytes()));
        hash.hex()
    }
}

/// Measures the error whenever the passes have doubled, and when they are as many as the settings ask for.
struct Watch<'a> {
    audience: &'a mut (dyn Audience + Send),
    against: Option<&'a Reference>,
    passes_wanted: u64,
    next: u64,
    /// Seconds of work so far.
    worked: f64,
    /// Time spent on measuring.
    measuring: Duration,
    points: Vec<Point>,
}

impl<'a> Watch<'a> {
    fn new(audience: &'a mut (dyn Audience + Send), against: Option<&'a Reference>, passes_wanted: u64) -> Self {
        Self { audience, against, passes_wanted, next: 1, worked: 0.0, measuring: Duration::ZERO, points: Vec::new() }
    }

    fn measure(&mut self, passes: u64, picture: &Picture) {
        let Some(reference) = self.against else { return };
        if self.points.last().is_none_or(|last| last.passes < passes) {
            self.points.push(Point { passes, seconds: self.worked, wrong: reference.wrong(picture) });
        }
    }
}

impl Monitor for Watch<'_> {
    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.worked = (progress.elapsed.saturating_sub(self.measuring)).as_secs_f64();
        self.audience.after_pass(progress)
    }

    fn keep(&mut self, run: &Run) {
        let passes = run.passes();
        if self.against.is_some() && (passes >= self.next || passes == self.passes_wanted) {
            let begun = Instant::now();
            self.measure(passes, &run.picture());
            self.next = (passes + 1).next_power_of_two();
            self.measuring += begun.elapsed();
        }
    }
}
