//! A film's exact sums as channels of an EXR: 128 bits a sum, in four channels of 32-bit words, lowest first.
//!
//! The channels are named `sums.<plane>.<word>`. Upper words are almost always 0 and lower ones of splats often, so that ZIP
//! leaves little of them.

use std::collections::BTreeMap;
use std::path::Path;

use ::exr::meta::header::Header;
use ::exr::prelude::{AnyChannel, FlatSamples, Vec2};

use super::read::{check_size, flat_image, metadata};
use crate::error::{Error, Result};
use crate::math::sum::ExactSum;
use crate::output::Metadata;
use crate::sensor::Film;

/// What the channels' names begin with.
pub(super) const PREFIX: &str = "sums.";

/// 32-bit words of a sum.
const WORDS: usize = 4;

fn name(plane: &str, word: usize) -> String {
    format!("{PREFIX}{plane}.{word}")
}

/// The channels of a film's sums.
pub(super) fn channels(film: &Film) -> Vec<AnyChannel<FlatSamples>> {
    let mut channels = Vec::new();
    for (plane, plane_name) in film.plane_names().iter().enumerate() {
        for word in 0..WORDS {
            let words = film.plane(plane).map(|sum| (sum.bits() >> (32 * word)) as u32).collect();
            channels.push(AnyChannel::new(name(plane_name, word).as_str(), FlatSamples::U32(words)));
        }
    }
    channels
}

/// The header's texts, without the pixels.
///
/// # Errors
/// The input's: a file that is missing or no EXR.
pub fn read_metadata(path: &Path) -> Result<Metadata> {
    let read = || {
        let meta = check_size(path)?;
        let first = meta.headers.first().ok_or_else(|| Error::input("holds no picture"))?;
        let texts = first.shared_attributes.other.iter().chain(&first.own_attributes.other);
        Ok(metadata(texts, &first.own_attributes))
    };
    read().map_err(|error: Error| error.in_file(path))
}

/// Whether a file's header is that of a film of this width, height and number of spectral bands, as far as it tells: asked before room is made
/// for such a film.
///
/// # Errors
/// The input's: a file that is missing or no EXR.
pub fn holds_sums_of(path: &Path, (width, height): (usize, usize), bands: usize) -> Result<bool> {
    let meta = check_size(path).map_err(|error| error.in_file(path))?;
    let fits =
        |header: &Header| header.layer_size == Vec2(width, height) && header.channels.list.len() / WORDS >= bands;
    Ok(meta.headers.first().is_some_and(fits))
}

/// Adds the exact sums that a file holds to a film of its size and bands.
///
/// # Errors
/// The input's: a file that is missing or no EXR, or whose sums are not those of such a film.
pub fn add_sums(path: &Path, film: &mut Film) -> Result<()> {
    decode(path, film).map_err(|error| error.in_file(path))
}

fn decode(path: &Path, film: &mut Film) -> Result<()> {
    let image = flat_image(path)?;
    let layer = image.layer_data.first().ok_or_else(|| Error::input("holds no picture"))?;
    if layer.size != Vec2(film.width(), film.height()) {
        return Err(Error::input("is damaged: its size is not the one that it states"));
    }
    let words: BTreeMap<String, &[u32]> = layer
        .channel_data
        .list
        .iter()
        .filter_map(|channel| match &channel.sample_data {
            FlatSamples::U32(samples) => Some((channel.name.to_string(), samples.as_slice())),
            FlatSamples::F16(_) | FlatSamples::F32(_) => None,
        })
        .collect();
    for (plane, plane_name) in film.plane_names().iter().enumerate() {
        let mut found = [[].as_slice(); WORDS];
        for (word, samples) in found.iter_mut().enumerate() {
            let name = name(plane_name, word);
            *samples = words.get(&name).ok_or_else(|| Error::input(format!("lacks the channel `{name}`")))?;
        }
        let pixels = film.width() * film.height();
        film.add_plane(plane, (0..pixels).map(|pixel| sum(found.map(|words| words[pixel]))));
    }
    Ok(())
}

fn sum(words: [u32; WORDS]) -> ExactSum {
    let bits = words.iter().rev().fold(0_u128, |bits, &word| bits << 32 | u128::from(word));
    ExactSum::from_bits(bits as i128)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Observer;

    #[test]
    fn sums_come_back_to_the_last_bit() {
        let (width, height, bands) = (4, 3, 2);
        let blank = || Film::new(width, height, Observer::cie1931(), bands);
        let mut film = blank();
        let values = [0.1, -3.7e-9, 8e17, -1e12, 0.0, 1.0];
        for plane in 0..film.plane_names().len() {
            let terms = (0..width * height).map(|pixel| {
                let mut sum = ExactSum::default();
                sum += values[(pixel + plane) % values.len()] * (plane + 1) as f64;
                sum
            });
            film.add_plane(plane, terms);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        super::super::write_with_sums(&path, &film, &film.develop(), &Metadata::new().with("abbe.seed", "7")).unwrap();
        let mut back = blank();
        add_sums(&path, &mut back).unwrap();
        for plane in 0..film.plane_names().len() {
            assert!(film.plane(plane).eq(back.plane(plane)), "plane {plane}");
        }
        assert_eq!(read_metadata(&path).unwrap().get("abbe.seed"), Some("7"));
        assert_eq!(super::super::read(&path).unwrap().picture.xyz.len(), width * height);

        let mut other = Film::new(width, height, Observer::cie1931(), bands + 1);
        assert!(add_sums(&path, &mut other).unwrap_err().to_string().contains("`sums.band2.0`"));
        let mut other = Film::new(width, height + 1, Observer::cie1931(), bands);
        assert!(add_sums(&path, &mut other).unwrap_err().to_string().contains("size"));
    }
}
