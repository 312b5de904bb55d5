//! Text files with two columns of numbers and various separators.

use super::spectrum_samples::SpectrumSamples;
use crate::error::{Error, Result};

/// The separator of the cells of a row, and the decimal sign of the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ColumnFormat {
    separator: Separator,
    decimal_comma: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Separator {
    Character(char),
    /// The separator is any number of blanks.
    Blank,
}

/// The formats of a row, in the order in which the parser tries them.
const FORMATS: [ColumnFormat; 8] = [
    ColumnFormat { separator: Separator::Character(';'), decimal_comma: false },
    ColumnFormat { separator: Separator::Character('\t'), decimal_comma: false },
    ColumnFormat { separator: Separator::Character('|'), decimal_comma: false },
    ColumnFormat { separator: Separator::Character(','), decimal_comma: false },
    ColumnFormat { separator: Separator::Blank, decimal_comma: false },
    ColumnFormat { separator: Separator::Character(';'), decimal_comma: true },
    ColumnFormat { separator: Separator::Character('\t'), decimal_comma: true },
    ColumnFormat { separator: Separator::Blank, decimal_comma: true },
];

/// A cell and the column of its first character, from 1.
type TextCell<'a> = (usize, &'a str);

impl ColumnFormat {
    /// Returns the format of a row of two or more numbers, or `None` if the row has another form.
    pub fn of(row: &str) -> Option<Self> {
        FORMATS.into_iter().find(|format| format.fits(row))
    }

    /// Returns the numbers of a row, or the first cell that is no number.
    ///
    /// # Errors
    /// Returns the text of this cell.
    pub fn numbers(self, row: &str) -> std::result::Result<Vec<f64>, String> {
        self.cells(row).into_iter().map(|(_, cell)| self.number(cell).ok_or_else(|| cell.to_owned())).collect()
    }

    /// Returns the titles of a header row. If blanks separate the numbers, titles are words.
    pub fn titles(self, row: &str) -> Vec<String> {
        self.cells(row).into_iter().map(|(_, cell)| cell.trim_matches('"').trim().to_owned()).collect()
    }

    fn cells(self, row: &str) -> Vec<TextCell<'_>> {
        let mut cells: Vec<TextCell<'_>> = match self.separator {
            Separator::Character(separator) => pieces(row, |c| c == separator).collect(),
            Separator::Blank => pieces(row, char::is_whitespace).filter(|(_, cell)| !cell.is_empty()).collect(),
        };
        // A separator at the end of a row does not begin another cell.
        if cells.len() > 1 && cells.last().is_some_and(|(_, cell)| cell.is_empty()) {
            cells.pop();
        }
        cells
    }

    fn number(self, cell: &str) -> Option<f64> {
        let cell = cell.trim_matches('"').trim();
        // Rust also parses "inf" and "nan", which are reported later as invalid values.
        if self.decimal_comma { cell.replace(',', ".").parse().ok() } else { cell.parse().ok() }
    }

    /// Returns true if the row consists of two or more numbers in this format.
    fn fits(self, row: &str) -> bool {
        let cells = self.cells(row);
        cells.len() >= 2 && cells.iter().all(|(_, cell)| self.number(cell).is_some())
    }
}

fn pieces(row: &str, is_separator: impl Fn(char) -> bool + Copy) -> impl Iterator<Item = TextCell<'_>> {
    let mut start = 0;
    row.split(is_separator).map(move |cell| {
        let begins = start + (cell.len() - cell.trim_start().len());
        start += cell.len() + row[start + cell.len()..].chars().next().map_or(0, char::len_utf8);
        (row[..begins].chars().count() + 1, cell.trim())
    })
}

/// Parses rows of wavelength and value. Returns an error with the line and the column if a row does
/// not consist of two numbers, or if a sample is invalid.
///
/// The separator of the cells is a semicolon, tab, bar, comma or blanks. Numbers may have a decimal
/// comma, unless the separator is a comma. Empty rows and rows that begin with `#`, `%` or `//` are
/// skipped. One header row may come first; if its first title contains µm (or um), the wavelengths
/// are in µm, otherwise in nm.
pub fn parse(text: &str) -> Result<SpectrumSamples> {
    let rows = text
        .lines()
        .enumerate()
        .map(|(i, row)| (i + 1, row))
        .filter(|(_, row)| !row.trim().is_empty())
        .filter(|(_, row)| !["#", "%", "//"].iter().any(|mark| row.trim_start().starts_with(mark)));
    let mut format = None;
    let mut nm_per_unit = None;
    let mut samples = Vec::new();
    for (line, row) in rows {
        let known = format.or_else(|| ColumnFormat::of(row));
        let Some(known) = known else {
            if nm_per_unit.is_some() {
                return Err(not_two_numbers(row).at(line, 1));
            }
            nm_per_unit = Some(unit_of_header(row));
            continue;
        };
        format = Some(known);
        let cells = known.cells(row);
        let [(nm_column, nm), (value_column, value)] = cells[..] else {
            let what = format!("a row with {} cells", cells.len());
            return Err(Error::input(what).expected("two columns: wavelength and value").at(line, 1));
        };
        let number = |column: usize, cell: &str| {
            known.number(cell).ok_or_else(|| Error::input(format!("\"{cell}\"")).expected("a number").at(line, column))
        };
        let nm = number(nm_column, nm)?;
        // Rounded to 10⁻⁹ nm, far below the width of any line: 0.5005 µm is exactly 500.5 nm.
        let nm = nm_per_unit.filter(|unit| *unit != 1.0).map_or(nm, |unit| (nm * unit * 1e9).round() / 1e9);
        samples.push(((nm, (line, nm_column)), (number(value_column, value)?, (line, value_column))));
    }
    SpectrumSamples::checked(&samples, None)
}

