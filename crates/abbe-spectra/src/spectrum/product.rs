//! Spectra that are products of spectra, or sums of black-body spectra.

use super::continuum::{Continuum, LinearPiece};
use super::line::LineSegment;
use super::planck::planck;
use super::sweep::sweep;
use super::value::Spectrum;

/// The largest error of the linear pieces of a product, relative to the product of the maxima.
const PRODUCT_TOLERANCE: f64 = 1e-7;

impl Spectrum {
    /// Multiplies two spectra. The error is at most 10⁻⁷ times the product of their maxima where
    /// both are smooth, and the power of the product is exact where at least one has a line.
    #[must_use]
    pub fn product(&self, other: &Self) -> Self {
        let tolerance = PRODUCT_TOLERANCE * self.continuum_only().max() * other.continuum_only().max();
        let (mut pieces, mut lines) = (Vec::new(), Vec::new());
        sweep([self.parts(), other.parts()], |nm, [a, b]| {
            let middle = 0.5 * (nm.0 + nm.1);
            let (line_a, line_b) = (self.parts().lines.at(middle), other.parts().lines.at(middle));
            let (smooth_a, smooth_b) = ((a.0 - line_a, a.1 - line_a), (b.0 - line_b, b.1 - line_b));
            add_pieces(nm, [smooth_a, smooth_b], tolerance, &mut pieces);
            if line_a > 0.0 || line_b > 0.0 {
                let power = (nm.1 - nm.0) * (mean_product(a, b) - mean_product(smooth_a, smooth_b));
                lines.push(LineSegment { nm, power });
            }
        });
        let lines = Self::from_segments(&lines);
        let product = Self::mix(&[(1.0, &Self::from_continuum(Continuum::from_pieces(&pieces))), (1.0, &lines)]);
        product.with_part_below(self.below_band().product(other.below_band()))
    }

    /// Returns 1 minus the continuum of the spectrum: the transmittance of an absorptance.
    #[must_use]
    pub fn complement(&self) -> Self {
        let complement =
            |piece: LinearPiece| LinearPiece { values: (1.0 - piece.values.0, 1.0 - piece.values.1), ..piece };
        let pieces: Vec<LinearPiece> = self.continuum().map(complement).collect();
        let complement = Self::from_continuum(Continuum::from_pieces(&pieces));
        complement.with_part_below(self.below_band().complement())
    }

    /// Returns the radiance in W m⁻² sr⁻¹ nm⁻¹ of black bodies (K above 0, weight).
    pub fn blackbodies(bodies: &[(f64, f64)]) -> Self {
        let radiance = |nm: f64| bodies.iter().map(|&(kelvin, weight)| weight * planck(nm, kelvin)).sum::<f64>() * 1e-9;
        Self::of_formula(radiance)
    }
}

/// Returns the mean of the product of two linear functions, given at both ends.
fn mean_product(a: (f64, f64), b: (f64, f64)) -> f64 {
    (2.0 * (a.0 * b.0 + a.1 * b.1) + a.0 * b.1 + a.1 * b.0) / 6.0
}

/// Appends linear pieces within the tolerance of the product of two linear functions.
fn add_pieces(nm: (f64, f64), [a, b]: [(f64, f64); 2], tolerance: f64, pieces: &mut Vec<LinearPiece>) {
    // A straight line through the end points of the product is off by at most a quarter of the
    // product of the two rises. The error is proportional to the square of the width of a part.
    let off = 0.25 * ((a.1 - a.0) * (b.1 - b.0)).abs();
    let parts = if off > tolerance { (off / tolerance).sqrt().ceil() } else { 1.0 };
    let value = |t: f64| (a.0 + t * (a.1 - a.0)) * (b.0 + t * (b.1 - b.0));
    let place = |i: f64| if i < parts { nm.0 + i / parts * (nm.1 - nm.0) } else { nm.1 };
    for i in (0..parts as u32).map(f64::from) {
        let values = (value(i / parts), value((i + 1.0) / parts));
        pieces.push(LinearPiece { nm: (place(i), place(i + 1.0)), values });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{Outside, SpectralLine};

    #[test]
    fn a_product_has_the_values_and_the_integral_of_its_factors() {
        let ramp = Spectrum::table(&[360.0, 500.0, 830.0], &[0.0, 4.0, 1.0], Outside::Hold).unwrap();
        let hot = Spectrum::blackbody(2000.0).unwrap();
        let sodium = |power: f64| SpectralLine { nm: 589.0, power, fwhm_nm: None };
        let lamp = Spectrum::mix(&[(1.0, &Spectrum::lines(&[sodium(2.0)]).unwrap()), (0.01, &ramp)]);
        for (a, b) in [(&ramp, &ramp), (&ramp, &hot), (&lamp, &ramp), (&hot, &lamp), (&lamp, &lamp)] {
            let product = a.product(b);
            for nm in [360.0, 431.7, 500.0, 588.9999, 589.0001, 612.3, 830.0] {
                let (got, expected) = (product.at(nm), a.at(nm) * b.at(nm));
                let scale =
                    if (nm - 589.0_f64).abs() < 0.01 { a.max() * b.max() } else { 4.0 * b.continuum_only().max() };
                assert!((got - expected).abs() <= 2e-6 * scale, "{nm} nm: {got}, expected {expected}");
            }
            let off = product.integral() / a.product_integral(b) - 1.0;
            assert!(off.abs() < 1e-6, "off by {off:e}");
        }
        let two = Spectrum::blackbodies(&[(1500.0, 2.0), (2500.0, 0.5)]);
        let expected = 2e-9 * planck(600.0, 1500.0) + 0.5e-9 * planck(600.0, 2500.0);
        assert!((two.at(600.0) / expected - 1.0).abs() < 1e-5);
    }
}
