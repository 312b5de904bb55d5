//! The origin of each part of an edited text.

use super::text::line_column;
use abbe_spectra::error::Error;
use std::path::{Path, PathBuf};

/// A file whose text is part of another text.
#[derive(Debug, Clone)]
pub(super) struct OriginalFile {
    pub(super) path: PathBuf,
    pub(super) text: String,
}

impl OriginalFile {
    /// Adds the file and the position of a byte offset in it to an error.
    pub(super) fn place(path: &Path, text: &str, offset: usize, error: Error) -> Error {
        let (line, column) = line_column(text, offset);
        error.in_file(path).at(line, column)
    }
}

/// The origin of each part of an edited text, in the order of the text.
#[derive(Debug, Clone)]
pub(super) struct TextPieces(Vec<TextPiece>);

/// A piece of the text that comes from a single origin. It ends where the next piece starts.
#[derive(Debug, Clone)]
struct TextPiece {
    /// Byte offset of its first byte.
    start: usize,
    origin: PieceOrigin,
}

#[derive(Debug, Clone)]
pub(super) enum PieceOrigin {
    /// The piece comes from the file, where it starts at this byte offset.
    File(usize),
    /// The piece comes from an included file with this number, where it starts at this byte offset.
    Part(usize, usize),
    /// The piece comes from the patch with this label.
    Patch(String),
    /// The whole piece stands for the value that starts at this origin.
    At(Box<PieceOrigin>),
}

impl PieceOrigin {
    /// Returns the origin of the text that starts `bytes` bytes later in the same piece.
    fn skip(&self, bytes: usize) -> Self {
        match self {
            Self::File(offset) => Self::File(offset + bytes),
            Self::Part(file, offset) => Self::Part(*file, offset + bytes),
            Self::Patch(_) | Self::At(_) => self.clone(),
        }
    }
}

impl TextPieces {
    /// Returns the pieces of a whole file.
    pub(super) fn of_file() -> Self {
        Self(vec![TextPiece { start: 0, origin: PieceOrigin::File(0) }])
    }

    fn index(&self, offset: usize) -> usize {
        self.0.partition_point(|piece| piece.start <= offset).saturating_sub(1)
    }

    /// Returns the origin of the byte at an offset in the edited text.
    pub(super) fn origin(&self, offset: usize) -> PieceOrigin {
        let piece = &self.0[self.index(offset)];
        let mut origin = piece.origin.skip(offset - piece.start);
        while let PieceOrigin::At(at) = origin {
            origin = *at;
        }
        origin
    }

    /// Returns the origin of a copy of the text between two offsets.
    pub(super) fn origin_of(&self, from: usize, to: usize) -> PieceOrigin {
        let origin = self.origin(from);
        let is_whole = self.index(from) == self.index(to.saturating_sub(1).max(from));
        if is_whole { origin } else { PieceOrigin::At(Box::new(origin)) }
    }

    /// Returns the pieces after the bytes from `from` to `to` are replaced by `added` bytes of an
    /// origin. Before, the text has `length` bytes.
    pub(super) fn after(&self, (from, to): (usize, usize), added: usize, origin: PieceOrigin, length: usize) -> Self {
        let ends = self.0.iter().skip(1).map(|piece| piece.start).chain([length]);
        let (mut before, mut after) = (Vec::new(), Vec::new());
        for (piece, end) in self.0.iter().zip(ends) {
            if piece.start < from {
                before.push(piece.clone());
            }
            if end > to {
                let skipped = to.saturating_sub(piece.start);
                let start = piece.start + skipped - to + from + added;
                after.push(TextPiece { start, origin: piece.origin.skip(skipped) });
            }
        }
        if added > 0 {
            before.push(TextPiece { start: from, origin });
        }
        before.extend(after);
        Self(before)
    }
}
