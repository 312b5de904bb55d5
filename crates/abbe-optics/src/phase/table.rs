//! Phase functions that are tabulated over angles and wavelengths, measured or computed from
//! particle sizes.
//!
//! The table is linear in cos θ between angles and linear in λ between wavelengths, and held beyond
//! the first and the last column, so it is a mixture of columns, each of which is integrated,
//! normalised and sampled exactly.
//!
//! Angles are stored as the versine 1 − cos θ, in [0, 2], which keeps full precision near the
//! forward peak.

use crate::glass::RefractiveIndex;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::math::elementary::{asin, sin};
use abbe_spectra::text::without_byte_order_mark;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Number of steps of the guide table, which finds the cell of an angle, per cell.
const GUIDE_STEPS: usize = 2;

/// A phase function over angles and wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseTable {
    /// Wavelengths in nm, ascending.
    nm: Vec<f64>,
    /// 1 − cos θ of the angles, ascending from 0 to 2.
    versines: Vec<f64>,
    columns: Vec<PhaseColumn>,
    /// The first cell that overlaps each equal step of sin(θ/2), and the last cell.
    guide: Vec<u32>,
    /// Computes the polarisation of each column, if it is known.
    spheres: Option<Spheres>,
    /// The ratios of the columns at each angle, once they are needed.
    ratios: OnceLock<Vec<Vec<[f32; 3]>>>,
}

/// The spheres of a table, whose polarisation can be computed.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Spheres {
    /// Pairs of a radius in µm and its fraction, and the refractive index, for the series of Mie.
    Mie(Vec<(f64, f64)>, RefractiveIndex),
    /// Drops of rain, for geometrical optics.
    Rain,
}

#[derive(Debug, Clone, PartialEq)]
struct PhaseColumn {
    /// Per steradian, at each angle.
    pdf_per_sr: Vec<f64>,
    /// Between two angles.
    cells: DiscreteDistribution,
    mean_cosine: f64,
}

impl PhaseTable {
    /// Creates a table from angles in degrees, ascending from 0 to 180, ascending wavelengths in
    /// nm, and one list of values, at any scale, per wavelength. Returns an error if angles or
    /// wavelengths do not ascend, the angles do not cover 0 to 180, lists have different lengths, a
    /// value is negative or not finite, or all values of a wavelength are 0.
    pub fn new(angles_deg: &[f64], nm: &[f64], values: &[Vec<f64>]) -> Result<Self> {
        check_angles(angles_deg)?;
        check_wavelengths(nm, values.len())?;
        let versine = |degrees: f64| 2.0 * sin((0.5 * degrees).to_radians()).powi(2);
        let versines: Vec<f64> = angles_deg.iter().map(|&degrees| versine(degrees)).collect();
        if let Some(i) = (1..versines.len()).find(|&i| versines[i] <= versines[i - 1]) {
            let what = format!("the angles {} and {}°, too near to each other", angles_deg[i - 1], angles_deg[i]);
            return Err(Error::input(what).expected("angles whose cosines differ"));
        }
        let columns: Result<Vec<PhaseColumn>> =
            nm.iter().zip(values).map(|(nm, values)| PhaseColumn::new(*nm, angles_deg, &versines, values)).collect();
        let guide = guide(&versines);
        let (nm, columns) = (nm.to_vec(), columns?);
        Ok(Self { nm, versines, columns, guide, spheres: None, ratios: OnceLock::new() })
    }

    /// Sets the spheres that scatter like this table.
    #[must_use]
    pub(super) fn of_spheres(self, spheres: Spheres) -> Self {
        Self { spheres: Some(spheres), ..self }
    }

    pub(super) fn has_polarisation(&self) -> bool {
        self.spheres.is_some()
    }

