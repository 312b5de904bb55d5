//! Reads scenes: scene files, and scenes of other programs, which are converted.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

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

/// Returns the file of a scene and, for a scene of another program, all files that it names: those
/// that it includes, and the files of these. A quoted text is a name if such a file exists.
pub fn scene_inputs(path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut found, mut open) = (BTreeSet::new(), vec![path.to_path_buf()]);
    while let Some(file) = open.pop() {
        if !found.insert(file.clone()) || !names_files(&file) {
            continue;
        }
        let Ok(bytes) = std::fs::read(&file) else { continue };
        let text = String::from_utf8_lossy(&bytes);
        // An included file names others relative to its own folder or to that of the scene.
        let folders = [folder, file.parent().unwrap_or(Path::new(""))];
        let names: BTreeSet<&str> = text.split(['"', '\'']).filter(|name| may_be_name(name)).collect();
        let named = names.iter().flat_map(|name| folders.map(|folder| folder.join(name)));
        open.extend(named.filter(|path| path.is_file()));
    }
    found.into_iter().collect()
}

/// Returns true for a text file of another program that can name other files.
fn names_files(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ["xml", "pbrt", "gltf"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// Returns true if a text is short and has an extension, as most names of files do.
fn may_be_name(text: &str) -> bool {
    const LONGEST: usize = 1024;
    text.len() <= LONGEST && text.contains('.') && !text.contains('\n')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inputs_of_a_foreign_scene_contain_its_includes() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).unwrap();
            folder.path().join(name)
        };
        std::fs::create_dir(folder.path().join("parts")).unwrap();
        let scene = write("scene.pbrt", "Include \"parts/all.pbrt\"\nCamera \"perspective\"");
        let all = write("parts/all.pbrt", "Include \"parts/wood.pbrt\" Include \"metal.pbrt\" Include \"none.pbrt\"");
        let wood =
            write("parts/wood.pbrt", "Texture \"wood\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.png\"");
        let (metal, picture) = (write("parts/metal.pbrt", ""), write("wood.png", ""));
        let mut expected = vec![scene.clone(), all, wood, metal, picture];
        expected.sort();
        assert_eq!(scene_inputs(&scene), expected);
        let xml = write("scene.xml", "<scene><include filename='part.xml'/></scene>");
        let part = write("part.xml", "<scene><include filename=\"scene.xml\"/></scene>");
        assert_eq!(scene_inputs(&xml), [part, xml.clone()]);
        let json = write("scene.json", r#"{"title": "scene.xml"}"#);
        assert_eq!(scene_inputs(&json), std::slice::from_ref(&json));
    }
}
