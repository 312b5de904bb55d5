//! Reading measured spectra from files: columns of text, and IES TM-27 (`.spdx`).

mod columns;
mod spdx;
mod spectrum_samples;

use std::path::Path;

use super::table::Outside;
use super::value::Spectrum;
use crate::error::{Error, Result};
use crate::text::without_byte_order_mark;

pub use columns::{ColumnFormat, nm_per_unit, parse as parse_columns};
pub use spdx::parse as parse_spdx;
pub use spectrum_samples::SpectrumSamples;

/// Reads the samples of a file: `.spdx` and `.xml` as IES TM-27, all others as columns of text.
/// Returns an error with the file, line and column if it cannot be read or a sample is invalid.
pub fn samples(path: &Path) -> Result<SpectrumSamples> {
    let bytes = std::fs::read(path)
        .map_err(|error| Error::input(format!("cannot read the spectrum: {error}")).in_file(path))?;
    let text = String::from_utf8_lossy(&bytes);
    let text = without_byte_order_mark(&text);
    let is_xml = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("spdx") || extension.eq_ignore_ascii_case("xml"));
    let samples = if is_xml { spdx::parse(text) } else { columns::parse(text) };
    samples.map_err(|error| error.in_file(path))
}

/// Reads the spectrum of a file, with the errors of [`samples`] and [`Spectrum::table`]. `outside`
/// determines the values beyond both ends of the table.
pub fn spectrum_file(path: &Path, outside: Outside) -> Result<Spectrum> {
    samples(path)?.spectrum(outside).map_err(|error| error.in_file(path))
}
