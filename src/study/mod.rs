//! What accuracy costs in time: a scene rendered many times, each picture's error measured against a reference.
//!
//! A study asks four things of a scene: how fast the error of each integrator falls ([`curves`]), which settings reach which error soonest
//! ([`sweep`]), what every effect of the plan costs and how much of the picture it makes ([`effects`]), and what follows for someone who
//! wants a certain error ([`wanted`]). It does so within a budget of time, at a size of film that the budget allows ([`film`]), against a
//! reference whose own noise is measured and taken off ([`truth`], [`mod@reference`]). Every render is a step that is kept in a file; a study
//! that is run again takes up what is there. What was found becomes JSON, CSV, plots and a page ([`report`], [`page`]).

mod course;
pub mod curves;
pub mod effects;
pub mod film;
pub mod fit;
pub mod page;
pub mod reference;
pub mod report;
mod shelf;
pub mod smooth;
pub mod subject;
pub mod sweep;
pub mod truth;
pub mod wanted;

use std::path::PathBuf;
use std::time::Duration;

use crate::error::{Error, Result};
use crate::output::file;
use crate::render::Monitor;
use crate::sensor::Picture;

use course::Workshop;
use curves::Curve;
use effects::Effects;
use film::StudyFilm;
use report::{Machine, Report};
use shelf::Shelf;
use sweep::Sweep;
use truth::Truth;

pub use course::Point;
pub use subject::Subject;

/// What is asked of a study.
#[derive(Debug, Clone)]
pub struct Options {
    /// The folder that takes its files.
    pub folder: PathBuf,
    /// How long it may take, about.
    pub budget: Duration,
    /// A reference from elsewhere with its name, instead of one that the study renders.
    pub reference: Option<(String, Picture)>,
}

/// Watches a study: its steps, and within each a render's passes.
pub trait Audience: Monitor {
    /// A step begins; one whose result was kept ends at once.
    fn begin(&mut self, step: &str, kept: bool);
}

/// How a study ended that did not fail.
#[derive(Debug)]
pub enum Ending {
    /// All is found and written.
    Finished(Box<Report>),
    /// Its audience ended it; finished steps are kept.
    Interrupted,
}

/// Why a study cannot go on.
#[derive(Debug)]
enum Halt {
    Interrupted,
    Failed(Error),
}

impl From<Error> for Halt {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}

/// What each part of a study may take, as shares of its budget; trying out film sizes takes a moment besides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// Finding out who renders the reference.
    pub trial: f64,
    /// The reference.
    pub reference: f64,
    /// Error against time: the photon integrator.
    pub photon_curve: f64,
    /// Error against time: the path tracer.
    pub path_curve: f64,
    /// The sweep of settings.
    pub sweep: f64,
    /// Effect by effect.
    pub effects: f64,
}

/// Those of every study.
pub const SHARES: Shares =
    Shares { trial: 0.06, reference: 0.34, photon_curve: 0.14, path_curve: 0.1, sweep: 0.2, effects: 0.16 };

/// The name of the study's page.
pub const PAGE: &str = "study.html";

/// Studies a scene on the current thread pool, and writes what it finds.
///
/// # Errors
/// The input's: a scene that is wrong, a reference that cannot be of it. The machine's: a folder that cannot be written to, a full disk.
pub fn run(subject: &Subject, options: &Options, audience: &mut (dyn Audience + Send)) -> Result<Ending> {
    match study(subject, options, audience) {
        Ok(report) => Ok(Ending::Finished(Box::new(report))),
        Err(Halt::Interrupted) => Ok(Ending::Interrupted),
        Err(Halt::Failed(error)) => Err(error),
    }
}

fn study(
    subject: &Subject,
    options: &Options,
    audience: &mut (dyn Audience + Send),
) -> std::result::Result<Report, Halt> {
    let (written, job) = (subject.written()?, subject.job(&[])?);
    let budget = options.budget.as_secs_f64();
    let changes = sweep::changes(&written, &job);
    let given = options.reference.as_ref();
    let steps = film::steps(given) + truth::steps(&job, given) + 2 + changes.len() + effects::steps(&job);
    let shelf = Shelf::open(&options.folder)?;
    let mut workshop = Workshop { subject, shelf, audience, film: Vec::new(), step: (0, steps), spent: 0.0 };

    let film = StudyFilm::choose(&mut workshop, &job, given.map(|(_, picture)| picture), (budget, changes.len()))?;
    workshop.film = film.changes();
    let truth = Truth::find(&mut workshop, (&written, &job), given, budget)?;
    let curves = Curve::of_both(&mut workshop, &job, &truth, budget)?;
    let sweep = Sweep::of(&mut workshop, &changes, &curves[0], (&truth, budget))?;
    let effects = Effects::of(&mut workshop, (&written, &job), (&truth, budget))?;

    let spent = workshop.spent;
    let shelf = workshop.shelf;
    let report = Report::new(
        (subject, &job, Machine::here(&curves[0])),
        (budget, spent),
        (film, &truth),
        (&curves, sweep, &effects),
    );
    for (name, text) in report.files() {
        file::write_whole(&shelf.path(name), text.as_bytes())?;
    }
    let page = page::page(&report, &page::Pictures::of(&job, &truth, &curves, &effects))?;
    file::write_whole(&shelf.path(PAGE), page.as_bytes())?;
    Ok(report)
}
