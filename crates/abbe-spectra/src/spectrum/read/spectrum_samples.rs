//! The samples of a file, and their validation.

use crate::error::{Error, Result};
use crate::spectrum::band::BAND_NM;
use crate::spectrum::library::SpectrumKind;
use crate::spectrum::table::{self, Outside};
use crate::spectrum::value::Spectrum;

/// The range of wavelengths in nm of a file; others indicate a wrong unit.
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
    /// What the reader decided from the values, such as the scale of a CGATS file.
    pub note: Option<String>,
}

/// A number with its line and column in the file, from 1.
pub(super) type PlacedNumber = (f64, (usize, usize));

impl SpectrumSamples {
    /// Builds the spectrum by interpolation of the samples, with the errors of [`Spectrum::table`].
    pub fn spectrum(&self, outside: Outside) -> Result<Spectrum> {
        Spectrum::table(&self.nm, &self.values, outside)
    }

    /// Validates the samples. An error contains the position of the invalid sample in the file.
    pub(super) fn checked(samples: &[(PlacedNumber, PlacedNumber)], kind: Option<SpectrumKind>) -> Result<Self> {
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
        Ok(Self { nm, values, kind, note: None })
    }
}
