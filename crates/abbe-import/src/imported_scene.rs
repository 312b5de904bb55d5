//! A converted scene.

use crate::{overlay, overlay::ImportedNames};
use abbe_spectra::error::Result;
use std::path::Path;

#[derive(Debug, Clone, PartialEq)]
pub struct ImportedScene {
    pub text: String,
    /// Sentences about the parts that the file lacks and that were added.
    pub added: Vec<String>,
    /// Sentences about what was left out, or replaced by something similar.
    pub left_out: Vec<String>,
    /// What the mesh reader ignores, in sentences. A reader of the scene finds them again.
    pub ignored_by_meshes: Vec<String>,
    /// The names that an overlay may use.
    pub(super) names: ImportedNames,
}

impl ImportedScene {
    /// Returns one sentence for each part that the conversion left out or added.
    pub fn notes(&self) -> Vec<String> {
        let added = self.added.iter().map(|what| format!("added {what}"));
        self.left_out.iter().cloned().chain(added).collect()
    }

    /// Applies an overlay: a small JSON file that replaces or changes materials, lights and objects
    /// of the scene by their names. It may also change the camera, the film and the render
    /// settings, and add lights and objects. Its paths are relative to the folder of the scene
    /// file.
    ///
    /// # Errors
    /// Returns an error with its position in the overlay if the overlay cannot be read, or if it
    /// contains an unknown key or name.
    pub fn with_overlay(mut self, path: &Path) -> Result<Self> {
        let overlaid = overlay::apply(&self.text, &self.names, path)?;
        self.text = overlaid.text;
        if overlaid.replaces_lights {
            let note = self.names.added_lights.as_ref().map(|lights| &lights.note);
            self.added.retain(|what| Some(what) != note);
        }
        Ok(self)
    }
}
