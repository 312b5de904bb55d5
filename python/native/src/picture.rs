//! Pictures with error bars.

use std::path::PathBuf;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::errors::OrException;
use super::json::json;
use abbe::Image;

/// A picture with error bars.
#[pyclass(name = "Picture", module = "abbe._native", frozen)]
pub(super) struct NativePicture {
    image: Image,
}

impl From<Image> for NativePicture {
    fn from(image: Image) -> Self {
        Self { image }
    }
}

/// An array with one value for each pixel. An unknown value is NaN.
fn plane<'py>(
    py: Python<'py>,
    image: &Image,
    values: impl Iterator<Item = Option<f32>>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let values: Vec<f32> = values.map(|value| value.unwrap_or(f32::NAN)).collect();
    values.into_pyarray(py).reshape([image.height(), image.width()])
}

#[pymethods]
impl NativePicture {
    /// Reads an EXR file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| Image::read_exr(path)).or_exception(py).map(Self::from)
    }

    #[getter]
    fn width(&self) -> usize {
        self.image.width()
    }

    #[getter]
    fn height(&self) -> usize {
        self.image.height()
    }

    #[getter]
    fn interrupted(&self) -> bool {
        self.image.is_interrupted()
    }

    #[getter]
    fn relative_error(&self) -> Option<f64> {
        self.image.relative_error()
    }

    #[getter]
    fn typical_error(&self) -> Option<f64> {
        self.image.typical_error()
    }

    /// The denoised picture, if there is one.
    #[getter]
    fn denoised(&self) -> Option<Self> {
        self.image.denoised().map(|image| Self { image })
    }

    /// The CIE tristimulus values X, Y and Z.
    fn xyz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let values = self.image.picture().xyz.clone().into_flattened();
        values.into_pyarray(py).reshape([self.image.height(), self.image.width(), 3])
    }

    /// The linear sRGB components.
    fn linear_rgb<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let colours = self.image.picture().xyz.iter().map(|&xyz| abbe_spectra::colour::xyz_to_linear_srgb(xyz));
        let values = colours.collect::<Vec<_>>().into_flattened();
        values.into_pyarray(py).reshape([self.image.height(), self.image.width(), 3])
    }

    /// The picture for a display in 8-bit sRGB.
    fn srgb<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let values = py.detach(|| self.image.to_srgb()).into_flattened();
        values.into_pyarray(py).reshape([self.image.height(), self.image.width(), 3])
    }

    /// A channel of a layer, or `None`.
    fn layer<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        let channels = &self.image.picture().layers.channels;
        let channel = channels.iter().find(|channel| channel.name == name);
        channel.map(|channel| plane(py, &self.image, channel.values.iter().map(|&value| Some(value)))).transpose()
    }

    /// The standard error of Y in cd/m².
    fn noise<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        plane(py, &self.image, self.image.picture().noise.iter().copied())
    }

    /// The magnitude of the bias of Y in cd/m².
    fn bias<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        plane(py, &self.image, self.image.picture().bias.iter().copied())
    }

    /// 1 near an edge of the illumination, 0 elsewhere.
    fn edge<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let value = |edge: &Option<bool>| edge.map(|is_edge| if is_edge { 1.0 } else { 0.0 });
        plane(py, &self.image, self.image.picture().edge.iter().map(value))
    }

    /// Half the width of the 95 % confidence interval of Y in cd/m².
    fn half_interval<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let picture = self.image.picture();
        let half = (0..picture.xyz.len()).map(|pixel| picture.half_interval_95(pixel, 0.0).unwrap_or(f64::NAN));
        let values: Vec<f64> = half.collect();
        values.into_pyarray(py).reshape([self.image.height(), self.image.width()])
    }

    /// The centres of the spectral bands in nm.
    fn wavelengths<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.image.picture().bands.as_ref().map(|bands| bands.centres_nm.clone().into_pyarray(py))
    }

    /// The spectral radiance in W/m²/sr/nm.
    fn spectrum<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f32>>>> {
        let Some(bands) = &self.image.picture().bands else { return Ok(None) };
        let shape = [self.image.height(), self.image.width(), bands.centres_nm.len()];
        bands.values.clone().into_pyarray(py).reshape(shape).map(Some)
    }

    /// The statistics of the render as JSON, if there are any.
    fn stats_json(&self) -> Option<String> {
        self.image.stats().map(json)
    }

    /// The entries of the EXR file's header.
    fn metadata(&self) -> Vec<(String, String)> {
        self.image.metadata().iter().map(|(name, value)| (name.to_string(), value.to_string())).collect()
    }

    fn write_exr(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.image.write_exr(path)).or_exception(py)
    }

    fn write_png(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.image.write_png(path)).or_exception(py)
    }

    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.image.to_png()).or_exception(py)?;
        Ok(PyBytes::new(py, &bytes))
    }
}
