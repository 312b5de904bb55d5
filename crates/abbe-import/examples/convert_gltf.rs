//! Converts a glTF file to a scene file, and prints the scene and what the conversion changed.
//!
//! ```text
//! cargo run --release -p abbe-import --example convert_gltf -- MODEL.gltf
//! ```
//!
//! Without an argument, the example converts `triangle.gltf` beside its source. Files of Mitsuba
//! (`.xml`) and pbrt (`.pbrt`) are converted in the same way.

use abbe_format::FileAccess;
use abbe_import::import;
use abbe_spectra::Result;
use std::path::PathBuf;

fn main() -> Result<()> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/triangle.gltf");
    let path = std::env::args_os().nth(1).map_or_else(|| PathBuf::from(default), PathBuf::from);
    // The scene file lies in the folder of the model, so the path between them is empty.
    let imported = import(&path, "", FileAccess::WithinFolder)?;
    println!("{}", imported.text);
    imported.notes().iter().for_each(|note| println!("note: {note}"));
    Ok(())
}
