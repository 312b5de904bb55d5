//! The numbers of luminaire files, with checks of their ranges.

use abbe_spectra::error::{Error, Result};

/// The largest number of intensities in a file.
pub(super) const MAX_VALUES: usize = 1 << 20;

/// Angles within this many degrees of a multiple of 90° are rounded to the multiple.
const SNAP_DEG: f64 = 0.01;

/// The largest intensity in cd. A search light has about 10⁹ cd.
const LARGEST_CANDELA: f64 = 1e15;

/// A number, and its line and column in the file, both counted from 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedValue {
    pub(super) value: f64,
    pub(super) line: usize,
    pub(super) column: usize,
}

impl PlacedValue {
    /// Parses a number. `what` names the number in errors.
    pub(super) fn parse(text: &str, what: &str, line: usize, column: usize) -> Result<Self> {
        let shown: String = text.chars().take(40).collect();
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        let value = value.ok_or_else(|| Error::input(format!("{what}: \"{shown}\"")).expected("a number"));
        value.map(|value| Self { value, line, column }).map_err(|error| error.at(line, column))
    }

    /// Returns an error at the number's place. `what` names the number.
    pub(super) fn wrong(self, what: &str, expected: &str) -> Error {
        Error::input(format!("{what}: {}", self.value)).expected(expected).at(self.line, self.column)
    }

    pub(super) fn count(self, what: &str, least: usize) -> Result<usize> {
        let is_whole = self.value.fract() == 0.0 && self.value >= least as f64 && self.value <= MAX_VALUES as f64;
        let wrong = || self.wrong(what, &format!("a whole number from {least} to {MAX_VALUES}"));
        is_whole.then_some(self.value as usize).ok_or_else(wrong)
    }

    pub(super) fn not_negative(self, what: &str) -> Result<f64> {
        if self.value >= 0.0 { Ok(self.value) } else { Err(self.wrong(what, "a number of at least 0")) }
    }
}

/// Returns an error if a file states more intensities than a file may contain.
pub(super) fn check_values(vertical: usize, horizontal: usize, place: PlacedValue) -> Result<()> {
    if vertical.saturating_mul(horizontal) <= MAX_VALUES {
        return Ok(());
    }
    let what = format!("{vertical} × {horizontal} intensities");
    Err(Error::input(what).expected(format!("at most {MAX_VALUES}")).at(place.line, place.column))
}

/// Checks that angles in degrees ascend within a range, and rounds those near a multiple of 90°.
pub(super) fn ascending(angles: &[PlacedValue], what: &str, (from, to): (f64, f64)) -> Result<Vec<f64>> {
    let snapped = |angle: f64| {
        let corner = (angle / 90.0).round() * 90.0;
        if (angle - corner).abs() <= SNAP_DEG { corner } else { angle }
    };
    let mut found: Vec<f64> = Vec::with_capacity(angles.len());
    for angle in angles {
        let value = snapped(angle.value);
        if !(from..=to).contains(&value) {
            return Err(angle.wrong(what, &format!("an angle from {from}° to {to}°")));
        }
        if let Some(before) = found.last().filter(|before| value <= **before) {
            return Err(angle.wrong(what, &format!("an angle above the one before it, {before}°")));
        }
        found.push(value);
    }
    Ok(found)
}

/// Scales intensities to cd, and checks their range.
pub(super) fn candela(values: &[PlacedValue], factor: f64) -> Result<Vec<f64>> {
    let scaled = |value: &PlacedValue| {
        let candela = value.not_negative("an intensity")? * factor;
        let too_large = || value.wrong("an intensity", "at most 10¹⁵ cd after scaling");
        (candela <= LARGEST_CANDELA).then_some(candela).ok_or_else(too_large)
    };
    values.iter().map(scaled).collect()
}
