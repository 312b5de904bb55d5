//! Opens scene files for the commands.

use std::path::{Path, PathBuf};

use super::print;
use crate::api::provenance::SceneFiles;
use crate::api::{SceneText, read_scene_text, scene_inputs};
use abbe_format::{self as format, FileAccess, JsonSource, SceneFile};
use abbe_spectra::error::Result;

#[derive(Debug, Clone, clap::Args)]
pub(crate) struct SceneFileArgs {
    /// Let the scene name files outside its own folder
    #[arg(long)]
    pub(super) allow_outside: bool,
    /// Apply a JSON file with changes to a scene of another program, such as new materials for the
    /// names of a glTF file
    #[arg(long, value_name = "FILE.json")]
    pub(super) overlay: Option<PathBuf>,
}

impl SceneFileArgs {
    pub(super) fn file_access(&self) -> FileAccess {
        if self.allow_outside { FileAccess::Anywhere } else { FileAccess::WithinFolder }
    }

    /// Returns the files that a scene is read from: its own, those that it names, and the overlay.
    pub(crate) fn inputs(&self, files: &SceneFiles, path: &Path) -> Vec<PathBuf> {
        files.paths.iter().cloned().chain(self.inputs_of_conversion(path)).collect()
    }

    /// Returns the files that a scene is converted from: its own, those that it includes, and the
    /// overlay.
    pub(crate) fn inputs_of_conversion(&self, path: &Path) -> Vec<PathBuf> {
        scene_inputs(path).into_iter().chain(self.overlay.clone()).collect()
    }

    /// Reads a scene file, prints what a conversion added and left out unless `quiet` is true, and
    /// applies the patches `sets` in the form `PATH=JSON`.
    pub(crate) fn read(&self, path: &Path, sets: &[String], quiet: bool) -> Result<(SceneFile, JsonSource)> {
        let access = self.file_access();
        let SceneText { text, notes } = read_scene_text(path, access, self.overlay.as_deref())?;
        print::notes(&notes, &[], quiet);
        format::parse_with_access(text, path, sets, access)
    }
}
