//! Expected values of a report, for tests: `--expect FIGURE=VALUE[:TOLERANCE]`.

use abbe_spectra::error::{Error, Result};
use serde_json::Value;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expectation {
    /// The key of the figure in the JSON report.
    figure: String,
    expected: Expected,
}

#[derive(Debug, Clone, PartialEq)]
enum Expected {
    Text(String),
    /// Each number with the largest difference that it may have.
    Numbers(Vec<(f64, f64)>),
}

/// Parses an expectation such as `cct_k=6504:5`, `xy=0.3127,0.3290:0.1%` or `srgb_hex=#ffffff`.
/// Without a tolerance, the value must round to the digits that are given.
pub(crate) fn parse(text: &str) -> std::result::Result<Expectation, String> {
    let wrong = || "expected a figure and its value such as cct_k=6504:5 or xy=0.3127,0.3290:0.1%".to_string();
    let (figure, value) = text.split_once('=').ok_or_else(wrong)?;
    let figure = figure.trim().to_string();
    if value.starts_with('#') {
        return Ok(Expectation { figure, expected: Expected::Text(value.to_string()) });
    }
    let (numbers, tolerance) = value.split_once(':').map_or((value, None), |(numbers, t)| (numbers, Some(t)));
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let with_tolerance = |text: &str| {
        let value = number(text)?;
        let tolerance = match tolerance {
            None => half_of_last_digit(text.trim())?,
            Some(tolerance) => match tolerance.trim().strip_suffix('%') {
                Some(percent) => number(percent)? * 0.01 * value.abs(),
                None => number(tolerance)?,
            },
        };
        (tolerance >= 0.0).then_some((value, tolerance))
    };
    let numbers: Option<Vec<(f64, f64)>> = numbers.split(',').map(with_tolerance).collect();
    Ok(Expectation { figure, expected: Expected::Numbers(numbers.ok_or_else(wrong)?) })
}

/// Returns half a unit of the last digit of a decimal number without exponent.
fn half_of_last_digit(number: &str) -> Option<f64> {
    let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let is_plain = number.chars().all(|c| c.is_ascii_digit() || "+-.".contains(c));
    // The factor beyond 1 admits the rounding errors of the report's own numbers.
    is_plain.then(|| (0.5 + 1e-9) * 0.1_f64.powi(decimals as i32))
}

impl Expectation {
    /// Returns a sentence if the value differs, or an input error if the report has no such figure
    /// or another number of values.
    pub(crate) fn failure(&self, report: &Value) -> Result<Option<String>> {
        let figures = report.as_object().into_iter().flatten().filter(|(key, _)| is_measured(key));
        let names: Vec<&str> = figures.map(|(key, _)| key.as_str()).collect();
        let figure = &self.figure;
        let Some(found) = report.get(figure).filter(|_| names.contains(&figure.as_str())) else {
            return Err(Error::unknown_name("figure", figure, names.clone()).expected(names.join(", ")));
        };
        match &self.expected {
            Expected::Text(text) => {
                let same = found.as_str().is_some_and(|found| found.eq_ignore_ascii_case(text));
                Ok((!same).then(|| format!("{figure} is {found}, expected {text}")))
            }
            Expected::Numbers(numbers) => {
                let values: Vec<&Value> = found.as_array().map_or(vec![found], |values| values.iter().collect());
                if values.len() != numbers.len() {
                    let what = format!("{figure} has {} values, but {} are expected", values.len(), numbers.len());
                    return Err(Error::input(what));
                }
                let fits = |(found, &(value, tolerance)): (&&Value, &(f64, f64))| {
                    found.as_f64().is_some_and(|found| (found - value).abs() <= tolerance)
                };
                let same = values.iter().zip(numbers).all(fits);
                let text = |numbers: &[(f64, f64)]| {
                    let each = numbers.iter().map(|(value, tolerance)| format!("{value} ± {tolerance:.2e}"));
                    each.collect::<Vec<_>>().join(", ")
                };
                Ok((!same).then(|| format!("{figure} is {found}, expected {}", text(numbers))))
            }
        }
    }
}

/// Returns false for the keys of a report that name its input.
fn is_measured(key: &str) -> bool {
    !["name", "observer", "under", "complementary"].contains(&key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn failure(text: &str) -> Option<String> {
        let report = json!({"name": "A", "xy": [0.44757, 0.40745], "cct_k": 2855.5, "ra": null, "srgb_hex": "#ffb26c"});
        parse(text).unwrap().failure(&report).unwrap()
    }

    #[test]
    fn values_fit_within_their_tolerance() {
        for fits in ["cct_k=2856:5", "cct_k=2855.5", "xy=0.448,0.407", "xy=0.44757,0.4:2%", "srgb_hex=#FFB26C"] {
            assert_eq!(failure(fits), None, "{fits}");
        }
        for differs in ["cct_k=2856:0.1", "cct_k=2860", "xy=0.449,0.407", "srgb_hex=#ffb26d", "ra=100:100"] {
            assert!(failure(differs).is_some(), "{differs}");
        }
        assert!(failure("cct_k=2860").unwrap().starts_with("cct_k is 2855.5, expected 2860 ± 5.00e-1"));
    }

    #[test]
    fn malformed_expectations_are_refused() {
        assert!(["cct_k", "cct_k=", "xy=0.3,b", "cct_k=1:-1", "cct_k=1e3"].iter().all(|text| parse(text).is_err()));
        let report = json!({"xy": [0.3, 0.3]});
        assert!(
            parse("cct=1").unwrap().failure(&report).is_err() && parse("xy=0.3").unwrap().failure(&report).is_err()
        );
    }
}
