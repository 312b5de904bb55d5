//! Correlated colour temperature.

use std::sync::OnceLock;

use super::coordinates::uv1960;
use super::tristimulus::Xyz;
use crate::math::elementary::hypot;
use crate::spectrum::{BAND_NM, Observer, planck};

/// The largest distance from the Planckian locus of a colour with a temperature (CIE 15).
const MAX_DUV: f64 = 0.05;

/// The range of reciprocal temperatures in 1/MK that is searched, from 10⁶ K down to 500 K.
const MIRED_RANGE: (f64, f64) = (1.0, 2001.0);

/// The number of steps of the first search over this range.
const LOCUS_STEPS: usize = 200;

/// The black body whose colour is nearest to a colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrelatedTemperature {
    /// The temperature in K.
    pub cct_k: f64,
    /// The distance from the Planckian locus in CIE 1960 u, v, positive above it (greenish).
    pub duv: f64,
}

/// Computes the correlated colour temperature of the XYZ of the CIE 1931 observer: that of the
/// nearest point of the Planckian locus in the CIE 1960 u, v plane. Returns `None` if this point is
/// farther than 0.05, or if the temperature is outside 500–10⁶ K.
pub fn cct_duv(xyz: Xyz) -> Option<CorrelatedTemperature> {
    let target = uv1960(xyz);
    let square = |uv: [f64; 2]| (uv[0] - target[0]).powi(2) + (uv[1] - target[1]).powi(2);
    let table = locus_table();
    let nearest = (0..table.len()).min_by(|&a, &b| square(table[a]).total_cmp(&square(table[b])))?;
    let bracket = (mired_of(nearest.saturating_sub(1)), mired_of((nearest + 1).min(LOCUS_STEPS)));
    let mired = minimum(|mired| square(locus(mired)), bracket.0, bracket.1);
    // The nearest point of a colour beyond an end of the locus is that end.
    if mired < MIRED_RANGE.0 * (1.0 + 1e-6) || mired > MIRED_RANGE.1 * (1.0 - 1e-6) {
        return None;
    }
    let (foot, before, after) = (locus(mired), locus(mired - 0.01), locus(mired + 0.01));
    let tangent = [after[0] - before[0], after[1] - before[1]];
    let offset = [target[0] - foot[0], target[1] - foot[1]];
    // With growing reciprocal temperature, u grows along the locus, so above is left.
    let side = (tangent[0] * offset[1] - tangent[1] * offset[0]).signum();
    let duv = side * hypot(offset[0], offset[1]);
    (duv.abs() <= MAX_DUV).then_some(CorrelatedTemperature { cct_k: 1e6 / mired, duv })
}

fn mired_of(step: usize) -> f64 {
    MIRED_RANGE.0 + (MIRED_RANGE.1 - MIRED_RANGE.0) * step as f64 / LOCUS_STEPS as f64
}

fn locus_table() -> &'static [[f64; 2]] {
    static TABLE: OnceLock<Vec<[f64; 2]>> = OnceLock::new();
    TABLE.get_or_init(|| (0..=LOCUS_STEPS).map(|step| locus(mired_of(step))).collect())
}

/// Returns u, v of a black body with a reciprocal temperature in 1/MK.
fn locus(mired: f64) -> [f64; 2] {
    let observer = Observer::cie1931();
    let mut xyz = [0.0; 3];
    for nm in (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from) {
        let radiance = planck(nm, 1e6 / mired);
        xyz.iter_mut().zip(observer.xyz_bar(nm)).for_each(|(sum, bar)| *sum += radiance * bar);
    }
    uv1960(xyz)
}

/// Returns the position of the minimum of a function, by golden-section search.
fn minimum(function: impl Fn(f64) -> f64, mut lower: f64, mut upper: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut inner = [upper - ratio * (upper - lower), lower + ratio * (upper - lower)];
    let mut values = inner.map(&function);
    while upper - lower > 1e-9 * upper {
        if values[0] < values[1] {
            upper = inner[1];
            inner = [upper - ratio * (upper - lower), inner[0]];
            values = [function(inner[0]), values[0]];
        } else {
            lower = inner[0];
            inner = [inner[1], lower + ratio * (upper - lower)];
            values = [values[1], function(inner[1])];
        }
    }
    0.5 * (lower + upper)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::report;
    use crate::spectrum::Spectrum;

    #[test]
    fn a_black_body_has_its_own_temperature() {
        for temperature in [600.0, 1000.0, 2856.0, 6500.0, 25_000.0, 200_000.0] {
            let xyz = report::xyz(&Spectrum::blackbody(temperature).unwrap(), Observer::cie1931());
            let found = cct_duv(xyz).unwrap();
            assert!((found.cct_k / temperature - 1.0).abs() < 1e-5, "{temperature} {found:?}");
            assert!(found.duv.abs() < 1e-7, "{temperature} {found:?}");
        }
    }

    #[test]
    fn saturated_colours_have_no_temperature() {
        assert_eq!(cct_duv([0.2, 0.7, 0.1]), None);
        assert_eq!(cct_duv([0.0, 0.0, 0.0]), None);
    }
}
