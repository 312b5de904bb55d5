//! Opens scene files for the commands.

use std::path::Path;

use crate::error::Result;
use crate::format::{self, FileAccess, JsonSource, SceneFile};

#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct SceneFileArgs {
    /// Let the scene name files outside its own folder
    #[arg(long)]
    allow_outside: bool,
}

impl SceneFileArgs {
    /// Reads a scene file, and then applies `sets`, the patches in the form `PATH=JSON`.
    pub(crate) fn read(self, path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
        let access = if self.allow_outside { FileAccess::Anywhere } else { FileAccess::WithinFolder };
        format::parse_with_access(&format::read_scene_text(path)?, path, sets, access)
    }
}
