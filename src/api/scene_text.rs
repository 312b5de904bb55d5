//! Reads scenes: scene files, and scenes of other programs, which are converted.

use std::path::Path;

use abbe_format::FileAccess;
use abbe_spectra::{Error, Result};

/// The text of a scene.
#[derive(Debug)]
pub struct SceneText {
    /// The text in the form of a scene file.
    pub text: String,
    /// The notes of a conversion say what it added and left out. A scene file has none.
    pub notes: Vec<String>,
}

/// Reads the text of a scene file, or converts a scene of another program. `file_access` states
/// which other files such a scene may name. `overlay` is a file with changes of a converted scene.
///
/// # Errors
/// Returns an error if the file cannot be read, is too large, is not UTF-8, or is a file of another
/// program that cannot be converted. In the last case, the error says how to bring the file into a
/// scene. Also returns an error if the overlay is wrong, or if there is an overlay for a file that
/// is not converted.
#[cfg_attr(not(feature = "meshes"), expect(unused_variables, reason = "only converted scenes name files"))]
pub fn read_scene_text(path: &Path, file_access: FileAccess, overlay: Option<&Path>) -> Result<SceneText> {
    #[cfg(feature = "meshes")]
    if abbe_import::can_import(path) {
        let imported = abbe_import::import(path, "", file_access)?;
        let imported = if let Some(overlay) = overlay { imported.with_overlay(overlay)? } else { imported };
        let notes = imported.notes();
        return Ok(SceneText { text: imported.text, notes });
    }
    let text = abbe_format::read_scene_text(path)?;
    if let Some(overlay) = overlay {
        return Err(Error::input("an overlay changes only scenes of other programs")
            .expected("no overlay for a scene file; `--set` changes a scene file")
            .in_file(overlay));
    }
    Ok(SceneText { text, notes: Vec::new() })
}
