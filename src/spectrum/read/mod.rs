//! Measured spectra from files: columns of text, and IES TM-27 (`.spdx`).

mod columns;
mod spdx;

use std::path::Path;

use super::library::Kind;
use super::value::{Outside, Spectrum};
use super::{BAND_NM, table};
use crate::error::{Error, Result};

pub use columns::parse as parse_columns;
pub use spdx::parse as parse_spdx;

/// Wavelengths, in nm, that a file may hold; what lies beyond is a slip of unit.
const PLAUSIBLE_NM: (f64, f64) = (10.0, 1e6);

/// The samples of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Wavelengths in nm, ascending.
    pub nm: Vec<f64>,
    /// Values; finite and not negative.
    pub values: Vec<f64>,
    /// What the file says they are, if it does.
    pub kind: Option<Kind>,
}

/// A number and where it stands in a file, line and column from 1.
type Placed = (f64, (usize, usize));

impl Samples {
    /// The spectrum through the samples.
    ///
    /// # Errors
    /// As [`Spectrum::table`].
    pub fn spectrum(&self, outside: Outside) -> Result<Spectrum> {
        Spectrum::table(&self.nm, &self.values, outside)
    }

    /// Checks samples whose places in the file are known.
    fn checked(samples: &[(Placed, Placed)], kind: Option<Kind>) -> Result<Self> {
        let nm: Vec<f64> = samples.iter().map(|(nm, _)| nm.0).collect();
        let values: Vec<f64> = samples.iter().map(|(_, value)| value.0).collect();
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return Err(Error::input("no samples").expected("rows of wavelength and value"));
        };
        if nm.iter().all(|nm| *nm < PLAUSIBLE_NM.0) {
            let (line, column) = first.0.1;
            let what = format!("wavelengths from {} to {} nm", first.0.0, last.0.0);
            let expected = "wavelengths in nm, or a header that says µm";
            return Err(Error::input(what).expected(expected).at(line, column));
        }
        if let Some((i, fault)) = table::first_fault(&nm, &values) {
            let (line, column) = samples[i].0.1;
            return Err(fault.at(line, column));
        }
        if let Some(((nm, (line, column)), _)) =
            samples.iter().find(|((nm, _), _)| *nm > PLAUSIBLE_NM.1 || *nm < PLAUSIBLE_NM.0)
        {
            let what = format!("the wavelength {nm} nm");
            let expected = format!("wavelengths from {} to {} nm", PLAUSIBLE_NM.0, PLAUSIBLE_NM.1);
            return Err(Error::input(what).expected(expected).at(*line, *column));
        }
        if first.0.0 > BAND_NM.1 || last.0.0 < BAND_NM.0 {
            let (line, column) = first.0.1;
            let what = format!("samples from {} to {} nm, none of them in the band", first.0.0, last.0.0);
            let expected = format!("wavelengths between {} and {} nm", BAND_NM.0, BAND_NM.1);
            return Err(Error::input(what).expected(expected).at(line, column));
        }
        Ok(Self { nm, values, kind })
    }
}

/// The samples of a file: IES TM-27 if it is called `.spdx` or `.xml`, otherwise columns of text.
///
/// # Errors
/// A file that cannot be read; anything in it that is no sample, with file, line and column.
pub fn samples(path: &Path) -> Result<Samples> {
    let bytes = std::fs::read(path)
        .map_err(|error| Error::input(format!("cannot read the spectrum: {error}")).in_file(path))?;
    let text = String::from_utf8_lossy(&bytes);
    let text = text.trim_start_matches('\u{feff}');
    let is_xml = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("spdx") || extension.eq_ignore_ascii_case("xml"));
    let samples = if is_xml { spdx::parse(text) } else { columns::parse(text) };
    samples.map_err(|error| error.in_file(path))
}

/// The spectrum of a file; `outside` says what it means beyond its ends.
///
/// # Errors
/// As [`samples`] and [`Spectrum::table`].
pub fn spectrum_file(path: &Path, outside: Outside) -> Result<Spectrum> {
    samples(path)?.spectrum(outside).map_err(|error| error.in_file(path))
}
