//! Reading measured spectra from files: columns of text, IES TM-27 (`.spdx`), and CGATS.

mod cgats;
mod columns;
mod spdx;
mod spectrum_samples;

use std::path::Path;

use super::table::Outside;
use super::value::Spectrum;
use crate::error::{Error, Result};
use crate::text::without_byte_order_mark;

pub use cgats::parse as parse_cgats;
pub use columns::{ColumnFormat, nm_per_unit, parse as parse_columns};
pub use spdx::parse as parse_spdx;
pub use spectrum_samples::SpectrumSamples;

/// The extensions of the names of CGATS files. Texts with other names are CGATS if they contain
/// `BEGIN_DATA_FORMAT`.
const CGATS_EXTENSIONS: [&str; 6] = ["cgats", "cgt", "ti3", "sp", "ccss", "it8"];

/// Reads the samples of a file with one spectrum: `.spdx`, `.xml` and `.tm33` as IES TM-27 or the
/// spectrum of an IES TM-33 luminaire, CGATS files, and all others as columns of text. Returns an
/// error with the file, line and column if it cannot be read or a sample is invalid.
pub fn samples(path: &Path) -> Result<SpectrumSamples> {
    samples_of(path, None)
}

/// Reads the samples of a file as [`samples`] does. `sample` chooses a sample of a CGATS file by
/// its identifier or its name, as [`parse_cgats`] describes; with another file it is an error.
pub fn samples_of(path: &Path, sample: Option<&str>) -> Result<SpectrumSamples> {
    let bytes = std::fs::read(path)
        .map_err(|error| Error::input(format!("cannot read the spectrum: {error}")).in_file(path))?;
    let text = String::from_utf8_lossy(&bytes);
    let text = without_byte_order_mark(&text);
    let ends_with = |ends: &[&str]| {
        path.extension().is_some_and(|extension| ends.iter().any(|end| extension.eq_ignore_ascii_case(end)))
    };
    let is_xml = ends_with(&["spdx", "xml", "tm33"]);
    let is_cgats = !is_xml && (ends_with(&CGATS_EXTENSIONS) || cgats::is_cgats(text));
    let samples = match sample {
        _ if is_cgats => cgats::parse(text, sample),
        Some(name) => {
            let what = format!("the sample \"{name}\" of a file with one spectrum");
            Err(Error::input(what).expected("a CGATS file, whose samples have names"))
        }
        None if is_xml => spdx::parse(text),
        None => columns::parse(text),
    };
    samples.map_err(|error| error.in_file(path))
}

/// Reads the spectrum of a file, with the errors of [`samples`] and [`Spectrum::table`]. `outside`
/// determines the values beyond both ends of the table.
pub fn spectrum_file(path: &Path, outside: Outside) -> Result<Spectrum> {
    samples(path)?.spectrum(outside).map_err(|error| error.in_file(path))
}
