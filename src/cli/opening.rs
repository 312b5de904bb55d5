//! How scene files are opened: what every command that reads one has in common.

use std::path::Path;

use abbe::error::Result;
use abbe::scene::file::{self, Reach, SceneFile, Source};

#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct Arguments {
    /// Let the scene name files outside its own folder
    #[arg(long)]
    allow_outside: bool,
}

impl Arguments {
    /// Reads a scene file; `sets` are `PATH=JSON` patches.
    pub(crate) fn read(self, path: &Path, sets: &[String]) -> Result<(SceneFile, Source)> {
        let (scene, source) = file::read(path, sets)?;
        Ok((scene, source.reaching(if self.allow_outside { Reach::Anywhere } else { Reach::Folder })))
    }
}
