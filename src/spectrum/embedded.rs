//! Reads the packed files that the program embeds. Unpacked, they would be a twentieth of the
//! program. `data/packed` contains packed copies of tables of `data`.

use std::io::Read;

/// Unpacks an embedded gzip file.
///
/// # Panics
/// Panics if `packed` is not a gzip file of UTF-8 text.
pub(crate) fn unpack(packed: &[u8]) -> String {
    let mut text = String::new();
    flate2::read::GzDecoder::new(packed).read_to_string(&mut text).expect("the file is packed text");
    text
}

/// Packs a table for embedding.
#[cfg(test)]
pub(crate) fn pack(text: &str) -> Vec<u8> {
    let mut packed = Vec::new();
    let mut encoder = flate2::read::GzEncoder::new(text.as_bytes(), flate2::Compression::best());
    encoder.read_to_end(&mut packed).expect("memory does not fail");
    packed
}
