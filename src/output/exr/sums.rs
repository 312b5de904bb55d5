//! The exact sums of a film as channels of an EXR. A 128-bit sum is split into four 32-bit words.
//! The lowest word comes first. Each word has its own channel.
//!
//! The channels are named `sums.<plane>.<word>`. The upper words are almost always 0, and the lower
//! words of splats are often 0. Therefore ZIP compresses the channels well.

use std::collections::BTreeMap;
use std::path::Path;

use ::exr::meta::header::Header;
use ::exr::prelude::{AnyChannel, FlatSamples, Vec2};

use super::channel_names::SUMS_PREFIX;
use super::open::{header_texts, read_headers, read_layers};
use crate::error::{Error, Result};
use crate::math::sum::ExactSum;
use crate::output::Metadata;
use crate::sensor::Film;

/// The number of 32-bit words of a sum.
const WORDS_PER_SUM: usize = 4;

fn name(plane: &str, word: usize) -> String {
    format!("{SUMS_PREFIX}{plane}.{word}")
}

/// Returns the channels of a film's sums.
pub(super) fn channels(film: &Film) -> Vec<AnyChannel<FlatSamples>> {
    let mut channels = Vec::new();
    for (plane, plane_name) in film.plane_names().iter().enumerate() {
        for word in 0..WORDS_PER_SUM {
            let words = film.plane(plane).map(|sum| (sum.bits() >> (32 * word)) as u32).collect();
            channels.push(AnyChannel::new(name(plane_name, word).as_str(), FlatSamples::U32(words)));
        }
    }
    channels
}

/// Reads the texts of the header without the pixels.
///
/// # Errors
/// Returns an input error if the file is missing or not an EXR.
pub fn read_metadata(path: &Path) -> Result<Metadata> {
    let read = || {
        let meta = read_headers(path)?;
        let first = meta.headers.first().ok_or_else(|| Error::input("contains no picture"))?;
        let texts = first.shared_attributes.other.iter().chain(&first.own_attributes.other);
        Ok(header_texts(texts, &first.own_attributes))
    };
    read().map_err(|error: Error| error.in_file(path))
}

/// Returns true if the header can belong to a film of this width, height and number of planes of
/// bands and layers. Call this function before you allocate the film.
///
/// # Errors
/// Returns an input error if the file is missing or not an EXR.
pub fn holds_sums_of(path: &Path, (width, height): (usize, usize), planes: usize) -> Result<bool> {
    let meta = read_headers(path).map_err(|error| error.in_file(path))?;
    let fits = |header: &Header| {
        header.layer_size == Vec2(width, height) && header.channels.list.len() / WORDS_PER_SUM >= planes
    };
    Ok(meta.headers.first().is_some_and(fits))
}

/// Adds the exact sums in a file to a film. The file and the film must have the same size, the same
/// spectral bands and the same layers.
///
/// # Errors
/// Returns an input error if the file is missing or not an EXR, or if its sums do not fit the size
/// and the bands of the film.
pub fn add_sums(path: &Path, film: &mut Film) -> Result<()> {
    decode(path, film).map_err(|error| error.in_file(path))
}

fn decode(path: &Path, film: &mut Film) -> Result<()> {
    let image = read_layers(path)?;
    let layer = image.layer_data.first().ok_or_else(|| Error::input("contains no picture"))?;
    if layer.size != Vec2(film.width(), film.height()) {
        return Err(Error::input("is damaged: its size differs from the recorded size"));
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
        film.add_plane(plane, plane_of(&words, plane_name)?);
    }
    for kind in film.name_kinds() {
        for place in 0.. {
            let plane_name = kind.plane_name(place);
            if !words.contains_key(&name(&plane_name, 0)) {
                break;
            }
            film.add_names(kind, plane_of(&words, &plane_name)?);
        }
    }
    Ok(())
}

/// Returns the sums of a plane, pixel by pixel. `words` contains the channels of the file.
fn plane_of<'w>(words: &BTreeMap<String, &'w [u32]>, plane: &str) -> Result<impl Iterator<Item = ExactSum> + use<'w>> {
    let mut found = [[].as_slice(); WORDS_PER_SUM];
    for (word, samples) in found.iter_mut().enumerate() {
        let name = name(plane, word);
        *samples = words.get(&name).ok_or_else(|| Error::input(format!("lacks the channel `{name}`")))?;
    }
    Ok((0..found[0].len()).map(move |pixel| sum(found.map(|words| words[pixel]))))
}

fn sum(words: [u32; WORDS_PER_SUM]) -> ExactSum {
    let bits = words.iter().rev().fold(0_u128, |bits, &word| bits << 32 | u128::from(word));
    ExactSum::from_bits(bits as i128)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Observer;

    #[test]
    fn sums_survive_a_round_trip_exactly() {
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
        super::super::write_with_sums(&path, &film, &film.picture(), &Metadata::new().with("abbe.seed", "7")).unwrap();
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
