//! A JSON text with its patches. Deserialises the text, and adds positions to errors.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::deserialize::ValueDeserializer;
use super::file_access::FileAccess;
use super::patch::{PatchedText, PieceOrigin, TextPieces};
use super::path;
use super::positions::Positions;
use super::text::line_column;
use crate::error::{Error, Result};

/// A JSON text with the position of each of its values.
#[derive(Debug, Clone)]
pub struct JsonSource {
    /// The path of the file, in the form in which the caller stated it.
    pub path: PathBuf,
    /// The text after all patches.
    pub text: String,
    /// The text before the patches, or `None` if there are no patches.
    unpatched: Option<String>,
    pieces: TextPieces,
    positions: Positions,
    file_access: FileAccess,
}

impl JsonSource {
    /// Reads strict JSON and applies patches.
    ///
    /// `sets` are patches of the form `PATH=JSON`. They are applied in the order of the list.
    /// `file` is the name of the text in errors.
    ///
    /// # Errors
    /// Returns an error if the text is not JSON, or if a patch cannot be applied.
    pub fn patched(text: &str, file: &Path, sets: &[String]) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let unpatched = (!sets.is_empty()).then(|| text.to_string());
        let PatchedText { text, pieces, positions } = PatchedText::new(text, file, sets)?;
        let file_access = FileAccess::default();
        Ok(Self { path: file.to_path_buf(), text, unpatched, pieces, positions, file_access })
    }

    /// Deserialises a value of type `T` from the text.
    ///
    /// # Errors
    /// If a value does not fit the type, returns an error with its file, line, column and JSON
    /// path.
    pub fn deserialize<T: DeserializeOwned>(&self) -> Result<T> {
        let root = self.positions.root(&self.text);
        T::deserialize(ValueDeserializer::new(root)).map_err(|error| {
            let (offset, error) = error.explain(root);
            self.error_at_offset(offset, error)
        })
    }

    /// Returns the folder to which paths in the text are relative.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Sets which files the text may name. The default is [`FileAccess::WithinFolder`].
    #[must_use]
    pub fn with_file_access(self, file_access: FileAccess) -> Self {
        Self { file_access, ..self }
    }

    /// Returns which files the text may name.
    pub fn file_access(&self) -> FileAccess {
        self.file_access
    }

    /// Returns the path of a file that is named in the text. The name is relative to the folder of
    /// the text.
    ///
    /// # Errors
    /// Returns an error if the path leads out of the folder and the file access does not allow it.
    pub fn file(&self, path: &str) -> Result<PathBuf> {
        self.file_access.file(self.folder(), Path::new(path))
    }

    /// Adds file, line, column and path to an error that was found after the text was read.
    ///
    /// The value at `json_path` gives the position of the error. If there is no such value, the
    /// deepest existing value on the path gives the position. An error may already name another
    /// file, such as a malformed lamp.csv. In such an error, the name of the other file stays, and
    /// this function adds only the JSON path.
    #[must_use]
    pub fn error_at(&self, json_path: &str, error: Error) -> Error {
        let steps = path::parse(json_path).unwrap_or_default();
        let value = self.positions.root(&self.text).nearest(&steps);
        self.error_at_offset(value.start(), error.on_path(json_path))
    }

    /// Adds file, line and column to an error that already has its JSON path.
    #[must_use]
    pub fn with_position(&self, error: Error) -> Error {
        let path = error.location.path.clone().unwrap_or_default();
        self.error_at(&path, error)
    }

    /// Adds file, line and column to an error. `offset` is the position of the error as a byte
    /// offset in the patched text.
    fn error_at_offset(&self, offset: usize, error: Error) -> Error {
        if error.location.file.is_some() {
            return error;
        }
        match self.pieces.origin(offset) {
            Some(PieceOrigin::Patch(label)) => error.in_file(Path::new(&label)),
            Some(PieceOrigin::File(offset)) => {
                let text = self.unpatched.as_ref().unwrap_or(&self.text);
                let (line, column) = line_column(text, offset);
                error.in_file(&self.path).at(line, column)
            }
            None => error.in_file(&self.path),
        }
    }
}
