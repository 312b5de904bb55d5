//! The program that owns the view: it loads the scene and knows whether the user interrupts.

use crate::page::LoadedScene;
use abbe_spectra::error::Result;
use std::path::Path;

pub trait ViewHost: Sync {
    fn scene_path(&self) -> &Path;

    /// Loads the scene with these changes in the form `PATH=JSON`, without the effects that the
    /// page has forbidden. Returns an input error if the scene or a change is wrong.
    fn load(&self, changes: &[String], forbidden: &[String]) -> Result<LoadedScene>;

    /// A function that returns true if the user has interrupted the program.
    fn interruption(&self) -> fn() -> bool;
}
