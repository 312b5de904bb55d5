//! The program that owns the view: it loads the scene and knows whether the user interrupts.

use super::examples::Example;
use crate::page::LoadedScene;
use abbe_spectra::error::Result;
use std::path::Path;

pub trait ViewHost: Sync {
    /// The scene file, or `None` if the reader chooses among the examples.
    fn scene_path(&self) -> Option<&Path>;

    /// Loads the scene file, or the chosen example, with these changes in the form `PATH=JSON`,
    /// without the effects that the page has forbidden. Returns an input error if the scene or a
    /// change is wrong.
    fn load(&self, example: Option<&Example>, changes: &[String], forbidden: &[String]) -> Result<LoadedScene>;

    /// A function that returns true if the user has interrupted the program.
    fn interruption(&self) -> fn() -> bool;
}
