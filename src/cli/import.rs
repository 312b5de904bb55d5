//! `abbe import`: converts scenes of other programs to scene files.

use std::path::{Path, PathBuf};

use super::{Outcome, print};
use crate::error::{Error, Result};
use crate::format::FileAccess;
use crate::format::import::import;
use crate::output::file::write_whole;

#[derive(Debug, clap::Args)]
pub(crate) struct ImportArgs {
    /// The glTF file (.gltf or .glb), Mitsuba scene (.xml) or pbrt scene (.pbrt)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The scene file to write, in the folder of FILE or in a folder above it [default: standard
    /// output, with paths relative to the folder of FILE]
    #[arg(short, long, value_name = "SCENE.json")]
    output: Option<PathBuf>,
    /// Apply a JSON file with changes, such as new materials for the names of a glTF file
    #[arg(long, value_name = "FILE.json")]
    overlay: Option<PathBuf>,
    /// Fail if anything in FILE is left out, or if anything is added
    #[arg(long)]
    strict: bool,
}

pub(crate) fn run(arguments: &ImportArgs) -> Result<Outcome> {
    let ImportArgs { file, output, overlay, strict } = arguments;
    let imported = import(file, &folder_from(output.as_deref(), file)?, FileAccess::WithinFolder)?;
    let imported = if let Some(overlay) = overlay { imported.with_overlay(overlay)? } else { imported };
    let notes: Vec<String> = imported.notes().into_iter().chain(imported.ignored_by_meshes).collect();
    if *strict && !notes.is_empty() {
        return Err(Error::input(notes.join("; ")).expected("nothing left out or added").in_file(file));
    }
    notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
    match output {
        Some(output) => {
            write_whole(output, imported.text.as_bytes())?;
            print::remark(&format!("wrote {}", output.display()));
        }
        None => print::result(&imported.text)?,
    }
    Ok(Outcome::Done)
}

/// Returns the path from the folder of the scene file `scene` to the folder of a file. Without a
/// scene file, both folders are the same.
fn folder_from(scene: Option<&Path>, file: &Path) -> Result<String> {
    let folder = |path: &Path| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        parent.canonicalize().map_err(|error| Error::input(format!("the folder cannot be read: {error}")).in_file(path))
    };
    let Some(scene) = scene else { return Ok(String::new()) };
    let (from, to) = (folder(scene)?, folder(file)?);
    let below = to.strip_prefix(&from).map_err(|_| {
        Error::input("the scene could not name the imported file")
            .expected("an output in the folder of the imported file or in a folder above it")
            .in_file(scene)
    })?;
    let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    Ok(parts.join("/"))
}
