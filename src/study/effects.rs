//! Measures the cost of every effect, and how much the effect changes the picture.

use super::monitor::StudyError;
use super::reference::MeanEstimate;
use super::reference_choice::{ChosenReference, seed};
use super::runner::{FinishedStep, RenderStep, Runner};
use super::time_fractions::TIME_FRACTIONS;
use abbe_format::SceneFile;
use abbe_session::output::compare::{DeltaE, compare};
use abbe_session::output::selection::Selection;
use abbe_session::render::Job;
use abbe_transport::plan::{EffectRow, EffectState};
use abbe_transport::sensor::Picture;
use serde::Serialize;

/// An effect that is on, and the comparison with a picture without this effect.
#[derive(Debug, Clone, Serialize)]
pub struct EffectAblation {
    pub name: &'static str,
    /// `on` or `forced`.
    pub state: &'static str,
    pub because: String,
    pub events: u64,
    /// The result of a render without the effect, or the reason why the effect cannot be left out.
    pub left_out: AblationResult,
    #[serde(skip)]
    pub picture: Option<Picture>,
}

#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AblationResult {
    /// The effect was left out.
    Measured {
        cost: RenderCost,
        /// The relative mean square difference between the pictures without and with the effect,
        /// with the same passes and seeds.
        relative_mse: f64,
        /// The colour difference between the pictures with and without the effect.
        delta_e_2000: DeltaE,
        #[serde(rename = "wrong")]
        error: MeanEstimate,
    },
    /// The reason why the effect cannot be left out.
    Refused(String),
    NoTime,
}

/// Time and memory of a render.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RenderCost {
    /// Seconds in total, including the pilot.
    pub seconds: f64,
    /// Seconds per pass.
    pub seconds_per_pass: f64,
    /// The memory of film, scene and photons (by their number), in bytes.
    pub memory_bytes: u64,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct InactiveEffect {
    pub name: &'static str,
    /// `off` or `forbidden`.
    pub state: &'static str,
    /// The reason why the effect is off.
    pub because: String,
    /// The number of events of the effect. It is always 0.
    pub events: u64,
}

#[derive(Debug, Clone, Serialize)]
pub struct EffectStudy {
    pub passes: u64,
    pub with: RenderCost,
    #[serde(rename = "wrong")]
    pub error: MeanEstimate,
    /// The relative mean square difference caused by noise alone, between two pictures with all
    /// effects but different seeds.
    pub noise_relative_mse: f64,
    /// The colour difference caused by noise alone.
    pub noise_delta_e_2000: DeltaE,
    pub on: Vec<EffectAblation>,
    pub off: Vec<InactiveEffect>,
    #[serde(skip)]
    pub picture: Picture,
}

/// The seed offset of the second render with all effects, which measures the noise.
const OTHER_SEED: u64 = 301;

/// Returns the largest number of renders that the measurements need.
pub(super) fn steps(job: &Job) -> usize {
    2 + job.rows.iter().filter(|row| row.state.is_on()).count()
}

impl RenderCost {
    fn of(step: &FinishedStep) -> Self {
        let stats = &step.result.stats;
        let passing = stats.seconds.total - stats.seconds.pilot;
        Self {
            seconds: stats.seconds.total,
            seconds_per_pass: passing / stats.passes.max(1) as f64,
            memory_bytes: step.result.memory_bytes,
        }
    }
}

