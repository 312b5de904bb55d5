//! Runs a study from its film to its page.

use super::curves::ConvergenceCurve;
use super::effects::{self, EffectStudy};
use super::film::{self, StudyFilm};
use super::monitor::{StudyError, StudyMonitor};
use super::page;
use super::recommendation;
use super::reference_choice::{self, ChosenReference};
use super::report::{self, MachineInfo, StudyReport};
use super::runner::Runner;
use super::smooth_regions;
use super::step_cache::StepCache;
use super::study_scene::StudyScene;
use super::sweep::{self, SettingSweep};
use abbe_session::output::file;
use abbe_spectra::error::Result;
use abbe_transport::sensor::Picture;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Clone)]
pub struct StudyOptions {
    pub folder: PathBuf,
    /// The approximate limit on the time of the study.
    pub budget: Duration,
    /// An existing reference picture, and its name, or `None` to render one.
    pub reference: Option<(String, Picture)>,
}

/// The outcome of a study that did not fail.
#[derive(Debug)]
pub enum StudyOutcome {
    Finished(Box<StudyReport>),
    /// The monitor stopped the study. The results of finished steps are cached.
    Interrupted,
}

pub const PAGE: &str = "study.html";

/// Studies a scene on the current thread pool, and writes the results. Returns an error if the
/// scene is invalid, if the given reference has another aspect ratio than the scene's film, or if
/// the folder cannot be written.
pub fn run(
    study_scene: &StudyScene,
    options: &StudyOptions,
    monitor: &mut (dyn StudyMonitor + Send),
) -> Result<StudyOutcome> {
    match study(study_scene, options, monitor) {
        Ok(report) => Ok(StudyOutcome::Finished(Box::new(report))),
        Err(StudyError::Interrupted) => Ok(StudyOutcome::Interrupted),
        Err(StudyError::Failed(error)) => Err(error),
    }
}

fn study(
    study_scene: &StudyScene,
    options: &StudyOptions,
    monitor: &mut (dyn StudyMonitor + Send),
) -> std::result::Result<StudyReport, StudyError> {
    let (scene_file, job) = (study_scene.scene_file()?, study_scene.job(&[])?);
    let budget_seconds = options.budget.as_secs_f64();
    let changes = sweep::changes(&scene_file, &job);
    let given = options.reference.as_ref();
    let steps_total =
        film::steps(given) + reference_choice::steps(&job, given) + 2 + changes.len() + effects::steps(&job);
    let step_cache = StepCache::open(&options.folder)?;
    let mut runner = Runner {
        study_scene,
        step_cache,
        monitor,
        film_changes: Vec::new(),
        steps_done: 0,
        steps_total,
        seconds_spent: 0.0,
    };

    let given_picture = given.map(|(_, picture)| picture);
    let film = StudyFilm::choose(&mut runner, &job, given_picture, budget_seconds, changes.len())?;
    runner.film_changes = film.changes();
    let reference = ChosenReference::find(&mut runner, &scene_file, &job, given, budget_seconds)?;
    let curves = ConvergenceCurve::of_both(&mut runner, &job, &reference, budget_seconds)?;
    let sweep = SettingSweep::of(&mut runner, &changes, &curves[0], &reference, budget_seconds)?;
    let effects = EffectStudy::of(&mut runner, &scene_file, &job, &reference, budget_seconds)?;

    let spent_seconds = runner.seconds_spent;
    let step_cache = runner.step_cache;
    let recommendations = recommendation::table(study_scene, &film, &reference.provenance, &curves, &sweep);
    let report = StudyReport {
        version: env!("CARGO_PKG_VERSION"),
        scene: study_scene.path.display().to_string(),
        title: job.scene.title.clone(),
        budget_seconds,
        spent_seconds,
        machine: MachineInfo::here(&curves[0]),
        film,
        reference: reference.provenance.clone(),
        smooth_rule: smooth_regions::RULE,
        curves: curves.clone(),
        sweep,
        fixed_by_design: report::FIXED_BY_DESIGN,
        effects: effects.clone(),
        recommendations,
    };
    for (name, text) in StudyReport::FILES.into_iter().zip(report.contents()) {
        file::write_whole(&step_cache.path(name), text.as_bytes())?;
    }
    let page = page::page(&report, &page::StudyPictures::of(&job, &reference, &curves, &effects))?;
    file::write_whole(&step_cache.path(PAGE), page.as_bytes())?;
    Ok(report)
}
