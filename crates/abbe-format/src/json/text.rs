//! Reads text files within a size limit, and finds the line and column of a byte offset.

use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::bytes_without_byte_order_mark;
use std::io::Read;
use std::path::Path;

/// Size in bytes of the largest JSON text that is read (256 MiB).
pub const MAX_BYTES: u64 = 256 << 20;

/// Returns the line and the column of a byte offset, both from 1. The column counts characters.
pub(super) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    let before = &text[..offset];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (1 + before.bytes().filter(|&byte| byte == b'\n').count(), 1 + before[line_start..].chars().count())
}

/// Reads a UTF-8 text file of at most [`MAX_BYTES`], without its byte order mark.
///
/// # Errors
/// Returns an error with the file's name if the file cannot be read, is too large or is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let unreadable = |error: std::io::Error| Error::input(format!("cannot be read: {error}")).in_file(path);
    let file = std::fs::File::open(path).map_err(unreadable)?;
    let expected = file.metadata().map_or(0, |metadata| metadata.len()).min(MAX_BYTES);
    let mut bytes = Vec::with_capacity(expected as usize + 1);
    // One byte more than allowed is read. A file that is too large is therefore detected even if
    // its size is not known in advance, as for a pipe.
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large().in_file(path));
    }
    let mark = bytes.len() - bytes_without_byte_order_mark(&bytes).len();
    bytes.drain(..mark);
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

pub(super) fn too_large() -> Error {
    Error::input("found a file above 256 MiB").expected("at most 256 MiB (put large data in separate files)")
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
        assert_eq!(line_column(text, 4), (2, 1), "inside a character: the position of the character");
        assert_eq!(line_column(text, 99), (4, 1), "beyond the end: the position of the end");
    }
}
