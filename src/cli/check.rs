//! `abbe check`: validates scenes without rendering.

use std::path::{Path, PathBuf};

use super::{Outcome, print};
use abbe::error::Result;
use abbe::render::Job;
use abbe::scene::resolve;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
}

/// Checks every scene; all errors are reported, not only the first scene's.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut worst = 0;
    for scene in &arguments.scenes {
        if let Err(error) = check(scene) {
            print::error(&error);
            worst = worst.max(error.exit_status());
        }
    }
    Outcome::Reported(worst)
}

fn check(scene: &Path) -> Result<()> {
    let job = Job::new(resolve::load(scene, &[])?).map_err(|error| error.in_file(scene))?;
    for note in &job.scene.notes {
        print::remark(&format!("{}: note: {note}", scene.display()));
    }
    print::result(&format!("{}: ok\n", scene.display()))
}
