//! Tables of samples: validation, and conversion to a function over the band.

use super::band::BAND_NM;
use super::continuum::{Continuum, LinearPiece};
use crate::error::{Error, Result};

/// The rule for the values of a table beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    /// The value is 0 outside the table, as for lights.
    Zero,
    /// Outside the table, the value is that at the nearest end, as for reflectances and optical
    /// constants.
    Hold,
}

/// The width of steps in nm below which one sample per nm would miss features of a table.
const FINE_STEP_NM: f64 = 0.49;

/// Returns the first error in a list of samples, and the index of the wrong sample.
pub(crate) fn first_fault(nm: &[f64], values: &[f64]) -> Option<(usize, Error)> {
    for (i, (&at, &value)) in nm.iter().zip(values).enumerate() {
        let what = if !(at.is_finite() && at > 0.0) {
            Error::input(format!("the wavelength {at}")).expected("a positive number of nm")
        } else if !value.is_finite() {
            Error::input(format!("the value {value} at {at} nm")).expected("a finite number")
        } else if value < 0.0 {
            Error::input(format!("the negative value {value} at {at} nm")).expected("0 or more")
        } else if i > 0 && at == nm[i - 1] {
            Error::input(format!("the wavelength {at} nm, which occurs twice")).expected("each wavelength once")
        } else if i > 0 && at < nm[i - 1] {
            Error::input(format!("the wavelength {at} nm after {} nm", nm[i - 1])).expected("ascending wavelengths")
        } else {
            continue;
        };
        return Some((i, what));
    }
    None
}

/// Returns true if two adjacent samples in the band are too close for a sum with one sample per nm.
pub(crate) fn is_fine(nm: &[f64]) -> bool {
    is_fine_within(nm, BAND_NM)
}

pub(super) fn is_fine_within(nm: &[f64], (from, to): (f64, f64)) -> bool {
    nm.windows(2).any(|pair| pair[1] - pair[0] < FINE_STEP_NM && pair[1] > from && pair[0] < to)
}

pub(crate) fn continuum(nm: &[f64], values: &[f64], outside: Outside) -> Result<Continuum> {
    if nm.len() != values.len() {
        let what = format!("{} wavelengths and {} values", nm.len(), values.len());
        return Err(Error::input(what).expected("equal numbers of wavelengths and values"));
    }
    if let Some((i, fault)) = first_fault(nm, values) {
        return Err(fault.on_path(format!("[{i}]")));
    }
    let [first_nm, .., last_nm] = *nm else {
        return match (values, outside) {
            ([value], Outside::Hold) => Ok(Continuum::constant(*value)),
            ([_], Outside::Zero) => {
                let what = "a table with a single sample for a light";
                Err(Error::input(what).expected("at least two samples, or a spectral line (\"lines\")"))
            }
            ([] | [_, _, ..], _) => Err(Error::input("a table without entries").expected("at least one sample")),
        };
    };
    let ends = match outside {
        Outside::Zero => [(first_nm, 0.0), (last_nm, 0.0)],
        Outside::Hold => [(first_nm, values[0]), (last_nm, values[values.len() - 1])],
    };
    Ok(Continuum::from_pieces(&pieces(nm, values, ends)))
}

/// Converts at least two samples to pieces. `below` is the first wavelength and the value below it,
/// and `above` the last one and the value above it.
fn pieces(nm: &[f64], values: &[f64], [below, above]: [(f64, f64); 2]) -> Vec<LinearPiece> {
    let mut pieces = Vec::with_capacity(nm.len() + 1);
    if below.0 > BAND_NM.0 {
        pieces.push(LinearPiece { nm: (BAND_NM.0, below.0.min(BAND_NM.1)), values: (below.1, below.1) });
    }
    for i in 1..nm.len() {
        let (from, to) = (nm[i - 1], nm[i]);
        let inside = (from.max(BAND_NM.0), to.min(BAND_NM.1));
        if inside.0 < inside.1 {
            let at = |x: f64| {
                let t = (x - from) / (to - from);
                (1.0 - t) * values[i - 1] + t * values[i]
            };
            pieces.push(LinearPiece { nm: inside, values: (at(inside.0), at(inside.1)) });
        }
    }
    if above.0 < BAND_NM.1 {
        // The last piece begins one floating-point step beyond the last sample, which thus belongs
        // to the table.
        let from = if above.0 < BAND_NM.0 { BAND_NM.0 } else { above.0.next_up() };
        if let Some(last) = pieces.last_mut() {
            last.nm.1 = from;
        }
        pieces.push(LinearPiece { nm: (from, BAND_NM.1), values: (above.1, above.1) });
    }
    pieces
}
