//! Spectra as the command line names them: JSON, a name of the library, a file.

use std::path::Path;

use abbe::error::{Error, Result};
use abbe::scene::file::{self, SpectrumFile};
use abbe::scene::resolve::{self, Role};
use abbe::spectrum::library::{self, Kind};
use abbe::spectrum::{Spectrum, read};

use super::print;

/// A spectrum with its name and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Named {
    /// The library's name, a few words for simple spectra written as JSON, or the argument as it was typed.
    pub(crate) name: String,
    /// What it is and whose numbers these are, in words.
    pub(crate) origin: String,
    pub(crate) spectrum: Spectrum,
}

/// The spectrum that an argument names.
pub(crate) fn spectrum(text: &str, role: Role) -> Result<Named> {
    let origin = Path::new("the command line");
    if text.trim_start().starts_with(['{', '"']) || text.trim().parse::<f64>().is_ok() {
        let (file, source) = file::parse_spectrum(text, origin)?;
        let spectrum = resolve::lone_spectrum(&file, &source, role)?;
        return Ok(Named { name: described(&file, text), origin: "written on the command line".to_string(), spectrum });
    }
    let unknown = match library::find(text) {
        Ok(entry) => {
            // By way of JSON, so that a name means what it means in a scene.
            let name = serde_json::to_string(text).expect("a text is JSON");
            let (_, source) = file::parse_spectrum(&name, origin)?;
            let spectrum = resolve::lone_spectrum(&SpectrumFile::Name(text.to_string()), &source, role)?;
            let origin = format!("{}; source: {}", entry.description, entry.source);
            return Ok(Named { name: entry.name.to_string(), origin, spectrum });
        }
        Err(unknown) => unknown,
    };
    let path = Path::new(text);
    if path.exists() || path.extension().is_some() || text.contains(std::path::is_separator) {
        // A slip in a library's name such as led/red looks like a missing file.
        let near = unknown.near.filter(|_| !path.exists());
        let spectrum = read::spectrum_file(path, role.outside()).map_err(|error| Error { near, ..error })?;
        return Ok(Named { name: text.to_string(), origin: "read from this file".to_string(), spectrum });
    }
    Err(unknown.expected("a name of `abbe spectrum --list`, a file, or a spectrum as JSON"))
}

/// What a spectrum is called that has no name: simple ones in words, others as they are written.
fn described(file: &SpectrumFile, text: &str) -> String {
    match file {
        SpectrumFile::Name(name) => name.clone(),
        SpectrumFile::Lines(lines) => match lines.as_slice() {
            [line] => format!("a line at {} nm", line.nm),
            _ => text.to_string(),
        },
        SpectrumFile::Blackbody { temperature } => format!("a black body at {temperature} K"),
        SpectrumFile::Gaussian { peak_nm, fwhm_nm } => format!("a Gaussian band at {peak_nm} nm, {fwhm_nm} nm wide"),
        SpectrumFile::Number(_)
        | SpectrumFile::Table { .. }
        | SpectrumFile::File(_)
        | SpectrumFile::Rgb(_)
        | SpectrumFile::Mix(_)
        | SpectrumFile::PowerLaw { .. }
        | SpectrumFile::Match { .. } => text.to_string(),
    }
}

/// The light that an argument names; what the library knows to be something else is taken with a remark.
pub(crate) fn light(text: &str) -> Result<Named> {
    let light = spectrum(text, Role::Light)?;
    if library::find(text).is_ok_and(|entry| entry.kind != Kind::Light) {
        let hint = "`abbe spectrum --reflectance-under D65` shows it as a reflectance";
        print::remark(&format!("note: {text} is no light; {hint}"));
    }
    Ok(light)
}
