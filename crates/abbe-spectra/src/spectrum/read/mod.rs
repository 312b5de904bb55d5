//! Reading measured spectra from files: columns of text, and IES TM-27 (`.spdx`).

mod columns;
mod spdx;

use std::path::Path;

use super::library::SpectrumKind;
use super::table::Outside;
use super::value::Spectrum;
use super::{BAND_NM, table};
use crate::error::{Error, Result};

pub use columns::parse as parse_columns;
pub use spdx::parse as parse_spdx;

/// The range of wavelengths in nm that a file may contain. Other values indicate a wrong unit.
const PLAUSIBLE_NM: (f64, f64) = (10.0, 1e6);

/// The samples of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumSamples {
    /// Wavelengths in nm, ascending.
    pub nm: Vec<f64>,
    /// Values; finite and not negative.
    pub values: Vec<f64>,
    /// The physical quantity, if the file contains it.
    pub kind: Option<SpectrumKind>,
}

/// A number with its line and column in the file, both counted from 1.
type PlacedNumber = (f64, (usize, usize));

impl SpectrumSamples {
    /// Builds the spectrum by interpolation of the samples.
    ///
    /// # Errors
    /// Returns the errors of [`Spectrum::table`].
    pub fn spectrum(&self, outside: Outside) -> Result<Spectrum> {
        Spectrum::table(&self.nm, &self.values, outside)
    }

    /// Validates the samples. The error for an invalid sample contains the position of this sample
    /// in the file.
    fn checked(samples: &[(PlacedNumber, PlacedNumber)], kind: Option<SpectrumKind>) -> Result<Self> {
        let nm: Vec<f64> = samples.iter().map(|(nm, _)| nm.0).collect();
        let values: Vec<f64> = samples.iter().map(|(_, value)| value.0).collect();
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return Err(Error::input("no samples").expected("rows of wavelength and value"));
        };
        if nm.iter().all(|nm| *nm < PLAUSIBLE_NM.0) {
            let (line, column) = first.0.1;
            let what = format!("wavelengths from {} to {} nm", first.0.0, last.0.0);
            let expected = "wavelengths in nm, or a header with the unit µm";
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
            let what = format!("samples from {} to {} nm, all of them outside the band", first.0.0, last.0.0);
            let expected = format!("wavelengths between {} and {} nm", BAND_NM.0, BAND_NM.1);
            return Err(Error::input(what).expected(expected).at(line, column));
        }
        Ok(Self { nm, values, kind })
    }
}

/// Reads the samples of a file. Files with the extension `.spdx` or `.xml` are read as IES TM-27,
/// all others as columns of text.
///
/// # Errors
/// Returns an error if the file cannot be read, or if a sample is invalid. The error contains the
/// file, and the line and column of the sample.
pub fn samples(path: &Path) -> Result<SpectrumSamples> {
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

/// Reads the spectrum of a file. `outside` determines the values beyond both ends of the table.
///
/// # Errors
/// Returns the errors of [`samples`] and [`Spectrum::table`].
pub fn spectrum_file(path: &Path, outside: Outside) -> Result<Spectrum> {
    samples(path)?.spectrum(outside).map_err(|error| error.in_file(path))
}
