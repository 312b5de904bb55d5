//! Spectra.

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use super::errors::OrException;
use super::json::json;
use abbe::reports::colour::{NamedColour, colour};
use abbe::reports::named::{NamedSpectrum, spectrum};
use abbe_format::resolve::Role;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{LineSegment, Observer, Outside, Spectrum, library};

/// A spectrum: a light, a reflectance, or a coefficient.
#[pyclass(name = "Spectrum", module = "abbe._native", frozen)]
pub(super) struct NativeSpectrum(NamedSpectrum);

fn role(word: &str) -> Result<Role> {
    match word {
        "light" => Ok(Role::Light),
        "reflectance" => Ok(Role::Reflectance),
        _ => Err(Error::unknown_name("role", word, ["light", "reflectance"]).expected("light or reflectance")),
    }
}

#[pymethods]
impl NativeSpectrum {
    /// Reads a spectrum from a name of the library, the path of a file, or JSON text.
    #[new]
    fn new(py: Python<'_>, text: &str, role: &str) -> PyResult<Self> {
        self::role(role).and_then(|role| spectrum(text, role)).map(Self).or_exception(py)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    #[getter]
    fn origin(&self) -> &str {
        &self.0.origin
    }

    /// The values at wavelengths in nm.
    fn at<'py>(&self, py: Python<'py>, nm: Vec<f64>) -> Bound<'py, PyArray1<f64>> {
        nm.iter().map(|&nm| self.0.spectrum.at(nm)).collect::<Vec<f64>>().into_pyarray(py)
    }

    /// The mean values between successive wavelengths in nm.
    fn means<'py>(&self, py: Python<'py>, edges: Vec<f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mean = |edges: &[f64]| -> Result<f64> {
            let (from, to) = (edges[0], edges[1]);
            let window = Spectrum::table(&[from, to], &[1.0, 1.0], Outside::Zero)?;
            Ok(self.0.spectrum.product_integral(&window) / (to - from))
        };
        let means = edges.windows(2).map(mean).collect::<Result<Vec<f64>>>().or_exception(py)?;
        Ok(means.into_pyarray(py))
    }

    /// The integral over 360–830 nm.
    fn integral(&self) -> f64 {
        self.0.spectrum.integral()
    }

    /// The spectral lines. Each line has a wavelength in nm and a power.
    fn lines(&self) -> Vec<(f64, f64)> {
        let line = |line: &LineSegment| (line.centre(), line.power);
        self.0.spectrum.line_segments().iter().map(line).collect()
    }

    /// The tristimulus values: the integrals of the spectrum and the colour-matching functions.
    fn xyz(&self, py: Python<'_>, observer: &str) -> PyResult<[f64; 3]> {
        Ok(Observer::by_name(observer).or_exception(py)?.xyz(&self.0.spectrum))
    }

    /// The report of `abbe spectrum --json`: the colour of a light, or of a reflectance under a
    /// light.
    #[pyo3(signature = (observer, under=None))]
    fn report_json(&self, py: Python<'_>, observer: &str, under: Option<&Self>) -> PyResult<String> {
        let NamedSpectrum { name, spectrum, .. } = &self.0;
        let report = || {
            let observer = Observer::by_name(observer)?;
            let report = colour(name, spectrum, under.map(|light| &light.0.spectrum), observer)?;
            Ok(json(&NamedColour::new(name, &report, observer, under.map(Self::name))))
        };
        report().or_exception(py)
    }
}

/// The names of the spectra in the library: name, kind and description.
#[pyfunction]
pub(super) fn spectrum_names() -> Vec<(&'static str, &'static str, &'static str)> {
    library::list().iter().map(|entry| (entry.name, entry.kind.name(), entry.description)).collect()
}
