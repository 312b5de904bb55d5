//! IES TM-25 ray files, in the layout of TM-25-13.

use super::bytes::{Bytes, numbers};
use super::{FluxUnit, RayFile, RayGroup, RaySpectrum, checked_count, checked_wavelength, ray, wavelengths};
use abbe_scene::light::EmittedRay;
use abbe_spectra::error::{Error, Result};
use std::io::BufRead;

/// The versions of the layout: TM-25-20 keeps that of 2013.
const VERSIONS: [i32; 2] = [2013, 2020];

/// The wavelengths of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SpectrumKind {
    Unknown,
    SingleWavelength,
    WavelengthPerRay,
    OneTable,
    TablePerRay,
}

/// The columns of a ray that are used, by their place in the record.
struct Columns {
    numbers: usize,
    watts: Option<usize>,
    lumens: Option<usize>,
    wavelength: Option<usize>,
    table: Option<usize>,
    /// True if the rays have columns of the standard that are not used.
    has_unused: bool,
}

pub(super) fn parse<R: BufRead>(bytes: &mut Bytes<R>) -> Result<RayFile> {
    bytes.skip(4)?;
    let version = bytes.i32()?;
    if !VERSIONS.contains(&version) {
        return Err(Error::input(format!("version {version} of TM-25")).expected("version 2013 or 2020"));
    }
    // The method of creation and the totals of the flux: the sum over the rays counts.
    bytes.skip(12)?;
    let count = checked_count(bytes.u64()?)?;
    // The date, and where the rays start.
    bytes.skip(28 + 4)?;
    let kind = match bytes.whole("the kind of spectral data", (0, 4))? {
        0 => SpectrumKind::Unknown,
        1 => SpectrumKind::SingleWavelength,
        2 => SpectrumKind::WavelengthPerRay,
        3 => SpectrumKind::OneTable,
        _ => SpectrumKind::TablePerRay,
    };
    let single_nm = f64::from(bytes.f32()?);
    bytes.skip(8)?;
    let tables = bytes.whole("the number of spectral tables", (0, 10_000))?;
    let items = bytes.whole("the number of additional columns", (0, 1000))? as usize;
    let text_bytes = bytes.whole("the size of the additional text", (0, 1 << 28))?;
    bytes.skip(168)?;
    let columns = columns(bytes, items)?;
    // Nine descriptions of 1000 characters.
    bytes.skip(9 * 4000)?;
    let tables = spectral_tables(bytes, tables)?;
    bytes.skip(512 * items as u64 + text_bytes as u64)?;
    bytes.check_records(count, columns.numbers)?;
    let unit = if columns.watts.is_some() { FluxUnit::Watt } else { FluxUnit::Lumen };
    let mut notes = Vec::new();
    notes.extend(columns.has_unused.then(|| "the polarisation or the colours of single rays are not used".to_owned()));
    let of_all = |bytes: &mut Bytes<R>, spectrum: RaySpectrum| -> Result<Vec<RayGroup>> {
        Ok(vec![RayGroup { spectrum, rays: rays(bytes, count, &columns)? }])
    };
    let groups = match kind {
        SpectrumKind::Unknown => of_all(bytes, RaySpectrum::Unknown)?,
        SpectrumKind::SingleWavelength => {
            let nm = checked_wavelength(single_nm, "nm", || "the wavelength".to_owned())?;
            of_all(bytes, RaySpectrum::Line(nm))?
        }
        SpectrumKind::OneTable => {
            let table = tables.into_iter().next();
            let table = table.ok_or_else(|| Error::input("no spectral table").expected("the table of all rays"))?;
            of_all(bytes, RaySpectrum::Table(table))?
        }
        SpectrumKind::WavelengthPerRay => {
            let mut found = Vec::with_capacity(count as usize);
            let column = columns.wavelength.ok_or_else(|| missing("wavelength"))?;
            each_ray(bytes, count, &columns, |number, ray, values| {
                let whose = || format!("ray {}: its wavelength", number + 1);
                let nm = checked_wavelength(f64::from(values[column]), "nm", whose)?;
                found.push((nm, ray));
                Ok(())
            })?;
            wavelengths::groups(found)
        }
        SpectrumKind::TablePerRay => {
            let column = columns.table.ok_or_else(|| missing("index of the spectrum"))?;
            let spectra = tables.into_iter().map(RaySpectrum::Table);
            let mut groups: Vec<RayGroup> = spectra.map(|spectrum| RayGroup { spectrum, rays: Vec::new() }).collect();
            each_ray(bytes, count, &columns, |number, ray, values| {
                let index = values[column];
                let known = index.fract() == 0.0 && index >= 1.0 && index <= groups.len() as f32;
                if !known {
                    let what = format!("ray {}: the index of its spectrum is {index}", number + 1);
                    return Err(Error::input(what).expected(format!("a whole number from 1 to {}", groups.len())));
                }
                groups[index as usize - 1].rays.push(ray);
                Ok(())
            })?;
            groups.retain(|group| !group.rays.is_empty());
            groups
        }
    };
    Ok(RayFile { unit, groups, notes })
}

