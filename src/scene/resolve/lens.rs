//! Lens prescriptions as written → lenses that can be built.

use super::Resolver;
use super::materials::index_of;
use crate::error::{Error, Result};
use crate::optics::lens::{Lens, Opening, Prescription, Profile, Surface, catalogue, medium, zemax};
use crate::scene::file::{self, IndexFile, JsonPath, LensSurfaceFile, PrescriptionFile, Source};
use std::path::Path;

/// Reads a lens from a file: a Zemax one by its ending `.zmx`, otherwise a prescription in JSON as a scene holds it.
///
/// # Errors
/// A file that cannot be read, and whatever is wrong with it, with its place.
pub fn lens_file(path: &Path) -> Result<Lens> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("zmx")) {
        let bytes = std::fs::read(path);
        let bytes = bytes.map_err(|error| Error::input(format!("cannot be read: {error}")).in_file(path))?;
        return zemax::parse(&bytes, path);
    }
    let (prescription, source) = file::parse_prescription(&file::read_text(path)?, path)?;
    lone_lens(&prescription, &source)
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
            let is_file =
                path.extension().is_some_and(|end| end.eq_ignore_ascii_case("zmx") || end.eq_ignore_ascii_case("json"));
            if is_file {
                return lens_file(&self.at(at, self.source.file(name))?);
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
        let LensSurfaceFile { radius_mm, thickness_mm, ior, semi_aperture_mm, stop: _ } = file;
        let index = match ior {
            IndexFile::Name(name) => medium(name),
            IndexFile::Number(_)
            | IndexFile::Cauchy { .. }
            | IndexFile::Sellmeier { .. }
            | IndexFile::Abbe { .. }
            | IndexFile::Table { .. }
            | IndexFile::Glass { .. } => index_of(ior),
        };
        let index = index.map_err(|error| source.error_at(&at.index(i).key("ior").to_string(), error))?;
        let profile = Profile::sphere(*radius_mm);
        let (thickness_mm, semi_aperture_mm) = (*thickness_mm, *semi_aperture_mm);
        surfaces.push(Surface { profile, thickness_mm, index, semi_aperture_mm });
    }
    Ok(surfaces)
}
