//! How much a glass absorbs, from its measured extinction coefficient.

use std::f64::consts::PI;

use super::dispersion::interpolate;

/// The extinction coefficient k of n + ik at some wavelengths; linear between them, the end values are held outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Extinction {
    /// Wavelengths in nm, strictly increasing.
    pub nm: Vec<f64>,
    /// k ≥ 0 at each, without unit.
    pub k: Vec<f64>,
}

impl Extinction {
    /// k at a wavelength in nm.
    pub fn k(&self, wavelength_nm: f64) -> f64 {
        interpolate(&self.nm, &self.k, wavelength_nm)
    }

    /// The absorption coefficient 4πk/λ at a wavelength in nm, in 1/m.
    pub fn absorption_per_m(&self, wavelength_nm: f64) -> f64 {
        4.0 * PI * self.k(wavelength_nm) / (wavelength_nm * 1e-9)
    }

    /// The fraction of light that `length_m` metres of the material let through, reflections at its faces left out.
    pub fn internal_transmittance(&self, wavelength_nm: f64, length_m: f64) -> f64 {
        (-self.absorption_per_m(wavelength_nm) * length_m).exp()
    }
}
