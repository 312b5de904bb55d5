//! Decoding of Zemax text files, whose encoding depends on the version of Zemax.

/// Decodes a text as UTF-16 if it has that byte order mark or its second byte is 0, and otherwise
/// as UTF-8, or Latin-1 if it is not valid UTF-8. The text has no byte order mark. Returns `None`
/// for malformed UTF-16, and for text with a NUL character.
pub(super) fn decoded(bytes: &[u8]) -> Option<String> {
    let wide = |unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        String::from_utf16(&units).ok()
    };
    match bytes {
        [0xFF, 0xFE, ..] | [_, 0, ..] => wide(u16::from_le_bytes),
        [0xFE, 0xFF, ..] => wide(u16::from_be_bytes),
        _ => {
            Some(String::from_utf8(bytes.to_vec()).unwrap_or_else(|_| bytes.iter().copied().map(char::from).collect()))
        }
    }
    .filter(|text| !text.contains('\0'))
    .map(|text| text.trim_start_matches('\u{feff}').to_string())
}
