//! Reads the colours of OpenEXR files.

use super::picture_primaries::FilePrimaries;
use abbe_optics::texture::ImageSize;
use abbe_spectra::error::{Error, Result};
use exr::meta::attribute::Chromaticities;
use exr::prelude::{ReadChannels, ReadLayers, Vec2, read};
use std::collections::BTreeMap;
use std::io::Cursor;

/// The linear colours of a file.
#[derive(Debug)]
pub(super) struct ExrColours {
    pub(super) size: ImageSize,
    /// The components red, green, blue and alpha, row by row from the top.
    pub(super) pixels: Vec<[f32; 4]>,
    /// The primaries, or `None` for those of sRGB.
    pub(super) primaries: Option<FilePrimaries>,
}

/// The first bytes of an OpenEXR file.
pub(super) const MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

/// Decodes an OpenEXR file: the first layer with the channels R, G and B, or else the colours of
/// other channels: `X Y Z`, `NAME.R NAME.G NAME.B`, `Y`, or the only channel.
pub(super) fn decode(bytes: &[u8]) -> Result<ExrColours> {
    check_size(bytes)?;
    let reader = read().no_deep_data().largest_resolution_level().rgba_channels(
        |size, _| (size.0, vec![[0.0_f32; 4]; size.0 * size.1]),
        |(width, pixels), position, (r, g, b, a): (f32, f32, f32, f32)| {
            pixels[position.1 * *width + position.0] = [r, g, b, a];
        },
    );
    let colours = reader.first_valid_layer().all_attributes().from_buffered(Cursor::new(bytes));
    match colours {
        Ok(image) => {
            let primaries = primaries(image.attributes.chromaticities)?;
            picture(image.layer_data.size, image.layer_data.channel_data.pixels.1, primaries)
        }
        Err(_) => other_channels(bytes),
    }
}

/// Decodes a file without the channels R, G and B.
fn other_channels(bytes: &[u8]) -> Result<ExrColours> {
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = reader.all_attributes().from_buffered(Cursor::new(bytes)).map_err(|error| unreadable(&error))?;
    let layer = image.layer_data;
    let whole = layer.channel_data.list.iter().filter(|channel| channel.sampling == Vec2(1, 1));
    let channels: BTreeMap<String, _> = whole.map(|channel| (channel.name.to_string(), &channel.sample_data)).collect();
    let samples = |name: &str| channels.get(name).map(|samples| samples.values_as_f32().collect::<Vec<f32>>());
    let alpha = samples("A");
    let pixels = |[r, g, b]: [Vec<f32>; 3]| -> Vec<[f32; 4]> {
        let alpha = |i: usize| alpha.as_ref().map_or(1.0, |alpha| alpha[i]);
        (0..r.len()).map(|i| [r[i], g[i], b[i], alpha(i)]).collect()
    };
    let three = |names: [&str; 3]| {
        let [a, b, c] = names.map(samples);
        Some([a?, b?, c?])
    };
    if let Some(xyz) = three(["X", "Y", "Z"]) {
        return picture(layer.size, pixels(xyz), Some(FilePrimaries::xyz()));
    }
    for prefix in channels.keys().filter_map(|name| name.strip_suffix(".R")) {
        let names = ["R", "G", "B"].map(|colour| format!("{prefix}.{colour}"));
        if let Some(rgb) = three(names.each_ref().map(String::as_str)) {
            return picture(layer.size, pixels(rgb), primaries(image.attributes.chromaticities)?);
        }
    }
    let mut others = channels.keys().filter(|name| *name != "A");
    let only = others.next().filter(|_| others.next().is_none()).map(String::as_str);
    let grey = samples("Y").or_else(|| samples(only?));
    let Some(grey) = grey else {
        let names: Vec<String> = layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
        let found =
            if names.is_empty() { "no channels".to_owned() } else { format!("the channels {}", names.join(", ")) };
        return Err(Error::input(format!("the image cannot be read: it has {found}"))
            .expected("the channels R, G and B, or a single channel such as Y"));
    };
    picture(layer.size, pixels([grey.clone(), grey.clone(), grey]), None)
}

fn picture(size: Vec2<usize>, pixels: Vec<[f32; 4]>, primaries: Option<FilePrimaries>) -> Result<ExrColours> {
    let size = ImageSize { width: size.0, height: size.1 };
    Ok(ExrColours { size, pixels, primaries })
}

