//! What runs leave in their folder.

use std::path::Path;

/// The names of all files, in their order.
pub(crate) fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder that can be listed");
    let names = entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name in Unicode"));
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}
