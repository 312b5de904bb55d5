//! Spectra as the command line names them: JSON, a name of the library, a file.

use std::path::Path;

use abbe::error::Result;
use abbe::scene::file::{self, SpectrumFile};
use abbe::scene::resolve::{self, Role};
use abbe::spectrum::library::{self, Kind};
use abbe::spectrum::{Outside, Spectrum, read};

use super::print;

/// A spectrum with its name and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Named {
    /// The library's name, or the argument as it was typed.
    pub(crate) name: String,
    /// What it is and whose numbers these are, in words.
    pub(crate) origin: String,
    pub(crate) spectrum: Spectrum,
}

/// The spectrum that an argument names.
pub(crate) fn spectrum(text: &str, role: Role) -> Result<Named> {
    let origin = Path::new("the command line");
    let typed = |spectrum: Spectrum, origin: &str| Named { name: text.to_string(), origin: origin.into(), spectrum };
    if text.trim_start().starts_with(['{', '"']) || text.trim().parse::<f64>().is_ok() {
        let (spectrum, source) = file::parse_spectrum(text, origin)?;
        return Ok(typed(resolve::lone_spectrum(&spectrum, &source, role)?, "written on the command line"));
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
        let outside = match role {
            Role::Light => Outside::Zero,
            Role::Reflectance | Role::Coefficient => Outside::Hold,
        };
        return Ok(typed(read::spectrum_file(path, outside)?, "read from this file"));
    }
    Err(unknown.expected("a name of `abbe spectrum --list`, a file, or a spectrum as JSON"))
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
