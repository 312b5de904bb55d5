//! Reads pbrt-v4 scenes.
//!
//! The format is described at <https://pbrt.org/fileformat-v4>. `token` and `parameters` read the
//! grammar, `directives` executes the directives, and the other modules convert their parameters. A
//! parameter with a wrong type or a wrong number of values is an error with its file and line.
//!
//! pbrt's coordinates are left-handed: the camera looks along +z with +x to the right. Abbe's
//! camera is right-handed. If the transform of the camera does not exchange the handedness, the
//! whole scene is mirrored, so that the picture is not.

mod camera;
mod directives;
mod light;
mod material;
mod parameters;
mod placed_shape;
mod reader;
mod shape;
mod spectrum;
mod state;
#[cfg(test)]
mod tests;
mod texture;
mod token;

use crate::ImportedScene;
use abbe_format::FileAccess;
use abbe_format::json::read_text;
use abbe_spectra::error::Result;
use reader::PbrtReader;
use std::path::Path;
use token::Tokens;

pub(super) fn import(path: &Path, folder: &str, file_access: FileAccess) -> Result<ImportedScene> {
    let tokens = || Ok(Tokens::new(read_text(path)?, path.to_path_buf()));
    let reader = || PbrtReader::new(path.parent().unwrap_or(Path::new("")), folder, file_access);
    PbrtReader::executed(reader, tokens)?.finish(&path.file_name().unwrap_or_default().to_string_lossy())
}
