//! Checks of single values: ranges, lengths, directions.
//!
//! Every check takes the JSON path of its value. The caller adds file, line and column to errors.

use crate::JsonPath;
use abbe_spectra::error::{Error, Result};

/// Returns an error that contains the JSON path of the wrong value. `what` says what was found.
pub(super) fn fault(at: &JsonPath, what: impl Into<String>, expected: impl Into<String>) -> Error {
    Error::input(what).expected(expected).on_path(at.to_string())
}

/// Returns an error with all faults, if one of the results is an error.
pub(super) fn all(results: impl IntoIterator<Item = Result<()>>) -> Result<()> {
    // The loop is compiled for each caller, so it only collects.
    let mut faults = Vec::new();
    for result in results {
        faults.extend(result.err());
    }
    Error::all(faults).map_or(Ok(()), Err)
}

/// Formats a number in the notation of scene files.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-5..1e15).contains(&size) { value.to_string() } else { format!("{value:e}") }
}

pub(super) fn triple(value: [f64; 3]) -> String {
    format!("[{}, {}, {}]", number(value[0]), number(value[1]), number(value[2]))
}

/// If `holds` is false, returns an error. The error states the number and `expected`.
pub(super) fn rule(at: &JsonPath, value: f64, holds: bool, expected: &str) -> Result<()> {
    if holds { Ok(()) } else { Err(fault(at, format!("found {}", number(value)), expected)) }
}

pub(super) fn positive(at: &JsonPath, value: f64) -> Result<()> {
    rule(at, value, value > 0.0, "a number above 0")
}

pub(super) fn not_negative(at: &JsonPath, value: f64) -> Result<()> {
    rule(at, value, value >= 0.0, "a number of at least 0")
}

pub(super) fn fraction(at: &JsonPath, value: f64) -> Result<()> {
    from_to(at, value, 0.0, 1.0)
}

pub(super) fn from_to(at: &JsonPath, value: f64, low: f64, high: f64) -> Result<()> {
    let allowed = format!("a number from {} to {}", number(low), number(high));
    rule(at, value, (low..=high).contains(&value), &allowed)
}

pub(super) fn between(at: &JsonPath, value: f64, low: f64, high: f64) -> Result<()> {
    let allowed = format!("a number above {} and below {}", number(low), number(high));
    rule(at, value, low < value && value < high, &allowed)
}

pub(super) fn count(at: &JsonPath, value: u64, low: u64, high: u64) -> Result<()> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let allowed = if high == u64::MAX {
        format!("a whole number of at least {low}")
    } else {
        format!("a whole number from {low} to {high}")
    };
    Err(fault(at, format!("found {value}"), allowed))
}

pub(super) fn direction(at: &JsonPath, value: [f64; 3]) -> Result<()> {
    if glam::DVec3::from_array(value).length() > 0.0 {
        return Ok(());
    }
    Err(fault(at, format!("found {}", triple(value)), "a direction that is not zero"))
}

/// Checks that two points differ: `value` at the path `at`, and `other` with the key `other_key`.
pub(super) fn apart(at: &JsonPath, value: [f64; 3], other_key: &str, other: [f64; 3]) -> Result<()> {
    if glam::DVec3::from_array(value) != glam::DVec3::from_array(other) {
        return Ok(());
    }
    Err(fault(at, format!("found {}, the same point as `{other_key}`", triple(value)), "another point"))
}

/// Checks that a list has at least `least` entries. `allowed` is the expectation in the error.
pub(super) fn entries(at: &JsonPath, found: usize, least: usize, allowed: &str) -> Result<()> {
    if found >= least {
        return Ok(());
    }
    let found = if found == 0 { "an empty array".to_string() } else { format!("an array of {found}") };
    Err(fault(at, format!("found {found}"), allowed))
}

/// Checks that each number is above the one before it. If the elements of the array are objects,
/// `key` is the key of the number in each element.
pub(super) fn rising(at: &JsonPath, values: impl IntoIterator<Item = f64>, key: Option<&str>) -> Result<()> {
    let mut last = f64::NEG_INFINITY;
    for (i, value) in values.into_iter().enumerate() {
        if value <= last {
            let element = at.index(i);
            let place = key.map_or(element, |key| element.key(key));
            let (value, last) = (number(value), number(last));
            return Err(fault(&place, format!("found {value} after {last}"), format!("a number above {last}")));
        }
        last = value;
    }
    Ok(())
}

/// Checks that no weight of a mix, with the key `weight`, is negative, and that one is above 0.
pub(super) fn weights(at: &JsonPath, values: impl IntoIterator<Item = f64>) -> Result<()> {
    let mut sum = 0.0;
    for (i, value) in values.into_iter().enumerate() {
        not_negative(&at.index(i).key("weight"), value)?;
        sum += value;
    }
    if sum > 0.0 { Ok(()) } else { Err(fault(at, "found only weights of 0", "at least one weight above 0")) }
}

pub(super) fn exactly_one(at: &JsonPath, given: &[(&str, bool)]) -> Result<()> {
    let list = given.iter().map(|(key, _)| *key).collect::<Vec<_>>().join(", ");
    let mut present = given.iter().filter(|(_, present)| *present).map(|(key, _)| *key);
    match (present.next(), present.next()) {
        (Some(_), None) => Ok(()),
        (None, _) => Err(fault(at, "found none of the keys it needs", format!("exactly one of {list}"))),
        (Some(first), Some(second)) => {
            Err(fault(&at.key(second), format!("found together with `{first}`"), format!("exactly one of {list}")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_formatted_as_in_a_scene_file() {
        assert_eq!([0.0, -1.0, 0.25, 1e-9, 2.5e20].map(number), ["0", "-1", "0.25", "1e-9", "2.5e20"]);
    }

    #[test]
    fn the_error_names_the_keys_or_the_second_key() {
        let at = JsonPath::Root.key("lamp");
        let error = |a, b| exactly_one(&at, &[("power", a), ("luminance", b)]).map_err(|error| error.to_string());
        assert_eq!(error(true, false), Ok(()));
        assert_eq!(
            error(false, false).unwrap_err(),
            "lamp: found none of the keys it needs; expected exactly one of power, luminance"
        );
        assert_eq!(
            error(true, true).unwrap_err(),
            "lamp.luminance: found together with `power`; expected exactly one of power, luminance"
        );
    }
}
