//! A JSON text with its patches. Deserialises the text, and adds positions to errors.

use super::patch::PatchedText;
use super::positions::{SpannedValue, ValueKind};
use super::{deserialize::ValueDeserializer, path, repair::Repairs, serialize::Sections};
use crate::{FileAccess, NamedFile};
use abbe_spectra::error::{Error, MAX_FAULTS, Result};
use abbe_spectra::text::without_byte_order_mark;
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// A value of a text with faults.
#[derive(Debug)]
pub struct RepairedValue<T> {
    /// The value with stand-ins for wrong parts. `None` after too many faults or without one.
    pub value: Option<T>,
    /// The faults of the text, each with its position.
    pub faults: Vec<Error>,
    repairs: Repairs,
}

impl<T> RepairedValue<T> {
    /// Returns whether the outermost object of the text `source` contains an unknown key. The names
    /// that the ignored entry defines are then unknown.
    pub fn lacks_definitions(&self, source: &JsonSource) -> bool {
        source.root().entries().any(|(key, _)| self.repairs.drops(key))
    }

    /// Returns whether an error may only follow from a repair of the text `source`. In such a case,
    /// the value at the path of the error contains a repaired part, or is inside one.
    pub fn explains(&self, source: &JsonSource, error: &Error) -> bool {
        let root = source.root();
        let steps = path::parse(error.location.path.as_deref().unwrap_or_default()).unwrap_or_default();
        self.repairs.concern(root.nearest(&steps))
    }
}

/// A JSON text with the position of each of its values.
#[derive(Debug, Clone)]
pub struct JsonSource {
    /// The path of the file, as the caller gave it.
    pub path: PathBuf,
    edited: PatchedText,
    /// The text before variables and groups were replaced, or `None` if there are none.
    written: Option<String>,
    file_access: FileAccess,
}

impl JsonSource {
    /// Reads strict JSON, the text `file` in errors, and applies the patches `sets` (`PATH=JSON`).
    ///
    /// # Errors
    /// Returns an error if the text is not JSON, or if a patch cannot be applied.
    pub fn patched(text: impl Into<String>, file: &Path, sets: &[String]) -> Result<Self> {
        let mut edited = PatchedText::new(without_mark(text.into()), file)?;
        edited.patch(sets)?;
        Ok(Self { path: file.to_path_buf(), edited, written: None, file_access: FileAccess::default() })
    }

    /// Reads the text of a scene like [`Self::patched`]. Before the patches, it adds the files that
    /// the scene includes, so that patches can change them. After the patches, it adds the files
    /// that patches include, and replaces variables and groups. `access` says which files
    /// the text may name.
    ///
    /// # Errors
    /// Returns also an error if an included file cannot be read, if a variable is unknown, or if a
    /// group is malformed.
    pub fn of_scene(text: impl Into<String>, file: &Path, sets: &[String], access: FileAccess) -> Result<Self> {
        let mut edited = PatchedText::new(without_mark(text.into()), file)?;
        edited.include(file, access)?;
        edited.patch(sets)?;
        edited.include(file, access)?;
        let before = edited.has_shorthands().then(|| edited.text.clone());
        edited.substitute(file)?;
        edited.ungroup(file)?;
        Ok(Self { path: file.to_path_buf(), edited, written: before, file_access: access })
    }

    /// Returns the text, in which variables and groups are replaced.
    pub fn text(&self) -> &str {
        &self.edited.text
    }

    /// Returns the text before variables and groups were replaced. Patches refer to its values.
    pub fn written(&self) -> &str {
        self.written.as_ref().unwrap_or(&self.edited.text)
    }

