//! Scratch folders for runs, and the files in them.

use std::path::Path;
use tempfile::TempDir;

/// Creates a folder with this scene as `ball.json`.
pub(crate) fn with_ball(scene: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder of its own");
    std::fs::write(folder.path().join("ball.json"), scene).expect("a folder that can be written");
    folder
}

/// Returns the names of all files in alphabetical order.
pub(crate) fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder that can be listed");
    let names = entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name in Unicode"));
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}
