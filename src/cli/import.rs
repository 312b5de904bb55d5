//! `abbe import`: converts scenes of other programs to scene files.

use std::path::{Path, PathBuf};

use super::scene_file::SceneFileArgs;
use super::{Outcome, print};
use abbe_format::mesh;
use abbe_import::{ImportedScene, import};
use abbe_session::output::file::{check_keeps_inputs, write_whole};
use abbe_spectra::error::{Error, Result};

#[derive(Debug, clap::Args)]
pub(crate) struct ImportArgs {
    /// The glTF file (.gltf or .glb), Mitsuba scene (.xml) or pbrt scene (.pbrt)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The scene file to write, in the folder of FILE or in a folder above it, or anywhere with
    /// --allow-outside [default: standard output, with paths relative to the folder of FILE]
    #[arg(short, long, value_name = "SCENE.json")]
    output: Option<PathBuf>,
    #[command(flatten)]
    scene_file: SceneFileArgs,
    /// Fail if anything in FILE is left out, or if anything is added
    #[arg(long)]
    strict: bool,
}

pub(crate) fn run(arguments: &ImportArgs) -> Result<Outcome> {
    let ImportArgs { file, output, scene_file, strict } = arguments;
    check_keeps_inputs(output.as_deref(), scene_file.inputs_of_conversion(file))?;
    let folder = folder_from(output.as_deref(), file, scene_file.allow_outside)?;
    let imported = import(file, &folder, scene_file.file_access())?;
    let imported = if let Some(overlay) = &scene_file.overlay { imported.with_overlay(overlay)? } else { imported };
    let notes: Vec<String> = imported.notes().into_iter().chain(of_meshes(file, scene_file, &imported)).collect();
    if *strict && !notes.is_empty() {
        return Err(Error::input(notes.join("; ")).expected("nothing left out or added").in_file(file));
    }
    notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
    match output {
        Some(output) => {
            write_whole(output, imported.text.as_bytes())?;
            print::remark(&format!("wrote {}", output.display()));
        }
        None => print::data(&imported.text)?,
    }
    Ok(Outcome::Done)
}

/// Returns what the reader of meshes ignores in the imported file, in sentences.
fn of_meshes(file: &Path, scene_file: &SceneFileArgs, imported: &ImportedScene) -> Vec<String> {
    let extension = file.extension().unwrap_or_default();
    if !["gltf", "glb"].iter().any(|own| extension.eq_ignore_ascii_case(own)) {
        return imported.ignored_by_meshes.clone();
    }
    match mesh::load_unplaced(file, scene_file.file_access()) {
        Ok(parts) => [parts.ignored, parts.warnings, parts.remarks].concat(),
        Err(error) => {
            let unreadable = format!("the meshes cannot be read: {error}");
            imported.ignored_by_meshes.iter().cloned().chain([unreadable]).collect()
        }
    }
}

/// Returns the path from the folder of the scene file `scene`, or of the file itself without one,
/// to the folder of a file. It leads out of the folder only if `allow_outside` is true.
fn folder_from(scene: Option<&Path>, file: &Path, allow_outside: bool) -> Result<String> {
    let folder = |path: &Path| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        parent.canonicalize().map_err(|error| Error::input(format!("the folder cannot be read: {error}")).in_file(path))
    };
    let Some(scene) = scene else { return Ok(String::new()) };
    let (from, to) = (folder(scene)?, folder(file)?);
    let shared = from.components().zip(to.components()).take_while(|(from, to)| from == to).count();
    let outside = from.components().count() - shared;
    if outside > 0 && !allow_outside {
        return Err(Error::input("the scene could not name the imported file")
            .expected("an output in the folder of the imported file or in a folder above it, or --allow-outside")
            .in_file(scene));
    }
    let up = std::iter::repeat_n("..".to_owned(), outside);
    let down = to.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    Ok(up.chain(down).collect::<Vec<_>>().join("/"))
}
