//! CGATS text files with spectra (ISO 28178, ANSI CGATS.17), and the variants of ArgyllCMS (`.ti3`,
//! `.sp`, `.ccss`).
//!
//! A file consists of tables. Keywords come first, then the names of the columns between
//! `BEGIN_DATA_FORMAT` and `END_DATA_FORMAT`, and then one row per sample between `BEGIN_DATA` and
//! `END_DATA`. The first table with spectral columns is read.

mod columns;
mod scale;
mod table;
#[cfg(test)]
mod tests;

use super::spectrum_samples::{PlacedNumber, SpectrumSamples};
use crate::error::{Error, Result};
use columns::SpectralColumns;
use scale::Scale;
use table::{Cell, CgatsTable};

/// The largest number of samples that an error lists.
const LISTED: usize = 40;

/// The columns that name a sample, in the order in which a name is looked up.
const NAME_COLUMNS: [&str; 3] = ["SAMPLEID", "SAMPLENAME", "SAMPLELOC"];

/// Returns whether a text has the form of CGATS: a word `BEGIN_DATA_FORMAT` that begins a line.
pub(super) fn is_cgats(text: &str) -> bool {
    text.lines().any(|line| line.split_whitespace().next() == Some(table::BEGIN_FORMAT))
}

/// Parses the spectrum of one sample of a CGATS file.
///
/// `sample` is the `SAMPLE_ID`, the `SAMPLE_NAME` or the `SAMPLE_LOC` of the sample. It may be
/// `None` if the file has only one sample. Columns with the names `SPECTRAL_NM380`,
/// `SPECTRAL_380`, `SPEC_380` or `nm380` contain the values at 380 nm; `SPECTRAL_PCT` and
/// `SPECTRAL_DEC` also follow a column `SPECTRAL_NM` with the wavelength. For columns `SPEC_…`,
/// the keywords `SPECTRAL_START_NM`, `SPECTRAL_END_NM` and `SPECTRAL_BANDS` give the wavelengths
/// exactly.
///
/// Reflectances and transmittances become fractions: values of columns `SPECTRAL_PCT` are divided
/// by 100, and all values by `SPECTRAL_NORM` if the file has this keyword. Otherwise the file is in
/// percent if one of its values is above 2, and `note` of the result tells which scale was found.
/// Values of emission keep their scale, apart from `SPECTRAL_NORM`. Negative noise of at most 1 %
/// of the full scale becomes 0.
///
/// # Errors
/// Returns an error with the line and the column if the file has no table with spectral columns, if
/// a row or a number is malformed, if the sample is unknown or has to be chosen, or if its values
/// are invalid.
pub fn parse(text: &str, sample: Option<&str>) -> Result<SpectrumSamples> {
    let tables = table::tables(text)?;
    let mut spectral = None;
    for table in &tables {
        if let Some(columns) = SpectralColumns::of(table)? {
            spectral = Some((table, columns));
            break;
        }
    }
    let Some((table, columns)) = spectral else { return Err(without_spectra(&tables)) };
    let row = chosen(table, sample)?;
    let scale = Scale::of(table, &columns)?;
    let mut samples: Vec<(PlacedNumber, PlacedNumber)> = Vec::new();
    for column in columns.iter() {
        let value = row[column.value];
        let nm = column.wavelength_nm(row)?;
        samples.push(((nm, value.place()), (scale.scaled(value.number()?, column.unit), value.place())));
    }
    let noise = scale.remove_noise(&mut samples);
    let mut found = SpectrumSamples::checked(&samples, scale.kind)?;
    let notes: Vec<String> = [scale.note, noise].into_iter().flatten().collect();
    found.note = (!notes.is_empty()).then(|| notes.join("; "));
    Ok(found)
}

/// Returns the row of the sample with a name, or the only row.
fn chosen<'t, 'a>(table: &'t CgatsTable<'a>, sample: Option<&str>) -> Result<&'t [Cell<'a>]> {
    let (line, column) = table.data_place;
    let Some(name) = sample else {
        return match table.rows.as_slice() {
            [] => Err(Error::input("a table without samples").expected("one row per sample").at(line, column)),
            [row] => Ok(row),
            rows => {
                let what = format!("a file with {} samples, none of which is chosen", rows.len());
                Err(Error::input(what).expected(format!("the name of a sample: {}", listed(table))).at(line, column))
            }
        };
    };
    for index in NAME_COLUMNS.iter().filter_map(|name| table.column(name)) {
        let same: Vec<_> = table.rows.iter().filter(|row| row[index].text == name).collect();
        match same[..] {
            [] => {}
            [row] => return Ok(row),
            [_, second, ..] => {
                let what = format!("{} samples with the {} \"{name}\"", same.len(), table.fields[index].text);
                let (line, column) = second[index].place();
                return Err(Error::input(what).expected("names that occur once").at(line, column));
            }
        }
    }
    let known = NAME_COLUMNS.iter().filter_map(|name| table.column(name));
    let known = known.flat_map(|index| table.rows.iter().map(move |row| row[index].text));
    let error = Error::unknown_name("sample", name, known);
    Err(error.expected(format!("the name of a sample: {}", listed(table))).at(line, column))
}

/// Lists the names of the samples, and the identifier where it differs from the name.
fn listed(table: &CgatsTable<'_>) -> String {
    let columns: Vec<usize> = NAME_COLUMNS.iter().filter_map(|name| table.column(name)).collect();
    let name = |row: &Vec<Cell<'_>>| {
        let mut names: Vec<&str> = columns.iter().map(|&column| row[column].text).collect();
        names.dedup();
        match names.split_first() {
            Some((id, [])) => (*id).to_owned(),
            Some((id, others)) => format!("{id} ({})", others.join(", ")),
            None => String::new(),
        }
    };
    if columns.is_empty() {
        return "none, because the file has no column SAMPLE_ID".to_owned();
    }
    let mut names = table.rows.iter().take(LISTED).map(name).collect::<Vec<_>>().join(", ");
    if table.rows.len() > LISTED {
        names += &format!(" and {} more", table.rows.len() - LISTED);
    }
    names
}

fn without_spectra(tables: &[CgatsTable<'_>]) -> Error {
    let fields: Vec<&str> = tables.iter().flat_map(|table| table.fields.iter().map(|field| field.text)).collect();
    let shown = fields.iter().take(LISTED).copied().collect::<Vec<_>>().join(" ");
    let place = tables.iter().flat_map(|table| table.fields.first()).next().map_or((1, 1), |field| field.place());
    let expected = "columns with a wavelength, such as SPECTRAL_NM380 or SPEC_380";
    Error::input(format!("the columns {shown}")).expected(expected).at(place.0, place.1)
}
