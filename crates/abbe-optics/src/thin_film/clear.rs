//! The reflectance of a stack of clear layers, by characteristic matrices.
//!
//! Without absorption, the matrix of a layer has real diagonal and imaginary off-diagonal elements
//! (Abelès; Macleod, *Thin-Film Optical Filters*, chapter 2), so no complex number has to be
//! divided and the only root is that of the angle.

use super::airy::{LEAST_COSINE, LEAST_NORMAL_INDEX};
use abbe_spectra::math::elementary::sin_cos;
use std::f64::consts::TAU;

/// The tangential electric and magnetic field for one polarisation, relative to the electric field
/// in the substrate: real and imaginary parts.
#[derive(Debug, Clone, Copy)]
struct Fields {
    electric: [f64; 2],
    magnetic: [f64; 2],
}

impl Fields {
    fn in_substrate(admittance: f64) -> Self {
        Self { electric: [1.0, 0.0], magnetic: [admittance, 0.0] }
    }

    /// Returns the fields on the other side of a layer, with the sine and the cosine of its phase.
    #[inline]
    fn above(self, [admittance, reciprocal]: [f64; 2], (sin, cos): (f64, f64)) -> Self {
        let Self { electric: [e_re, e_im], magnetic: [m_re, m_im] } = self;
        let (of_electric, of_magnetic) = (sin * admittance, sin * reciprocal);
        Self {
            electric: [cos * e_re - of_magnetic * m_im, cos * e_im + of_magnetic * m_re],
            magnetic: [cos * m_re - of_electric * e_im, cos * m_im + of_electric * e_re],
        }
    }

    /// Returns the reflectance from a medium with this admittance.
    fn reflectance(self, admittance: f64) -> f64 {
        let square = |sign: f64| {
            let part = |i: usize| (admittance * self.electric[i] + sign * self.magnetic[i]).powi(2);
            part(0) + part(1)
        };
        (square(-1.0) / square(1.0)).min(1.0)
    }
}

/// Returns the reflectance for unpolarised light of the wavelength `nm` (nm, in air), or `None` if
/// light does not propagate in a layer, whose response [`response`](super::response) computes.
///
/// The arguments are those of [`response`](super::response), with real indices. Light that does not
/// enter the substrate is reflected totally: the reflectance is then exactly 1.
pub(super) fn clear_reflectance(
    cos: f64,
    incident: f64,
    layers: impl DoubleEndedIterator<Item = (f64, f64)>,
    substrate: f64,
    nm: f64,
) -> Option<f64> {
    let cos = cos.abs().min(1.0);
    let transverse = incident * ((1.0 - cos) * (1.0 + cos)).sqrt();
    if cos < LEAST_COSINE || transverse >= substrate {
        return Some(1.0);
    }
    // n cos θ. The product has no cancellation near the critical angle.
    let normal_of = |n: f64| ((n - transverse) * (n + transverse)).sqrt();
    let normal = normal_of(substrate);
    let [mut s, mut p] = [normal, substrate * substrate / normal].map(Fields::in_substrate);
    let per_nm = TAU / nm;
    for (n, thickness_nm) in layers.rev() {
        if n - transverse < LEAST_NORMAL_INDEX {
            return None;
        }
        let normal = normal_of(n);
        let (reciprocal, square) = (1.0 / normal, n * n);
        let phase = sin_cos(normal * (per_nm * thickness_nm));
        s = s.above([normal, reciprocal], phase);
        p = p.above([square * reciprocal, normal / square], phase);
    }
    Some(0.5 * (s.reflectance(incident * cos) + p.reflectance(incident / cos)))
}

#[cfg(test)]
mod tests {
    use super::super::response;
    use super::*;
    use abbe_spectra::math::complex::Complex;

    /// Stacks of up to six layers, at all angles, between media of larger and smaller index.
    #[test]
    fn the_reflectance_is_that_of_the_complex_recursion() {
        // A linear congruential generator (Knuth, *The Art of Computer Programming*, volume 2).
        let mut state = 1_u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 32) as f64 / 2_f64.powi(32)
        };
        let (mut clear, mut frustrated) = (0, 0);
        for i in 0..20_000 {
            let layers: Vec<(f64, f64)> = (0..i % 7).map(|_| (1.0 + 1.5 * uniform(), 900.0 * uniform())).collect();
            let (cos, incident, substrate) = (uniform(), 1.0 + uniform(), 1.0 + uniform());
            let nm = 360.0 + 470.0 * uniform();
            let complex = layers.iter().map(|&(n, thickness_nm)| (Complex::from(n), thickness_nm));
            let known = response(cos, incident, complex, substrate.into(), nm).reflectance();
            match clear_reflectance(cos, incident, layers.iter().copied(), substrate, nm) {
                Some(found) => {
                    clear += 1;
                    assert!((found - known).abs() < 1e-11, "{found} for {known}: {layers:?}, {cos}, {incident}");
                }
                None => frustrated += 1,
            }
        }
        assert!(clear > 10_000 && frustrated > 1_000, "{clear} and {frustrated}");
    }

    #[test]
    fn grazing_and_totally_reflected_light_has_the_reflectance_one() {
        let layer = [(1.38, 100.0)];
        for (cos, incident, substrate) in [(0.0, 1.0, 1.5), (1e-120, 1.0, 1.5), (0.1, 1.5, 1.0), (0.0, 1.0, 1.0)] {
            assert_eq!(clear_reflectance(cos, incident, layer.into_iter(), substrate, 550.0), Some(1.0));
        }
        let almost = clear_reflectance(1e-90, 1.0, layer.into_iter(), 1.5, 550.0).expect("light enters the glass");
        assert!((almost - 1.0).abs() < 1e-12, "{almost}");
    }
}
