//! Translates lens prescriptions of the scene file to lenses.

use super::index::{glass_file, index_of, read_bytes};
use super::{context::Resolver, spectra::Spectra};
use crate::{IndexFile, JsonPath, JsonSource, LensSurfaceFile, PrescriptionFile};
use abbe_optics::glass::{AgfCatalogue, RefractiveIndex};
use abbe_optics::lens::zemax::{self, ZmxSystem};
use abbe_optics::lens::{ApertureSpec, Lens, LensSurface, Prescription, SurfaceProfile, catalogue, medium};
use abbe_spectra::error::Result;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads a lens from a file: that of a design program if the extension is in [`zemax::EXTENSIONS`],
/// or else a prescription in JSON as in a scene file. The glasses of the former are looked up in
/// `catalogues`, then in the catalogues that a Zemax file names and that are in its folder, and
/// last among the built-in ones.
///
/// # Errors
/// Returns an error with its place if the file cannot be read or is not a valid lens file.
pub fn lens_file(path: &Path, catalogues: &[AgfCatalogue]) -> Result<Lens> {
    if is_design(path) {
        let bytes = read_bytes(path)?;
        return zemax::parse(&bytes, path, &with_catalogues_beside(path, &bytes, catalogues)?);
    }
    let (prescription, source) = crate::parse_prescription(&crate::read_text(path)?, path)?;
    lone_lens(&prescription, &source)
}

/// Reads a lens or a system with mirrors from a file, like [`lens_file`] and with the same errors.
pub fn lens_system_file(path: &Path, catalogues: &[AgfCatalogue]) -> Result<ZmxSystem> {
    if !is_design(path) {
        return lens_file(path, catalogues).map(ZmxSystem::Lens);
    }
    let bytes = read_bytes(path)?;
    zemax::parse_system(&bytes, path, &with_catalogues_beside(path, &bytes, catalogues)?)
}

/// Returns the given catalogues, followed by those beside a Zemax lens. Of the last resorts among
/// those given, the ones that the lens names come next, as ordinary catalogues in its order.
fn with_catalogues_beside(path: &Path, lens: &[u8], given: &[AgfCatalogue]) -> Result<Vec<AgfCatalogue>> {
    let named = zemax::catalogues(lens);
    let is = |file: &AgfCatalogue, name: &str| stem(file.path()).eq_ignore_ascii_case(name);
    let (last, mut all): (Vec<_>, Vec<_>) = given.iter().cloned().partition(AgfCatalogue::is_last_resort);
    for path in catalogues_beside(path, lens) {
        all.push(glass_file(&path)?);
    }
    for name in &named {
        all.extend(last.iter().filter(|file| is(file, name)).cloned().map(AgfCatalogue::as_first_choice));
    }
    all.extend(last);
    Ok(all)
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns the paths of the glass catalogues (`NAME.agf`, in any case) that a Zemax lens with the
/// content `lens` names and that exist in its folder.
pub fn catalogues_beside(path: &Path, lens: &[u8]) -> Vec<PathBuf> {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let names = zemax::catalogues(lens);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let number = |path: &PathBuf| names.iter().position(|name| name.eq_ignore_ascii_case(&stem(path)));
    let named = entries.filter(|path| has_ending(path, "agf")).filter_map(|path| Some((number(&path)?, path)));
    let mut named: Vec<(usize, PathBuf)> = named.collect();
    named.sort();
    named.into_iter().map(|(_, path)| path).collect()
}

/// Returns true for a file of a lens design program.
fn is_design(path: &Path) -> bool {
    zemax::EXTENSIONS.iter().any(|ending| has_ending(path, ending))
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

/// Resolves a lens outside a scene: a built-in name, or surfaces. Errors have a place in `source`.
pub fn lone_lens(prescription: &PrescriptionFile, source: &JsonSource) -> Result<Lens> {
    let notes = RefCell::default();
    lens_at(&JsonPath::Root, prescription, &Spectra { named: &BTreeMap::new(), source, notes: &notes })
}

impl Resolver<'_> {
    /// Resolves the lens of a camera: a built-in name, a file, or surfaces.
    pub(super) fn lens(&self, at: &JsonPath, prescription: &PrescriptionFile) -> Result<Lens> {
        if let PrescriptionFile::Name(name) = prescription {
            let path = Path::new(name);
            if is_design(path) || has_ending(path, "json") {
                return lens_file(&self.at(at, self.source.file(name))?, &[]);
            }
        }
        lens_at(at, prescription, &self.spectra())
    }
}

fn lens_at(at: &JsonPath, prescription: &PrescriptionFile, spectra: &Spectra) -> Result<Lens> {
    let source = spectra.source;
    let files = match prescription {
        PrescriptionFile::Name(name) => {
            return catalogue::find(name).cloned().map_err(|error| source.error_at(&at.to_string(), error));
        }
        PrescriptionFile::Surfaces(files) => files,
    };
    let lens = Lens::new(Prescription {
        name: source.path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        source: None,
        surfaces: surfaces(&at.key("surfaces"), files, spectra)?,
        stop: files.iter().position(|surface| surface.stop),
        opening: ApertureSpec::Stop,
        half_field_deg: None,
        notes: Vec::new(),
    });
    lens.map_err(|mut error| {
        // The JSON path in an error of `Lens::new` starts at the prescription.
        let steps = [at.to_string(), error.location.path.take().unwrap_or_default()];
        let path: Vec<&str> = steps.iter().map(String::as_str).filter(|step| !step.is_empty()).collect();
        source.error_at(&path.join("."), error)
    })
}

fn surfaces(at: &JsonPath, files: &[LensSurfaceFile], spectra: &Spectra) -> Result<Vec<LensSurface>> {
    let source = spectra.source;
    let mut front = RefractiveIndex::constant(1.0)?;
    let mut surfaces = Vec::new();
    for (i, it) in files.iter().enumerate() {
        let LensSurfaceFile { radius_mm, conic, aspheric, thickness_mm, ior, semi_aperture_mm, stop: _, coating } = it;
        let index = if let IndexFile::Name(name) = ior { medium(name) } else { index_of(ior, source) };
        let index = index.map_err(|error| source.error_at(&at.index(i).key("ior").to_string(), error))?;
        // The file's coefficients begin with h⁴, and a profile's with h², so a 0 comes first.
        let even_terms = if aspheric.is_empty() { [].into() } else { [0.0].iter().chain(aspheric).copied().collect() };
        let profile = SurfaceProfile { conic: *conic, even_terms, ..SurfaceProfile::sphere(*radius_mm) };
        let resolve = |file| spectra.lens_coating(&at.index(i).key("coating"), file, [&front, &index]);
        let coating = coating.as_ref().map(resolve).transpose()?;
        front = index.clone();
        let (thickness_mm, semi_aperture_mm) = (*thickness_mm, *semi_aperture_mm);
        surfaces.push(LensSurface { profile, thickness_mm, index, semi_aperture_mm, obscuration_mm: 0.0, coating });
    }
    Ok(surfaces)
}
