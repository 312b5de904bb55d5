//! Where words go: results to standard output, everything else to standard error.

use std::io::{ErrorKind, Write};

use abbe::error::{Error, Result};
use serde::Serialize;

/// Prints a result. A reader that has gone away (`abbe … | head`) is no error.
pub(crate) fn result(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Error::machine(format!("standard output cannot be written: {error}"))),
    }
}

/// Prints a result as one JSON object. Numbers that are not finite become `null`.
pub(crate) fn json<T: Serialize>(value: &T) -> Result<()> {
    let text = serde_json::to_string_pretty(value).expect("reports have text keys and no fallible values");
    result(&(text + "\n"))
}

/// Prints a remark on standard error; if that is closed there is nobody to tell.
pub(crate) fn remark(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Prints an error on one line.
pub(crate) fn error(error: &Error) {
    error_line(&error.to_string());
}

/// Prints an error's text on one line.
pub(crate) fn error_line(text: &str) {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    remark(&format!("error: {}", lines.join(" ")));
}
