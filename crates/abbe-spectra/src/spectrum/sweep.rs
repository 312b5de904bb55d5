//! Simultaneous traversal of several spectra, interval by interval, for their sums and products,
//! and for integrals of products.

use super::band::BAND_NM;
use super::continuum::{Continuum, ContinuumCursor};
use super::line::{LineCursor, Lines};

#[derive(Debug, Clone, Copy)]
pub(crate) struct SpectrumParts<'a> {
    pub(crate) continuum: &'a Continuum,
    pub(crate) lines: &'a Lines,
}

struct SpectrumCursor<'a> {
    continuum: ContinuumCursor<'a>,
    lines: LineCursor<'a>,
}

/// Divides the band at every knot of every spectrum, so that all are linear within each interval,
/// and calls `visit` with the ends of the interval in nm and the values of every spectrum at both
/// ends, including the power per nm of lines.
pub(crate) fn sweep<const N: usize>(
    spectra: [SpectrumParts<'_>; N],
    mut visit: impl FnMut((f64, f64), [(f64, f64); N]),
) {
    let mut cursors = spectra
        .map(|spectrum| SpectrumCursor { continuum: spectrum.continuum.cursor(), lines: spectrum.lines.cursor() });
    let mut lower = BAND_NM.0;
    while lower < BAND_NM.1 {
        let mut upper = BAND_NM.1;
        for cursor in &mut cursors {
            upper = upper.min(cursor.continuum.knot_after(lower)).min(cursor.lines.knot_after(lower));
        }
        let values = cursors.each_ref().map(|cursor| {
            let (from, to) = cursor.continuum.values_on(lower, upper);
            let line = cursor.lines.values_on(lower);
            (from + line, to + line)
        });
        visit((lower, upper), values);
        lower = upper;
    }
}

/// Integrates the product of at most three spectra over the band, exactly.
pub(crate) fn product_integral<const N: usize>(spectra: [SpectrumParts<'_>; N]) -> f64 {
    let mut sum = 0.0;
    sweep(spectra, |nm, values| sum += interval_integral(nm, values));
    sum
}

/// Integrates the product of at most three linear functions over an interval. They have these
/// values at its ends. Simpson's rule is exact for cubic polynomials.
pub(crate) fn interval_integral<const N: usize>(nm: (f64, f64), values: [(f64, f64); N]) -> f64 {
    const { assert!(N <= 3, "four linear factors make a quartic, which Simpson's rule does not integrate") }
    let mut product = (1.0, 1.0, 1.0);
    for (from, to) in values {
        product = (product.0 * from, product.1 * (0.5 * from + 0.5 * to), product.2 * to);
    }
    (nm.1 - nm.0) * ((product.0 + 4.0 * product.1 + product.2) / 6.0)
}
