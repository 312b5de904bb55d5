//! Reads EXR pictures, including pictures of other renderers.

use std::collections::BTreeMap;
use std::path::Path;

use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{AnyChannels, FlatSamples, Layer, Text, Vec2};
use glam::{DMat3, DVec3};

use super::channel_names::{
    BIAS, DENOISED_BIAS, DENOISED_NOISE, DENOISED_XYZ, EDGE, LAYER_PREFIXES, NOISE, SUMS_PREFIX, XYZ,
};
use super::cryptomatte;
use super::open::{header_texts, read_layers};
use crate::output::Metadata;
use abbe_spectra::colour::RgbSpace;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::sort::sort_by_number;
use abbe_spectra::spectrum::emissive_wavelength_nm;
use abbe_transport::sensor::layers::{LayerChannel, PictureLayers};
use abbe_transport::sensor::{DenoisedPicture, Picture, SpectralBands};

#[derive(Debug, Clone, PartialEq)]
pub struct ExrFile {
    /// The picture. Noise, bias and edges are unknown if the file has no channels for them.
    pub picture: Picture,
    pub metadata: Metadata,
}

const COLOUR_CHANNELS: &str = "channels `xyz.X xyz.Y xyz.Z`, `R G B`, `X Y Z` or `Y`";

/// Reads a picture. The XYZ values come from the first set of channels in this list that the file
/// contains:
/// - `xyz.X xyz.Y xyz.Z`
/// - `R G B`; the header gives the chromaticities (default: Rec. 709) and the white luminance
///   (default: 1 cd/m²)
/// - `X Y Z`
/// - `NAME.R NAME.G NAME.B` for the first such NAME in alphabetical order
/// - `Y`, as grey
///
/// Returns an input error if the file is missing or not an EXR, contains no colours, or contains
/// layers of different sizes.
pub fn read(path: &Path) -> Result<ExrFile> {
    decode(path).map_err(|error| error.in_file(path))
}

fn decode(path: &Path) -> Result<ExrFile> {
    let image = read_layers(path)?;
    let first = image.layer_data.first().ok_or_else(|| Error::input("contains no picture"))?;
    let Vec2(width, height) = first.size;
    let mut channels = BTreeMap::new();
    for layer in &image.layer_data {
        collect(layer, first.size, image.layer_data.len() > 1, &mut channels)?;
    }
    let rgb = RgbToXyz::of(image.attributes.chromaticities, first.attributes.white_luminance)?;
    let mut picture = Picture::black(width, height);
    picture.xyz = colours(&channels, &rgb)?;
    for (layer, name) in [(&mut picture.noise, NOISE), (&mut picture.bias, BIAS)] {
        if let Some(samples) = channels.get(name) {
            *layer = samples.iter().map(|&sample| known(sample)).collect();
        }
    }
    if let Some(samples) = channels.get(EDGE) {
        picture.edge = samples.iter().map(|&sample| known(sample).map(|edge| edge > 0.0)).collect();
    }
    picture.denoised = denoised(&channels);
    picture.bands = bands(&channels);
    let texts = image.attributes.other.iter().chain(&first.attributes.other);
    let metadata = header_texts(texts, &first.attributes);
    picture.layers = layers(&channels, &metadata);
    Ok(ExrFile { picture, metadata })
}

/// Returns a sample of an error channel. Negative numbers and NaN mean that the error is unknown.
fn known(sample: f32) -> Option<f32> {
    (sample >= 0.0).then_some(sample)
}

/// Adds the channels of a layer under their full names, without exact sums and subsampled channels.
fn collect(
    layer: &Layer<AnyChannels<FlatSamples>>,
    size: Vec2<usize>,
    several: bool,
    channels: &mut BTreeMap<String, Vec<f32>>,
) -> Result<()> {
    if layer.size != size {
        return Err(Error::input("contains layers of different sizes").expected("layers of one size"));
    }
    let prefix = layer.attributes.layer_name.as_ref().filter(|_| several).map(Text::to_string);
    for channel in &layer.channel_data.list {
        if channel.sampling != Vec2(1, 1) {
            continue;
        }
        let name = channel.name.to_string();
        if name.starts_with(SUMS_PREFIX) {
            continue;
        }
        let full = prefix.as_ref().map_or(name.clone(), |prefix| format!("{prefix}.{name}"));
        let samples: Vec<f32> = channel.sample_data.values_as_f32().collect();
        // A channel is also available without the layer's name, of the first layer that has it.
        if prefix.is_some() {
            channels.entry(name).or_insert_with(|| samples.clone());
        }
        channels.entry(full).or_insert(samples);
    }
    Ok(())
}

