//! Reads the pixels of picture files: PNG, JPEG, WebP, OpenEXR and Radiance HDR.

use super::file_kinds::refuse_as_picture;
use super::picture::EncodingFile;
use super::picture_primaries::{ColourUse, FilePrimaries};
use super::{picture_exr, picture_exr::unreadable, radiance_hdr};
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
    /// The primaries of the colours, or `None` for those of sRGB.
    primaries: Option<FilePrimaries>,
}

impl PictureFile {
    /// Reads a file. Its contents, and not its name, decide its kind.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is not a picture. The error contains the name
    /// of the file.
    pub fn read(path: &Path) -> Result<Self> {
        Self::decode(&contents(path)?).map_err(|error| error.in_file(path))
    }

    /// Decodes the contents of a PNG, JPEG, WebP, OpenEXR or Radiance HDR file.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a picture.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        if bytes.starts_with(b"\x89PNG") {
            Self::of_png(bytes)
        } else if bytes.starts_with(b"\xff\xd8") {
            Self::of_jpeg(bytes)
        } else if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
            Self::of_webp(bytes)
        } else if bytes.starts_with(picture_exr::MAGIC) {
            let picture_exr::ExrColours { size, pixels, primaries } = picture_exr::decode(bytes)?;
            Ok(Self { size, pixels, usual: EncodingFile::Linear, primaries })
        } else if radiance_hdr::is_radiance_hdr(bytes) {
            let picture = radiance_hdr::decode(bytes)?;
            Ok(Self { primaries: picture.primaries, ..Self::of_colours(picture.size, &picture.colours) })
        } else {
            Err(refuse_as_picture(bytes))
        }
    }

    /// Creates a picture of linear sRGB colours, row by row from the top.
    pub(super) fn of_colours(size: ImageSize, colours: &[[f32; 3]]) -> Self {
        let pixels = colours.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        Self { size, pixels, usual: EncodingFile::Linear, primaries: None }
    }

    /// Returns the reflectances as linear sRGB. `encoding` is the encoding of the file, or `None`
    /// for the usual one.
    pub fn linear_rgb(&self, encoding: Option<EncodingFile>) -> Vec<[f32; 3]> {
        self.linear(encoding, ColourUse::Reflectance)
    }

    /// Returns the colours as linear sRGB.
    pub(super) fn linear(&self, encoding: Option<EncodingFile>, usage: ColourUse) -> Vec<[f32; 3]> {
        let mut colours = self.components(encoding);
        if let Some(primaries) = &self.primaries {
            colours.iter_mut().for_each(|colour| *colour = primaries.srgb(*colour, usage));
        }
        colours
    }

    /// Returns the linear components of red, green and blue in the file, which need not be colours.
    pub(super) fn components(&self, encoding: Option<EncodingFile>) -> Vec<[f32; 3]> {
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
    /// The attribute `emissiveUnits` of the file.
    pub(super) emissive_units: Option<String>,
}

impl BandPicture {
    /// Reads the channels `T.…nm` of a file, or the channels `S0.…nm` if there are no others.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let kinds = [reflective_wavelength_nm, emissive_wavelength_nm];
        Self::of_bytes(&contents(path)?, &kinds).map_err(|error| error.in_file(path))
    }

    /// Reads the channels `S0.…nm` of the contents of a file. Returns `None` if they are no OpenEXR
    /// file, or have no such channel.
    pub(super) fn of_light(bytes: &[u8]) -> Result<Option<Self>> {
        let is_emissive = |channel: &str| emissive_wavelength_nm(channel).is_some();
        if !bytes.starts_with(picture_exr::MAGIC) || !picture_exr::has_channel(bytes, is_emissive) {
            return Ok(None);
        }
        Self::of_bytes(bytes, &[emissive_wavelength_nm]).map(Some)
    }

    /// Reads the channels of the first kind of which the file has one. A kind of channels is a
    /// function that returns their wavelengths.
    fn of_bytes(bytes: &[u8], kinds: &[fn(&str) -> Option<f64>]) -> Result<Self> {
        use exr::prelude::*;
        picture_exr::check_size(bytes)?;
        let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = reader.all_attributes().from_buffered(Cursor::new(bytes)).map_err(|error| unreadable(&error))?;
        let layer = image.layer_data;
        let bands = |wavelength: fn(&str) -> Option<f64>| {
            let whole = layer.channel_data.list.iter().filter(|channel| channel.sampling == Vec2(1, 1));
            let mut bands: Vec<_> =
                whole.filter_map(|channel| Some((wavelength(&channel.name.to_string())?, channel))).collect();
            sort_by_number(&mut bands, |band| band.0);
            bands.dedup_by_key(|(nm, _)| nm.to_bits());
            bands
        };
        let found = kinds.iter().map(|wavelength| bands(*wavelength)).find(|found| !found.is_empty());
        let Some(found) = found else {
            return Err(abbe_spectra::error::Error::input("the image has no spectral bands")
                .expected("channels such as `T.550nm` or `S0.550nm`"));
        };
        let emissive_units = [&layer.attributes.other, &image.attributes.other].into_iter().find_map(|attributes| {
            attributes.get(&Text::from("emissiveUnits"))?.to_text().ok().map(|units| units.to_string())
        });
        let Vec2(width, height) = layer.size;
        let mut values = vec![0.0; width * height * found.len()];
        for (band, (_, channel)) in found.iter().enumerate() {
            let of_band = values.iter_mut().skip(band).step_by(found.len());
            of_band.zip(channel.sample_data.values_as_f32()).for_each(|(value, sample)| *value = sample);
        }
        Ok(Self {
            size: ImageSize { width, height },
            nm: found.iter().map(|(nm, _)| *nm).collect(),
            values,
            emissive_units,
        })
    }
}

/// Returns the contents of a picture file.
pub(super) fn contents(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| unreadable(&error).in_file(path))
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
        Ok(Self { size, pixels, usual: EncodingFile::Srgb, primaries: None })
    }

    fn of_webp(bytes: &[u8]) -> Result<Self> {
        let mut decoder = image_webp::WebPDecoder::new(Cursor::new(bytes)).map_err(|error| unreadable(&error))?;
        let (width, height) = decoder.dimensions();
        let size = checked_size(width as usize, height as usize)?;
        let mut codes = vec![0; decoder.output_buffer_size().ok_or_else(|| unreadable(&"it is too large"))?];
        decoder.read_image(&mut codes).map_err(|error| unreadable(&error))?;
        let component = |code: u8| f32::from(code) / f32::from(u8::MAX);
        let pixels = if decoder.has_alpha() {
            codes.as_chunks().0.iter().map(|pixel| pixel.map(component)).collect()
        } else {
            codes.as_chunks().0.iter().map(|&[r, g, b]| [component(r), component(g), component(b), 1.0]).collect()
        };
        Ok(Self { size, pixels, usual: EncodingFile::Srgb, primaries: None })
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
        Ok(Self { size, pixels: pixels.collect(), usual: EncodingFile::Srgb, primaries: None })
    }
}

fn checked_size(width: usize, height: usize) -> Result<ImageSize> {
    if width.saturating_mul(height) > MOST_PIXELS {
        let what = format!("the image has {width} × {height} pixels");
        return Err(Error::input(what).expected(format!("at most {MOST_PIXELS} pixels")));
    }
    Ok(ImageSize { width, height })
}
