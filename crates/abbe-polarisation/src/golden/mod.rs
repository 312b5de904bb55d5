//! Comparisons with `polarisation.json` and `birefringence.json` of `tests/golden`, section by
//! section, with other programs, and with closed forms.

mod crystal_surfaces;
mod crystals;
mod elements;
mod laws;
mod particles;
mod peers;
mod surfaces;

use crate::{Mueller, Stokes};
use serde_json::Value;
use std::path::Path;

/// A golden file, and the largest error of each of its sections.
struct Golden(Value);

fn golden(name: &str) -> Golden {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Golden(serde_json::from_str(&text).expect("golden files are JSON"))
}

impl Golden {
    /// Returns a tolerance that the file states.
    fn tolerance(&self, name: &str) -> f64 {
        number(&self.0["tolerance"][name])
    }

    /// Compares the numbers that `compare` returns for each row of a section, as pairs of a found
    /// and a known value with its tolerance.
    fn check(&self, section: &str, compare: impl Fn(&Value) -> Vec<Pair>) {
        let rows = self.0[section].as_array().unwrap_or_else(|| panic!("no section {section}"));
        let (mut count, mut worst) = (0, 0.0_f64);
        for row in rows {
            for Pair { found, known, tolerance } in compare(row) {
                let error = (found - known).abs() / tolerance;
                assert!(error <= 1.0, "{section}: found {found}, known {known}, tolerance {tolerance:e}\n{row}");
                (count, worst) = (count + 1, worst.max(error));
            }
        }
        assert!(count > 0, "nothing compared in {section}");
        println!("{section}: {count} numbers, the largest error is {worst:.1e} of the tolerance");
    }
}

/// A found and a known value.
struct Pair {
    found: f64,
    known: f64,
    tolerance: f64,
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Returns all numbers of nested lists, in order.
fn numbers(value: &Value) -> Vec<f64> {
    match value.as_array() {
        Some(list) => list.iter().flat_map(numbers).collect(),
        None => vec![number(value)],
    }
}

/// Pairs found values with a number or with nested lists of numbers.
fn pairs(found: &[f64], known: &Value, tolerance: f64) -> Vec<Pair> {
    let known = numbers(known);
    assert_eq!(found.len(), known.len());
    found.iter().zip(known).map(|(&found, known)| Pair { found, known, tolerance }).collect()
}

fn elements(matrix: impl Into<Mueller>) -> [f64; 16] {
    let Mueller(rows) = matrix.into();
    std::array::from_fn(|i| rows[i / 4][i % 4])
}

fn stokes(value: &Value) -> Stokes {
    Stokes(numbers(value).try_into().expect("four numbers"))
}

fn cos_deg(degrees: f64) -> f64 {
    degrees.to_radians().cos()
}