/// The matrix from the RGB of a file to XYZ.
struct RgbToXyz(DMat3);

impl RgbToXyz {
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
        Err(Error::input("has invalid chromaticities or an invalid white luminance"))
    }

    fn xyz(&self, rgb: [f32; 3]) -> [f64; 3] {
        (self.0 * DVec3::from_array(rgb.map(f64::from))).to_array()
    }
}

/// Returns the XYZ of every pixel from the first channel set that is present.
fn colours(channels: &BTreeMap<String, Vec<f32>>, rgb: &RgbToXyz) -> Result<Vec<[f64; 3]>> {
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
    let grey =
        channels.get("Y").ok_or_else(|| Error::input("contains no colour channels").expected(COLOUR_CHANNELS))?;
    let white = RgbSpace::Srgb.white();
    Ok(grey.iter().map(|&y| white.map(|value| value * f64::from(y))).collect())
}

/// Returns the denoised picture, if the file has all of its channels.
fn denoised(channels: &BTreeMap<String, Vec<f32>>) -> Option<DenoisedPicture> {
    let [x, y, z] = DENOISED_XYZ.map(|name| channels.get(name));
    let xyz = x?.iter().zip(y?).zip(z?).map(|((&x, &y), &z)| [x, y, z].map(f64::from)).collect();
    let errors = |name: &str| Some(channels.get(name)?.iter().map(|&sample| known(sample)).collect());
    Some(DenoisedPicture { xyz, noise: errors(DENOISED_NOISE)?, bias: errors(DENOISED_BIAS)? })
}

/// Returns the layers of a picture of Abbe, whose `header` names the Cryptomatte layers.
fn layers(channels: &BTreeMap<String, Vec<f32>>, header: &Metadata) -> PictureLayers {
    let is_layer = |name: &str| LAYER_PREFIXES.iter().any(|prefix| name.starts_with(prefix));
    let own = channels.iter().filter(|(name, _)| is_layer(name));
    PictureLayers {
        channels: own.map(|(name, values)| LayerChannel { name: name.clone(), values: values.clone() }).collect(),
        mattes: cryptomatte::mattes(header),
    }
}

fn bands(channels: &BTreeMap<String, Vec<f32>>) -> Option<SpectralBands> {
    let mut found: Vec<(f64, &Vec<f32>)> =
        channels.iter().filter_map(|(name, samples)| Some((emissive_wavelength_nm(name)?, samples))).collect();
    sort_by_number(&mut found, |band| band.0);
    let pixels = found.first()?.1.len();
    let values = (0..pixels).flat_map(|pixel| found.iter().map(move |(_, samples)| samples[pixel])).collect();
    Some(SpectralBands { centres_nm: found.iter().map(|(nm, _)| *nm).collect(), values })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::{AnyChannel, Encoding, Image, LayerAttributes, WritableImage};

    /// Writes a file with a single pixel and the given channels, as another program would write it.
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
    fn explicit_primaries_are_used() {
        let [red, green, blue] = RgbSpace::Rec2020.primaries_xy().map(|xy| Vec2(xy[0] as f32, xy[1] as f32));
        let white = Vec2(0.3127, 0.3290);
        let explicit = Some(Chromaticities { red, green, blue, white });
        let found = pixel(&[("R", 0.25), ("G", 0.5), ("B", 0.75)], explicit, None);
        let known = RgbSpace::Rec2020.to_xyz([0.25, 0.5, 0.75]);
        assert!(found.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {known:?}");
    }

    #[test]
    fn files_without_a_picture_are_input_errors() {
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
        assert!(complaint().contains("not a valid EXR"));
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
    fn a_header_with_a_huge_size_is_refused() {
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
