//! EXR to pictures, ours and those of other renderers.

use std::collections::BTreeMap;
use std::path::Path;

use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{
    AnyChannels, AttributeValue, FlatImage, FlatSamples, Layer, LayerAttributes, MetaData, ReadChannels, ReadLayers,
    Text, Vec2,
};
use glam::{DMat3, DVec3};

use super::{BIAS, EDGE, NOISE, XYZ, spectral, sums};
use crate::colour::RgbSpace;
use crate::error::{Error, Result};
use crate::output::Metadata;
use crate::sensor::{Bands, Picture};

/// What an EXR file holds for us.
#[derive(Debug, Clone, PartialEq)]
pub struct ExrFile {
    /// The picture; noise and bias are −1 where the file has no such layers.
    pub picture: Picture,
    /// The header's texts.
    pub metadata: Metadata,
}

/// What colour channels a file is searched for, in this order.
const COLOURS: &str = "channels `xyz.X xyz.Y xyz.Z`, `R G B`, `X Y Z` or `Y`";

/// Reads a picture. Its XYZ come from `xyz.X xyz.Y xyz.Z`, or else from `R G B` (by the header's chromaticities and
/// white luminance, Rec. 709 and 1 cd/m² without them), from `X Y Z`, from the first layer's `NAME.R NAME.G NAME.B`, or
/// as grey from `Y`.
///
/// # Errors
/// The input's: a file that is missing or no EXR, without colours, with layers of different sizes.
pub fn read(path: &Path) -> Result<ExrFile> {
    decode(path).map_err(|error| error.in_file(path))
}

/// All layers and channels of a file that is not larger than it should be.
pub(super) fn flat_image(path: &Path) -> Result<FlatImage> {
    check_size(path)?;
    let reader = ::exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    reader.all_layers().all_attributes().from_file(path).map_err(unreadable)
}

fn decode(path: &Path) -> Result<ExrFile> {
    let image = flat_image(path)?;
    let first = image.layer_data.first().ok_or_else(|| Error::input("holds no picture"))?;
    let Vec2(width, height) = first.size;
    let mut channels = BTreeMap::new();
    for layer in &image.layer_data {
        collect(layer, first.size, image.layer_data.len() > 1, &mut channels)?;
    }
    let rgb = Rgb::of(image.attributes.chromaticities, first.attributes.white_luminance)?;
    let mut picture = Picture::black(width, height);
    picture.xyz = colours(&channels, &rgb)?;
    for (layer, name) in [(&mut picture.noise, NOISE), (&mut picture.bias, BIAS), (&mut picture.edge, EDGE)] {
        if let Some(samples) = channels.get(name) {
            layer.copy_from_slice(samples);
        }
    }
    picture.bands = bands(&channels);
    let texts = image.attributes.other.iter().chain(&first.attributes.other);
    Ok(ExrFile { picture, metadata: metadata(texts, &first.attributes) })
}

pub(super) fn unreadable(error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::Io(error) => Error::input(format!("cannot be read: {error}")),
        ::exr::error::Error::Invalid(what) => Error::input(format!("is not a sound EXR file: {what}")),
        ::exr::error::Error::NotSupported(what) => Error::input(format!("is an EXR file of an unknown kind: {what}")),
        ::exr::error::Error::Aborted => Error::input("was not read to its end"),
    }
}

/// Reads the header, and refuses one that asks for far more memory than the file can fill.
pub(super) fn check_size(path: &Path) -> Result<MetaData> {
    /// No compression of the format makes more of a byte (deflate's limit is 1032), and what is read is copied once.
    const MOST_PER_BYTE: u64 = 4000;
    /// A file below 1 MiB may fill this much, whatever it says.
    const ALWAYS_ALLOWED: u64 = 3 << 28;
    /// What a pixel takes as XYZ with its error layers.
    const PIXEL: u64 = 36;
    let meta = MetaData::read_from_file(path, false).map_err(unreadable)?;
    let bytes = std::fs::metadata(path).map_err(|error| unreadable(error.into()))?.len();
    let wanted = meta.headers.iter().fold(0_u64, |sum, header| {
        let Vec2(width, height) = header.layer_size;
        let pixels = (width as u64).saturating_mul(height as u64);
        sum.saturating_add(pixels.saturating_mul(PIXEL + 8 * header.channels.list.len() as u64))
    });
    let whole_mib = bytes >> 20 << 20;
    if wanted > ALWAYS_ALLOWED.max(whole_mib.saturating_mul(MOST_PER_BYTE)) {
        return Err(Error::input(format!(
            "is not a sound EXR file: {bytes} bytes cannot hold {wanted} bytes of pixels"
        )));
    }
    Ok(meta)
}

