//! The columns of a CGATS table that contain spectral values.

use super::table::{Cell, CgatsTable};
use crate::error::{Error, Result};

/// The unit that the name of a column states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Percent,
    Fraction,
    Unknown,
}

impl Unit {
    /// Returns the unit of a column that follows a column with its wavelengths.
    pub(super) fn of_paired(name: &str) -> Option<Self> {
        match name {
            "SPECTRAL_PCT" => Some(Self::Percent),
            "SPECTRAL_DEC" => Some(Self::Fraction),
            _ => None,
        }
    }
}

/// A spectral column.
#[derive(Debug)]
pub(super) struct SpectralColumn {
    /// The index of the values in a row.
    pub(super) value: usize,
    wavelength: Wavelength,
    pub(super) unit: Unit,
}

#[derive(Debug)]
enum Wavelength {
    /// All samples have this wavelength in nm.
    Fixed(f64),
    /// The index of the wavelengths in a row.
    Column(usize),
}

impl SpectralColumn {
    /// Returns the wavelength in nm in a row, or an error if it is no number.
    pub(super) fn wavelength_nm(&self, row: &[Cell<'_>]) -> Result<f64> {
        match self.wavelength {
            Wavelength::Fixed(nm) => Ok(nm),
            Wavelength::Column(index) => row[index].number(),
        }
    }
}

/// The spectral columns of a table, at least one.
#[derive(Debug)]
pub(super) struct SpectralColumns(Vec<SpectralColumn>);

impl SpectralColumns {
    /// Finds the spectral columns of a table. Returns `None` if there are none, and an error if the
    /// keywords with the wavelengths contradict the columns.
    pub(super) fn of(table: &CgatsTable<'_>) -> Result<Option<Self>> {
        let mut columns: Vec<SpectralColumn> = Vec::new();
        let mut wavelengths = None;
        for (index, field) in table.fields.iter().enumerate() {
            let name = field.text.to_ascii_uppercase();
            if name == "SPECTRAL_NM" {
                wavelengths = Some(index);
            } else if let (Some(at), Some(unit)) = (wavelengths, Unit::of_paired(&name)) {
                columns.push(SpectralColumn { value: index, wavelength: Wavelength::Column(at), unit });
                wavelengths = None;
            } else if let Some((nm, unit)) = named(&name) {
                columns.push(SpectralColumn { value: index, wavelength: Wavelength::Fixed(nm), unit });
            }
        }
        if columns.is_empty() {
            return Ok(None);
        }
        refine(table, &mut columns)?;
        Ok(Some(Self(columns)))
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &SpectralColumn> {
        self.0.iter()
    }
}

/// Returns the wavelength in nm that the name of a column in capitals contains, and its unit.
fn named(name: &str) -> Option<(f64, Unit)> {
    const PREFIXES: [(&str, Unit); 7] = [
        ("SPECTRAL_NM", Unit::Unknown),
        ("SPECTRAL_PCT", Unit::Percent),
        ("SPECTRAL_DEC", Unit::Fraction),
        ("SPECTRAL", Unit::Unknown),
        ("SPEC", Unit::Unknown),
        ("NM", Unit::Unknown),
        ("", Unit::Unknown),
    ];
    let (rest, unit) =
        PREFIXES.iter().find_map(|(prefix, unit)| name.strip_prefix(prefix).map(|rest| (rest, *unit)))?;
    let digits = rest.trim_start_matches('_');
    let plain = digits.strip_suffix("NM").map(|digits| digits.trim_end_matches('_'));
    // A number alone is no wavelength: it needs one of the words.
    let has_word = rest.len() < name.len() || plain.is_some();
    let digits = plain.unwrap_or(digits);
    let is_number =
        digits.starts_with(|c: char| c.is_ascii_digit()) && digits.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    if !has_word || !is_number {
        return None;
    }
    digits.parse().ok().map(|nm| (nm, unit))
}

/// The largest difference in nm between a wavelength in the name of a column, which is rounded, and
/// its exact value.
const ROUNDED_NM: f64 = 1.0;

/// Replaces the rounded wavelengths of the names by the exact ones of the keywords of ArgyllCMS.
fn refine(table: &CgatsTable<'_>, columns: &mut [SpectralColumn]) -> Result<()> {
    let keywords = ["SPECTRAL_BANDS", "SPECTRAL_START_NM", "SPECTRAL_END_NM"].map(|keyword| table.value(keyword));
    let [Some(bands), Some(start), Some(end)] = keywords else { return Ok(()) };
    let [count, from, to] = [bands.number()?, start.number()?, end.number()?];
    if count != columns.len() as f64 {
        let (line, column) = bands.place();
        let what = format!("SPECTRAL_BANDS is {}", bands.text);
        let expected = format!("{}, the number of spectral columns", columns.len());
        return Err(Error::input(what).expected(expected).at(line, column));
    }
    for (index, column) in columns.iter_mut().enumerate() {
        let Wavelength::Fixed(nm) = &mut column.wavelength else { continue };
        let exact = if count > 1.0 { from + index as f64 * (to - from) / (count - 1.0) } else { from };
        if (exact - *nm).abs() > ROUNDED_NM {
            let field = table.fields[column.value];
            let (line, column) = field.place();
            let what = format!("the column {}", field.text);
            let expected = format!("the wavelength {exact} nm, by SPECTRAL_START_NM and SPECTRAL_END_NM");
            return Err(Error::input(what).expected(expected).at(line, column));
        }
        *nm = exact;
    }
    Ok(())
}
