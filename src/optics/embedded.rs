//! Reads the tables that `build.rs` deflates and the program embeds.

use std::io::Read;

/// Inflates an embedded table.
///
/// # Panics
/// Panics if `deflated` was not written by `build.rs`.
pub(super) fn inflate(deflated: &[u8]) -> String {
    let mut text = String::new();
    flate2::read::ZlibDecoder::new(deflated).read_to_string(&mut text).expect("build.rs deflated the table");
    text
}