/// Adds a layer's channels by their full names; exact sums are no picture and left out.
fn collect(
    layer: &Layer<AnyChannels<FlatSamples>>,
    size: Vec2<usize>,
    several: bool,
    channels: &mut BTreeMap<String, Vec<f32>>,
) -> Result<()> {
    if layer.size != size {
        return Err(Error::input("holds layers of different sizes").expected("layers of one size"));
    }
    let prefix = layer.attributes.layer_name.as_ref().filter(|_| several).map(Text::to_string);
    for channel in &layer.channel_data.list {
        if channel.sampling != Vec2(1, 1) {
            continue;
        }
        let name = channel.name.to_string();
        if name.starts_with(sums::PREFIX) {
            continue;
        }
        let full = prefix.as_ref().map_or(name.clone(), |prefix| format!("{prefix}.{name}"));
        let samples: Vec<f32> = channel.sample_data.values_as_f32().collect();
        // The first layer goes also by its plain names.
        if prefix.is_some() {
            channels.entry(name).or_insert_with(|| samples.clone());
        }
        channels.entry(full).or_insert(samples);
    }
    Ok(())
}

/// From RGB of a file to XYZ.
struct Rgb(DMat3);

impl Rgb {
    fn of(chromaticities: Option<Chromaticities>, white_luminance: Option<f32>) -> Result<Self> {
        let luminance = white_luminance.map_or(1.0, f64::from);
        let to_xyz = match chromaticities {
            None => DMat3::from_cols_array_2d(
                &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| RgbSpace::Srgb.to_xyz(rgb)),
            ),
            Some(Chromaticities { red, green, blue, white }) => {
                let of_xy = |Vec2(x, y): Vec2<f32>| {
                    let (x, y) = (f64::from(x), f64::from(y));
                    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
                };
                let primaries = DMat3::from_cols(of_xy(red), of_xy(green), of_xy(blue));
                primaries * DMat3::from_diagonal(primaries.inverse() * of_xy(white))
            }
        };
        let matrix = to_xyz * luminance;
        if matrix.is_finite() {
            return Ok(Self(matrix));
        }
        Err(Error::input("states chromaticities or a white luminance that make no colours"))
    }

    fn xyz(&self, rgb: [f32; 3]) -> [f64; 3] {
        (self.0 * DVec3::from_array(rgb.map(f64::from))).to_array()
    }
}

/// XYZ of every pixel from the best channels there are.
fn colours(channels: &BTreeMap<String, Vec<f32>>, rgb: &Rgb) -> Result<Vec<[f64; 3]>> {
    let three = |names: [&str; 3]| {
        let [a, b, c] = names.map(|name| channels.get(name));
        Some(a?.iter().zip(b?).zip(c?).map(|((&a, &b), &c)| [a, b, c]))
    };
    let wide = |xyz: [f32; 3]| xyz.map(f64::from);
    if let Some(pixels) = three(XYZ) {
        return Ok(pixels.map(wide).collect());
    }
    if let Some(pixels) = three(["R", "G", "B"]) {
        return Ok(pixels.map(|pixel| rgb.xyz(pixel)).collect());
    }
    if let Some(pixels) = three(["X", "Y", "Z"]) {
        return Ok(pixels.map(wide).collect());
    }
    for prefix in channels.keys().filter_map(|name| name.strip_suffix(".R")) {
        let names = ["R", "G", "B"].map(|colour| format!("{prefix}.{colour}"));
        if let Some(pixels) = three(names.each_ref().map(String::as_str)) {
            return Ok(pixels.map(|pixel| rgb.xyz(pixel)).collect());
        }
    }
    let grey = channels.get("Y").ok_or_else(|| Error::input("holds no colours").expected(COLOURS))?;
    let white = RgbSpace::Srgb.white();
    Ok(grey.iter().map(|&y| white.map(|value| value * f64::from(y))).collect())
}

fn bands(channels: &BTreeMap<String, Vec<f32>>) -> Option<Bands> {
    let mut found: Vec<(f64, &Vec<f32>)> =
        channels.iter().filter_map(|(name, samples)| Some((spectral::wavelength_nm(name)?, samples))).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pixels = found.first()?.1.len();
    let values = (0..pixels).flat_map(|pixel| found.iter().map(move |(_, samples)| samples[pixel])).collect();
    Some(Bands { centres_nm: found.iter().map(|(nm, _)| *nm).collect(), values })
}

