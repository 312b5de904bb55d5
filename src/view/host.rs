//! The program that owns the view: it loads the scene and knows whether the user interrupts.

use abbe_format::JsonSource;
use abbe_session::output::Metadata;
use abbe_session::render::Job;
use abbe_spectra::error::Result;
use std::path::Path;

#[derive(Debug)]
pub struct LoadedScene {
    /// The text of the scene after all changes.
    pub source: JsonSource,
    pub job: Job,
    /// The header entries that describe the scene.
    pub metadata: Metadata,
}

pub trait ViewHost: Sync {
    fn scene_path(&self) -> &Path;

    /// Loads the scene with these changes in the form `PATH=JSON`, without the effects that the
    /// page has forbidden. Returns an input error if the scene or a change is wrong.
    fn load(&self, changes: &[String], forbidden: &[String]) -> Result<LoadedScene>;

    /// A function that returns true if the user has interrupted the program.
    fn interruption(&self) -> fn() -> bool;
}
