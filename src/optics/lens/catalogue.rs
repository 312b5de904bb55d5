//! The built-in lenses: `data/lenses/lenses.json`, read once, at the first look-up.

use std::sync::LazyLock;

use serde::Deserialize;

use super::prescription::{Lens, Opening, Prescription, Surface, medium};
use super::profile::Profile;
use crate::error::{Error, Result};

/// All lenses, in the file's order.
pub fn all() -> &'static [Lens] {
    &LENSES
}

/// The lens of this name, without regard to case, with `-` and `_` for blanks if one likes; the first words of a name will do
/// (`double-gauss` for "double Gauss f/2 f100"). Fails on an unknown name, with the nearest known one.
pub fn find(name: &str) -> Result<&'static Lens> {
    let wanted = plain(name);
    let found = LENSES.iter().find(|lens| plain(lens.name()) == wanted);
    let found = found.or_else(|| LENSES.iter().find(|lens| plain(lens.name()).starts_with(&format!("{wanted} "))));
    found.ok_or_else(|| Error::unknown_name("lens", name, LENSES.iter().flat_map(|lens| forms(lens.name()))))
}

fn plain(name: &str) -> String {
    name.to_lowercase().replace(['-', '_'], " ")
}

/// The name, and its first one and two words, which find it too.
fn forms(name: &str) -> impl Iterator<Item = &str> {
    let ends = name.match_indices(' ').map(|(at, _)| at).take(2).chain([name.len()]);
    ends.map(|end| &name[..end])
}

static LENSES: LazyLock<Vec<Lens>> = LazyLock::new(|| {
    let text = include_str!("../../../data/lenses/lenses.json");
    let file: File = serde_json::from_str(text).expect("a test reads the whole of the embedded file");
    let lens = |entry| Lens::new(prescription(entry)?);
    file.lenses.into_iter().map(lens).collect::<Result<_>>().expect("a test reads the whole of the embedded file")
});

/// The file as written.
#[derive(Deserialize)]
struct File {
    lenses: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    name: String,
    source: String,
    entrance_pupil_diameter_mm: f64,
    half_field_deg: f64,
    surfaces: Vec<Row>,
}

#[derive(Deserialize)]
struct Row {
    radius_mm: Option<f64>,
    thickness_mm: f64,
    glass: String,
    semi_aperture_mm: f64,
    #[serde(default)]
    stop: bool,
}

fn prescription(entry: Entry) -> Result<Prescription> {
    let Entry { name, source, entrance_pupil_diameter_mm: diameter_mm, half_field_deg, surfaces } = entry;
    let stop = surfaces.iter().position(|row| row.stop);
    let surface = |row: Row| {
        let Row { radius_mm, thickness_mm, glass, semi_aperture_mm, stop: _ } = row;
        let profile = Profile::sphere(radius_mm.unwrap_or(0.0));
        Ok(Surface { profile, thickness_mm, index: medium(&glass)?, semi_aperture_mm })
    };
    Ok(Prescription {
        name,
        source: Some(source),
        surfaces: surfaces.into_iter().map(surface).collect::<Result<_>>()?,
        stop,
        opening: Opening::EntrancePupil { diameter_mm },
        half_field_deg: Some(half_field_deg),
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
