//! The exact sums of a film as channels of an EXR. A 128-bit sum is four 32-bit words, the lowest
//! first, each in its own channel `sums.<plane>.<word>`. The upper words are almost always 0, and
//! the lower words of splats often, so run lengths compress these channels well.

use std::path::Path;

use ::exr::block::lines::LineRef;
use ::exr::block::reader::ChunksReader;
use ::exr::meta::attribute::{ChannelList, SampleType};
use ::exr::meta::header::Header;
use ::exr::prelude::{AnyChannel, Vec2};

use super::channel_names::SUMS_PREFIX;
use super::open::{header_texts, open_blocks, read_headers, unreadable};
use super::samples::ChannelSamples;
use crate::output::Metadata;
use crate::output::hash::SumsHash;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::sum::ExactSum;
use abbe_transport::sensor::Film;
use abbe_transport::sensor::layers::NameKind;

const WORDS_PER_SUM: usize = 4;

fn name(plane: &str, word: usize) -> String {
    format!("{SUMS_PREFIX}{plane}.{word}")
}

pub(super) fn channels(film: &Film) -> impl Iterator<Item = AnyChannel<ChannelSamples<'_>>> {
    film.plane_names().into_iter().enumerate().flat_map(move |(plane, plane_name)| {
        (0..WORDS_PER_SUM).map(move |word| {
            let sum = film.plane_sums(plane);
            let samples = ChannelSamples::words(move |pixel| (sum(pixel).bits() >> (32 * word)) as u32);
            AnyChannel::new(name(&plane_name, word).as_str(), samples)
        })
    })
}

/// Reads the texts of the header. Returns an input error if the file is missing or not an EXR.
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
/// bands and layers, before the film is allocated. Returns an input error if the file is missing or
/// not an EXR.
pub fn holds_sums_of(path: &Path, (width, height): (usize, usize), planes: usize) -> Result<bool> {
    let meta = read_headers(path).map_err(|error| error.in_file(path))?;
    let fits = |header: &Header| {
        header.layer_size == Vec2(width, height) && header.channels.list.len() / WORDS_PER_SUM >= planes
    };
    Ok(meta.headers.first().is_some_and(fits))
}

pub fn hash_sums(film: &Film) -> SumsHash {
    let mut hash = SumsHash::default();
    for (plane, plane_name) in film.plane_names().iter().enumerate() {
        let mut sums = film.plane(plane);
        for row in 0..film.height() {
            let words: Vec<u8> = sums.by_ref().take(film.width()).flat_map(|sum| sum.bits().to_le_bytes()).collect();
            hash.add_row(plane_name, row, &words);
        }
    }
    hash
}

/// Adds the exact sums in a file to a film, and returns their hash. The film must have the same
/// size, spectral bands and layers.
///
/// The file is decoded in blocks of rows, so it needs little memory in addition to the film.
/// Returns an input error if the file is missing or not an EXR, or if its sums do not fit the film,
/// which may then contain a part of them.
pub fn add_sums(path: &Path, film: &mut Film) -> Result<SumsHash> {
    decode(path, film).map_err(|error| error.in_file(path))
}

#[derive(Debug, Clone, Copy)]
enum PlaneTarget {
    Light(usize),
    Names(NameKind),
}

/// A plane of a file: its name, its target, and the indices of its channels.
type FilePlane = (String, PlaneTarget, [usize; WORDS_PER_SUM]);

fn decode(path: &Path, film: &mut Film) -> Result<SumsHash> {
    let reader = open_blocks(path)?;
    let header = reader.headers().first().ok_or_else(|| Error::input("contains no picture"))?;
    if header.layer_size != Vec2(film.width(), film.height()) {
        return Err(Error::input("is damaged: its size differs from the recorded size"));
    }
    let planes = planes(&header.channels, film)?;
    let (channels, width) = (header.channels.clone(), film.width());
    let mut hash = SumsHash::default();
    let blocks = reader.all_chunks(false).map_err(unreadable)?;
    let added = blocks.decompress_parallel(false, |_, block| {
        let lines: Vec<LineRef<'_>> = block.lines(&channels).collect();
        // The lines of one row follow each other, one for each channel.
        for row in lines.chunks(channels.list.len()).filter(|_| block.index.layer == 0) {
            let place = row[0].location;
            let first = place.position.y() * width + place.position.x();
            for (name, target, words) in &planes {
                let bytes: Vec<u8> = (0..place.sample_count)
                    .flat_map(|pixel| words.map(|channel| word(row[channel].value, pixel).to_le_bytes()))
                    .flatten()
                    .collect();
                hash.add_row(name, place.position.y(), &bytes);
                let bits = bytes.chunks_exact(size_of::<i128>()).filter_map(|bits| bits.try_into().ok());
                let sums = bits.map(|bits| ExactSum::from_bits(i128::from_le_bytes(bits)));
                match target {
                    PlaneTarget::Light(plane) => film.add_plane(*plane, first, sums),
                    PlaneTarget::Names(kind) => film.add_names(*kind, first, sums),
                }
            }
        }
        Ok(())
    });
    added.map_err(unreadable)?;
    Ok(hash)
}

/// Returns the planes of the film's light, and those of names as far as the file has them.
fn planes(channels: &ChannelList, film: &Film) -> Result<Vec<FilePlane>> {
    if channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(Error::input("is damaged: it has subsampled channels"));
    }
    let channel = |name: &str| {
        channels.list.iter().position(|channel| channel.sample_type == SampleType::U32 && channel.name.eq(name))
    };
    let words = |plane: &str| -> Result<[usize; WORDS_PER_SUM]> {
        let mut found = [0; WORDS_PER_SUM];
        for (word, place) in found.iter_mut().enumerate() {
            let name = name(plane, word);
            *place = channel(&name).ok_or_else(|| Error::input(format!("lacks the channel `{name}`")))?;
        }
        Ok(found)
    };
    let mut planes = Vec::new();
    for (plane, plane_name) in film.light_plane_names().into_iter().enumerate() {
        let words = words(&plane_name)?;
        planes.push((plane_name, PlaneTarget::Light(plane), words));
    }
    for kind in film.name_kinds() {
        for plane_name in (0..).map(|place| kind.plane_name(place)) {
            if channel(&name(&plane_name, 0)).is_none() {
                break;
            }
            let words = words(&plane_name)?;
            planes.push((plane_name, PlaneTarget::Names(kind), words));
        }
    }
    Ok(planes)
}

/// Returns a sample of a line. The samples have the byte order of the machine.
fn word(line: &[u8], pixel: usize) -> u32 {
    let bytes = line.get(size_of::<u32>() * pixel..).and_then(|rest| rest.first_chunk());
    bytes.map_or(0, |bytes| u32::from_ne_bytes(*bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::Observer;

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
            film.add_plane(plane, 0, terms);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        super::super::write_with_sums(&path, &film, &film.picture(), &Metadata::new().with("abbe.seed", "7")).unwrap();
        let mut back = blank();
        assert_eq!(add_sums(&path, &mut back).unwrap(), hash_sums(&film));
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