    /// Returns the elements S12, S33 and S34 of the phase matrix in the notation of Bohren &
    /// Huffman, divided by S11, or `None` if they are unknown. The first call asks `ratios` for those
    /// of the spheres at each wavelength in nm and at angles in degrees.
    pub(super) fn polarisation(
        &self,
        cos_theta: f64,
        nm: f64,
        ratios: impl Fn(&Spheres, f64, &[f64]) -> Vec<[f32; 3]>,
    ) -> Option<[f64; 3]> {
        let spheres = self.spheres.as_ref()?;
        let ratios = self.ratios.get_or_init(|| {
            let degrees = |versine: &f64| 2.0 * asin((0.5 * versine).sqrt().min(1.0)).to_degrees();
            let angles: Vec<f64> = self.versines.iter().map(degrees).collect();
            self.nm.iter().map(|&nm| ratios(spheres, nm, &angles)).collect()
        });
        let versine = (1.0 - cos_theta).clamp(0.0, 2.0);
        let cell = self.cell(versine);
        let (from, to) = (self.versines[cell], self.versines[cell + 1]);
        let t = (versine - from) / (to - from);
        let (first, weight) = self.column(nm);
        let mixed = |column: usize, i: usize| {
            let [from, to] = [0, 1].map(|next| f64::from(ratios[column][cell + next][i]));
            from + t * (to - from)
        };
        Some(std::array::from_fn(|i| {
            let value = mixed(first, i);
            if weight == 0.0 { value } else { value + weight * (mixed(first + 1, i) - value) }
        }))
    }

    pub(super) fn depends_on_wavelength(&self) -> bool {
        self.columns.iter().any(|column| column.pdf_per_sr != self.columns[0].pdf_per_sr)
    }

    /// Returns the pdf per steradian.
    pub(super) fn eval(&self, cos_theta: f64, nm: f64) -> f64 {
        let versine = (1.0 - cos_theta).clamp(0.0, 2.0);
        let cell = self.cell(versine);
        let (from, to) = (self.versines[cell], self.versines[cell + 1]);
        let t = (versine - from) / (to - from);
        self.interpolated(nm, |column| (1.0 - t) * column.pdf_per_sr[cell] + t * column.pdf_per_sr[cell + 1])
    }

    /// Samples the versine by a random number `u` in [0, 1), which selects one of the two columns
    /// next to the wavelength, and is then rescaled for the quantile of that column.
    pub(super) fn quantile(&self, nm: f64, mut u: f64) -> f64 {
        let (first, weight) = self.column(nm);
        let column = if u < weight {
            u /= weight;
            &self.columns[first + 1]
        } else {
            u = (u - weight) / (1.0 - weight);
            &self.columns[first]
        };
        let cell = column.cells.sample(&mut u);
        let (from, to) = (column.pdf_per_sr[cell], column.pdf_per_sr[cell + 1]);
        // The quantile of a linear pdf within a cell, without cancellation.
        let t = u * (from + to) / (from + (from * from + u * (to - from) * (to + from)).max(0.0).sqrt());
        let t = if t.is_finite() { t.min(1.0) } else { 0.0 };
        self.versines[cell] + t * (self.versines[cell + 1] - self.versines[cell])
    }

    pub(super) fn mean_cosine(&self, nm: f64) -> f64 {
        self.interpolated(nm, |column| column.mean_cosine)
    }

    fn interpolated(&self, nm: f64, of: impl Fn(&PhaseColumn) -> f64) -> f64 {
        let (first, weight) = self.column(nm);
        let value = of(&self.columns[first]);
        if weight == 0.0 { value } else { value + weight * (of(&self.columns[first + 1]) - value) }
    }

    /// Returns the index of the column below a wavelength, and the weight of the next column.
    fn column(&self, nm: f64) -> (usize, f64) {
        let last = self.nm.len() - 1;
        let after = self.nm.partition_point(|&known| known <= nm);
        if after == 0 || after > last {
            return (after.min(last), 0.0);
        }
        let (from, to) = (self.nm[after - 1], self.nm[after]);
        (after - 1, (nm - from) / (to - from))
    }

    fn cell(&self, versine: f64) -> usize {
        let steps = self.guide.len() - 1;
        let step = (((0.5 * versine).sqrt() * steps as f64) as usize).min(steps - 1);
        let (first, last) = (self.guide[step] as usize, self.guide[step + 1] as usize);
        first + self.versines[first + 1..=last].partition_point(|&known| known <= versine)
    }
}

