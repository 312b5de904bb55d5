//! `abbe explain`: the plan of a scene.

use std::path::PathBuf;

use super::{Outcome, opening, print};
use abbe::error::Result;
use abbe::plan::explain;
use abbe::render::{Diffracting, Job};
use abbe::scene::camera::{Camera, DepthOfField, Diffraction};
use abbe::scene::facts::Facts;
use abbe::scene::resolve::resolve;
use serde::Serialize;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    opening: opening::Arguments,
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
    /// How far things move over the picture while the shutter is open; null if nothing does.
    motion_px: Option<f64>,
    camera: CameraReport,
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

#[derive(Debug, Serialize)]
struct CameraReport {
    /// Across and down.
    field_of_view_degrees: [f64; 2],
    /// Null for a pinhole.
    depth_of_field: Option<DepthReport>,
    /// Null for a pinhole.
    diffraction: Option<DiffractionReport>,
}

#[derive(Debug, Serialize)]
struct DiffractionReport {
    /// 2.44 λN in green light, 550 nm.
    airy_diameter_px: f64,
    /// Whether that is more than a pixel.
    matters: bool,
    simulated: bool,
    /// Slices of the spectrum that the film keeps apart, 48 bytes a pixel each.
    slices: usize,
}

#[derive(Debug, Serialize)]
struct DepthReport {
    focus_m: f64,
    near_m: f64,
    /// Null if sharp to infinity.
    far_m: Option<f64>,
    hyperfocal_m: f64,
    blur_at_infinity_px: f64,
}

impl CameraReport {
    fn of(camera: &Camera, slices: usize) -> Self {
        let diffraction = Diffraction::of(camera).map(|diffraction| DiffractionReport {
            airy_diameter_px: diffraction.airy_diameter_px(),
            matters: diffraction.matters(),
            simulated: slices > 0,
            slices,
        });
        let depth = DepthOfField::of(camera).map(|depth| {
            let DepthOfField { focus_m, near_m, far_m, hyperfocal_m, blur_at_infinity_px } = depth;
            let far_m = far_m.is_finite().then_some(far_m);
            DepthReport { focus_m, near_m, far_m, hyperfocal_m, blur_at_infinity_px }
        });
        let field_of_view_degrees = camera.field_of_view().map(f64::to_degrees);
        Self { field_of_view_degrees, depth_of_field: depth, diffraction }
    }
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
        let slices = job.diffraction.as_ref().map_or(0, Diffracting::slices);
        let both = !upsampled.is_empty() && !line_lamps.is_empty();
        Self {
            effects: effects.collect(),
            wavelengths: explain::wavelengths_word(&job.plan),
            passes: budget.passes,
            photons: budget.photons,
            nearest: budget.radius_m.is_none().then_some(budget.nearest),
            radius_m: budget.radius_m,
            memory_bytes: budget.memory_bytes,
            motion_px: job.scene.moves().then_some(budget.motion_px),
            camera: CameraReport::of(&job.scene.camera, slices),
            guessed_colours: both.then_some(GuessedColours { upsampled, line_lamps }),
            notes: &job.scene.notes,
        }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let (scene, source) = arguments.opening.read(&arguments.scene, &[])?;
    let job = Job::new(resolve(&scene, &source)?).map_err(|error| error.in_file(&arguments.scene))?;
    if arguments.json {
        print::json(&PlanReport::of(&job))?;
    } else {
        print::result(&explain::text(&job.scene, &job.plan, &job.rows, &job.budget))?;
    }
    Ok(Outcome::Done)
}
