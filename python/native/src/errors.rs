//! Errors of the library as Python exceptions.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use abbe_spectra::error::{Error, ErrorKind};

/// Converts an error to an exception of the Python module `abbe._errors`. The text of the exception
/// is the text that the command line prints.
pub(super) fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let class = match error.kind {
        ErrorKind::Input => "InputError",
        ErrorKind::Machine => "MachineError",
    };
    let build = || -> PyResult<PyErr> {
        let details = PyDict::new(py);
        let location = &error.location;
        details.set_item("file", location.file.as_ref().map(|file| file.display().to_string()))?;
        details.set_item("line", location.line_column.map(|(line, _)| line))?;
        details.set_item("column", location.line_column.map(|(_, column)| column))?;
        details.set_item("path", location.path.clone())?;
        details.set_item("suggestion", error.suggestion.clone())?;
        let class = py.import("abbe._errors")?.getattr(class)?;
        Ok(PyErr::from_value(class.call((error.to_string(),), Some(&details))?))
    };
    build().unwrap_or_else(|failure| failure)
}

/// A result whose error can become a Python exception.
pub(super) trait OrException<T> {
    /// Returns the value, or the error as a Python exception.
    fn or_exception(self, py: Python<'_>) -> PyResult<T>;
}

impl<T> OrException<T> for abbe_spectra::error::Result<T> {
    fn or_exception(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| exception(py, &error))
    }
}
