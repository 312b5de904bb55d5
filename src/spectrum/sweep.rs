//! Several spectra side by side, stretch by stretch: the one way in which integrals, sums and products are formed.

use super::BAND_NM;
use super::Spectrum;
use super::continuum::ContinuumCursor;
use super::line::LineCursor;

struct Cursor<'a> {
    continuum: ContinuumCursor<'a>,
    lines: LineCursor<'a>,
}

/// Cuts the band at every knot of every spectrum and calls `visit` with each stretch (its ends in nm) and every
/// spectrum's values at its ends; within the stretch all are linear. Lines count with their power per nm.
pub(crate) fn sweep<const N: usize>(spectra: [&Spectrum; N], mut visit: impl FnMut((f64, f64), [(f64, f64); N])) {
    let mut cursors = spectra.map(|spectrum| Cursor {
        continuum: spectrum.continuum_part().cursor(),
        lines: spectrum.lines_part().cursor(),
    });
    let mut lower = BAND_NM.0;
    while lower < BAND_NM.1 {
        let mut upper = BAND_NM.1;
        for cursor in &mut cursors {
            upper = upper.min(cursor.continuum.knot_after(lower)).min(cursor.lines.knot_after(lower));
        }
        let values = cursors.each_ref().map(|cursor| {
            let (from, to) = cursor.continuum.on(lower, upper);
            let line = cursor.lines.on(lower);
            (from + line, to + line)
        });
        visit((lower, upper), values);
        lower = upper;
    }
}

/// The integral over the band of the product of at most three spectra: exact, because Simpson's rule is exact for
/// cubics.
pub(crate) fn product_integral<const N: usize>(spectra: [&Spectrum; N]) -> f64 {
    const { assert!(N <= 3, "four linear factors make a quartic, which Simpson's rule does not integrate") }
    let mut sum = 0.0;
    sweep(spectra, |nm, values| {
        let mut product = (1.0, 1.0, 1.0);
        for (from, to) in values {
            product = (product.0 * from, product.1 * (0.5 * from + 0.5 * to), product.2 * to);
        }
        sum += (nm.1 - nm.0) * ((product.0 + 4.0 * product.1 + product.2) / 6.0);
    });
    sum
}
