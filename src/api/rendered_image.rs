//! Images with error bars.

use std::path::{Path, PathBuf};

use super::provenance;
use abbe_session::output::exr::{read, write};
use abbe_session::output::file::check_keeps_inputs;
use abbe_session::output::metadata::Metadata;
use abbe_session::output::png::{encode as encode_png, write as write_png};
use abbe_session::render::{DisplaySettings, Job, Rendered, Run, Stats};
use abbe_spectra::colour::{RgbSpace, xyz_to_linear_srgb};
use abbe_spectra::error::Result;
use abbe_transport::sensor::{Codes, Picture};

/// A picture in absolute units with an error estimate for every pixel.
///
/// Columns `x` are counted from the left, and rows `y` are counted from the top. The first column
/// and the first row have the number 0. A method with the arguments `x` and `y` panics if the pixel
/// (`x`, `y`) lies outside the image.
#[derive(Debug, Clone)]
pub struct Image {
    picture: Picture,
    /// The settings that convert the picture for a display.
    display: DisplaySettings,
    stats: Option<Stats>,
    metadata: Metadata,
    interrupted: bool,
    /// The files from which the scene was read, which no method replaces.
    inputs: Vec<PathBuf>,
}

/// The spectral radiance of a pixel in bands of equal width.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PixelSpectrum {
    /// The centres of the bands in nm.
    pub centres_nm: Vec<f64>,
    /// The mean spectral radiance in each band, in W/m²/sr/nm.
    pub values: Vec<f64>,
}

impl Image {
    /// Creates the image of a finished render. `metadata` describes the scene.
    pub(super) fn of_render(rendered: Rendered, job: &Job, metadata: &Metadata) -> Self {
        let metadata = provenance::of_render(metadata, &rendered.stats);
        Self {
            picture: rendered.picture,
            display: DisplaySettings::of(job),
            stats: Some(rendered.stats),
            metadata,
            interrupted: rendered.interrupted,
            inputs: Vec::new(),
        }
    }

    /// Protects the files from which the scene was read.
    pub(super) fn with_inputs(self, inputs: &[PathBuf]) -> Self {
        // The working directory may change before a file is written.
        Self { inputs: inputs.iter().filter_map(|path| path.canonicalize().ok()).collect(), ..self }
    }

    /// Creates the image of an unfinished render. `metadata` describes the scene and the passes.
    pub(super) fn of_run(run: &Run, job: &Job, metadata: Metadata) -> Self {
        let (picture, display) = (run.picture(), DisplaySettings::of(job));
        Self { picture, display, stats: None, metadata, interrupted: false, inputs: Vec::new() }
    }

    /// Reads an image from an EXR file written by Abbe.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is not an EXR file with the layers of Abbe.
    pub fn read_exr(path: impl AsRef<Path>) -> Result<Self> {
        let file = read(path.as_ref())?;
        let display = DisplaySettings::of_header(&file.metadata).unwrap_or(DisplaySettings::automatic());
        let (picture, metadata) = (file.picture, file.metadata);
        Ok(Self { picture, display, stats: None, metadata, interrupted: false, inputs: Vec::new() })
    }

    /// The number of pixels in a row.
    pub fn width(&self) -> usize {
        self.picture.width
    }

    /// The number of rows.
    pub fn height(&self) -> usize {
        self.picture.height
    }

    fn index(&self, x: usize, y: usize) -> usize {
        let (width, height) = (self.width(), self.height());
        assert!(x < width && y < height, "the pixel {x}, {y} lies outside of {width} × {height} pixels");
        y * width + x
    }

    /// The CIE tristimulus values X, Y, Z of a pixel. Y is the luminance in cd/m².
    pub fn xyz(&self, x: usize, y: usize) -> [f64; 3] {
        self.picture.xyz[self.index(x, y)]
    }

    /// The linear sRGB components of a pixel. White of 1 cd/m² has the components 1, 1, 1. Colours
    /// outside the gamut have negative components.
    pub fn linear_rgb(&self, x: usize, y: usize) -> [f64; 3] {
        xyz_to_linear_srgb(self.xyz(x, y))
    }

