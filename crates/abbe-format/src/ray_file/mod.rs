//! Ray files of light sources: IES TM-25 (`.TM25RAY`) and the source files of Zemax (`.dat`).
//!
//! A ray file is a sample of the light of a source near its surface: points, directions and the
//! flux of each ray. The layout of TM-25-13 follows the field list of the standard's preview and
//! the public readers `TM25RaySetTools` and `tm25ray`; that of Zemax, the manual of OpticStudio.

mod bytes;
#[cfg(test)]
mod tests;
mod tm25;
mod wavelengths;
mod zemax;

use abbe_scene::light::EmittedRay;
use abbe_spectra::error::{Error, Result};
use bytes::Bytes;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The largest number of rays of a file.
const MAX_RAYS: u64 = 200_000_000;

/// The unit of the flux of all rays of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FluxUnit {
    Watt,
    Lumen,
}

/// What a file says about the wavelengths of some rays.
#[derive(Debug, Clone, PartialEq)]
pub enum RaySpectrum {
    /// The file has no wavelengths.
    Unknown,
    /// One wavelength in nm.
    Line(f64),
    /// Wavelengths in nm, which ascend, and the spectral flux per nm on any scale.
    Table(Vec<(f64, f64)>),
}

/// Rays with the same spectrum. Their coordinates are in m.
#[derive(Debug, Clone, PartialEq)]
pub struct RayGroup {
    pub spectrum: RaySpectrum,
    pub rays: Vec<EmittedRay>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct RayFile {
    pub unit: FluxUnit,
    pub groups: Vec<RayGroup>,
    /// What the file contains that is not used.
    pub notes: Vec<String>,
}

/// Reads a ray file: TM-25 by its first bytes, and otherwise a source file of Zemax, binary or
/// text.
///
/// # Errors
/// Returns an error with the name of the file if it cannot be read, is damaged or has no rays.
pub fn read(path: &Path) -> Result<RayFile> {
    let opened = File::open(path).and_then(|file| Ok((file.metadata()?.len(), file)));
    let (length, file) =
        opened.map_err(|error| Error::input(format!("cannot read the ray file: {error}")).in_file(path))?;
    parse(BufReader::new(file), length).map_err(|error| error.in_file(path))
}

/// Parses a ray file of this length in bytes.
pub(crate) fn parse(reader: impl std::io::BufRead, length: u64) -> Result<RayFile> {
    let mut bytes = Bytes::new(reader, length);
    match bytes.first()? {
        [b'T', b'M', b'2', b'5'] => tm25::parse(&mut bytes),
        first if i32::from_le_bytes(first) == zemax::IDENTIFIER => zemax::parse(&mut bytes),
        _ => zemax::parse_text(&mut bytes),
    }
}

/// Checks the number of rays that a file states.
fn checked_count(count: u64) -> Result<u64> {
    let wrong = || Error::input(format!("{count} rays")).expected(format!("from 1 to {MAX_RAYS} rays"));
    (1..=MAX_RAYS).contains(&count).then_some(count).ok_or_else(wrong)
}

/// Checks a wavelength in this unit. `whose` names it in errors.
fn checked_wavelength(value: f64, unit: &str, whose: impl FnOnce() -> String) -> Result<f64> {
    let wrong = || Error::input(format!("{} is {value} {unit}", whose())).expected("a number above 0");
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(wrong()) }
}

/// Returns a ray, or an error that names it, by its number from 0.
fn ray(number: u64, origin_m: [f64; 3], direction: [f32; 3], flux: f32) -> Result<EmittedRay> {
    /// The largest error of the length of a direction.
    const LENGTH: f32 = 0.01;
    let wrong = |what: String, expected: &str| Error::input(format!("ray {}: {what}", number + 1)).expected(expected);
    let direction = glam::Vec3::from(direction);
    if !origin_m.iter().all(|place| place.is_finite()) {
        return Err(wrong("its point is not a number".to_owned(), "three finite coordinates"));
    }
    let length = direction.length();
    if (length - 1.0).abs().partial_cmp(&LENGTH) != Some(std::cmp::Ordering::Less) {
        return Err(wrong(format!("its direction has the length {length}"), "a unit vector"));
    }
    if !(flux >= 0.0 && flux.is_finite()) {
        return Err(wrong(format!("its flux is {flux}"), "a number of at least 0"));
    }
    Ok(EmittedRay { origin: glam::DVec3::from(origin_m).as_vec3(), direction: direction / length, flux })
}