impl EffectStudy {
    /// Renders the scene with all effects, with another seed, and without each active effect.
    pub(super) fn of(
        runner: &mut Runner<'_>,
        scene_file: &SceneFile,
        job: &Job,
        reference: &ChosenReference,
        budget_seconds: f64,
    ) -> Result<Self, StudyError> {
        let fraction = TIME_FRACTIONS.effects * budget_seconds;
        let before = runner.seconds_spent;
        let seconds = fraction / steps(job) as f64;
        let whole = runner.render(&RenderStep::new("effects-all", "all effects", seconds), reference.identified())?;
        let stats = &whole.result.stats;
        let step =
            RenderStep::new("effects-other-seed", "all effects, another seed", seconds).with_passes(stats.passes);
        let other = runner.render(&step.with_changes([seed(job, OTHER_SEED)]), None)?;
        let noise = compare(&other.picture, &whole.picture, &Selection::default())?;
        let events = |row: &EffectRow| stats.effects.get(row.effect.name).map_or(0, |effect| effect.events);
        let (mut on, mut off) = (Vec::new(), Vec::new());
        for row in &job.rows {
            let (name, state, because, events) = (row.effect.name, row.state.word(), row.because.clone(), events(row));
            if !row.state.is_on() {
                off.push(InactiveEffect { name, state, because, events });
                continue;
            }
            // Without an effect, passes can also be slower, so the time can run out.
            let (left_out, picture) = if runner.seconds_spent - before > 2.0 * fraction {
                runner.steps_done += 1;
                (AblationResult::NoTime, None)
            } else {
                without(runner, scene_file, row, &whole, reference)?
            };
            on.push(EffectAblation { name, state, because, events, left_out, picture });
        }
        Ok(Self {
            passes: stats.passes,
            with: RenderCost::of(&whole),
            error: final_error(&whole),
            noise_relative_mse: noise.relative_mse,
            noise_delta_e_2000: noise.delta_e_2000,
            on,
            off,
            picture: whole.picture,
        })
    }
}

/// The error of the finished picture, over all pixels.
fn final_error(step: &FinishedStep) -> MeanEstimate {
    let none = MeanEstimate { value: f64::NAN, standard_error: f64::NAN };
    step.result.points.last().map_or(none, |point| point.error.whole)
}

fn without(
    runner: &mut Runner<'_>,
    scene_file: &SceneFile,
    row: &EffectRow,
    whole: &FinishedStep,
    reference: &ChosenReference,
) -> Result<(AblationResult, Option<Picture>), StudyError> {
    let name = row.effect.name;
    let changes = changes_without(scene_file, row);
    let planned = runner.film_changes.iter().chain(&changes).cloned().collect::<Vec<String>>();
    if let Err(error) = runner.study_scene.job(&planned) {
        runner.steps_done += 1;
        let reason =
            error.expected.map_or(error.what.clone(), |expected| format!("{}; expected {expected}", error.what));
        return Ok((AblationResult::Refused(reason), None));
    }
    let step = RenderStep::new(&format!("effects-without-{name}"), &format!("without {name}"), 1.0);
    let step = step.with_passes(whole.result.stats.passes).with_changes(changes);
    let finished = runner.render(&step, reference.identified())?;
    let difference = compare(&finished.picture, &whole.picture, &Selection::default())?;
    let measured = AblationResult::Measured {
        cost: RenderCost::of(&finished),
        relative_mse: difference.relative_mse,
        delta_e_2000: difference.delta_e_2000,
        error: final_error(&finished),
    };
    Ok((measured, Some(finished.picture)))
}

/// Returns changes of the scene that forbid an effect, or no longer force it.
fn changes_without(scene_file: &SceneFile, row: &EffectRow) -> Vec<String> {
    let name = row.effect.name;
    let list = |names: Vec<&str>| {
        format!("[{}]", names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(","))
    };
    let (force, forbid) = (&scene_file.render.force, &scene_file.render.forbid);
    if row.state == EffectState::Forced {
        let others = force.iter().map(String::as_str).filter(|&other| other != name);
        return vec![format!("render.force={}", list(others.collect()))];
    }
    // An effect must not be forced and forbidden at the same time.
    let others = force.iter().map(String::as_str).filter(|&other| other != name).collect();
    let forbidden = forbid.iter().map(String::as_str).chain([name]).collect();
    vec![format!("render.force={}", list(others)), format!("render.forbid={}", list(forbidden))]
}
