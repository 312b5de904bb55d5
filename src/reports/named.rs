//! Spectra given as text: JSON, a name of the library, or a file.

use std::path::Path;

use abbe_format::resolve::{self, Role};
use abbe_format::{self as format, SpectrumFile, is_hex_colour};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::library::{self, LibraryListing, SpectrumKind};
use abbe_spectra::spectrum::{Spectrum, read};
use serde::Serialize;

#[derive(Debug, Clone, PartialEq)]
pub struct NamedSpectrum {
    /// The name in the library, a description of a simple JSON spectrum, or the text itself.
    pub name: String,
    /// A description of the spectrum, and the source of its data.
    pub origin: String,
    /// A light, a reflectance or a coefficient.
    pub spectrum: Spectrum,
    /// Remarks on what the reader of a file decided from its values.
    pub notes: Vec<String>,
}

/// Returns the spectrum that a text describes: a name of the library, the path of a file, or the
/// JSON form of scenes. Returns an error if it is none of these, or if the file or the JSON is
/// wrong.
pub fn spectrum(text: &str, role: Role) -> Result<NamedSpectrum> {
    let origin = Path::new("the command line");
    let is_colour = is_hex_colour(text);
    if is_colour || text.trim_start().starts_with(['{', '"']) || text.trim().parse::<f64>().is_ok() {
        let json = if is_colour { serde_json::to_string(text).expect("a text is JSON") } else { text.to_string() };
        let (file, source) = format::parse_spectrum(&json, origin)?;
        let (spectrum, notes) = resolve::lone_spectrum_with_notes(&file, &source, role)?;
        return Ok(NamedSpectrum {
            name: described(&file, text),
            origin: "written on the command line".to_string(),
            spectrum,
            notes,
        });
    }
    let unknown = match library::find(text) {
        Ok(entry) => {
            // The name is resolved as in a scene.
            let name = serde_json::to_string(text).expect("a text is JSON");
            let (_, source) = format::parse_spectrum(&name, origin)?;
            let spectrum = resolve::lone_spectrum(&SpectrumFile::Name(text.to_string()), &source, role)?;
            let origin = format!("{}; source: {}", entry.description, entry.source);
            return Ok(NamedSpectrum { name: entry.name.to_string(), origin, spectrum, notes: Vec::new() });
        }
        Err(unknown) => unknown,
    };
    let path = Path::new(text);
    if path.exists() || path.extension().is_some() || text.contains(std::path::is_separator) {
        // A misspelt name with a slash, such as led/red, looks like the path of a missing file, so
        // the error also suggests a name.
        let near = unknown.suggestion.filter(|_| !path.exists());
        let samples = read::samples(path).map_err(|error| Error { suggestion: near.or(error.suggestion), ..error })?;
        let spectrum = samples.spectrum(role.outside()).map_err(|error| error.in_file(path))?;
        let notes = samples.note.iter().map(|note| format!("{text}: {note}")).collect();
        return Ok(NamedSpectrum {
            name: text.to_string(),
            origin: "read from this file".to_string(),
            spectrum,
            notes,
        });
    }
    Err(unknown.expected("a name of `abbe spectrum --list`, a file, or a spectrum as JSON"))
}

/// Describes a spectrum in JSON: in words if it is simple, or by its JSON text.
fn described(file: &SpectrumFile, text: &str) -> String {
    match file {
        SpectrumFile::Name(name) => name.clone(),
        SpectrumFile::Lines(lines) => match lines.as_slice() {
            [line] => format!("a line at {} nm", line.nm),
            _ => text.to_string(),
        },
        SpectrumFile::Blackbody { temperature } => format!("a black body at {temperature} K"),
        SpectrumFile::Daylight { temperature } => format!("daylight of {temperature} K"),
        SpectrumFile::Gaussian { peak_nm, fwhm_nm } => format!("a Gaussian band at {peak_nm} nm, {fwhm_nm} nm wide"),
        SpectrumFile::File(file) => {
            file.sample.as_ref().map_or_else(|| text.to_string(), |sample| format!("{sample} of {}", file.path))
        }
        SpectrumFile::Number(_)
        | SpectrumFile::Table { .. }
        | SpectrumFile::Rgb(_)
        | SpectrumFile::Srgb(_)
        | SpectrumFile::Mix(_)
        | SpectrumFile::PowerLaw { .. }
        | SpectrumFile::Match { .. } => text.to_string(),
    }
}

/// Returns a remark on a spectrum that the library does not list as a light.
pub fn light_remark(text: &str) -> Option<String> {
    let is_other = library::find(text).is_ok_and(|entry| entry.kind != SpectrumKind::Light);
    let hint = "`abbe spectrum --reflectance-under D65` shows it as a reflectance";
    is_other.then(|| format!("{text} is not a light; {hint}"))
}

#[derive(Debug, Serialize)]
pub struct SpectrumList {
    /// The entries, in the order of the library.
    pub spectra: Vec<SpectrumListing>,
}

/// An entry of the list.
#[derive(Debug, Serialize)]
pub struct SpectrumListing {
    /// The name that [`spectrum`] accepts.
    pub name: &'static str,
    /// What the values are, such as `light` or `reflectance`.
    pub kind: &'static str,
    /// A few words about the spectrum.
    pub description: &'static str,
    pub source: &'static str,
}

impl SpectrumList {
    pub fn of_library() -> Self {
        let listed = |entry: &LibraryListing| SpectrumListing {
            name: entry.name,
            kind: entry.kind.name(),
            description: entry.description,
            source: entry.source,
        };
        Self { spectra: library::list().iter().map(listed).collect() }
    }
}