impl PhaseColumn {
    fn new(nm: f64, angles_deg: &[f64], versines: &[f64], values: &[f64]) -> Result<Self> {
        if values.len() != versines.len() {
            let what = format!("{} values at {nm} nm for {} angles", values.len(), versines.len());
            return Err(Error::input(what).expected("a value for each angle"));
        }
        if let Some(i) = values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
            let what = format!("the value {} at {}° and {nm} nm", values[i], angles_deg[i]);
            return Err(Error::input(what).expected("a finite number of at least 0"));
        }
        let cells = |i: usize| (versines[i + 1] - versines[i], values[i], values[i + 1]);
        let count = versines.len() - 1;
        let masses: Vec<f64> = (0..count).map(cells).map(|(width, from, to)| TAU * width * 0.5 * (from + to)).collect();
        let total: f64 = masses.iter().sum();
        let nothing = || Error::input(format!("no scattering at all at {nm} nm")).expected("some value above 0");
        let distribution = DiscreteDistribution::new(masses).filter(|_| total.is_finite()).ok_or_else(nothing)?;
        let first_moment = |i: usize| {
            let (width, from, to) = cells(i);
            TAU * width * (versines[i] * (2.0 * from + to) + versines[i + 1] * (from + 2.0 * to)) / 6.0
        };
        let mean_cosine = 1.0 - (0..count).map(first_moment).sum::<f64>() / total;
        let pdf_per_sr = values.iter().map(|value| value / total).collect();
        Ok(Self { pdf_per_sr, cells: distribution, mean_cosine })
    }
}

/// Computes [`PhaseTable::guide`].
fn guide(versines: &[f64]) -> Vec<u32> {
    let cells = versines.len() - 1;
    let steps = GUIDE_STEPS * cells;
    // Steps are widened slightly, because the square root in `cell` is rounded.
    let versine = |step: f64| 2.0 * (step / steps as f64).powi(2);
    let cell_of = |versine: f64| versines.partition_point(|&known| known <= versine).clamp(1, cells) - 1;
    let mut guide: Vec<u32> = (0..steps).map(|step| cell_of(versine(step as f64) * (1.0 - 1e-12)) as u32).collect();
    guide.push(cells as u32 - 1);
    guide
}

fn check_angles(degrees: &[f64]) -> Result<()> {
    if let Some(pair) = degrees.windows(2).find(|pair| pair[0] >= pair[1] || pair[1].is_nan()) {
        let what = format!("the angle {}° after {}°", pair[1], pair[0]);
        return Err(Error::input(what).expected("ascending angles"));
    }
    let whole = |first: f64, last: f64| first.abs() < 1e-9 && (last - 180.0).abs() < 1e-9;
    match degrees {
        [first, .., last] if whole(*first, *last) => Ok(()),
        [first, .., last] => {
            let what = format!("angles from {first} to {last}°");
            Err(Error::input(what).expected("angles from 0 (forward) to 180° (backward)"))
        }
        [] | [_] => Err(Error::input(format!("{} angles", degrees.len())).expected("angles from 0 to 180°")),
    }
}

fn check_wavelengths(nm: &[f64], columns: usize) -> Result<()> {
    if nm.is_empty() || nm.len() != columns {
        let what = format!("{} wavelengths and {columns} columns of values", nm.len());
        return Err(Error::input(what).expected("a column of values for each wavelength, and at least one"));
    }
    if let Some(nm) = nm.iter().find(|nm| !(nm.is_finite() && **nm > 0.0)) {
        return Err(Error::input(format!("the wavelength {nm}")).expected("a positive number of nm"));
    }
    match nm.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => {
            let what = format!("the wavelength {} nm after {} nm", pair[1], pair[0]);
            Err(Error::input(what).expected("ascending wavelengths"))
        }
        None => Ok(()),
    }
}

/// Parses a table of comma-separated values.
///
/// The first line is a header: an ignored title, and for each other column its wavelength in nm
/// (`p_550nm_per_sr` or `550`), which a single column, valid at all wavelengths, does not need.
/// Each further line contains an angle in degrees and the values. Empty lines and lines that start
/// with `#` are skipped.
///
/// Returns an error, with the line number for the text of a line, if a cell is not a number, a row
/// has the wrong number of cells, or [`PhaseTable::new`] rejects the values.
pub fn parse(text: &str) -> Result<PhaseTable> {
    let mut rows = without_byte_order_mark(text)
        .lines()
        .enumerate()
        .map(|(i, row)| (i + 1, row.trim()))
        .filter(|(_, row)| !row.is_empty() && !row.starts_with('#'));
    let Some((line, header)) = rows.next() else {
        return Err(Error::input("an empty file").expected("a header line and a row for each angle"));
    };
    let titles: Vec<&str> = header.split(',').skip(1).collect();
    let nm = wavelengths(&titles).map_err(|error| error.at(line, 1))?;
    let (mut angles, mut values) = (Vec::new(), vec![Vec::new(); nm.len()]);
    for (line, row) in rows {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if cells.len() != nm.len() + 1 {
            let what = format!("a row of {} cells", cells.len());
            return Err(Error::input(what).expected(format!("{} cells, as in the header", nm.len() + 1)).at(line, 1));
        }
        let number = |cell: &str| -> Result<f64> {
            cell.parse().map_err(|_| Error::input(format!("\"{cell}\"")).expected("a number").at(line, 1))
        };
        angles.push(number(cells[0])?);
        for (column, cell) in values.iter_mut().zip(&cells[1..]) {
            column.push(number(cell)?);
        }
    }
    PhaseTable::new(&angles, &nm, &values)
}

