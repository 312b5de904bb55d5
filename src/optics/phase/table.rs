//! A phase function known at angles and wavelengths: measured, or computed from the particles' size.
//!
//! Between its angles it is linear in cos θ, between its wavelengths linear in λ, beyond the first and last wavelength it keeps
//! its values. So it is a mix of columns, each of which integrates exactly, is normalised exactly and is drawn from exactly.

use crate::error::{Error, Result};
use crate::math::distribution::Discrete;
use std::f64::consts::TAU;

/// Steps of the guide that finds an angle's cell, for each cell.
const GUIDE_STEPS: usize = 2;

/// A phase function at angles × wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseTable {
    /// Wavelengths in nm, ascending.
    nm: Vec<f64>,
    /// 1 − cos θ at the angles, ascending from 0 to 2: unlike the cosine it keeps its digits near the forward peak.
    heights: Vec<f64>,
    /// One column for each wavelength.
    columns: Vec<Column>,
    /// For equal steps of sin θ/2, the first cell that reaches into the step; one more entry closes the list.
    guide: Vec<u32>,
}

/// The phase function at one wavelength.
#[derive(Debug, Clone, PartialEq)]
struct Column {
    /// Density per steradian at the angles.
    density: Vec<f64>,
    /// The share of the light in each cell between two angles.
    cells: Discrete,
    mean_cosine: f64,
}

impl PhaseTable {
    /// A table from angles in degrees (ascending from 0 to 180), wavelengths in nm (ascending) and, for each wavelength, values at
    /// the angles on any scale: they are normalised to integrate to 1 over the sphere.
    ///
    /// # Errors
    /// Angles or wavelengths that do not ascend or do not reach from 0 to 180; lists of different lengths; values that are negative
    /// or not finite; a wavelength at which all values are 0.
    pub fn new(angles_deg: &[f64], nm: &[f64], values: &[Vec<f64>]) -> Result<Self> {
        check_angles(angles_deg)?;
        check_wavelengths(nm, values.len())?;
        let height = |degrees: f64| 2.0 * (0.5 * degrees).to_radians().sin().powi(2);
        let heights: Vec<f64> = angles_deg.iter().map(|&degrees| height(degrees)).collect();
        if let Some(i) = (1..heights.len()).find(|&i| heights[i] <= heights[i - 1]) {
            let what = format!("the angles {} and {}°, too near to each other", angles_deg[i - 1], angles_deg[i]);
            return Err(Error::input(what).expected("angles whose cosines differ"));
        }
        let columns: Result<Vec<Column>> =
            nm.iter().zip(values).map(|(nm, values)| Column::new(*nm, (angles_deg, &heights), values)).collect();
        let guide = guide(&heights);
        Ok(Self { nm: nm.to_vec(), heights, columns: columns?, guide })
    }

    /// Whether it differs between wavelengths.
    pub(super) fn depends_on_wavelength(&self) -> bool {
        self.columns.iter().any(|column| column.density != self.columns[0].density)
    }

    /// The density per steradian.
    pub(super) fn at(&self, cos_theta: f64, nm: f64) -> f64 {
        let height = (1.0 - cos_theta).clamp(0.0, 2.0);
        let cell = self.cell(height);
        let (from, to) = (self.heights[cell], self.heights[cell + 1]);
        let t = (height - from) / (to - from);
        self.mixed(nm, |column| (1.0 - t) * column.density[cell] + t * column.density[cell + 1])
    }

    /// 1 − cos θ below which a share `u` in [0, 1) of one of the two neighbouring columns lies, the column drawn by `u` as well.
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
        let (from, to) = (column.density[cell], column.density[cell + 1]);
        // The share of a cell of linear density, in the form without cancellation.
        let t = u * (from + to) / (from + (from * from + u * (to - from) * (to + from)).max(0.0).sqrt());
        let t = if t.is_finite() { t.min(1.0) } else { 0.0 };
        self.heights[cell] + t * (self.heights[cell + 1] - self.heights[cell])
    }

    /// The mean of cos θ.
    pub(super) fn mean_cosine(&self, nm: f64) -> f64 {
        self.mixed(nm, |column| column.mean_cosine)
    }

    /// The value at a wavelength of what each column has one of.
    fn mixed(&self, nm: f64, of: impl Fn(&Column) -> f64) -> f64 {
        let (first, weight) = self.column(nm);
        let value = of(&self.columns[first]);
        if weight == 0.0 { value } else { value + weight * (of(&self.columns[first + 1]) - value) }
    }

    /// The column before a wavelength, and the weight of the one behind it.
    fn column(&self, nm: f64) -> (usize, f64) {
        let last = self.nm.len() - 1;
        let after = self.nm.partition_point(|&known| known <= nm);
        if after == 0 || after > last {
            return (after.min(last), 0.0);
        }
        let (from, to) = (self.nm[after - 1], self.nm[after]);
        (after - 1, (nm - from) / (to - from))
    }

    /// The cell that holds a height.
    fn cell(&self, height: f64) -> usize {
        let steps = self.guide.len() - 1;
        let step = (((0.5 * height).sqrt() * steps as f64) as usize).min(steps - 1);
        let (first, last) = (self.guide[step] as usize, self.guide[step + 1] as usize);
        first + self.heights[first + 1..=last].partition_point(|&known| known <= height)
    }
}

