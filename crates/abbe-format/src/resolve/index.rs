//! Translates refractive indices of the scene file to functions of wavelength.

use crate::{FormulaFile, IndexFile, JsonSource, json::read_text};
use abbe_optics::glass::{AgfCatalogue, IndexFileData, RefractiveIndex};
use abbe_spectra::error::{Error, Result};
use std::path::Path;

/// Reads a Zemax glass catalogue (`.agf`).
pub fn glass_file(path: &Path) -> Result<AgfCatalogue> {
    AgfCatalogue::parse(&read_bytes(path)?, path)
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
