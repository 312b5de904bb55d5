//! The text of a scene, and the way back from a value to its place in the file or on the command line.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::path;
use super::positions::Positions;
use super::reach::Reach;
use crate::error::{Error, Result};

/// The largest scene file that is read, in bytes.
pub const MAX_BYTES: u64 = 256 << 20;

/// The text of a scene and where everything stands in it.
#[derive(Debug, Clone)]
pub struct Source {
    /// The file, as it was named.
    pub path: PathBuf,
    /// The text, with the patches of `--set` in it.
    pub text: String,
    /// The file's own text, where patches changed it.
    unpatched: Option<String>,
    /// The pieces that the text consists of, in order.
    pieces: Vec<Piece>,
    /// Where every value stands in the text.
    positions: Positions,
    /// Which files it may name.
    reach: Reach,
}

/// Where a piece of text comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Origin {
    /// From the file, from this byte offset on.
    File(usize),
    /// From a patch, named as on the command line.
    Set(String),
}

/// A piece of the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Piece {
    /// Byte offset of its first byte.
    pub(super) start: usize,
    /// Where it comes from.
    pub(super) origin: Origin,
}

/// Line and column of a byte offset, both from 1; the column counts characters.
pub(super) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    let before = &text[..offset];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (1 + before.bytes().filter(|&byte| byte == b'\n').count(), 1 + before[line_start..].chars().count())
}

impl Source {
    /// A text that was patched or not; `pieces` says where each part of it comes from.
    pub(super) fn new(
        path: &Path,
        text: String,
        unpatched: Option<String>,
        pieces: Vec<Piece>,
        positions: Positions,
    ) -> Self {
        Self { path: path.to_path_buf(), text, unpatched, pieces, positions, reach: Reach::default() }
    }

    /// Where every value stands.
    pub(super) fn positions(&self) -> &Positions {
        &self.positions
    }

    /// The folder that paths in the scene are relative to.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The same scene, which may name these files; at first only those of its folder.
    #[must_use]
    pub fn reaching(self, reach: Reach) -> Self {
        Self { reach, ..self }
    }

    /// Which files the scene may name.
    pub fn reach(&self) -> Reach {
        self.reach
    }

    /// The file that the scene names by this path, relative to its folder.
    ///
    /// # Errors
    /// A path that leads out of the folder, unless the scene may reach anywhere.
    pub fn file(&self, path: &str) -> Result<PathBuf> {
        self.reach.file(self.folder(), Path::new(path))
    }

    /// Adds file, line, column and path to an error that was found later, at a value of the scene.
    ///
    /// The position is the value's; where the path leads nowhere, it is that of the longest part that does. An error
    /// that names another file already (a broken lamp.csv) keeps its place there and gains only the path.
    #[must_use]
    pub fn error_at(&self, json_path: &str, error: Error) -> Error {
        let steps = path::parse(json_path).unwrap_or_default();
        let value = self.positions.root(&self.text).nearest(&steps);
        self.error_in_text(value.start(), error.on_path(json_path))
    }

    /// Adds file, line and column to an error that knows its path.
    pub(super) fn placed(&self, error: Error) -> Error {
        let path = error.place.path.clone().unwrap_or_default();
        self.error_at(&path, error)
    }

    /// Adds file, line and column of a byte offset in the text.
    pub(super) fn error_in_text(&self, offset: usize, error: Error) -> Error {
        if error.place.file.is_some() {
            return error;
        }
        let piece = self.pieces.partition_point(|piece| piece.start <= offset).saturating_sub(1);
        match self.pieces.get(piece).map(|piece| (piece.start, &piece.origin)) {
            Some((_, Origin::Set(label))) => error.in_file(Path::new(label)),
            Some((start, Origin::File(from))) => {
                let text = self.unpatched.as_ref().unwrap_or(&self.text);
                let (line, column) = line_column(text, from + (offset - start));
                error.in_file(&self.path).at(line, column)
            }
            None => error.in_file(&self.path),
        }
    }
}

/// Reads a file's text in UTF-8, at most [`MAX_BYTES`]. Errors name the file.
pub fn read_text(path: &Path) -> Result<String> {
    let unreadable = |error: std::io::Error| Error::input(format!("cannot be read: {error}")).in_file(path);
    let file = std::fs::File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    // One byte more than allowed is enough to see that there is too much (also where the size is not known before).
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large().in_file(path));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let (line, column) = line_column(&String::from_utf8_lossy(&bytes[..valid]), valid);
        Error::input(format!("malformed JSON: found the byte 0x{:02X}, which is not UTF-8", bytes[valid]))
            .expected("a text in UTF-8")
            .at(line, column)
            .in_file(path)
    })
}

/// The error for a file that is too large.
pub(super) fn too_large() -> Error {
    Error::input("found a file above 256 MiB").expected("at most 256 MiB (put large data in files of their own)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one_and_in_characters() {
        let text = "ab\nλµ x\r\n\n";
        for (offset, place) in
            [(0, (1, 1)), (2, (1, 3)), (3, (2, 1)), (5, (2, 2)), (8, (2, 4)), (11, (3, 1)), (12, (4, 1))]
        {
            assert_eq!(line_column(text, offset), place, "offset {offset}");
        }
        assert_eq!(line_column(text, 4), (2, 1), "inside a character: at it");
        assert_eq!(line_column(text, 99), (4, 1), "beyond the end: at it");
    }
}
