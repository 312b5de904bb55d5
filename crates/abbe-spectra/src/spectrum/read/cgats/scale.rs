//! The quantity and the scale of the values of a CGATS table.

use super::columns::{SpectralColumns, Unit};
use super::table::CgatsTable;
use crate::error::{Error, Result};
use crate::spectrum::library::SpectrumKind;
use crate::spectrum::read::spectrum_samples::PlacedNumber;

/// If a value of a file is above this number, its reflectances are in percent. Fluorescent papers
/// exceed 1, but do not reach 2.
const LARGEST_FRACTION: f64 = 2.0;

/// The largest negative noise, relative to the full scale.
const NOISE: f64 = 0.01;

/// How the values of a table become the values of a spectrum.
#[derive(Debug)]
pub(super) struct Scale {
    /// Light, reflectance or transmittance, if the file states it.
    pub(super) kind: Option<SpectrumKind>,
    /// A value that means 1, for columns whose name states no unit.
    full: f64,
    /// What was decided from the values.
    pub(super) note: Option<String>,
}

impl Scale {
    /// Finds the scale of a table. All spectral values of the file must be numbers.
    pub(super) fn of(table: &CgatsTable<'_>, columns: &SpectralColumns) -> Result<Self> {
        let kind = kind(table);
        let mut largest = 0.0_f64;
        let mut is_unknown = false;
        for row in &table.rows {
            for column in columns.iter() {
                let value = row[column.value].number()?;
                if column.unit == Unit::Unknown {
                    (largest, is_unknown) = (largest.max(value), true);
                }
            }
        }
        if let Some(norm) = table.value("SPECTRAL_NORM") {
            let full = norm.number()?;
            if full <= 0.0 {
                let (line, column) = norm.place();
                let what = format!("SPECTRAL_NORM is {}", norm.text);
                return Err(Error::input(what).expected("a number above 0").at(line, column));
            }
            return Ok(Self { kind, full, note: None });
        }
        if kind == Some(SpectrumKind::Light) || !is_unknown {
            return Ok(Self { kind, full: 1.0, note: None });
        }
        let is_percent = largest > LARGEST_FRACTION;
        let (full, read) = if is_percent { (100.0, "percent") } else { (1.0, "fractions from 0 to 1") };
        Ok(Self { kind, full, note: Some(format!("the file has values up to {largest}, which are read as {read}")) })
    }

    /// Returns a value of a column as a value of the spectrum.
    pub(super) fn scaled(&self, value: f64, unit: Unit) -> f64 {
        match unit {
            Unit::Percent => value / 100.0,
            Unit::Fraction => value,
            Unit::Unknown => value / self.full,
        }
    }

    /// Sets small negative values to 0, which instruments measure in the dark. Returns a note if
    /// there are any.
    pub(super) fn remove_noise(&self, samples: &mut [(PlacedNumber, PlacedNumber)]) -> Option<String> {
        let largest = samples.iter().map(|(_, value)| value.0).fold(0.0, f64::max);
        let limit = -NOISE * if self.kind == Some(SpectrumKind::Light) { largest } else { 1.0 };
        let mut count = 0;
        for (_, (value, _)) in samples {
            if *value < 0.0 && *value >= limit {
                *value = 0.0;
                count += 1;
            }
        }
        (count > 0).then(|| format!("{count} values below 0 by at most 1 % became 0"))
    }
}

/// Returns the quantity that the keywords state.
fn kind(table: &CgatsTable<'_>) -> Option<SpectrumKind> {
    let value = |keyword: &str| table.value(keyword).map_or(String::new(), |cell| cell.text.to_ascii_uppercase());
    let (measured, device) = (value("MEAS_TYPE"), value("DEVICE_CLASS"));
    let is_light = ["EMISSION", "AMBIENT", "EMISSION_FLASH", "AMBIENT_FLASH"].contains(&measured.as_str())
        || device == "DISPLAY"
        || table.has_word("CCSS");
    if is_light {
        Some(SpectrumKind::Light)
    } else if measured == "TRANSMISSIVE" {
        Some(SpectrumKind::Transmittance)
    } else if measured == "REFLECTIVE" || device == "OUTPUT" {
        Some(SpectrumKind::Reflectance)
    } else {
        None
    }
}
