//! Stores the results of finished steps in files. A repeated study can use these results.

use std::fs;
use std::path::{Path, PathBuf};

use super::convergence::ConvergencePoint;
use abbe_session::output::exr::{read, write};
use abbe_session::output::file;
use abbe_session::output::metadata::Metadata;
use abbe_session::render::Stats;
use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::Picture;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct StepResult {
    /// The errors after some numbers of passes. The list is empty if no error was measured.
    pub(super) points: Vec<ConvergencePoint>,
    /// The statistics of the render.
    pub(super) stats: Stats,
    /// The memory of film, scene and photons (by their number), in bytes.
    pub(super) memory_bytes: u64,
    pub(super) passes_wanted: u64,
}

/// The folder of a study. The folder contains the cached results of the steps.
#[derive(Debug, Clone)]
pub(super) struct StepCache {
    folder: PathBuf,
}

/// The content of a step's JSON file.
#[derive(Debug, Serialize, Deserialize)]
struct CachedStep {
    /// A hash of the scene, the version, the settings and the reference.
    identity: String,
    result: StepResult,
}

const STEPS: &str = "steps";

/// The header attribute in the picture file of a step that stores its identity.
const STEP: &str = "abbe.step";

impl StepCache {
    /// Opens or creates the folder. Returns an error if it cannot be created or written.
    pub(super) fn open(folder: &Path) -> Result<Self> {
        let steps = folder.join(STEPS);
        fs::create_dir_all(&steps)
            .map_err(|error| Error::machine(format!("the folder cannot be created: {error}")).in_file(folder))?;
        file::check_writable(&steps.join("check.json"))?;
        Ok(Self { folder: folder.to_path_buf() })
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn step(&self, name: &str, extension: &str) -> PathBuf {
        self.folder.join(STEPS).join(name).with_added_extension(extension)
    }

    /// Returns the cached result of a step, unless it has another identity or damaged files.
    pub(super) fn find(&self, name: &str, identity: &str) -> Option<(StepResult, Picture)> {
        let text = fs::read(self.step(name, "json")).ok()?;
        let cached: CachedStep =
            serde_json::from_slice(&text).ok().filter(|cached: &CachedStep| cached.identity == identity)?;
        let file = read(&self.step(name, "exr")).ok()?;
        (file.metadata.get(STEP) == Some(identity)).then_some((cached.result, file.picture))
    }

    /// Stores the result of a step. The picture is written before the record, so that every record
    /// has one. Returns the picture in the precision of the file.
    pub(super) fn store(
        &self,
        name: &str,
        identity: &str,
        result: StepResult,
        picture: &Picture,
    ) -> Result<(StepResult, Picture)> {
        let path = self.step(name, "exr");
        let record = self.step(name, "json");
        [&path, &record].into_iter().for_each(|path| file::remove_temporary_files(path));
        write(&path, picture, &Metadata::new().with(STEP, identity))?;
        let picture = read(&path)?.picture;
        let cached = CachedStep { identity: identity.to_string(), result };
        file::write_whole(&record, (json(&cached) + "\n").as_bytes())?;
        Ok((cached.result, picture))
    }
}

/// Writes a report as JSON. Numbers that are not finite become `null`.
pub(super) fn json<T: Serialize>(value: &T) -> String {
    serde_json::to_string_pretty(value).expect("reports have text keys and no fallible values")
}