fn wavelengths(titles: &[&str]) -> Result<Vec<f64>> {
    let number = |title: &str| -> Option<f64> {
        let start = title.find(|c: char| c.is_ascii_digit())?;
        let rest = &title[start..];
        let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(rest.len());
        rest[..end].parse().ok()
    };
    match titles {
        [] => Err(Error::input("a table of one column").expected("the angle and at least one column of values")),
        [only] => Ok(vec![number(only).unwrap_or(SINGLE_COLUMN_NM)]),
        _ => titles
            .iter()
            .map(|title| {
                number(title).ok_or_else(|| {
                    Error::input(format!("the title \"{}\"", title.trim())).expected("the column's wavelength in nm")
                })
            })
            .collect(),
    }
}

/// Wavelength in nm, without effect, of a single column whose title contains none.
const SINGLE_COLUMN_NM: f64 = 550.0;

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const FORM: &str = "angle_deg,p_400nm_per_sr,p_700nm_per_sr\n0,3,1\n90,1,1\n180,0,1\n";

    #[test]
    fn table_interpolates_wavelengths_and_holds_its_ends() {
        let table = parse(FORM).unwrap();
        // The integral is 2π (2 + 0.5) for the first column and 4π for the second.
        let first = |p: f64| p / (5.0 * PI);
        assert!((table.eval(1.0, 380.0) - first(3.0)).abs() < 1e-15);
        assert!((table.eval(0.5, 400.0) - first(2.0)).abs() < 1e-15);
        assert!((table.eval(-1.0, 700.0) - 0.25 / PI).abs() < 1e-15);
        assert!((table.eval(0.0, 550.0) - 0.5 * (first(1.0) + 0.25 / PI)).abs() < 1e-15);
        // ∫ cos θ p dω of the first column is 2π (∫₀¹ μ(1 + 2μ) dμ + ∫₋₁⁰ μ(1 + μ) dμ) / 5π.
        assert!((table.mean_cosine(400.0) - 2.0 * (7.0 / 6.0 - 1.0 / 6.0) / 5.0).abs() < 1e-15);
        assert!(table.depends_on_wavelength());
        assert!(!parse("angle,p\n0,1\n180,2\n").unwrap().depends_on_wavelength());
    }

    #[test]
    fn malformed_tables_give_specific_errors() {
        for (text, words) in [
            ("", "an empty file"),
            ("angle\n0\n180\n", "a table of one column"),
            ("angle,red,blue\n0,1,1\n180,1,1\n", "the title \"red\"; expected the column's wavelength in nm"),
            ("angle,400,500\n0,1,1\n180,1\n", "line 3, column 1: a row of 2 cells; expected 3 cells"),
            ("angle,400\n0,1\n90,x\n180,1\n", "line 3, column 1: \"x\"; expected a number"),
            ("angle,400\n0,1\n90,-1\n180,1\n", "the value -1 at 90° and 400 nm"),
            ("angle,400\n0,1\n90,nan\n180,1\n", "the value NaN at 90° and 400 nm"),
            ("angle,400\n0,1\n90,inf\n180,1\n", "the value inf at 90° and 400 nm"),
            ("angle,400\n0,0\n180,0\n", "no scattering at all at 400 nm"),
            ("angle,400\n0,1\n90,1\n", "angles from 0 to 90°"),
            ("angle,400\n10,1\n180,1\n", "angles from 10 to 180°"),
            ("angle,400\n0,1\n90,1\n90,1\n180,1\n", "the angle 90° after 90°"),
            ("angle,400\n0,1\nnan,1\n180,1\n", "the angle NaN° after 0°"),
            ("angle,400\n0,1\n", "1 angles"),
            ("angle,500,400\n0,1,1\n180,1,1\n", "the wavelength 400 nm after 500 nm"),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(words), "{text:?}: {error}");
        }
    }
}
