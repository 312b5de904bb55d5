//! Reading measured bispectral matrices (Donaldson matrices) from files.

use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::without_byte_order_mark;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// For excitation and for emission.
const MOST_WAVELENGTHS: usize = 500;

const MOST_BYTES: u64 = 1 << 23;

/// A bispectral matrix of a fluorescent surface, without the light that keeps its wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct DonaldsonMatrix {
    /// Of the arriving light in nm, ascending.
    pub excitation_nm: Vec<f64>,
    /// Of the emitted light in nm, ascending.
    pub emission_nm: Vec<f64>,
    /// For each excitation wavelength, the bispectral luminescent radiance factor at each emission
    /// wavelength: the emitted power per nm, divided by the arriving power.
    pub factors: Vec<Vec<f64>>,
}

impl DonaldsonMatrix {
    /// Reads a file of comma-separated values. The first row contains an ignored cell and the
    /// excitation wavelengths; each other row an emission wavelength and a factor for each
    /// excitation wavelength. Lines that begin with `#` are comments. Returns an error with the
    /// file, and the line and column of the cell, if the file cannot be read, is too large, or has
    /// a malformed cell.
    pub fn read(path: &Path) -> Result<Self> {
        let cannot = |error: std::io::Error| Error::input(format!("cannot read the matrix: {error}")).in_file(path);
        let mut bytes = Vec::new();
        File::open(path).and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes)).map_err(cannot)?;
        if bytes.len() as u64 > MOST_BYTES {
            let error = Error::input("a matrix of more than 8 MiB");
            return Err(error.expected("a smaller file").in_file(path));
        }
        let text = String::from_utf8_lossy(&bytes);
        Self::parse(without_byte_order_mark(&text)).map_err(|error| error.in_file(path))
    }

    fn parse(text: &str) -> Result<Self> {
        let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line));
        let mut rows = lines.filter(|(_, line)| !(line.trim().is_empty() || line.starts_with('#')));
        let Some((header_line, header)) = rows.next() else {
            return Err(Error::input("an empty file").expected("a row of excitation wavelengths"));
        };
        let excitation_nm: Vec<f64> =
            cells(header).skip(1).map(|(column, cell)| number(header_line, column, cell)).collect::<Result<_>>()?;
        check_wavelengths("excitation", &excitation_nm, header_line)?;
        let (mut emission_nm, mut last_line) = (Vec::new(), header_line);
        let mut factors = vec![Vec::new(); excitation_nm.len()];
        for (line, row) in rows {
            last_line = line;
            let values: Vec<f64> =
                cells(row).map(|(column, cell)| number(line, column, cell)).collect::<Result<_>>()?;
            if values.len() != excitation_nm.len() + 1 {
                let expected = format!("{} cells, as in the first row", excitation_nm.len() + 1);
                return Err(Error::input(format!("a row of {} cells", values.len())).expected(expected).at(line, 1));
            }
            emission_nm.push(values[0]);
            factors.iter_mut().zip(&values[1..]).for_each(|(column, value)| column.push(*value));
        }
        check_wavelengths("emission", &emission_nm, last_line)?;
        Ok(Self { excitation_nm, emission_nm, factors })
    }
}

fn cells(row: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut column = 1;
    row.split(',').map(move |cell| {
        let start = column;
        column += cell.chars().count() + 1;
        (start, cell.trim())
    })
}

fn number(line: usize, column: usize, cell: &str) -> Result<f64> {
    let value = cell.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
    value
        .ok_or_else(|| Error::input(format!("the cell \"{cell}\"")).expected("a number of at least 0").at(line, column))
}

/// Checks the number and the order of wavelengths, for errors in the line `line`.
fn check_wavelengths(kind: &str, nm: &[f64], line: usize) -> Result<()> {
    let fault = if nm.len() < 2 || nm.len() > MOST_WAVELENGTHS {
        format!("{} {kind} wavelengths", nm.len())
    } else if let Some(pair) = nm.windows(2).find(|pair| pair[1] <= pair[0]) {
        format!("the {kind} wavelength {} nm after {} nm", pair[1], pair[0])
    } else if nm[0] < 100.0 || nm[nm.len() - 1] > 10_000.0 {
        format!("{kind} wavelengths from {} to {} nm", nm[0], nm[nm.len() - 1])
    } else {
        return Ok(());
    };
    let expected = format!("2 to {MOST_WAVELENGTHS} ascending wavelengths in nm");
    Err(Error::input(fault).expected(expected).at(line, 1))
}