/// The header's texts in the order of their names.
pub(super) fn metadata<'a>(
    others: impl Iterator<Item = (&'a Text, &'a AttributeValue)>,
    layer: &LayerAttributes,
) -> Metadata {
    let mut texts = BTreeMap::new();
    for (name, value) in others {
        if let AttributeValue::Text(value) = value {
            texts.insert(name.to_string(), value.to_string());
        }
    }
    if let Some(software) = &layer.software_name {
        texts.insert("software".to_string(), software.to_string());
    }
    texts.iter().fold(Metadata::new(), |metadata, (name, value)| metadata.with(name, value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{AnyChannel, Encoding, Image, WritableImage};

    /// Writes single-pixel channels as another program might.
    fn foreign(path: &Path, channels: &[(&str, f32)], chromaticities: Option<Chromaticities>, white: Option<f32>) {
        let list = channels.iter().map(|(name, value)| AnyChannel::new(*name, FlatSamples::F32(vec![*value])));
        let attributes = LayerAttributes { white_luminance: white, ..LayerAttributes::default() };
        let layer = Layer::new(Vec2(1, 1), attributes, Encoding::UNCOMPRESSED, AnyChannels::sort(list.collect()));
        let mut image = Image::from_layer(layer);
        image.attributes.chromaticities = chromaticities;
        image.write().to_file(path).unwrap();
    }

    fn pixel(channels: &[(&str, f32)], chromaticities: Option<Chromaticities>, white: Option<f32>) -> [f64; 3] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        foreign(&path, channels, chromaticities, white);
        read(&path).unwrap().picture.xyz[0]
    }

    fn assert_near(found: [f64; 3], known: [f64; 3]) {
        assert!(found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-6 * b.abs().max(1.0)), "{found:?} {known:?}");
    }

    #[test]
    fn rgb_of_other_renderers_becomes_xyz() {
        let rgb = [("R", 0.25), ("G", 0.5), ("B", 0.75)];
        let known = RgbSpace::Srgb.to_xyz([0.25, 0.5, 0.75]);
        assert_near(pixel(&rgb, None, None), known);
        assert_near(pixel(&rgb, None, Some(80.0)), known.map(|value| 80.0 * value));
        let layer = [("Combined.R", 0.25), ("Combined.G", 0.5), ("Combined.B", 0.75), ("Depth.Z", 3.0)];
        assert_near(pixel(&layer, None, None), known);
        assert_near(pixel(&[("Y", 2.0)], None, None), RgbSpace::Srgb.white().map(|value| 2.0 * value));
        assert_near(pixel(&[("X", 1.0), ("Y", 2.0), ("Z", 3.0)], None, None), [1.0, 2.0, 3.0]);
        assert_near(pixel(&[("R", 9.0), ("xyz.X", 1.0), ("xyz.Y", 2.0), ("xyz.Z", 3.0)], None, None), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn stated_primaries_are_used() {
        let [red, green, blue] = RgbSpace::Rec2020.primaries_xy().map(|xy| Vec2(xy[0] as f32, xy[1] as f32));
        let white = Vec2(0.3127, 0.3290);
        let stated = Some(Chromaticities { red, green, blue, white });
        let found = pixel(&[("R", 0.25), ("G", 0.5), ("B", 0.75)], stated, None);
        let known = RgbSpace::Rec2020.to_xyz([0.25, 0.5, 0.75]);
        assert!(found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {known:?}");
    }

    #[test]
    fn what_is_no_picture_is_the_input_s_fault_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let complaint = || {
            let error = read(&path).unwrap_err();
            assert_eq!(error.exit_status(), 2);
            assert!(error.to_string().contains("a.exr: "), "{error}");
            error.to_string()
        };
        assert!(complaint().contains("cannot be read"));
        std::fs::write(&path, "P6 1 1 255 ...").unwrap();
        assert!(complaint().contains("not a sound EXR"));
        foreign(&path, &[("depth", 1.0)], None, None);
        assert!(complaint().contains("expected channels"));
        foreign(&path, &[("R", 1.0), ("G", 1.0), ("B", 1.0)], None, Some(f32::NAN));
        assert!(complaint().contains("white luminance"));

        crate::output::exr::write(&path, &super::super::tests::sample(), &Metadata::new()).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for length in [0, 3, 40, whole.len() / 2, whole.len() - 1] {
            std::fs::write(&path, &whole[..length]).unwrap();
            complaint();
        }
    }

    #[test]
    fn a_header_that_asks_for_the_world_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        foreign(&path, &[("R", 1.0), ("G", 1.0), ("B", 1.0)], None, None);
        let mut bytes = std::fs::read(&path).unwrap();
        let name = b"dataWindow\0box2i\0";
        let at = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len() + 4;
        bytes[at + 8..at + 16].copy_from_slice(&[0xff, 0xff, 0xff, 0x00, 0xff, 0xff, 0xff, 0x00]);
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(read(&path).unwrap_err().exit_status(), 2);
    }
}
