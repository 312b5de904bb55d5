//! Translates refractive indices of the scene file to functions of wavelength.

use crate::{FormulaFile, IndexFile, JsonSource, json::read_text};
use abbe_optics::glass::{AgfCatalogue, IndexFileData, RefractiveIndex};
use abbe_spectra::error::{Error, Result};
use std::path::{Path, PathBuf};

/// Reads a Zemax glass catalogue (`.agf`).
pub fn glass_file(path: &Path) -> Result<AgfCatalogue> {
    AgfCatalogue::parse(&read_bytes(path)?, path)
}

/// Reads a Zemax glass catalogue, or all catalogues of a folder (`.agf`, in any case) in the order
/// of their names. Those of a folder are a last resort, because makers use some names for different
/// glasses; a lens file that names them has them as its first choice.
///
/// # Errors
/// Returns an error if a file or the folder cannot be read, or if a file is not a catalogue.
pub fn glass_files(path: &Path) -> Result<Vec<AgfCatalogue>> {
    if !path.is_dir() {
        return Ok(vec![glass_file(path)?]);
    }
    let entries =
        std::fs::read_dir(path).map_err(|error| Error::input(format!("cannot be read: {error}")).in_file(path))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("agf")));
    files.sort();
    files.iter().map(|path| glass_file(path).map(AgfCatalogue::as_last_resort)).collect()
}

pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::input(format!("cannot be read: {error}")).in_file(path))
}

/// Reads a file with measured indices of refraction. `path` is relative to the scene's folder.
pub(super) fn index_file(path: &str, source: &JsonSource) -> Result<IndexFileData> {
    let path = source.file(path)?;
    IndexFileData::parse(&read_text(&path)?, &path)
}

pub(super) fn index_of(file: &IndexFile, source: &JsonSource) -> Result<RefractiveIndex> {
    match file {
        IndexFile::Number(n) => RefractiveIndex::constant(*n),
        IndexFile::Name(name) => RefractiveIndex::catalogue(name),
        IndexFile::Cauchy { a, b, c } => RefractiveIndex::cauchy(*a, *b, *c),
        IndexFile::Sellmeier { b, c } => RefractiveIndex::sellmeier(b, c),
        IndexFile::Abbe { nd, vd } => RefractiveIndex::abbe(*nd, *vd),
        IndexFile::Table { nm, values } => RefractiveIndex::table(nm, values),
        IndexFile::Glass { path: None, name, formula: FormulaFile::Sellmeier } => RefractiveIndex::catalogue(name),
        IndexFile::Glass { path: None, name, formula: FormulaFile::Cauchy } => RefractiveIndex::catalogue_cauchy(name),
        IndexFile::File(path) => index_file(path, source)?.index(),
        IndexFile::Glass { path: Some(path), name, formula } => {
            let glass = glass_file(&source.file(path)?)?.find(name)?;
            match formula {
                FormulaFile::Sellmeier => Ok(glass.index),
                FormulaFile::Cauchy => glass.cauchy_index(),
            }
        }
    }
}
