//! Absorption of a glass from its measured extinction coefficient.

use std::f64::consts::PI;

use super::dispersion::interpolate;
use abbe_spectra::math::elementary::exp;

/// The extinction coefficient k, the imaginary part of the complex index n + ik, interpolated
/// linearly between tabulated wavelengths and held outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Extinction {
    /// Wavelengths in nm, strictly increasing.
    pub nm: Vec<f64>,
    /// k ≥ 0 at each wavelength, dimensionless.
    pub k: Vec<f64>,
}

impl Extinction {
    /// Returns k at a wavelength in nm.
    pub fn k(&self, wavelength_nm: f64) -> f64 {
        interpolate(&self.nm, &self.k, wavelength_nm)
    }

    /// Returns the absorption coefficient 4πk/λ, in 1/m, at a wavelength in nm.
    pub fn absorption_per_m(&self, wavelength_nm: f64) -> f64 {
        4.0 * PI * self.k(wavelength_nm) / (wavelength_nm * 1e-9)
    }

    /// Returns the internal transmittance (without reflection) of a piece of `length_m` metres.
    pub fn internal_transmittance(&self, wavelength_nm: f64, length_m: f64) -> f64 {
        exp(-self.absorption_per_m(wavelength_nm) * length_m)
    }
}
