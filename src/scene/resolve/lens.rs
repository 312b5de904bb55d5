//! Lens prescriptions as written → lenses that can be built.

use super::Resolver;
use super::materials::index_of;
use crate::error::{Error, Result};
use crate::optics::glass::GlassFile;
use crate::optics::lens::{Lens, Opening, Prescription, Profile, Surface, catalogue, medium, zemax};
use crate::scene::file::{self, IndexFile, JsonPath, LensSurfaceFile, PrescriptionFile, Source};
use std::path::{Path, PathBuf};

/// Reads a lens from a file: a Zemax one by its ending `.zmx`, otherwise a prescription in JSON as a scene holds it. The glasses of a Zemax file are
/// those of `catalogues`, then of the catalogues that it names if they lie beside it, then the built-in ones.
///
/// # Errors
/// A file that cannot be read, and whatever is wrong with it, with its place.
pub fn lens_file(path: &Path, catalogues: &[GlassFile]) -> Result<Lens> {
    if has_ending(path, "zmx") {
        let bytes = bytes(path)?;
        let mut catalogues = catalogues.to_vec();
        for path in catalogues_beside(path, &bytes) {
            catalogues.push(glass_file(&path)?);
        }
        return zemax::parse(&bytes, path, &catalogues);
    }
    let (prescription, source) = file::parse_prescription(&file::read_text(path)?, path)?;
    lone_lens(&prescription, &source)
}

/// Reads a Zemax glass catalogue (`.agf`).
///
/// # Errors
/// A file that cannot be read or is no such catalogue.
pub fn glass_file(path: &Path) -> Result<GlassFile> {
    GlassFile::parse(&bytes(path)?, path)
}

/// The files `NAME.agf` in a Zemax lens's folder, in any case, of the catalogues that it names.
pub fn catalogues_beside(path: &Path, lens: &[u8]) -> Vec<PathBuf> {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let names = zemax::catalogues(lens);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let number = |path: &PathBuf| names.iter().position(|name| name.eq_ignore_ascii_case(&stem(path)));
    let named = entries.filter(|path| has_ending(path, "agf")).filter_map(|path| Some((number(&path)?, path)));
    let mut named: Vec<(usize, PathBuf)> = named.collect();
    named.sort();
    named.into_iter().map(|(_, path)| path).collect()
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

fn bytes(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::input(format!("cannot be read: {error}")).in_file(path))
}

/// Resolves a lens that stands by itself, outside any scene; a name is that of a built-in one.
///
/// # Errors
/// Unknown names, and surfaces that make no lens; each with its place in `source`.
pub fn lone_lens(prescription: &PrescriptionFile, source: &Source) -> Result<Lens> {
    lens_at(&JsonPath::Root, prescription, source)
}

impl Resolver<'_> {
    /// Resolves a camera's lens: a built-in name, a file beside the scene (by its ending `.zmx` or `.json`), or surfaces.
    pub(super) fn lens(&self, at: &JsonPath<'_>, prescription: &PrescriptionFile) -> Result<Lens> {
        if let PrescriptionFile::Name(name) = prescription {
            let path = Path::new(name);
            if has_ending(path, "zmx") || has_ending(path, "json") {
                return lens_file(&self.at(at, self.source.file(name))?, &[]);
            }
        }
        lens_at(at, prescription, self.source)
    }
}

/// The lens that is written at a place of a file.
fn lens_at(at: &JsonPath<'_>, prescription: &PrescriptionFile, source: &Source) -> Result<Lens> {
    let files = match prescription {
        PrescriptionFile::Name(name) => {
            return catalogue::find(name).cloned().map_err(|error| source.error_at(&at.to_string(), error));
        }
        PrescriptionFile::Surfaces(files) => files,
    };
    let lens = Lens::new(Prescription {
        name: source.path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        source: None,
        surfaces: surfaces(&at.key("surfaces"), files, source)?,
        stop: files.iter().position(|surface| surface.stop),
        opening: Opening::Stop,
        half_field_deg: None,
    });
    lens.map_err(|mut error| {
        // A lens names its surfaces from its own beginning.
        let steps = [at.to_string(), error.place.path.take().unwrap_or_default()];
        let path: Vec<&str> = steps.iter().map(String::as_str).filter(|step| !step.is_empty()).collect();
        source.error_at(&path.join("."), error)
    })
}

fn surfaces(at: &JsonPath<'_>, files: &[LensSurfaceFile], source: &Source) -> Result<Vec<Surface>> {
    let mut surfaces = Vec::new();
    for (i, file) in files.iter().enumerate() {
        let LensSurfaceFile { radius_mm, conic, aspheric, thickness_mm, ior, semi_aperture_mm, stop: _ } = file;
        let index = match ior {
            IndexFile::Name(name) => medium(name),
            IndexFile::Number(_)
            | IndexFile::Cauchy { .. }
            | IndexFile::Sellmeier { .. }
            | IndexFile::Abbe { .. }
            | IndexFile::Table { .. }
            | IndexFile::Glass { .. } => index_of(ior, source),
        };
        let index = index.map_err(|error| source.error_at(&at.index(i).key("ior").to_string(), error))?;
        // A prescription begins with h⁴, the profile with h².
        let even_terms =
            if aspheric.is_empty() { [].into() } else { std::iter::once(&0.0).chain(aspheric).copied().collect() };
        let profile = Profile { conic: *conic, even_terms, ..Profile::sphere(*radius_mm) };
        let (thickness_mm, semi_aperture_mm) = (*thickness_mm, *semi_aperture_mm);
        surfaces.push(Surface { profile, thickness_mm, index, semi_aperture_mm });
    }
    Ok(surfaces)
}
