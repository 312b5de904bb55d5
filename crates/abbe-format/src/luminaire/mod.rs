//! Measured distributions of luminaires: IES LM-63 (`.ies`), EULUMDAT (`.ldt`) and IES TM-33
//! (`.tm33`, `.xml`).

mod eulumdat;
mod ies;
mod number;
mod photometry;
mod summary;
#[cfg(test)]
mod tests;
mod tm33;

use crate::FileAccess;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::without_byte_order_mark;
use std::io::Read;
use std::path::Path;

pub use photometry::{LuminaireSymmetry, OpeningSize, Photometry};
pub use summary::{BeamAngles, LuminaireSummary};

/// The largest size of a file in bytes.
const MAX_FILE_BYTES: u64 = 16 << 20;

/// Returns whether the name of a file ends with `.ies`, `.ldt` or `.tm33`, or whether it is an
/// `.xml` file of TM-33.
pub fn is_luminaire(path: &Path) -> bool {
    ["ies", "ldt", "tm33"].iter().any(|end| ends_with(path, end))
        || ends_with(path, "xml") && text_of(path).is_ok_and(|text| tm33::is_tm33(&text))
}

/// Returns whether luminaire files with this name contain no spectrum, as those of IES LM-63 and
/// EULUMDAT.
pub(crate) fn lacks_spectrum(path: &Path) -> bool {
    !ends_with(path, "tm33") && !ends_with(path, "xml")
}

fn ends_with(path: &Path, end: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(end))
}

/// Reads a luminaire file: EULUMDAT if its name ends with `.ldt`, IES TM-33 if it ends with `.tm33`
/// or `.xml`, and IES LM-63 otherwise. `access` decides whether the file may name a file with tilt
/// factors in another folder.
///
/// # Errors
/// Returns an error with the name of the file, and with its line and column if they are known, if
/// the file cannot be read, is larger than 16 MiB, or is damaged.
pub fn read(path: &Path, access: FileAccess) -> Result<Photometry> {
    let text = text_of(path)?;
    let tilt_file = |name: &str| {
        let folder = path.parent().unwrap_or(Path::new(""));
        access.file(folder, Path::new(name)).and_then(|path| text_of(&path))
    };
    let parsed = if ends_with(path, "ldt") {
        eulumdat::parse(&text)
    } else if lacks_spectrum(path) {
        ies::parse(&text, &tilt_file)
    } else {
        tm33::parse(&text)
    };
    // A damaged table is found before the scene is built.
    parsed.and_then(|photometry| photometry.table().map(|_| photometry)).map_err(|error| error.in_file(path))
}

/// Parses an IES LM-63 file without another file of tilt factors. Errors have a line and column.
pub fn parse_ies(text: &str) -> Result<Photometry> {
    ies::parse(text, &|_| Err(Error::input("the tilt factors are in another file")))
}

/// Parses the text of an EULUMDAT file. An error has its line and column.
pub fn parse_eulumdat(text: &str) -> Result<Photometry> {
    eulumdat::parse(text)
}

/// Parses the text of an IES TM-33 document. An error has its line and column.
pub fn parse_tm33(text: &str) -> Result<Photometry> {
    tm33::parse(text)
}

/// Reads a text file. Bytes that are not UTF-8 are read as Latin-1.
fn text_of(path: &Path) -> Result<String> {
    let unreadable = |error: std::io::Error| Error::input(format!("cannot read the luminaire: {error}")).in_file(path);
    let file = std::fs::File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(Error::input("a luminaire file above 16 MiB").expected("at most 16 MiB").in_file(path));
    }
    let text = String::from_utf8(bytes);
    let text = text.unwrap_or_else(|error| error.as_bytes().iter().map(|&byte| char::from(byte)).collect());
    Ok(without_byte_order_mark(&text).to_string())
}
