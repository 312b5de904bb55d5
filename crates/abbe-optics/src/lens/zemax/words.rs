//! The numbers of an operand, and errors about what the reader does not support.

use abbe_spectra::error::{Error, Result};

pub(super) fn number(arguments: &[&str], i: usize) -> Result<f64> {
    match arguments.get(i) {
        Some(word) => parsed(word),
        None => Err(Error::input(format!("found {} values", arguments.len())).expected(format!("at least {}", i + 1))),
    }
}

pub(super) fn parsed(word: &str) -> Result<f64> {
    if word == "INFINITY" {
        return Ok(f64::INFINITY);
    }
    let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
    value.ok_or_else(|| Error::input(format!("found \"{word}\"")).expected("a number"))
}

pub(super) fn unsupported(what: &str, expected: &str) -> Error {
    Error::input(format!("{what} is not supported")).expected(expected)
}