    /// The whole picture in 8-bit sRGB, row by row. The first row is the top row. The scene sets
    /// exposure, white balance, tone curve and gamut mapping. A picture of another program has
    /// automatic exposure.
    pub fn to_srgb(&self) -> Vec<[u8; 3]> {
        match self.display.in_space(RgbSpace::Srgb).screen(&self.picture).codes {
            Codes::Eight(codes) => codes,
            Codes::Sixteen(codes) => codes.into_iter().map(|rgb| rgb.map(|code| (code >> 8) as u8)).collect(),
        }
    }

    /// The spectrum of a pixel, or `None` if the render did not store spectral bands.
    pub fn spectrum(&self, x: usize, y: usize) -> Option<PixelSpectrum> {
        let pixel = self.index(x, y);
        let bands = self.picture.bands.as_ref()?;
        let count = bands.centres_nm.len();
        let values = &bands.values[pixel * count..(pixel + 1) * count];
        Some(PixelSpectrum {
            centres_nm: bands.centres_nm.clone(),
            values: values.iter().map(|&value| f64::from(value)).collect(),
        })
    }

    /// The standard error of the luminance Y in cd/m², or `None` if the error is unknown.
    pub fn noise(&self, x: usize, y: usize) -> Option<f64> {
        self.picture.noise[self.index(x, y)].map(f64::from)
    }

    /// The estimated bias of the luminance Y in cd/m², without its sign. `None` means unknown.
    pub fn bias(&self, x: usize, y: usize) -> Option<f64> {
        self.picture.bias[self.index(x, y)].map(f64::from)
    }

    /// Returns whether the pixel is near an edge of the illumination. Kernels blur such an edge,
    /// and the bias may be larger there than the estimate of [`bias`](Self::bias). `None` means
    /// unknown.
    pub fn is_near_edge(&self, x: usize, y: usize) -> Option<bool> {
        self.picture.edge[self.index(x, y)]
    }

    /// Returns half the width of the 95 % confidence interval of the luminance Y. The unit is
    /// cd/m². The interval includes noise and bias. `None` means that the noise or the bias is
    /// unknown.
    pub fn half_interval_95(&self, x: usize, y: usize) -> Option<f64> {
        self.picture.half_interval_95(self.index(x, y), 0.0)
    }

    /// The relative error of a typical pixel, or `None` if this error is unknown: the root mean
    /// square of the relative errors of all pixels except the worst 2 %. The target error of a
    /// render refers to it.
    pub fn typical_error(&self) -> Option<f64> {
        self.picture.error_distribution().map(|errors| errors.typical)
    }

    /// The root mean square error of the whole picture, or `None` if this error is unknown. The
    /// formula is √mean(noise² + bias²) / mean Y.
    pub fn relative_error(&self) -> Option<f64> {
        self.picture.error_means().relative
    }

    /// The denoised image, whose noise and bias are those of its own pixels, or `None` if the
    /// render did not denoise or has fewer than four passes. It has no spectrum and no edges.
    pub fn denoised(&self) -> Option<Self> {
        Some(Self { picture: self.picture.denoised()?, ..self.clone() })
    }

    /// Returns true if [`write_png`](Self::write_png) shows the denoised image: if the scene
    /// requests it, or if it is safe by its own error bars.
    pub fn shows_denoised(&self) -> bool {
        self.display.shows_denoised(&self.picture)
    }

    /// The statistics of the render, or `None` for a picture from a file.
    pub fn stats(&self) -> Option<&Stats> {
        self.stats.as_ref()
    }

    /// Returns true if the progress callback stopped the render early.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted
    }

    /// Writes an EXR file: XYZ, error layers, spectral bands, and a header with scene, plan and
    /// statistics.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, or is one from which the scene was read.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<()> {
        check_keeps_inputs([path.as_ref()], &self.inputs)?;
        write(path.as_ref(), &self.picture, &self.metadata)
    }

    /// Writes a PNG file. The scene sets colour space, exposure, white balance, tone curve and
    /// gamut mapping. A picture of another program is written in sRGB with automatic exposure.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, or is one from which the scene was read.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<()> {
        check_keeps_inputs([path.as_ref()], &self.inputs)?;
        write_png(path.as_ref(), &self.display.screen(&self.picture))
    }

    /// Returns the bytes of the PNG file that [`write_png`](Self::write_png) writes.
    ///
    /// # Errors
    /// Returns an error if the picture is too large for a PNG file.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        encode_png(&self.display.screen(&self.picture))
    }

    /// The picture with its error layers.
    #[doc(hidden)]
    pub fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The header of the EXR file.
    #[doc(hidden)]
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }
}
