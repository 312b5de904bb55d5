//! Reads the pixels of picture files: PNG, JPEG, OpenEXR and Radiance HDR.

use super::picture::EncodingFile;
use abbe_optics::texture::ImageSize;
use abbe_spectra::colour::decode_srgb;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::sort::sort_by_number;
use abbe_spectra::spectrum::{emissive_wavelength_nm, reflective_wavelength_nm};
use image::DynamicImage;
use std::path::Path;

/// The pixels of a picture file.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureFile {
    /// The size of the picture.
    pub size: ImageSize,
    /// The components red, green, blue and alpha as the file encodes them, row by row from the top.
    /// Components of integer files lie in [0, 1].
    pixels: Vec<[f32; 4]>,
    /// The encoding that files of this kind have.
    usual: EncodingFile,
}

impl PictureFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is not a picture. The error contains the name of
    /// the file.
    pub fn read(path: &Path) -> Result<Self> {
        let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
        if is_exr { read_exr(path) } else { read_other(path) }.map_err(|error| error.in_file(path))
    }

    /// Decodes the contents of a PNG, JPEG or Radiance HDR file.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a picture.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        image::load_from_memory(bytes).map(of_image).map_err(|error| unreadable(&error))
    }

    /// Creates a picture of linear sRGB colours, row by row from the top.
    #[cfg(feature = "meshes")]
    pub(super) fn of_colours(size: ImageSize, colours: &[[f32; 3]]) -> Self {
        let pixels = colours.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        Self { size, pixels, usual: EncodingFile::Linear }
    }

    /// Returns the linear components of red, green and blue. `encoding` is the encoding of the
    /// file, or `None` for the usual one.
    pub fn linear_rgb(&self, encoding: Option<EncodingFile>) -> Vec<[f32; 3]> {
        let decode = Decoder::new(encoding.unwrap_or(self.usual));
        self.pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(|component| decode.linear(component))).collect()
    }

    /// Returns the linear values of a channel. The channels are numbered from 0: red, green, blue
    /// and alpha. Alpha is always linear.
    pub fn linear_channel(&self, channel: usize, encoding: EncodingFile) -> Vec<f32> {
        let decode = Decoder::new(if channel == 3 { EncodingFile::Linear } else { encoding });
        self.pixels.iter().map(|pixel| decode.linear(pixel[channel])).collect()
    }
}

/// The spectral bands of an EXR file.
pub(super) struct BandPicture {
    pub(super) size: ImageSize,
    /// The wavelengths of the bands in nm, in rising order.
    pub(super) nm: Vec<f64>,
    /// The values of the bands. The values of a pixel are adjacent.
    pub(super) values: Vec<f32>,
}

impl BandPicture {
    /// Reads the channels `T.…nm` of a file, or the channels `S0.…nm` if there are no others.
    pub(super) fn read(path: &Path) -> Result<Self> {
        Self::of_file(path).map_err(|error| error.in_file(path))
    }

    fn of_file(path: &Path) -> Result<Self> {
        use exr::prelude::*;
        check_size(path)?;
        let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = reader.all_attributes().from_file(path).map_err(|error| unreadable(&error))?;
        let layer = image.layer_data;
        let bands = |wavelength: fn(&str) -> Option<f64>| {
            let whole = layer.channel_data.list.iter().filter(|channel| channel.sampling == Vec2(1, 1));
            let mut bands: Vec<_> =
                whole.filter_map(|channel| Some((wavelength(&channel.name.to_string())?, channel))).collect();
            sort_by_number(&mut bands, |band| band.0);
            bands.dedup_by_key(|(nm, _)| nm.to_bits());
            bands
        };
        let mut found = bands(reflective_wavelength_nm);
        if found.is_empty() {
            found = bands(emissive_wavelength_nm);
        }
        if found.is_empty() {
            return Err(abbe_spectra::error::Error::input("the image has no spectral bands")
                .expected("channels such as `T.550nm` or `S0.550nm`"));
        }
        let Vec2(width, height) = layer.size;
        let mut values = vec![0.0; width * height * found.len()];
        for (band, (_, channel)) in found.iter().enumerate() {
            let of_band = values.iter_mut().skip(band).step_by(found.len());
            of_band.zip(channel.sample_data.values_as_f32()).for_each(|(value, sample)| *value = sample);
        }
        Ok(Self { size: ImageSize { width, height }, nm: found.iter().map(|(nm, _)| *nm).collect(), values })
    }
}

