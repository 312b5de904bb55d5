//! Opens scene files for the commands.

use std::path::Path;

use super::print;
use crate::error::Result;
use crate::format::{self, FileAccess, JsonSource, SceneFile};

#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct SceneFileArgs {
    /// Let the scene name files outside its own folder
    #[arg(long)]
    allow_outside: bool,
}

/// Reads the text of a scene file. Prints what was added to a glTF file.
fn read_text(path: &Path, access: FileAccess) -> Result<String> {
    #[cfg(feature = "meshes")]
    if format::import::is_gltf(path) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let imported = format::import::scene_of_gltf(path, &name, access)?;
        imported.added.iter().for_each(|what| print::remark(&format!("note: added {what}")));
        return Ok(imported.text);
    }
    format::read_scene_text(path)
}

impl SceneFileArgs {
    /// Reads a scene file, and then applies `sets`, the patches in the form `PATH=JSON`.
    pub(crate) fn read(self, path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
        let access = if self.allow_outside { FileAccess::Anywhere } else { FileAccess::WithinFolder };
        format::parse_with_access(&read_text(path, access)?, path, sets, access)
    }
}
