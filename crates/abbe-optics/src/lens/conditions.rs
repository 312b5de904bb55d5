//! The conditions of an analysis: the field, the wavelengths and the position of the sensor.

use std::borrow::Cow;

use crate::glass::lines;
use abbe_spectra::error::{Error, Result};

/// The spectral lines of the default conditions: name and wavelength in nm.
pub const LINES: [(&str, f64); 3] = [("F", lines::F_NM), ("d", lines::D_NM), ("C", lines::C_NM)];

/// The largest number of wavelengths of an analysis, so that their colours remain distinguishable.
pub const MAX_LINES: usize = 6;

/// A wavelength of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalysisLine {
    /// Name of the spectral line, or the wavelength in nm as text.
    pub name: Cow<'static, str>,
    /// Wavelength in nm.
    pub nm: f64,
}

/// The position of the sensor of an analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorFocus {
    /// At this distance in mm behind the paraxial focus of the reference wavelength, for a distant
    /// object. Negative values move the sensor towards the lens.
    Shift(f64),
    /// Where the mean square radius of the spots of all fields, each with all wavelengths, is
    /// least.
    Best,
}

/// What an analysis computes.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalysisConditions {
    /// Half of the field of view in degrees, above 0 and below 90, or `None` for that of the
    /// design.
    pub half_field_deg: Option<f64>,
    /// The position of the sensor.
    pub focus: SensorFocus,
    lines: Vec<AnalysisLine>,
}

impl Default for AnalysisConditions {
    /// Returns the conditions of [`LINES`] at the paraxial focus of the d line.
    fn default() -> Self {
        let lines = LINES.map(|(name, nm)| AnalysisLine { name: Cow::Borrowed(name), nm });
        Self { half_field_deg: None, focus: SensorFocus::Shift(0.0), lines: lines.to_vec() }
    }
}

impl AnalysisConditions {
    /// Returns the same conditions with half of another field of view in degrees, above 0 and below
    /// 90, or with that of the design.
    pub fn with_half_field(self, half_field_deg: Option<f64>) -> Self {
        Self { half_field_deg, ..self }
    }

    /// Returns the same conditions with another position of the sensor.
    pub fn with_focus(self, focus: SensorFocus) -> Self {
        Self { focus, ..self }
    }

    /// Returns the same conditions with other wavelengths in nm, which may have any order. Returns
    /// an error for no wavelength, for more than [`MAX_LINES`], and if one occurs twice.
    pub fn with_wavelengths(self, nm: &[f64]) -> Result<Self> {
        let mut sorted = nm.to_vec();
        sorted.sort_by(f64::total_cmp);
        if !(1..=MAX_LINES).contains(&sorted.len()) {
            let what = format!("found {} wavelengths", sorted.len());
            return Err(Error::input(what).expected(format!("1 to {MAX_LINES} wavelengths")));
        }
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Error::input(format!("found the wavelength {} nm twice", pair[0])));
        }
        let line = |nm: f64| {
            let known = LINES.iter().find(|(_, known)| (known - nm).abs() < 1e-3);
            AnalysisLine { name: known.map_or(Cow::Owned(nm.to_string()), |(name, _)| Cow::Borrowed(*name)), nm }
        };
        Ok(Self { lines: sorted.into_iter().map(line).collect(), ..self })
    }

    /// Returns the wavelengths in ascending order.
    pub fn lines(&self) -> &[AnalysisLine] {
        &self.lines
    }

    /// Returns the index of the reference wavelength: the middle one, or of an even number, the
    /// longer one of the two in the middle.
    pub fn reference(&self) -> usize {
        self.lines.len() / 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wavelengths_are_sorted_named_and_limited() {
        let with = |nm: &[f64]| AnalysisConditions::default().with_wavelengths(nm);
        let conditions = with(&[650.0, 450.0, 587.5618]).unwrap();
        let names: Vec<&str> = conditions.lines().iter().map(|line| line.name.as_ref()).collect();
        assert_eq!((names, conditions.reference()), (vec!["450", "d", "650"], 1));
        assert_eq!(AnalysisConditions::default(), with(&LINES.map(|line| line.1)).unwrap());
        for (nm, words) in [(&[][..], "1 to 6"), (&[500.0, 500.0], "500 nm twice"), (&[1.0; 7], "found 7")] {
            let error = with(nm).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
