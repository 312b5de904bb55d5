//! Converts scenes of other programs to scene files of the renderer Abbe: glTF, Mitsuba and pbrt.
//!
//! [`import`] selects the reader by the extension of the file. A reader hands the parts of the
//! scene to a scene writer, and states what it leaves out or adds, so that no difference stays
//! hidden.
//!
//! ```
//! use abbe_format::FileAccess;
//!
//! let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/triangle.gltf");
//! let imported = abbe_import::import(path.as_ref(), "", FileAccess::WithinFolder)?;
//! assert!(imported.text.contains("triangle.gltf"));
//! for note in imported.notes() {
//!     println!("note: {note}");
//! }
//! # Ok::<(), abbe_spectra::Error>(())
//! ```
//!
//! `examples/convert_gltf.rs` prints the scene file of a model.
//!
//! # Modules
//!
//! All modules are private, one for each program:
//!
//! | module | content |
//! | --- | --- |
//! | `gltf` | cameras, punctual lights and animations of glTF files; the meshes stay in their file |
//! | `mitsuba` | scenes of Mitsuba 3 (`.xml`) |
//! | `pbrt` | scenes of pbrt-v4 (`.pbrt`) |
//! | `overlay` | changes that a small JSON file makes to a converted scene |
//! | `scene_writer` | the parts of a scene, and their text |
//!
//! # Units and conventions
//!
//! A converted scene is in metres. glTF gives luminous quantities, which stay luminous; Mitsuba and
//! pbrt give radiance without a unit, which becomes W/m²/sr over the band of these programs.
//!
//! # Dependencies
//!
//! [`abbe_format`] defines the scene file and reads meshes; [`abbe_scene`], [`abbe_optics`] and
//! [`abbe_spectra`] supply the model and the names of spectra and glasses.

mod gltf;
mod mitsuba;
mod overlay;
mod pbrt;
mod scene_writer;

use std::path::Path;

use serde_json::{Value, json};

use abbe_format::FileAccess;
use abbe_spectra::error::{Error, Result};
use overlay::ImportedNames;
use scene_writer::SceneWriter;

/// The wavelengths (nm) that pbrt and Mitsuba simulate.
const VISIBLE_NM: [f64; 2] = [360.0, 830.0];

/// A converted scene.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportedScene {
    /// The text of the scene file.
    pub text: String,
    /// Sentences about the parts that the file lacks and that were added.
    pub added: Vec<String>,
    /// Sentences about what was left out, or replaced by something similar.
    pub left_out: Vec<String>,
    /// Sentences about what the mesh reader ignores. A reader of the converted scene finds them
    /// again.
    pub ignored_by_meshes: Vec<String>,
    /// The names that an overlay may use.
    names: ImportedNames,
}

impl ImportedScene {
    /// Returns one sentence for each part that the conversion left out or added.
    pub fn notes(&self) -> Vec<String> {
        let added = self.added.iter().map(|what| format!("added {what}"));
        self.left_out.iter().cloned().chain(added).collect()
    }

    /// Applies an overlay: a small JSON file that names materials, lights and objects of the
    /// converted scene, and replaces or changes them. The file may also change the camera, the film
    /// and the render settings, and add lights and objects. Paths in the overlay are relative to
    /// the folder of the scene file.
    ///
    /// # Errors
    /// Returns an error if the overlay cannot be read, or if it contains an unknown key or an
    /// unknown name. The error contains the position in the overlay.
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

/// A reader of the scenes of another program. The first argument is the file. The second argument
/// is the path from the folder of the scene file to the folder of the file. This path is empty or
/// ends with "/".
type Reader = fn(&Path, &str, FileAccess) -> Result<ImportedScene>;

/// The readers by file name extension.
const READERS: [(&str, Reader); 4] =
    [("gltf", gltf::import), ("glb", gltf::import), ("xml", mitsuba::import), ("pbrt", pbrt::import)];

fn reader(path: &Path) -> Option<Reader> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    READERS.iter().find(|(known, _)| extension.eq_ignore_ascii_case(known)).map(|&(_, reader)| reader)
}

/// Returns the table of a reflectance or of a coefficient. In pbrt and in Mitsuba, it is 0 beyond
/// its ends, and in a scene file, it is constant there.
fn dark_outside(nm: &[f64], values: &[f64]) -> Value {
    /// The distance (nm) from the end of a table to the first wavelength with the value 0.
    const EDGE_NM: f64 = 0.01;
    let (mut nm, mut values) = (nm.to_vec(), values.to_vec());
    if nm.first().is_some_and(|&first| first > VISIBLE_NM[0]) {
        nm.insert(0, nm[0] - EDGE_NM);
        values.insert(0, 0.0);
    }
    if let Some(&last) = nm.last()
        && last < VISIBLE_NM[1]
    {
        nm.push(last + EDGE_NM);
        values.push(0.0);
    }
    json!({"table": {"nm": nm, "values": values}})
}

/// Returns true if the extension of a file says that [`import`] can read it.
pub fn can_import(path: &Path) -> bool {
    reader(path).is_some()
}

/// Converts a scene of another program to the text of a scene file. `folder` is the path from the
/// folder of the scene file to the folder of `path`, with "/" between its parts. It is empty if
/// both are the same. `file_access` states which other files the scene may name.
///
/// If the file has no camera, the camera sees the whole scene from the front. If the file has no
/// light, a sky illuminates the scene: an overcast sky with a soft sun for glTF, and a uniform sky
/// for the other formats. `added` says so.
///
/// # Errors
/// Returns an error if the file cannot be read, or if it is not valid. The error contains the name
/// of the file.
pub fn import(path: &Path, folder: &str, file_access: FileAccess) -> Result<ImportedScene> {
    let known = READERS.map(|(extension, _)| format!(".{extension}")).join(", ");
    let reader = reader(path).ok_or_else(|| {
        Error::input("found a file of another kind")
            .expected(format!("one of {known}; docs/guide/import.md lists what other files can bring into a scene"))
            .in_file(path)
    })?;
    let folder = if folder.is_empty() { String::new() } else { format!("{folder}/") };
    reader(path, &folder, file_access).map_err(|error| error.in_file(path))
}

#[cfg(test)]
mod test_support {
    use abbe_format::{FileAccess, JsonSource, SceneFile, parse};
    use abbe_spectra::error::Result;
    use std::path::Path;

    /// Converts a scene, and reads it as a scene file.
    pub(crate) fn read_converted(path: &Path) -> Result<(SceneFile, JsonSource)> {
        parse(super::import(path, "", FileAccess::WithinFolder)?.text, path, &[])
    }
}