fn missing(column: &str) -> Error {
    Error::input(format!("the rays have no {column}")).expected(format!("a column with the {column} of each ray"))
}

/// Reads the flags of the columns. A record is the point and the direction, and then the columns in
/// the order of their flags, but the tristimulus values X and Z after the polarisation.
fn columns<R: BufRead>(bytes: &mut Bytes<R>, items: usize) -> Result<Columns> {
    for what in ["the flag of points", "the flag of directions"] {
        bytes.whole(what, (1, 1))?;
    }
    let mut flag = |what: &str| bytes.whole(&format!("the flag of {what}"), (0, 1)).map(|flag| flag == 1);
    let mut numbers = 6;
    let mut column = |is_there: bool, width: usize| {
        let first = numbers;
        numbers += if is_there { width } else { 0 };
        is_there.then_some(first)
    };
    let watts = column(flag("radiant flux")?, 1);
    let wavelength = column(flag("wavelengths")?, 1);
    let lumens = column(flag("luminous flux")?, 1);
    // Three Stokes parameters and the axis of the ellipse.
    let stokes = column(flag("Stokes vectors")?, 6);
    let tristimulus = column(flag("tristimulus values")?, 2);
    let table = column(flag("spectrum indices")?, 1);
    if watts.is_none() && lumens.is_none() {
        return Err(missing("flux"));
    }
    let has_unused = stokes.is_some() || tristimulus.is_some();
    Ok(Columns { numbers: numbers + items, watts, lumens, wavelength, table, has_unused })
}

/// Reads spectral tables, which end at a multiple of 32 bytes.
fn spectral_tables<R: BufRead>(bytes: &mut Bytes<R>, count: i32) -> Result<Vec<Vec<(f64, f64)>>> {
    let mut tables = Vec::new();
    let before = bytes.left();
    for number in 1..=count {
        let points = bytes.whole("the number of wavelengths of a spectrum", (1, 1_000_000))?;
        let mut table = Vec::new();
        for _ in 0..points {
            let (nm, value) = (f64::from(bytes.f32()?), f64::from(bytes.f32()?));
            let ascends = table.last().is_none_or(|&(last, _)| nm > last);
            if !(nm > 0.0 && nm.is_finite() && ascends && value >= 0.0 && value.is_finite()) {
                let what = format!("spectrum {number}: the value {value} at {nm} nm");
                return Err(Error::input(what).expected("wavelengths that ascend, and values of at least 0"));
            }
            table.push((nm, value));
        }
        tables.push(table);
    }
    bytes.skip((before - bytes.left()).next_multiple_of(32) - (before - bytes.left()))?;
    Ok(tables)
}

fn rays<R: BufRead>(bytes: &mut Bytes<R>, count: u64, columns: &Columns) -> Result<Vec<EmittedRay>> {
    let mut rays = Vec::with_capacity(count as usize);
    each_ray(bytes, count, columns, |_, ray, _| {
        rays.push(ray);
        Ok(())
    })?;
    Ok(rays)
}

/// Reads the rays, and calls `visit` with the number of each from 0, the ray and its columns.
fn each_ray<R: BufRead>(
    bytes: &mut Bytes<R>,
    count: u64,
    columns: &Columns,
    mut visit: impl FnMut(u64, EmittedRay, &[f32]) -> Result<()>,
) -> Result<()> {
    let flux = columns.watts.or(columns.lumens).ok_or_else(|| missing("flux"))?;
    let (mut record, mut values) = (vec![0; 4 * columns.numbers], vec![0.0; columns.numbers]);
    for number in 0..count {
        bytes.read(&mut record)?;
        numbers(&record, &mut values);
        let [x, y, z] = [0, 1, 2].map(|column| 1e-3 * f64::from(values[column]));
        visit(number, ray(number, [x, y, z], [values[3], values[4], values[5]], values[flux])?, &values)?;
    }
    Ok(())
}
