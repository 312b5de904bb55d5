//! `abbe explain`: prints the plan of a scene.

use std::path::PathBuf;

use super::scene_file::SceneFileArgs;
use super::{Outcome, print};
use crate::api::PlanReport;
use abbe_format::resolve::resolve;
use abbe_session::render::Job;
use abbe_spectra::error::Result;
use abbe_transport::plan::explain::{self, Details};

#[derive(Debug, clap::Args)]
pub(crate) struct ExplainArgs {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Describe also the effects that are off, which are otherwise only listed
    #[arg(long)]
    all: bool,
    /// Print also the notes that concern no visible light, such as the range of a glass
    #[arg(long)]
    verbose: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scene_file: SceneFileArgs,
}

pub(crate) fn run(arguments: &ExplainArgs) -> Result<Outcome> {
    let (scene, source) = arguments.scene_file.read(&arguments.scene, &[], false)?;
    let job = Job::of_picture(resolve(&scene, &source)?).map_err(|error| error.in_file(&arguments.scene))?;
    if arguments.json {
        print::json(&PlanReport::of(&job))?;
    } else {
        let details = Details { all_effects: arguments.all, negligible_notes: arguments.verbose };
        print::result(&explain::text(&job.scene, &job.plan, &job.rows, &job.budget, details))?;
    }
    Ok(Outcome::Done)
}
