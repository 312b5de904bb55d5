//! `abbe explain`: the plan of a scene.

use std::path::PathBuf;

use super::{Outcome, print};
use abbe::error::Result;
use abbe::plan::explain;
use abbe::render::Job;
use abbe::scene::facts::Facts;
use abbe::scene::resolve;
use serde::Serialize;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// A plan for programs to read.
#[derive(Debug, Serialize)]
pub(crate) struct PlanReport<'a> {
    effects: Vec<EffectReport<'a>>,
    wavelengths: &'static str,
    passes: u64,
    photons: u64,
    /// Photons within the first radius, unless the scene fixes the radius.
    nearest: Option<u32>,
    /// The first radius, if the scene fixes it.
    radius_m: Option<f64>,
    memory_bytes: u64,
    /// What has a colour made from RGB, and the lamps of spectral lines that such guesses meet; null unless there are both.
    guessed_colours: Option<GuessedColours>,
    notes: &'a [String],
}

#[derive(Debug, Serialize)]
struct GuessedColours {
    upsampled: Vec<String>,
    line_lamps: Vec<String>,
}

#[derive(Debug, Serialize)]
struct EffectReport<'a> {
    name: &'static str,
    state: &'static str,
    because: &'a str,
    field: &'static str,
    /// What it costs where it is on, what its absence means where it is off.
    consequence: &'static str,
}

impl<'a> PlanReport<'a> {
    pub(crate) fn of(job: &'a Job) -> Self {
        let effects = job.rows.iter().map(|row| EffectReport {
            name: row.effect.name,
            state: row.state.word(),
            because: &row.because,
            field: row.effect.field,
            consequence: if row.state.is_on() { row.effect.cost } else { row.effect.absent },
        });
        let budget = &job.budget;
        let Facts { upsampled, line_lamps, .. } = Facts::of(&job.scene);
        let both = !upsampled.is_empty() && !line_lamps.is_empty();
        Self {
            effects: effects.collect(),
            wavelengths: explain::wavelengths_word(&job.plan),
            passes: budget.passes,
            photons: budget.photons,
            nearest: budget.radius_m.is_none().then_some(budget.nearest),
            radius_m: budget.radius_m,
            memory_bytes: budget.memory_bytes,
            guessed_colours: both.then_some(GuessedColours { upsampled, line_lamps }),
            notes: &job.scene.notes,
        }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let scene = resolve::load(&arguments.scene, &[])?;
    let job = Job::new(scene).map_err(|error| error.in_file(&arguments.scene))?;
    if arguments.json {
        print::json(&PlanReport::of(&job))?;
    } else {
        print::result(&explain::text(&job.scene, &job.plan, &job.rows, &job.budget))?;
    }
    Ok(Outcome::Done)
}
