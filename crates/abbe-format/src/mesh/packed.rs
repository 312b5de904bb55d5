//! Reads the bytes of mesh files, and unpacks them.

use abbe_spectra::error::{Error, Result};
use std::io::Read as _;
use std::path::Path;

pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::input(format!("cannot read the mesh: {error}")))
}

/// The largest size in bytes of an unpacked mesh file (4 GiB).
const MAX_UNPACKED_BYTES: u64 = 4 << 30;

/// Reads the unpacked data of a decoder. `kind` names the packed data, such as "gzip file".
pub(super) fn unpacked(decoder: impl std::io::Read, kind: &str) -> Result<Vec<u8>> {
    let mut unpacked = Vec::new();
    let mut reader = decoder.take(MAX_UNPACKED_BYTES + 1);
    reader.read_to_end(&mut unpacked).map_err(|error| Error::input(format!("not a valid {kind}: {error}")))?;
    if unpacked.len() as u64 > MAX_UNPACKED_BYTES {
        return Err(Error::input("the unpacked mesh is above 4 GiB").expected("a smaller mesh"));
    }
    Ok(unpacked)
}