    fn root(&self) -> SpannedValue<'_> {
        self.edited.positions.root(&self.edited.text)
    }

    /// Deserialises the text.
    ///
    /// # Errors
    /// Returns an error with the file, line, column and JSON path of each value that does not fit.
    pub fn deserialize<T: DeserializeOwned>(&self) -> Result<T> {
        let RepairedValue { value, faults, .. } = self.deserialize_repaired();
        match (value, Error::all(faults)) {
            (Some(value), None) => Ok(value),
            (_, Some(error)) => Err(error),
            (None, None) => Err(Error::input("the text cannot be read").in_file(&self.path)),
        }
    }

    /// Deserialises the text. A part that does not fit is reported and replaced.
    pub fn deserialize_repaired<T: DeserializeOwned>(&self) -> RepairedValue<T> {
        let root = self.root();
        let (mut faults, mut repairs) = (Vec::new(), Repairs::default());
        loop {
            let error = match T::deserialize(ValueDeserializer::new(root, &repairs)) {
                Ok(value) => return RepairedValue { value: Some(value), faults, repairs },
                Err(error) => error,
            };
            let outcome = repairs.repair(&error, root);
            if outcome.is_fault {
                let (offset, error) = error.explain(root);
                faults.push(self.error_at_offset(offset, error));
            }
            if !outcome.can_continue || faults.len() >= MAX_FAULTS {
                return RepairedValue { value: None, faults, repairs };
            }
        }
    }

    /// Returns the values of the text as compact JSON. `keeps` returns whether an entry stays, from
    /// the key of its section (an object inside the outermost object) and from its own key.
    pub fn compact(&self, keeps: impl Fn(&str, &str) -> bool) -> String {
        let root = self.root();
        serde_json::to_string(&Sections { root, keeps }).expect("the scanner has checked the text")
    }

    /// Returns all strings of the text except the keys, in the order of the text.
    pub fn strings(&self) -> impl Iterator<Item = Cow<'_, str>> {
        let root = self.root();
        let is_string = move |id: &u32| root.with_id(*id).kind() == ValueKind::String && !root.is_key(*id);
        self.edited.positions.ids().filter(is_string).map(move |id| root.with_id(id).content())
    }

    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Sets which files the text may name. The default is [`FileAccess::WithinFolder`].
    #[must_use]
    pub fn with_file_access(self, file_access: FileAccess) -> Self {
        Self { file_access, ..self }
    }

    pub fn file_access(&self) -> FileAccess {
        self.file_access
    }

    /// Returns the path of a file that the text names relative to its folder.
    ///
    /// # Errors
    /// Returns an error if the path leads out of the folder and the file access does not allow it.
    pub fn file(&self, path: &str) -> Result<NamedFile> {
        self.file_access.file(self.folder(), Path::new(path))
    }

    /// Adds file, line, column and path to an error that was found after the text was read. The
    /// position is that of the deepest existing value on `json_path`. An error that already names
    /// another file, such as a malformed lamp.csv, gets only the path.
    #[must_use]
    pub fn error_at(&self, json_path: &str, error: Error) -> Error {
        let steps = path::parse(json_path).unwrap_or_default();
        let value = self.root().nearest(&steps);
        self.error_at_offset(value.start(), error.on_path(json_path))
    }

    #[must_use]
    pub fn fault(&self, at: &path::JsonPath, what: impl Into<String>, expected: impl Into<String>) -> Error {
        self.error_at(&at.to_string(), Error::input(what).expected(expected))
    }

    /// Adds file, line and column to an error whose faults already have their JSON paths.
    #[must_use]
    pub fn with_position(&self, error: Error) -> Error {
        let mut faults = error.into_faults().into_iter().map(|fault| {
            let path = fault.location.path.clone().unwrap_or_default();
            self.error_at(&path, fault)
        });
        let first = faults.next().unwrap_or_else(|| Error::input("found no fault"));
        Error { others: faults.collect(), ..first }
    }

    /// Adds file, line and column to an error at a byte offset of the patched text.
    fn error_at_offset(&self, offset: usize, error: Error) -> Error {
        if error.location.file.is_some() {
            return error;
        }
        self.edited.place(&self.path, offset, error)
    }
}

/// Removes the byte order mark of a text.
fn without_mark(mut text: String) -> String {
    let mark = text.len() - without_byte_order_mark(&text).len();
    text.drain(..mark);
    text
}
