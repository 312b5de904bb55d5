//! `abbe check`: validates scenes without rendering.

use std::path::{Path, PathBuf};

use super::{Outcome, opening, print};
use abbe::error::Result;
use abbe::render::Job;
use abbe::scene::resolve::resolve;

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    opening: opening::Arguments,
}

/// Checks every scene; all errors are reported, not only the first scene's.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut worst = 0;
    for scene in &arguments.scenes {
        if let Err(error) = check(scene, arguments.opening) {
            print::error(&error);
            worst = worst.max(error.exit_status());
        }
    }
    Outcome::Reported(worst)
}

fn check(path: &Path, opening: opening::Arguments) -> Result<()> {
    let (scene, source) = opening.read(path, &[])?;
    let job = Job::new(resolve(&scene, &source)?).map_err(|error| error.in_file(path))?;
    for note in &job.scene.notes {
        print::remark(&format!("{}: note: {note}", path.display()));
    }
    print::result(&format!("{}: ok\n", path.display()))
}
