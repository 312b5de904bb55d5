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
//! A converted scene is in metres, and its lights have photometric quantities: those of glTF, or of
//! Mitsuba and pbrt, whose value 1 becomes 1 cd/m², 1 cd or 1 lx.
//!
//! # Dependencies
//!
//! [`abbe_format`] defines the scene file and reads meshes; [`abbe_scene`], [`abbe_optics`] and
//! [`abbe_spectra`] supply the model and the names of spectra and glasses.

mod dark_outside;
mod facing;
mod gltf;
mod imported_scene;
mod mitsuba;
mod overlay;
mod pbrt;
mod scene_writer;

use abbe_format::FileAccess;
use abbe_spectra::error::{Error, Result};
pub use imported_scene::ImportedScene;
use std::path::Path;

/// A reader of the scenes of another program. The first argument is the file. The second argument
/// is the path from the folder of the scene file to the folder of the file. This path is empty or
/// ends with "/".
type ImportFn = fn(&Path, &str, FileAccess) -> Result<ImportedScene>;

/// The readers by file name extension.
const READERS: [(&str, ImportFn); 4] =
    [("gltf", gltf::import), ("glb", gltf::import), ("xml", mitsuba::import), ("pbrt", pbrt::import)];

fn reader(path: &Path) -> Option<ImportFn> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    READERS.iter().find(|(known, _)| extension.eq_ignore_ascii_case(known)).map(|&(_, reader)| reader)
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
/// Returns an error with the name of the file if it cannot be read or is not valid.
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

    /// Returns a PNG file of 2 × 2 pixels.
    pub(crate) fn small_png(codes: [[u8; 3]; 4]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(codes.as_flattened()).unwrap();
        bytes
    }
}