/// Decodes components.
enum Decoder {
    Linear,
    /// A table of the linear values of 2¹⁶ levels from 0 to 1.
    Srgb(Vec<f32>),
}

impl Decoder {
    const LEVELS: u32 = 1 << 16;

    fn new(encoding: EncodingFile) -> Self {
        let of_level = |level| decode_srgb(f64::from(level) / f64::from(Self::LEVELS - 1)) as f32;
        match encoding {
            EncodingFile::Linear => Self::Linear,
            EncodingFile::Srgb => Self::Srgb((0..Self::LEVELS).map(of_level).collect()),
        }
    }

    fn linear(&self, encoded: f32) -> f32 {
        match self {
            Self::Linear => encoded,
            Self::Srgb(table) => {
                let level = encoded * (Self::LEVELS - 1) as f32;
                let whole = level.round();
                // Files of floating-point numbers may contain any value.
                let is_level = (level - whole).abs() < 0.01 && (0.0..Self::LEVELS as f32).contains(&whole);
                if is_level { table[whole as usize] } else { decode_srgb(f64::from(encoded)) as f32 }
            }
        }
    }
}

fn read_exr(path: &Path) -> Result<PictureFile> {
    use exr::prelude::*;
    check_size(path)?;
    let image = read_first_rgba_layer_from_file(
        path,
        |size, _| (size.0, vec![[0.0_f32; 4]; size.0 * size.1]),
        |(width, pixels), position, (r, g, b, a): (f32, f32, f32, f32)| {
            pixels[position.1 * *width + position.0] = [r, g, b, a];
        },
    )
    .map_err(|error| unreadable(&error))?;
    let Vec2(width, height) = image.layer_data.size;
    let pixels = image.layer_data.channel_data.pixels.1;
    Ok(PictureFile { size: ImageSize { width, height }, pixels, usual: EncodingFile::Linear })
}

fn unreadable(error: &dyn std::fmt::Display) -> Error {
    Error::input(format!("the image cannot be read: {error}"))
}

/// Refuses a file if its header states far more pixels than the file can contain.
fn check_size(path: &Path) -> Result<()> {
    const ALWAYS_ALLOWED: u64 = 1 << 24;
    const MOST_PER_BYTE: u64 = 100;
    let file = std::fs::File::open(path).map_err(|error| unreadable(&error))?;
    let bytes = file.metadata().map_err(|error| unreadable(&error))?.len();
    let reader = exr::block::read(std::io::BufReader::new(file), false).map_err(|error| unreadable(&error))?;
    let area = |size: exr::math::Vec2<usize>| (size.0 as u64).saturating_mul(size.1 as u64);
    let pixels = reader.headers().iter().map(|header| area(header.layer_size)).max().unwrap_or(0);
    if pixels > ALWAYS_ALLOWED.max(bytes.saturating_mul(MOST_PER_BYTE)) {
        return Err(Error::input(format!("the image is damaged: {bytes} bytes cannot hold {pixels} pixels")));
    }
    Ok(())
}

fn read_other(path: &Path) -> Result<PictureFile> {
    image::open(path).map(of_image).map_err(|error| unreadable(&error))
}

fn of_image(image: DynamicImage) -> PictureFile {
    let linear = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let size = ImageSize { width: image.width() as usize, height: image.height() as usize };
    let pixels = image.into_rgba32f().pixels().map(|pixel| pixel.0).collect();
    PictureFile { size, pixels, usual: if linear { EncodingFile::Linear } else { EncodingFile::Srgb } }
}
