//! The steps that are finished, in files: a study that is run again takes up what is there.

use std::fs;
use std::path::{Path, PathBuf};

use super::course::Found;
use crate::error::{Error, Result};
use crate::output::exr::{read, write};
use crate::output::file;
use crate::output::metadata::Metadata;
use crate::sensor::Picture;
use serde::{Deserialize, Serialize};

/// The folder of a study.
#[derive(Debug, Clone)]
pub(super) struct Shelf {
    folder: PathBuf,
}

/// What a step's file holds.
#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    /// Of the scene, the version, the settings and what it was measured against.
    identity: String,
    found: Found,
}

/// The folder of the steps, within the study's.
const STEPS: &str = "steps";

/// The attribute of a picture that names its step.
const STEP: &str = "abbe.step";

impl Shelf {
    /// Opens the folder, and makes it if it is not there.
    ///
    /// # Errors
    /// The machine's: a folder that cannot be made or written to.
    pub(super) fn open(folder: &Path) -> Result<Self> {
        let steps = folder.join(STEPS);
        fs::create_dir_all(&steps)
            .map_err(|error| Error::machine(format!("the folder cannot be made: {error}")).in_file(folder))?;
        file::check_writable(&steps.join("check.json"))?;
        Ok(Self { folder: folder.to_path_buf() })
    }

    /// A file of the study.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn step(&self, name: &str, extension: &str) -> PathBuf {
        self.folder.join(STEPS).join(name).with_added_extension(extension)
    }

    /// What a step found, if it was kept; a step of another identity, or one that is damaged, counts as missing.
    pub(super) fn find(&self, name: &str, identity: &str) -> Option<(Found, Picture)> {
        let text = fs::read(self.step(name, "json")).ok()?;
        let kept: Kept = serde_json::from_slice(&text).ok().filter(|kept: &Kept| kept.identity == identity)?;
        let file = read(&self.step(name, "exr")).ok()?;
        (file.metadata.get(STEP) == Some(identity)).then_some((kept.found, file.picture))
    }

    /// Keeps what a step found: the picture first, so that a record never stands without it. Returns the picture as the file holds it.
    pub(super) fn keep(&self, name: &str, identity: &str, found: Found, picture: &Picture) -> Result<(Found, Picture)> {
        let path = self.step(name, "exr");
        let record = self.step(name, "json");
        [&path, &record].into_iter().for_each(|path| file::clear_unfinished(path));
        write(&path, picture, &Metadata::new().with(STEP, identity))?;
        let picture = read(&path)?.picture;
        let kept = Kept { identity: identity.to_string(), found };
        file::write_whole(&record, (json(&kept) + "\n").as_bytes())?;
        Ok((kept.found, picture))
    }
}

/// A report as JSON; numbers that are not finite become `null`.
pub(super) fn json<T: Serialize>(value: &T) -> String {
    serde_json::to_string_pretty(value).expect("reports have text keys and no fallible values")
}
