//! Source files of Zemax, binary and as text.

use super::bytes::{Bytes, numbers};
use super::{FluxUnit, MAX_RAYS, RayFile, RayGroup, RaySpectrum, checked_count, checked_wavelength, ray, wavelengths};
use abbe_scene::light::EmittedRay;
use abbe_spectra::error::{Error, Result};
use std::io::BufRead;

/// The first number of a binary file.
pub(super) const IDENTIFIER: i32 = 1010;

/// The length in m of each unit, by its number.
const UNITS_M: [f64; 5] = [1.0, 0.0254, 0.01, 0.3048, 0.001];

pub(super) fn parse<R: BufRead>(bytes: &mut Bytes<R>) -> Result<RayFile> {
    bytes.skip(4)?;
    let count = checked_count(u64::from(bytes.i32()? as u32))?;
    // The description, and the flux of the source and of the rays: the sum over the rays counts.
    bytes.skip(100 + 8)?;
    let wavelength_um = f64::from(bytes.f32()?);
    // The angles of the rays.
    bytes.skip(16)?;
    let unit_m = UNITS_M[bytes.whole("the unit of length", (0, 4))? as usize];
    // The place, turn and scale of the source, which Zemax does not use, and reserved numbers.
    bytes.skip(4 * 13)?;
    let format_at = "the format of the rays: 0 for flux, or 2 for flux and wavelengths";
    let has_wavelengths = match bytes.whole(format_at, (0, 2))? {
        0 => false,
        2 => true,
        _ => return Err(Error::input("the format 1 of rays").expected("0 for flux, or 2 for flux and wavelengths")),
    };
    let unit = if bytes.whole("the unit of the flux", (0, 1))? == 0 { FluxUnit::Watt } else { FluxUnit::Lumen };
    bytes.skip(8)?;
    let columns = if has_wavelengths { 8 } else { 7 };
    bytes.check_records(count, columns)?;
    let (mut record, mut values) = (vec![0; 4 * columns], vec![0.0; columns]);
    let mut rows = Vec::with_capacity(count as usize);
    for number in 0..count {
        bytes.read(&mut record)?;
        numbers(&record, &mut values);
        let um = has_wavelengths.then(|| f64::from(values[7]));
        rows.push((um, row(number, &values, unit_m)?));
    }
    grouped(rows, unit, wavelength_um)
}

fn row(number: u64, values: &[f32], unit_m: f64) -> Result<EmittedRay> {
    let origin = [0, 1, 2].map(|column| unit_m * f64::from(values[column]));
    ray(number, origin, [values[3], values[4], values[5]], values[6])
}

/// Parses a file of text: the number of rays and the unit of length, and then a line for each ray.
/// The flux is in W.
pub(super) fn parse_text<R: BufRead>(bytes: &mut Bytes<R>) -> Result<RayFile> {
    let unknown = || Error::input("an unknown kind of ray file").expected("a TM-25 file, or a source file of Zemax");
    let text = String::from_utf8(bytes.rest()?).map_err(|_| unknown())?;
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let numbers_of = |line: &str| line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>();
    let header = lines.next().and_then(|(_, line)| numbers_of(line));
    let Some([count, unit]) = header.as_deref() else { return Err(unknown()) };
    let (count, unit) = (*count, *unit);
    if !(count.fract() == 0.0 && count >= 1.0 && count <= MAX_RAYS as f64) {
        return Err(Error::input(format!("{count} rays")).expected(format!("from 1 to {MAX_RAYS} rays")).at(1, 1));
    }
    let unit_m = (0..).map(f64::from).zip(UNITS_M).find(|&(number, _)| number == unit).map(|(_, unit_m)| unit_m);
    let unit_m = unit_m.ok_or_else(|| {
        Error::input(format!("the unit of length is {unit}")).expected("a number from 0 to 4").at(1, 1)
    })?;
    let mut rows = Vec::new();
    for (number, (line, text)) in (0..).zip(lines) {
        let wrong = || Error::input("this ray").expected("seven numbers, or eight with a wavelength in µm").at(line, 1);
        let values = numbers_of(text).ok_or_else(wrong)?;
        if !(7..=8).contains(&values.len()) {
            return Err(wrong());
        }
        let single: Vec<f32> = values.iter().map(|&value| value as f32).collect();
        rows.push((values.get(7).copied(), row(number, &single, unit_m).map_err(|error| error.at(line, 1))?));
    }
    if rows.len() as f64 != count {
        return Err(
            Error::input(format!("{} rays", rows.len())).expected(format!("the {count} rays of the first line"))
        );
    }
    grouped(rows, FluxUnit::Watt, 0.0)
}

/// Returns the rays by their wavelengths in µm, or with the one of the file, if it has one.
fn grouped(rows: Vec<(Option<f64>, EmittedRay)>, unit: FluxUnit, wavelength_um: f64) -> Result<RayFile> {
    let groups = if rows.iter().all(|(um, _)| um.is_some()) {
        let mut rays = Vec::with_capacity(rows.len());
        for (number, (um, ray)) in (1..).zip(rows) {
            let whose = || format!("ray {number}: its wavelength");
            let um = checked_wavelength(um.unwrap_or(0.0), "µm", whose)?;
            rays.push((1e3 * um, ray));
        }
        wavelengths::groups(rays)
    } else {
        let rays = rows.into_iter().map(|(_, ray)| ray).collect();
        let has_wavelength = wavelength_um > 0.0 && wavelength_um.is_finite();
        let spectrum = if has_wavelength { RaySpectrum::Line(1e3 * wavelength_um) } else { RaySpectrum::Unknown };
        vec![RayGroup { spectrum, rays }]
    };
    Ok(RayFile { unit, groups, notes: Vec::new() })
}
