//! Compares numbers with known values, with a stated tolerance.

use serde_json::Value;

/// One number or several.
pub(crate) trait Numbers {
    /// Returns the numbers in order.
    fn numbers(&self) -> Vec<f64>;
}

impl Numbers for f64 {
    fn numbers(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl<const N: usize> Numbers for &[f64; N] {
    fn numbers(&self) -> Vec<f64> {
        self.to_vec()
    }
}

impl<const N: usize> Numbers for [f64; N] {
    fn numbers(&self) -> Vec<f64> {
        self.to_vec()
    }
}

impl Numbers for &[f64] {
    fn numbers(&self) -> Vec<f64> {
        self.to_vec()
    }
}

impl Numbers for &Vec<f64> {
    fn numbers(&self) -> Vec<f64> {
        (*self).clone()
    }
}

impl Numbers for &Value {
    fn numbers(&self) -> Vec<f64> {
        match self {
            Value::Array(list) => list.iter().map(number).collect(),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) | Value::Object(_) => vec![number(self)],
        }
    }
}

/// Returns the number in a JSON value.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().expect("the value is a number")
}

/// Checks that each number of `found` differs from its counterpart in `known` by at most
/// `tolerance` (absolute). NaN never passes.
#[track_caller]
pub(crate) fn assert_near(what: &str, found: impl Numbers, known: impl Numbers, tolerance: f64) {
    let (found, known) = (found.numbers(), known.numbers());
    assert_eq!(found.len(), known.len(), "{what}: {found:?} instead of {known:?}");
    let near = found.iter().zip(&known).all(|(found, known)| (found - known).abs() <= tolerance);
    assert!(near, "{what}: {found:?} instead of {known:?}, tolerance {tolerance:e}");
}

/// Does the same as [`assert_near`], with a tolerance relative to the largest magnitude in `known`.
#[track_caller]
pub(crate) fn assert_near_relative(what: &str, found: impl Numbers, known: impl Numbers, relative: f64) {
    let largest = known.numbers().into_iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    assert_near(what, found, known, relative * largest);
}

#[test]
fn a_number_outside_its_tolerance_is_refused() {
    assert_near("inside", [1.0, 2.0], [1.0, 2.1], 0.11);
    assert!(std::panic::catch_unwind(|| assert_near("outside", 1.0, 1.2, 0.11)).is_err());
    assert!(std::panic::catch_unwind(|| assert_near("no number", f64::NAN, 1.0, 0.11)).is_err());
}