fn not_two_numbers(row: &str) -> Error {
    let shown: String = row.trim().chars().take(40).collect();
    Error::input(format!("the row \"{shown}\"")).expected("two numbers: wavelength and value")
}

/// Returns the factor from the unit that a word in the title of the first column names to nm.
fn unit_of_header(row: &str) -> f64 {
    let first = row.split([';', '\t', '|', ',']).next().unwrap_or(row);
    nm_per_unit(first).unwrap_or(1.0)
}

/// Returns the factor from the unit of length that a title names to nm, such as 1000 for
/// "Wavelength (µm)", or `None` if it names no unit.
pub fn nm_per_unit(title: &str) -> Option<f64> {
    // µ has two code points, and in another encoding, it is the replacement character.
    const MICRO: [&str; 10] =
        ["um", "µm", "μm", "\u{fffd}m", "micron", "microns", "micrometer", "micrometre", "micrometers", "micrometres"];
    const NANO: [&str; 5] = ["nm", "nanometer", "nanometre", "nanometers", "nanometres"];
    let title = title.to_lowercase();
    let mut words = title.split(|c: char| !(c.is_alphabetic() || c == '\u{fffd}'));
    words.find_map(|word| match word {
        micro if MICRO.contains(&micro) => Some(1000.0),
        nano if NANO.contains(&nano) => Some(1.0),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> (Vec<f64>, Vec<f64>) {
        let samples = parse(text).unwrap();
        (samples.nm, samples.values)
    }

    #[test]
    fn all_notations_of_two_columns_are_read() {
        let expected = (vec![400.0, 500.5], vec![0.25, 1.0]);
        for text in [
            "400,0.25\n500.5,1\n",
            "wavelength_nm,value\r\n400,0.25\r\n500.5,1\r\n",
            "# a comment\nnm;W\n\n400;0,25\n500,5;1,0\n",
            "400\t0.25\n500.5\t1\t\n",
            "  400   2.5e-1\n  500.5 1",
            "400 | 0.25\n500.5|1",
            "400,0 0,25\n500,5 1,0\n",
            "\"400\", \"0.25\"\n\"500.5\", \"1\"\n",
            "Wavelength (µm), power\n0.4, 0.25\n0.5005, 1\n",
            "lambda_um luminance\n0.4 0.25\n0.5005 1\n",
        ] {
            assert_eq!(of(text), expected, "{text}");
        }
        // The word "spectrum" contains "um", but it does not name a unit.
        assert_eq!(of("spectrum nm,value\n400,0.25\n500.5,1\n"), expected);
    }

    #[test]
    fn errors_name_line_and_column() {
        for (text, place, word) in [
            ("400,1\n390,1\n", (2, 1), "ascending"),
            ("nm,W\n400,1\n\n400,2\n", (4, 1), "twice"),
            ("400,1\n500,-1\n", (2, 1), "negative"),
            ("400,1\n500,nan\n", (2, 1), "NaN"),
            ("400,1\n500,inf\n", (2, 1), "inf"),
            ("400,1\n  500, red\n", (2, 8), "\"red\""),
            ("400,1,2\n", (1, 1), "3 cells"),
            ("400,1\n500\n", (2, 1), "1 cells"),
            ("nm,W\nsecond header\n400,1\n", (2, 1), "second header"),
            ("0.4,1\n0.5,1\n", (1, 1), "µm"),
            ("900,1\n1000,1\n", (1, 1), "band"),
            ("1,1\n400,1\n", (1, 1), "wavelengths from 10"),
        ] {
            let error = parse(text).unwrap_err();
            assert_eq!(error.location.line_column, Some(place), "{text}: {error}");
            assert!(error.to_string().contains(word), "{text}: {error}");
        }
        assert!(parse("").unwrap_err().to_string().contains("no samples"));
        assert!(parse("nm,W\n").unwrap_err().to_string().contains("no samples"));
    }
}
