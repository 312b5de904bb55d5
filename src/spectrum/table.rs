//! Tables of samples: their checks, and their meaning over the band.

use super::BAND_NM;
use super::continuum::{Continuum, Piece};
use super::value::Outside;
use crate::error::{Error, Result};

/// Tables with steps below this, in nm, hold features that samples every nm would miss.
const FINE_STEP_NM: f64 = 0.49;

/// The first fault of a list of samples and the number (from 0) of the entry it stands at.
pub(crate) fn first_fault(nm: &[f64], values: &[f64]) -> Option<(usize, Error)> {
    for (i, (&at, &value)) in nm.iter().zip(values).enumerate() {
        let what = if !(at.is_finite() && at > 0.0) {
            Error::input(format!("the wavelength {at}")).expected("a positive number of nm")
        } else if !value.is_finite() {
            Error::input(format!("the value {value} at {at} nm")).expected("a finite number")
        } else if value < 0.0 {
            Error::input(format!("the negative value {value} at {at} nm")).expected("0 or more")
        } else if i > 0 && at == nm[i - 1] {
            Error::input(format!("the wavelength {at} nm twice")).expected("every wavelength once")
        } else if i > 0 && at < nm[i - 1] {
            Error::input(format!("the wavelength {at} nm after {} nm", nm[i - 1])).expected("ascending wavelengths")
        } else {
            continue;
        };
        return Some((i, what));
    }
    None
}

/// Whether any step within the band is too fine for sums over samples every nm.
pub(crate) fn is_fine(nm: &[f64]) -> bool {
    nm.windows(2).any(|pair| pair[1] - pair[0] < FINE_STEP_NM && pair[1] > BAND_NM.0 && pair[0] < BAND_NM.1)
}

/// The table as pieces over the band.
pub(crate) fn continuum(nm: &[f64], values: &[f64], outside: Outside) -> Result<Continuum> {
    if nm.len() != values.len() {
        let what = format!("{} wavelengths and {} values", nm.len(), values.len());
        return Err(Error::input(what).expected("as many of one as of the other"));
    }
    if let Some((i, fault)) = first_fault(nm, values) {
        return Err(fault.on_path(format!("[{i}]")));
    }
    let [first_nm, .., last_nm] = *nm else {
        return match (values, outside) {
            ([value], Outside::Hold) => Ok(Continuum::constant(*value)),
            ([_], Outside::Zero) => {
                let what = "a light's table of a single sample, which has no width";
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

/// The pieces of at least two samples; `ends` holds their first and last wavelength and the value beyond it.
fn pieces(nm: &[f64], values: &[f64], [below, above]: [(f64, f64); 2]) -> Vec<Piece> {
    let mut pieces = Vec::with_capacity(nm.len() + 1);
    if below.0 > BAND_NM.0 {
        pieces.push(Piece { nm: (BAND_NM.0, below.0.min(BAND_NM.1)), values: (below.1, below.1) });
    }
    for i in 1..nm.len() {
        let (from, to) = (nm[i - 1], nm[i]);
        let inside = (from.max(BAND_NM.0), to.min(BAND_NM.1));
        if inside.0 < inside.1 {
            let at = |x: f64| {
                let t = (x - from) / (to - from);
                (1.0 - t) * values[i - 1] + t * values[i]
            };
            pieces.push(Piece { nm: inside, values: (at(inside.0), at(inside.1)) });
        }
    }
    if above.0 < BAND_NM.1 {
        // One step of rounding beyond the last sample, so that the sample itself still belongs to the table.
        let from = if above.0 < BAND_NM.0 { BAND_NM.0 } else { above.0.next_up() };
        if let Some(last) = pieces.last_mut() {
            last.nm.1 = from;
        }
        pieces.push(Piece { nm: (from, BAND_NM.1), values: (above.1, above.1) });
    }
    pieces
}
