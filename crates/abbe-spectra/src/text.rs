//! Helpers of the readers of text files.

/// Returns a text without the byte order mark with which some programs, mostly on Windows, begin
/// their files.
#[must_use]
pub fn without_byte_order_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Returns the bytes of a file without the byte order mark of UTF-8, as
/// [`without_byte_order_mark`].
#[must_use]
pub fn bytes_without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}
