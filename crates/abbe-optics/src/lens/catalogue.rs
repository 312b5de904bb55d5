//! The built-in lenses, parsed from `data/lenses/lenses.json` on first use.

use std::sync::LazyLock;

use serde::Deserialize;

use super::prescription::{ApertureSpec, Lens, LensSurface, Prescription, medium};
use super::profile::SurfaceProfile;
use abbe_spectra::error::{Error, Result};

/// Returns all lenses in the order of the file.
pub fn all() -> &'static [Lens] {
    &LENSES
}

/// Returns the lens `name`, in any case, with `-` and `_` for spaces, of which the first words
/// suffice. The error for an unknown name suggests the most similar one.
pub fn find(name: &str) -> Result<&'static Lens> {
    let wanted = normalised_name(name);
    let found = LENSES.iter().find(|lens| normalised_name(lens.name()) == wanted);
    let found =
        found.or_else(|| LENSES.iter().find(|lens| normalised_name(lens.name()).starts_with(&format!("{wanted} "))));
    found.ok_or_else(|| Error::unknown_name("lens", name, LENSES.iter().flat_map(|lens| searchable_names(lens.name()))))
}

fn normalised_name(name: &str) -> String {
    name.to_lowercase().replace(['-', '_'], " ")
}

/// Returns names for suggestions: the first word, the first two words, and the full name.
fn searchable_names(name: &str) -> impl Iterator<Item = &str> {
    let ends = name.match_indices(' ').map(|(at, _)| at).take(2).chain([name.len()]);
    ends.map(|end| &name[..end])
}

static LENSES: LazyLock<Vec<Lens>> = LazyLock::new(|| {
    let text = include_str!("../../data/lenses/lenses.json");
    let file: LensesFile = serde_json::from_str(text).expect("a test parses the embedded file");
    let lens = |entry| Lens::new(prescription(entry)?);
    file.lenses.into_iter().map(lens).collect::<Result<_>>().expect("a test parses the embedded file")
});

#[derive(Deserialize)]
struct LensesFile {
    lenses: Vec<LensEntry>,
}

#[derive(Deserialize)]
struct LensEntry {
    name: String,
    source: String,
    entrance_pupil_diameter_mm: f64,
    half_field_deg: f64,
    surfaces: Vec<LensSurfaceEntry>,
}

#[derive(Deserialize)]
struct LensSurfaceEntry {
    radius_mm: Option<f64>,
    thickness_mm: f64,
    glass: String,
    semi_aperture_mm: f64,
    #[serde(default)]
    stop: bool,
}

fn prescription(entry: LensEntry) -> Result<Prescription> {
    let LensEntry { name, source, entrance_pupil_diameter_mm: diameter_mm, half_field_deg, surfaces } = entry;
    let stop = surfaces.iter().position(|row| row.stop);
    let surface = |row: LensSurfaceEntry| {
        let LensSurfaceEntry { radius_mm, thickness_mm, glass, semi_aperture_mm, stop: _ } = row;
        Ok(LensSurface {
            profile: SurfaceProfile::sphere(radius_mm.unwrap_or(0.0)),
            thickness_mm,
            index: medium(&glass)?,
            semi_aperture_mm,
            obscuration_mm: 0.0,
            coating: None,
        })
    };
    Ok(Prescription {
        name,
        source: Some(source),
        surfaces: surfaces.into_iter().map(surface).collect::<Result<_>>()?,
        stop,
        opening: ApertureSpec::EntrancePupil { diameter_mm },
        half_field_deg: Some(half_field_deg),
        notes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lens_is_well_formed_and_found_by_its_name() {
        assert_eq!(all().len(), 10);
        for lens in all() {
            assert_eq!(find(&lens.name().to_uppercase()).unwrap().name(), lens.name());
            assert!(lens.source().is_some() && lens.half_field_deg().is_some());
        }
        assert_eq!(find("double-gauss").unwrap().name(), "double Gauss f/2 f100");
        assert_eq!(find("tessar").unwrap().name(), "Tessar f/4.5");
    }

    #[test]
    fn an_unknown_name_brings_the_nearest_one() {
        let message = find("tesar").unwrap_err().to_string();
        assert!(message.contains("unknown lens \"tesar\"; did you mean \"Tessar\""), "{message}");
    }
}
