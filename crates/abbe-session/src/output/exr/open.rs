//! Opens EXR files: checks their size, and reads their layers and the texts of their headers.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use ::exr::block::reader::Reader;
use ::exr::prelude::{AttributeValue, FlatImage, LayerAttributes, MetaData, ReadChannels, ReadLayers, Text, Vec2};

use crate::output::Metadata;
use abbe_spectra::error::{Error, Result};

/// Reads all layers and channels of a file after a check of its size.
pub(super) fn read_layers(path: &Path) -> Result<FlatImage> {
    read_headers(path)?;
    let reader = ::exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    reader.all_layers().all_attributes().from_file(path).map_err(unreadable)
}

pub(super) fn unreadable(error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::Io(error) => Error::input(format!("cannot be read: {error}")),
        ::exr::error::Error::Invalid(what) => Error::input(format!("is not a valid EXR file: {what}")),
        ::exr::error::Error::NotSupported(what) => {
            Error::input(format!("is an EXR file of an unsupported kind: {what}"))
        }
        ::exr::error::Error::Aborted => Error::input("was not read completely"),
    }
}

/// Opens a file for reading its blocks after a check of its size.
pub(super) fn open_blocks(path: &Path) -> Result<Reader<BufReader<File>>> {
    read_headers(path)?;
    let file = File::open(path).map_err(|error| unreadable(error.into()))?;
    ::exr::block::read(BufReader::new(file), false).map_err(unreadable)
}

/// Reads the headers. An error means that their pixels need far more memory than the file holds.
pub(super) fn read_headers(path: &Path) -> Result<MetaData> {
    /// The largest ratio of the memory for the pixels to the size of the file: 1032 by the limit of
    /// deflate, the strongest compression in an EXR file, and reading copies the data once.
    const MAX_EXPANSION: u64 = 4000;
    /// The memory in bytes that the pixels of any file, even of a very small one, may need.
    const SMALL_FILE_LIMIT: u64 = 3 << 28;
    /// The number of bytes that one pixel needs for XYZ and for the error layers.
    const PIXEL_BYTES: u64 = 41;
    let meta = MetaData::read_from_file(path, false).map_err(unreadable)?;
    let bytes = std::fs::metadata(path).map_err(|error| unreadable(error.into()))?.len();
    let wanted = meta.headers.iter().fold(0_u64, |sum, header| {
        let Vec2(width, height) = header.layer_size;
        let pixels = (width as u64).saturating_mul(height as u64);
        sum.saturating_add(pixels.saturating_mul(PIXEL_BYTES + 8 * header.channels.list.len() as u64))
    });
    let whole_mib = bytes >> 20 << 20;
    if wanted > SMALL_FILE_LIMIT.max(whole_mib.saturating_mul(MAX_EXPANSION)) {
        return Err(Error::input(format!(
            "is not a valid EXR file: {bytes} bytes cannot contain {wanted} bytes of pixels"
        )));
    }
    Ok(meta)
}

/// Returns the texts of a header in the order of their names.
pub(super) fn header_texts<'a>(
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
