//! Reads scene files, and parts of scenes from their text.

use crate::{
    CoatingFile, FileAccess, JsonPath, JsonSource, PrescriptionFile, SceneFile, SpectrumFile, file_kinds,
    json::read_text, spectrum::SpectrumUse,
};
use abbe_spectra::error::{Error, Result};
use std::path::Path;

/// Reads a scene file and applies the patches `sets` (`PATH=JSON`) in their order.
///
/// # Errors
/// Returns an error if the file cannot be read, is larger than [`MAX_BYTES`](crate::MAX_BYTES) or
/// is not JSON, if a patch cannot be applied, if a key is unknown, or if a value has a wrong type
/// or is out of range. The error contains up to [`MAX_FAULTS`](abbe_spectra::error::MAX_FAULTS)
/// faults, each with its line, column and JSON path if it has a position in the file.
pub fn read(path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
    parse(read_scene_text(path)?, path, sets)
}

/// Reads the text of a scene file.
///
/// # Errors
/// Returns an error if the file cannot be read, is too large, is not UTF-8, or is a file of another
/// program. In the last case, the error says how to bring the file into a scene.
pub fn read_scene_text(path: &Path) -> Result<String> {
    file_kinds::refuse_as_scene(path)?;
    read_text(path)
}

/// Reads a scene from its text, like [`read()`] and with the same errors. `path` is its name.
pub fn parse(text: impl Into<String>, path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
    let source = JsonSource::of_scene(text, path, sets, FileAccess::default())?;
    parse_source(source, &|_, _| None)
}

/// Reads a scene and checks single values. If the text has faults, `look_further` returns further
/// faults of the scene, in which stand-ins replace the wrong parts.
pub(super) fn parse_source(
    source: JsonSource,
    look_further: &dyn Fn(&SceneFile, &JsonSource) -> Option<Error>,
) -> Result<(SceneFile, JsonSource)> {
    let repaired = source.deserialize_repaired::<SceneFile>();
    let mut faults = repaired.faults.clone();
    if let Some(foreign) = file_kinds::foreign_json(source.text()).filter(|_| !faults.is_empty()) {
        return Err(foreign.in_file(&source.path));
    }
    if let Some(scene) = &repaired.value {
        let mut later = scene.validate(&source).err();
        if (later.is_some() || !faults.is_empty()) && !repaired.lacks_definitions(&source) {
            // A fault of the whole scene, such as no light, may follow from the others.
            let further = look_further(scene, &source).map_or_else(Vec::new, Error::into_faults);
            let in_a_part = |fault: &Error| fault.location.path.as_deref().is_some_and(|path| !path.is_empty());
            // The resolver repeats some checks of `validate`. It may find the same fault in a value
            // that contains the wrong value, such as a table.
            let known = later.clone().map_or_else(Vec::new, Error::into_faults);
            let contains = |fault: &Error, known: &Error| match (&fault.location.path, &known.location.path) {
                (Some(whole), Some(part)) => part
                    .strip_prefix(whole.as_str())
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '['])),
                (None, _) | (_, None) => false,
            };
            let is_new = |fault: &Error| {
                !known.iter().any(|known| {
                    (&known.what, &known.expected) == (&fault.what, &fault.expected) || contains(fault, known)
                })
            };
            let further = further.into_iter().filter(|fault| in_a_part(fault) && is_new(fault));
            later = Error::all(later.into_iter().chain(further));
        }
        let later = later.map_or_else(Vec::new, Error::into_faults);
        faults.extend(later.into_iter().filter(|fault| !repaired.explains(&source, fault)));
    }
    match (repaired.value, Error::all(faults)) {
        (Some(scene), None) => Ok((scene, source)),
        (_, Some(error)) => Err(error),
        (None, None) => Err(Error::input("the scene cannot be read").in_file(&source.path)),
    }
}

/// Reads a spectrum from its text, in any form that a scene may contain. `name` is the text's name.
/// The spectrum may name any file, because the text comes from the user.
///
/// # Errors
/// If the text is not a spectrum, returns an error with its position in the text.
pub fn parse_spectrum(text: &str, name: &Path) -> Result<(SpectrumFile, JsonSource)> {
    let source = JsonSource::patched(text, name, &[])?.with_file_access(FileAccess::Anywhere);
    let spectrum: SpectrumFile = source.deserialize()?;
    spectrum.validate(&JsonPath::Root, SpectrumUse::Any).map_err(|error| source.with_position(error))?;
    Ok((spectrum, source))
}

/// Reads a stack of thin films from its text, in the form of a coating in a scene. Errors use
/// `name` as the name of the text. Paths in the stack may name any file.
///
/// # Errors
/// If the text is not a stack, returns an error with its position in the text.
pub fn parse_coating(text: &str, name: &Path) -> Result<(CoatingFile, JsonSource)> {
    let source = JsonSource::patched(text, name, &[])?.with_file_access(FileAccess::Anywhere);
    let coating: CoatingFile = source.deserialize()?;
    coating.validate(&JsonPath::Root).map_err(|error| source.with_position(error))?;
    Ok((coating, source))
}

/// Reads a lens prescription from its text, in any form of a scene. `name` is the text's name.
///
/// # Errors
/// If the text is not a prescription, returns an error with its position in the text.
pub fn parse_prescription(text: &str, name: &Path) -> Result<(PrescriptionFile, JsonSource)> {
    let source = JsonSource::patched(text, name, &[])?;
    let prescription: PrescriptionFile = source.deserialize()?;
    prescription.validate(&JsonPath::Root).map_err(|error| source.with_position(error))?;
    Ok((prescription, source))
}
