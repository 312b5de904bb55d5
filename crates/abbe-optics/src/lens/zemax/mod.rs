//! Zemax lens files (`.zmx`): sequential systems, with media from the built-in catalogue or from
//! `.agf` files. Sequences of CODE V (`.seq`), lens files of
//! OSLO (`.len`) and prescriptions of the Optical Bench of photonstophotos.net (`.txt`) become the
//! same operands.
//!
//! The file is a list of operands, one per line, where those of a surface are indented under its
//! `SURF` line. The reader uses `MODE`, `NAME`, `UNIT`, `ENPD`, `FNUM`, `FLOA`, `OBNA`, `FTYP`,
//! `XFLN` and `YFLN`, and for surfaces `STOP`, `TYPE`, `CURV`, `CONI`, `PARM`, `XDAT`, `SCBD`,
//! `DISZ`, `GLAS`, `DIAM`, `CLAP`, `OBSC`, `SQAP` and `ELAP`. Operands that are known to change the rays but are
//! not supported are errors, and all others are ignored. The first surface is the object, and the
//! last one the sensor.
//!
//! A system that is no camera lens, for example with mirrors or tilts, becomes a [`FoldedSystem`],
//! which can be analysed but not used in a camera.

mod codev;
mod folded;
mod operand;
mod optical_bench;
mod oslo;
mod reader;
mod surface;
#[cfg(test)]
mod surface_tests;
#[cfg(test)]
mod tests;
mod types;
mod words;

use std::path::Path;

use super::folded::FoldedSystem;
use super::prescription::Lens;
use crate::glass::AgfCatalogue;
use crate::glass::lines;
use crate::zemax_text::decoded;
use abbe_spectra::error::{Error, Result};
use reader::ZmxReader;

/// A system that a file describes.
#[derive(Debug, Clone)]
pub enum ZmxSystem {
    /// A lens for cameras.
    Lens(Lens),
    /// A system that is no camera lens.
    Folded(FoldedSystem),
}

/// The extensions of the files that [`parse`] reads, in small letters.
pub const EXTENSIONS: [&str; 4] = ["zmx", "seq", "len", "txt"];

/// Parses a lens from the bytes of a file in UTF-8, UTF-16 or Latin-1. The extension of `path`
/// selects the format: CODE V (`.seq`), OSLO (`.len`), the Optical Bench (`.txt`), or else Zemax.
/// Each glass is searched in `catalogues` in their order, and then as
/// [`in_lens_file`](crate::glass::makers::in_lens_file) does.
///
/// Returns an error with `path` and the line number if an operand is not supported, a glass is
/// unknown, the surfaces form no valid lens, or the system is no camera lens.
pub fn parse(bytes: &[u8], path: &Path, catalogues: &[AgfCatalogue]) -> Result<Lens> {
    read(bytes, path, catalogues)?.unfolded().map_err(|error| error.in_file(path))
}

/// Parses a system of any kind, like [`parse`]. Returns an error if an operand is not
/// supported, a glass is unknown, or the surfaces form no valid system.
pub fn parse_system(bytes: &[u8], path: &Path, catalogues: &[AgfCatalogue]) -> Result<ZmxSystem> {
    system(read(bytes, path, catalogues)?).map_err(|error| error.in_file(path))
}

fn system(mut reader: ZmxReader<'_>) -> Result<ZmxSystem> {
    let object_mm = reader.take_ends()?;
    if reader.object_index.is_some() || reader.rows.iter().any(|row| row.not_in_camera().is_some()) {
        return folded::system(reader, object_mm).map(ZmxSystem::Folded);
    }
    let unfit = match reader.clone().lens(object_mm) {
        Ok(lens) => match lens.at(lines::D_NM).image_distance_mm(f64::INFINITY) {
            Ok(_) => return Ok(ZmxSystem::Lens(lens)),
            Err(error) => error,
        },
        Err(error) if error.location.line_column.is_some() => return Err(error),
        Err(error) => error,
    };
    // A telescope, a plate or a diverging lens has no real image of a distant object.
    let mut system = folded::system(reader, object_mm).map_err(|_| unfit.clone())?;
    let what = format!("{}, so all figures follow from traced rays and the image plane of the file", unfit.what);
    system.notes.push(what);
    Ok(ZmxSystem::Folded(system))
}

fn read<'a>(bytes: &[u8], path: &Path, catalogues: &'a [AgfCatalogue]) -> Result<ZmxReader<'a>> {
    let text = text(bytes).map_err(|error| error.in_file(path))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut reader = ZmxReader::new(name, catalogues);
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let other = match extension.as_str() {
        "seq" => Some(codev::read(&text, &mut reader, catalogues)),
        "len" => Some(oslo::read(&text, &mut reader, catalogues)),
        "txt" => Some(optical_bench::read(&text, &mut reader, catalogues)),
        _ => None,
    };
    if let Some(read) = other {
        return read.map(|()| reader).map_err(|error| error.in_file(path));
    }
    for (i, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let Some(operand) = words.next() else { continue };
        let arguments: Vec<&str> = words.collect();
        reader.read(operand, &arguments, i + 1).map_err(|error| error.at(i + 1, 1).in_file(path))?;
    }
    Ok(reader)
}

/// Returns the names of the glass catalogues (`GCAT`) that a file lists; none if it is not text.
pub fn catalogues(bytes: &[u8]) -> Vec<String> {
    let text = text(bytes).unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.trim().strip_prefix("GCAT "));
    lines.flat_map(str::split_whitespace).map(str::to_string).collect()
}

fn text(bytes: &[u8]) -> Result<String> {
    let expected = "a lens file in UTF-8 or UTF-16";
    decoded(bytes).ok_or_else(|| Error::input("the file is not text").expected(expected))
}
