//! Studies of the error against time for a scene file.

use std::path::{Path, PathBuf};
use std::time::Duration;

use abbe_format::resolve::resolve;
use abbe_format::{JsonSource, SceneFile};
use abbe_session::output::exr::read;
use abbe_session::output::file::check_keeps_inputs;
use abbe_session::output::metadata::names;
use abbe_session::render::{Integrator, on_threads};
use abbe_spectra::error::Result;

use crate::api::memory;
use crate::api::provenance::{self, SceneFiles};
use crate::study::report::StudyReport;
use crate::study::{self, PAGE, StudyMonitor, StudyOptions, StudyOutcome, StudyScene};

#[derive(Debug, Clone, Copy)]
pub struct StudyFiles<'a> {
    pub scene: &'a Path,
    /// The folder of the results.
    pub output: &'a Path,
    /// The EXR file of the reference, if it is given.
    pub reference: Option<&'a Path>,
}

/// Runs a study of a scene, on `threads` or those of the scene. Returns an error if a file cannot
/// be read or written, or if the scene cannot be rendered.
pub fn study(
    scene: &SceneFile,
    source: &JsonSource,
    files: &StudyFiles<'_>,
    budget: Duration,
    threads: Option<u32>,
    monitor: &mut (dyn StudyMonitor + Send),
) -> Result<StudyOutcome> {
    let names = StudyReport::FILES.into_iter().chain([PAGE]);
    let outputs: Vec<PathBuf> = names.map(|name| files.output.join(name)).collect();
    let scene_files = SceneFiles::of(source);
    let inputs = scene_files.paths.iter().map(PathBuf::as_path).chain([files.scene]).chain(files.reference);
    check_keeps_inputs(outputs.iter().map(PathBuf::as_path), inputs)?;
    let reference = match files.reference {
        Some(path) => Some((path.display().to_string(), read(path)?.picture)),
        None => None,
    };
    let job = memory::plan(resolve(scene, source)?, files.scene)?;
    let of_scene = provenance::of_scene(Some((source, &scene_files)), &job, Integrator::Photon);
    let study_scene = StudyScene {
        path: files.scene.to_owned(),
        text: source.written().to_string(),
        file_access: source.file_access(),
        hash: of_scene.get(names::SCENE_HASH).unwrap_or_default().to_string(),
    };
    let options = StudyOptions { folder: files.output.to_owned(), budget, reference };
    on_threads(threads.or(job.scene.settings.threads), || study::run(&study_scene, &options, monitor))?
}
