//! `abbe check`: checks scenes without rendering them.

use std::path::{Path, PathBuf};

use super::scene_file::SceneFileArgs;
use super::{Outcome, print};
use abbe_format::is_json_schema;
use abbe_format::resolve::resolve_any;
use abbe_optics::glass::is_negligible;
use abbe_session::render::Job;
use abbe_spectra::error::Result;

#[derive(Debug, clap::Args)]
pub(crate) struct CheckArgs {
    /// Scene files
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    scene_file: SceneFileArgs,
}

/// Checks all scenes. If one scene has an error, the other scenes are still checked.
pub(crate) fn run(arguments: &CheckArgs) -> Outcome {
    let mut worst = 0;
    for scene in &arguments.scenes {
        if let Err(error) = check(scene, &arguments.scene_file) {
            print::error(&error);
            worst = worst.max(error.exit_status());
        }
    }
    Outcome::Reported(worst)
}

fn check(path: &Path, scene_file: &SceneFileArgs) -> Result<()> {
    if std::fs::read_to_string(path).is_ok_and(|text| is_json_schema(&text)) {
        print::remark(&format!("{}: note: this is a JSON Schema and not a scene; it was skipped", path.display()));
        return Ok(());
    }
    let (scene, source) = scene_file.read(path, &[], false)?;
    let job = Job::new(resolve_any(&scene, &source)?).map_err(|error| error.in_file(path))?;
    for note in job.scene.notes.iter().filter(|note| !is_negligible(note)) {
        let kind = print::note_kind(job.scene.warnings.contains(note));
        print::remark(&format!("{}: {kind}: {note}", path.display()));
    }
    print::result(&format!("{}: ok\n", path.display()))
}
