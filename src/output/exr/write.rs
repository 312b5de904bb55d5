//! Writes EXR pictures.

use std::io::Cursor;
use std::path::Path;

use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes, Text, Vec2,
    WritableImage,
};

use super::channel_names::{BIAS, EDGE, NOISE, XYZ};
use super::{cryptomatte, sums};
use crate::colour::{RgbSpace, xyz_to_linear_srgb};
use crate::error::{Error, Result};
use crate::output::{Metadata, file};
use crate::sensor::{Film, Picture, SpectralBands};
use crate::spectrum::emissive_channel;

/// Writes a picture atomically.
///
/// # Errors
/// Returns a machine error if the folder is missing or not writable, or the disk is full.
pub fn write(path: &Path, picture: &Picture, metadata: &Metadata) -> Result<()> {
    let bytes = encode(picture, metadata).map_err(|error| error.in_file(path))?;
    file::write_whole(path, &bytes)
}

/// Atomically writes a picture that another picture will soon replace. The file is not compressed,
/// because compression takes longer than writing.
///
/// # Errors
/// Returns the errors of [`write()`].
pub fn write_uncompressed(path: &Path, picture: &Picture, metadata: &Metadata) -> Result<()> {
    let bytes = encode_channels(channels(picture), picture, metadata, Encoding::UNCOMPRESSED)
        .map_err(|error| error.in_file(path))?;
    file::write_whole(path, &bytes)
}

/// Atomically writes a file that contains the exact sums of a film and the film's current picture.
///
/// # Errors
/// Returns the errors of [`write()`].
pub fn write_with_sums(path: &Path, film: &Film, picture: &Picture, metadata: &Metadata) -> Result<()> {
    let channels = channels(picture).into_iter().chain(sums::channels(film)).collect();
    let bytes =
        encode_channels(channels, picture, metadata, Encoding::SMALL_LOSSLESS).map_err(|error| error.in_file(path))?;
    file::write_whole(path, &bytes)
}

/// Returns the bytes of a picture's file.
///
/// # Errors
/// Returns a machine error if the picture cannot be encoded.
pub fn encode(picture: &Picture, metadata: &Metadata) -> Result<Vec<u8>> {
    encode_channels(channels(picture), picture, metadata, Encoding::SMALL_LOSSLESS)
}

fn encode_channels(
    channels: Vec<AnyChannel<FlatSamples>>,
    picture: &Picture,
    metadata: &Metadata,
    encoding: Encoding,
) -> Result<Vec<u8>> {
    let size = Vec2(picture.width, picture.height);
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let mut attributes = LayerAttributes {
        white_luminance: Some(1.0),
        software_name: Some(text(&format!("abbe {}", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    for (name, value) in metadata.iter().chain(spectral_attributes(picture)) {
        attributes.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    for (name, value) in picture.layers.mattes.iter().flat_map(cryptomatte::attributes) {
        attributes.other.insert(text(&name), AttributeValue::Text(text(&value)));
    }
    let mut image = Image::from_layer(Layer::new(size, attributes, encoding, channels));
    image.attributes.chromaticities = Some(chromaticities());
    let mut bytes = Cursor::new(Vec::new());
    image
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| Error::machine(format!("cannot be written as EXR: {error}")))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// The length of the magic number and of the version field.
const PREAMBLE: usize = 8;

/// Sorts the attributes in the header of a file with a single part. The crate writes them in a
/// random order, but equal pictures must be equal files. The length of the header does not change.
fn sort_attributes(file: &mut [u8]) {
    let mut attributes: Vec<&[u8]> = Vec::new();
    let mut rest = &file[PREAMBLE..];
    // An attribute is a name, a type, the size of its value (four bytes), and the value. An empty
    // name ends the header.
    while rest.first().is_some_and(|&first| first != 0) {
        let Some(length) = attribute_length(rest).filter(|&length| length <= rest.len()) else { return };
        let (attribute, after) = rest.split_at(length);
        attributes.push(attribute);
        rest = after;
    }
    attributes.sort_unstable();
    let sorted = attributes.concat();
    file[PREAMBLE..][..sorted.len()].copy_from_slice(&sorted);
}

/// Returns the length of the attribute at the beginning of `bytes`. Returns `None` if the attribute
/// is incomplete.
fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let name = bytes.iter().position(|&byte| byte == 0)? + 1;
    let kind = bytes[name..].iter().position(|&byte| byte == 0)? + 1;
    let size = bytes.get(name + kind..name + kind + 4)?.try_into().ok()?;
    Some(name + kind + 4 + u32::from_le_bytes(size) as usize)
}

fn channels(picture: &Picture) -> Vec<AnyChannel<FlatSamples>> {
    let of_each =
        |value: &dyn Fn(&[f64; 3]) -> f64| FlatSamples::F32(picture.xyz.iter().map(|xyz| value(xyz) as f32).collect());
    let mut channels = vec![
        AnyChannel::new(NOISE, error_samples(picture.noise.iter().copied())),
        AnyChannel::new(BIAS, error_samples(picture.bias.iter().copied())),
        AnyChannel::new(
            EDGE,
            error_samples(picture.edge.iter().map(|edge| edge.map(|edge| f32::from(u8::from(edge))))),
        ),
    ];
    for (c, name) in XYZ.into_iter().enumerate() {
        channels.push(AnyChannel::new(name, of_each(&|xyz| xyz[c])));
    }
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        channels.push(AnyChannel::new(name, of_each(&|xyz| xyz_to_linear_srgb(*xyz)[c])));
    }
    if let Some(SpectralBands { centres_nm, values }) = &picture.bands {
        for (band, &nm) in centres_nm.iter().enumerate() {
            let samples = values.iter().skip(band).step_by(centres_nm.len()).copied().collect();
            channels.push(AnyChannel::new(text(&emissive_channel(nm)), FlatSamples::F32(samples)));
        }
    }
    for layer in &picture.layers.channels {
        channels.push(AnyChannel::new(text(&layer.name), FlatSamples::F32(layer.values.clone())));
    }
    channels
}

/// The value of an unknown error in an error channel.
const UNKNOWN_ERROR: f32 = -1.0;

/// Returns the samples of an error channel.
fn error_samples(errors: impl Iterator<Item = Option<f32>>) -> FlatSamples {
    FlatSamples::F32(errors.map(|error| error.unwrap_or(UNKNOWN_ERROR)).collect())
}

/// Returns the attributes required by the spectral layout. The layout defines the values as
/// radiance per nm, although its attribute `emissiveUnits` does not mention nm. `abbe.bandUnits`
/// states the full unit.
fn spectral_attributes<'a>(picture: &Picture) -> impl Iterator<Item = (&'a str, &'a str)> + use<'a> {
    let attributes =
        [("spectralLayoutVersion", "1.0"), ("emissiveUnits", "W.m^-2.sr^-1"), ("abbe.bandUnits", "W.m^-2.sr^-1.nm^-1")];
    let wanted = picture.bands.is_some();
    attributes.into_iter().filter(move |_| wanted)
}

fn chromaticities() -> Chromaticities {
    let vector = |xy: [f64; 2]| Vec2(xy[0] as f32, xy[1] as f32);
    let [red, green, blue] = RgbSpace::Srgb.primaries_xy().map(vector);
    Chromaticities { red, green, blue, white: vector(RgbSpace::Srgb.white_xy()) }
}

/// Converts a text for the header. Metadata is already ASCII. In other texts, characters outside
/// Latin-1 become question marks.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.chars().map(|c| u8::try_from(c).unwrap_or(b'?')).collect::<Vec<u8>>().as_slice())
}
