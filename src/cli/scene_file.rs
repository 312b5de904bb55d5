//! Opens scene files for the commands.

use std::path::Path;

use super::print;
use crate::error::Result;
use crate::format::{self, FileAccess, JsonSource, SceneFile, SceneText};

#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct SceneFileArgs {
    /// Let the scene name files outside its own folder
    #[arg(long)]
    allow_outside: bool,
}

impl SceneFileArgs {
    /// Reads a scene file. Prints what the conversion of another program's scene added and left
    /// out. Then applies `sets`, the patches in the form `PATH=JSON`.
    pub(crate) fn read(self, path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
        let access = if self.allow_outside { FileAccess::Anywhere } else { FileAccess::WithinFolder };
        let SceneText { text, notes } = format::read_scene_text(path, access)?;
        notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
        format::parse_with_access(&text, path, sets, access)
    }
}