fn primaries(stated: Option<Chromaticities>) -> Result<Option<FilePrimaries>> {
    let Some(Chromaticities { red, green, blue, white }) = stated else { return Ok(None) };
    FilePrimaries::new([red, green, blue, white].map(|Vec2(x, y)| [f64::from(x), f64::from(y)]))
}

pub(super) fn unreadable(error: &dyn std::fmt::Display) -> Error {
    Error::input(format!("the image cannot be read: {error}"))
}

/// Returns whether a channel of the file has a name of this kind. A damaged header has none.
pub(super) fn has_channel(bytes: &[u8], is_kind: impl Fn(&str) -> bool) -> bool {
    let Ok(reader) = exr::block::read(Cursor::new(bytes), false) else { return false };
    reader.headers().iter().any(|header| header.channels.list.iter().any(|channel| is_kind(&channel.name.to_string())))
}

/// Refuses a file if its header states far more pixels than the file can contain.
pub(super) fn check_size(bytes: &[u8]) -> Result<()> {
    const ALWAYS_ALLOWED: u64 = 1 << 24;
    const MOST_PER_BYTE: u64 = 100;
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(|error| unreadable(&error))?;
    let area = |size: Vec2<usize>| (size.0 as u64).saturating_mul(size.1 as u64);
    let pixels = reader.headers().iter().map(|header| area(header.layer_size)).max().unwrap_or(0);
    let bytes = bytes.len() as u64;
    if pixels > ALWAYS_ALLOWED.max(bytes.saturating_mul(MOST_PER_BYTE)) {
        return Err(Error::input(format!("the image is damaged: {bytes} bytes cannot hold {pixels} pixels")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::picture_primaries::ColourUse;
    use super::*;
    use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};

    /// Returns a file of 2 × 1 pixels with these channels, as another program writes it.
    fn file(channels: &[(&str, f32)], chromaticities: Option<Chromaticities>) -> Vec<u8> {
        let channel = |&(name, value): &(&str, f32)| AnyChannel::new(name, FlatSamples::F32(vec![value; 2]));
        let channels = AnyChannels::sort(channels.iter().map(channel).collect());
        let layer = Layer::new((2, 1), LayerAttributes::default(), Encoding::UNCOMPRESSED, channels);
        let mut image = Image::from_layer(layer);
        image.attributes.chromaticities = chromaticities;
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn light(channels: &[(&str, f32)]) -> [f32; 3] {
        light_of(&decode(&file(channels, None)).unwrap())
    }

    fn light_of(colours: &ExrColours) -> [f32; 3] {
        let [r, g, b, _] = colours.pixels[1];
        colours.primaries.map_or([r, g, b], |primaries| primaries.srgb([r, g, b], ColourUse::Light))
    }

    #[test]
    fn colours_are_found_in_the_channels_of_other_programs() {
        assert_eq!(light(&[("Y", 0.3)]), [0.3; 3]);
        assert_eq!(light(&[("A", 1.0), ("Y", 0.3)]), [0.3; 3]);
        assert_eq!(light(&[("R", 0.3)]), [0.3; 3]);
        assert_eq!(light(&[("diffuse.R", 0.1), ("diffuse.G", 0.2), ("diffuse.B", 0.3)]), [0.1, 0.2, 0.3]);
        let white = light(&[("X", 0.9505), ("Y", 1.0), ("Z", 1.0891)]);
        assert!(white.iter().all(|c| (c - 1.0).abs() < 1e-3), "{white:?}");
        let error = decode(&file(&[("N", 1.0), ("Q", 1.0)], None)).unwrap_err();
        assert!(error.to_string().contains("it has the channels N, Q"), "{error}");
        assert!(decode(&file(&[("Y", 0.3)], None)[..200]).is_err());
    }

    /// The primaries of ACEScg. The components of the file, such as a roughness, are kept.
    #[test]
    fn chromaticities_change_colours_only() {
        let [red, green, blue] = [Vec2(0.713, 0.293), Vec2(0.165, 0.830), Vec2(0.128, 0.044)];
        let chromaticities = Chromaticities { red, green, blue, white: Vec2(0.32168, 0.33767) };
        let bytes = file(&[("R", 0.5), ("G", 0.1), ("B", 0.1)], Some(chromaticities));
        let picture = decode(&bytes).unwrap();
        let [r, g, b] = light_of(&picture);
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!((luminance - 0.208_89).abs() < 1e-4, "{luminance}");
        assert_eq!(picture.pixels[0], [0.5, 0.1, 0.1, 1.0]);
    }
}
