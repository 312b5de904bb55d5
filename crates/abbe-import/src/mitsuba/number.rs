//! Parses the numbers of attributes.

use super::xml::XmlElement;
use abbe_spectra::error::Result;

/// Returns the number of a property such as `<float name="radius" value="2"/>`.
pub(super) fn number(element: &XmlElement) -> Result<f64> {
    let text = element.required("value")?;
    parse(element, text)
}

/// Parses one number.
pub(super) fn parse(element: &XmlElement, text: &str) -> Result<f64> {
    let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| element.error(format!("found \"{}\"", text.trim())).expected("a number"))
}

/// Parses numbers that are separated by commas or blanks.
pub(super) fn numbers(element: &XmlElement, text: &str) -> Result<Vec<f64>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| parse(element, word)).collect()
}
