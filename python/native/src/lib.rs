//! The native module of the Python package: `abbe._native`.
//!
//! The Python files of the package, in `python/abbe`, define the documented interface. They call
//! this module for everything that is computed. Reports go to Python as JSON text, and pictures go
//! to Python as numpy arrays.

mod errors;
mod json;
mod lens;
mod optics;
mod picture;
mod render;
mod reports;
mod spectrum;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the `abbe` program with the words of a command line, and returns its exit status.
#[pyfunction]
fn run_command_line(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| abbe::cli::run_from(words))
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<render::RenderTask>()?;
    module.add_class::<picture::NativePicture>()?;
    module.add_class::<optics::NativeGlass>()?;
    module.add_class::<lens::NativeLens>()?;
    module.add_class::<spectrum::NativeSpectrum>()?;
    module.add_function(wrap_pyfunction!(run_command_line, module)?)?;
    module.add_function(wrap_pyfunction!(render::check_scene, module)?)?;
    module.add_function(wrap_pyfunction!(render::explain_scene, module)?)?;
    module.add_function(wrap_pyfunction!(optics::glass_names, module)?)?;
    module.add_function(wrap_pyfunction!(spectrum::spectrum_names, module)?)?;
    module.add_function(wrap_pyfunction!(reports::regression_set, module)?)?;
    module.add_function(wrap_pyfunction!(reports::regression_report, module)?)?;
    module.add_function(wrap_pyfunction!(lens::lens_names, module)?)?;
    module.add_function(wrap_pyfunction!(lens::lens_plot_names, module)?)?;
    module.add_function(wrap_pyfunction!(lens::lens_prescription, module)?)?;
    module.add_function(wrap_pyfunction!(reports::lamps_report, module)?)?;
    module.add_function(wrap_pyfunction!(reports::write_whole, module)?)?;
    module.add_class::<reports::ReportTask>()?;
    Ok(())
}