impl Column {
    fn new(nm: f64, (angles_deg, heights): (&[f64], &[f64]), values: &[f64]) -> Result<Self> {
        if values.len() != heights.len() {
            let what = format!("{} values at {nm} nm for {} angles", values.len(), heights.len());
            return Err(Error::input(what).expected("a value for each angle"));
        }
        if let Some(i) = values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
            let what = format!("the value {} at {}° and {nm} nm", values[i], angles_deg[i]);
            return Err(Error::input(what).expected("a finite number of at least 0"));
        }
        let cells = |i: usize| (heights[i + 1] - heights[i], values[i], values[i + 1]);
        let count = heights.len() - 1;
        let masses: Vec<f64> = (0..count).map(cells).map(|(width, from, to)| TAU * width * 0.5 * (from + to)).collect();
        let total: f64 = masses.iter().sum();
        let nothing = || Error::input(format!("no scattering at all at {nm} nm")).expected("some value above 0");
        let distribution = Discrete::new(masses).filter(|_| total.is_finite()).ok_or_else(nothing)?;
        let first_moment = |i: usize| {
            let (width, from, to) = cells(i);
            TAU * width * (heights[i] * (2.0 * from + to) + heights[i + 1] * (from + 2.0 * to)) / 6.0
        };
        let mean_cosine = 1.0 - (0..count).map(first_moment).sum::<f64>() / total;
        let density = values.iter().map(|value| value / total).collect();
        Ok(Self { density, cells: distribution, mean_cosine })
    }
}

/// See [`PhaseTable::guide`].
fn guide(heights: &[f64]) -> Vec<u32> {
    let cells = heights.len() - 1;
    let steps = GUIDE_STEPS * cells;
    // A little before and behind each step's ends, for what rounding does to a root.
    let height = |step: f64| 2.0 * (step / steps as f64).powi(2);
    let cell_of = |height: f64| heights.partition_point(|&known| known <= height).clamp(1, cells) - 1;
    let mut guide: Vec<u32> = (0..steps).map(|step| cell_of(height(step as f64) * (1.0 - 1e-12)) as u32).collect();
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

/// Reads a table of comma-separated values: a header line, whose first title names the angle and each further one the wavelength
/// of its column in nm (`p_550nm_per_sr` or just `550`), then a row for each angle in degrees. A single column needs no
/// wavelength: it holds at all. Lines that are empty or begin with `#` are passed over.
///
/// # Errors
/// A cell that is no number, a row of another length than the header, whatever [`PhaseTable::new`] refuses; with its line where
/// it has one.
pub fn parse(text: &str) -> Result<PhaseTable> {
    let mut rows = text
        .trim_start_matches('\u{feff}')
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

/// The wavelengths that the titles of columns name.
fn wavelengths(titles: &[&str]) -> Result<Vec<f64>> {
    let number = |title: &str| -> Option<f64> {
        let start = title.find(|c: char| c.is_ascii_digit())?;
        let rest = &title[start..];
        let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(rest.len());
        rest[..end].parse().ok()
    };
    match titles {
        [] => Err(Error::input("a table of one column").expected("the angle and at least one column of values")),
        [only] => Ok(vec![number(only).unwrap_or(ANY_NM)]),
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

/// Where a single column stands that names no wavelength.
const ANY_NM: f64 = 550.0;

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const FORM: &str = "angle_deg,p_400nm_per_sr,p_700nm_per_sr\n0,3,1\n90,1,1\n180,0,1\n";

    #[test]
    fn a_table_is_mixed_between_its_wavelengths_and_held_beyond_them() {
        let table = parse(FORM).unwrap();
        // ∫ = 2π (2 + 0.5) for the first column, 4π for the second.
        let first = |p: f64| p / (5.0 * PI);
        assert!((table.at(1.0, 380.0) - first(3.0)).abs() < 1e-15);
        assert!((table.at(0.5, 400.0) - first(2.0)).abs() < 1e-15);
        assert!((table.at(-1.0, 700.0) - 0.25 / PI).abs() < 1e-15);
        assert!((table.at(0.0, 550.0) - 0.5 * (first(1.0) + 0.25 / PI)).abs() < 1e-15);
        // ∫ cos θ p dω: of the first column 2π (∫₀¹ μ(1 + 2μ) dμ + ∫₋₁⁰ μ(1 + μ) dμ) / 5π.
        assert!((table.mean_cosine(400.0) - 2.0 * (7.0 / 6.0 - 1.0 / 6.0) / 5.0).abs() < 1e-15);
        assert!(table.depends_on_wavelength());
        assert!(!parse("angle,p\n0,1\n180,2\n").unwrap().depends_on_wavelength());
    }

    #[test]
    fn what_is_wrong_with_a_table_is_said() {
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
