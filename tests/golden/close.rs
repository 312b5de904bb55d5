//! Single numbers against golden ones.

use serde_json::Value;

/// A number of a golden file.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Checks that two numbers are no further apart than `tolerance`.
#[track_caller]
pub(crate) fn close(what: &str, got: f64, golden: f64, tolerance: f64) {
    assert!((got - golden).abs() <= tolerance, "{what}: {got}, golden {golden}, off by {:e}", got - golden);
}
