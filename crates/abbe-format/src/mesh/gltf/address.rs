//! Addresses of the data that a glTF file names.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// Decodes an address that contains its data in base 64. Returns `None` if the address names a
/// file, and `Some(None)` if its data is not valid.
pub(super) fn decoded_data(uri: &str) -> Option<Option<Vec<u8>>> {
    let encoded = uri.strip_prefix("data:")?.split_once(";base64,");
    Some(encoded.and_then(|(_, encoded)| STANDARD.decode(encoded).ok()))
}

/// Decodes the percent escapes of an address. Returns `None` if the result is not UTF-8.
pub fn decoded_address(uri: &str) -> Option<String> {
    let mut decoded = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let escaped = (*first == b'%').then(|| tail.get(..2)).flatten();
        let value = escaped.and_then(|hex| u8::from_str_radix(std::str::from_utf8(hex).ok()?, 16).ok());
        decoded.push(value.unwrap_or(*first));
        rest = if value.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(decoded).ok()
}
