//! Glasses of the catalogue.

use std::borrow::Cow;
use std::path::PathBuf;

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use super::errors::OrException;
use super::json::json;
use abbe::reports::glass::{GlassReport, indices};
use abbe_format::resolve;
use abbe_optics::glass::Glass;
use abbe_optics::glass::catalogue;

/// A glass of the catalogue, or of an AGF file.
#[pyclass(name = "Glass", module = "abbe._native", frozen)]
pub(super) struct NativeGlass {
    glass: Cow<'static, Glass>,
}

#[pymethods]
impl NativeGlass {
    #[new]
    #[pyo3(signature = (name, agf=None))]
    fn new(py: Python<'_>, name: &str, agf: Option<PathBuf>) -> PyResult<Self> {
        let glass = match agf {
            None => catalogue::find(name).map(Cow::Borrowed),
            Some(path) => resolve::glass_file(&path).and_then(|file| file.find(name)).map(Cow::Owned),
        };
        Ok(Self { glass: glass.or_exception(py)? })
    }

    /// The index of refraction at wavelengths in nm.
    fn n<'py>(&self, py: Python<'py>, nm: Vec<f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(indices(&self.glass, &nm).or_exception(py)?.into_pyarray(py))
    }

    /// The report of `abbe glass --json`.
    fn report_json(&self, py: Python<'_>) -> PyResult<String> {
        GlassReport::of(&self.glass, &[]).map(|report| json(&report)).or_exception(py)
    }
}

/// The names of all glasses of the catalogue.
#[pyfunction]
pub(super) fn glass_names() -> Vec<&'static str> {
    catalogue::all().iter().map(|glass| glass.name.as_str()).collect()
}
