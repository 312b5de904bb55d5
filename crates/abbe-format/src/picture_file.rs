//! Reads the pixels of picture files: PNG, JPEG, OpenEXR and Radiance HDR.

use super::picture::EncodingFile;
use super::radiance_hdr;
use abbe_optics::texture::ImageSize;
use abbe_spectra::colour::decode_srgb;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::sort::sort_by_number;
use abbe_spectra::spectrum::{emissive_wavelength_nm, reflective_wavelength_nm};
use std::io::Cursor;
use std::path::Path;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

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
    /// Returns an error if the file cannot be read or is not a picture. The error contains the name
    /// of the file.
    pub fn read(path: &Path) -> Result<Self> {
        let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
        let decode = || Self::decode(&std::fs::read(path).map_err(|error| unreadable(&error))?);
        if is_exr { read_exr(path) } else { decode() }.map_err(|error| error.in_file(path))
    }

    /// Decodes the contents of a PNG, JPEG or Radiance HDR file.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a picture.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        if bytes.starts_with(b"\x89PNG") {
            Self::of_png(bytes)
        } else if bytes.starts_with(b"\xff\xd8") {
            Self::of_jpeg(bytes)
        } else if radiance_hdr::is_radiance_hdr(bytes) {
            let (size, colours) = radiance_hdr::decode(bytes)?;
            Ok(Self::of_colours(size, &colours))
        } else {
            Err(unreadable(&"it is not a PNG, JPEG or Radiance HDR file"))
        }
    }

    /// Creates a picture of linear sRGB colours, row by row from the top.
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

/// The largest number of pixels of a PNG or JPEG file, 16,384 × 8,192. Their headers may state
/// sizes that no memory holds.
const MOST_PIXELS: usize = 1 << 27;

impl PictureFile {
    fn of_png(bytes: &[u8]) -> Result<Self> {
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().map_err(|error| unreadable(&error))?;
        let size = checked_size(reader.info().width as usize, reader.info().height as usize)?;
        let mut buffer = vec![0; reader.output_buffer_size().ok_or_else(|| unreadable(&"it is too large"))?];
        let frame = reader.next_frame(&mut buffer).map_err(|error| unreadable(&error))?;
        buffer.truncate(frame.buffer_size());
        let components: Vec<f32> = if frame.bit_depth == png::BitDepth::Sixteen {
            let codes = buffer.as_chunks().0.iter().map(|code| u16::from_be_bytes(*code));
            codes.map(|code| f32::from(code) / f32::from(u16::MAX)).collect()
        } else {
            buffer.iter().map(|code| f32::from(*code) / f32::from(u8::MAX)).collect()
        };
        let pixels = match frame.color_type {
            png::ColorType::Grayscale => components.iter().map(|&v| [v, v, v, 1.0]).collect(),
            png::ColorType::GrayscaleAlpha => components.as_chunks().0.iter().map(|&[v, a]| [v, v, v, a]).collect(),
            png::ColorType::Rgba => components.as_chunks().0.to_vec(),
            // The colours of a palette are expanded.
            png::ColorType::Rgb | png::ColorType::Indexed => {
                components.as_chunks().0.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect()
            }
        };
        Ok(Self { size, pixels, usual: EncodingFile::Srgb })
    }

    fn of_jpeg(bytes: &[u8]) -> Result<Self> {
        let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
        let options = options.set_max_width(usize::MAX).set_max_height(usize::MAX);
        let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
        decoder.decode_headers().map_err(|error| unreadable(&error))?;
        let (width, height) = decoder.dimensions().expect("the headers are decoded");
        let size = checked_size(width, height)?;
        let codes = decoder.decode().map_err(|error| unreadable(&error))?;
        let component = |code: u8| f32::from(code) / f32::from(u8::MAX);
        let pixels = codes.as_chunks().0.iter().map(|&[r, g, b]| [component(r), component(g), component(b), 1.0]);
        Ok(Self { size, pixels: pixels.collect(), usual: EncodingFile::Srgb })
    }
}

fn checked_size(width: usize, height: usize) -> Result<ImageSize> {
    if width.saturating_mul(height) > MOST_PIXELS {
        let what = format!("the image has {width} × {height} pixels");
        return Err(Error::input(what).expected(format!("at most {MOST_PIXELS} pixels")));
    }
    Ok(ImageSize { width, height })
}
