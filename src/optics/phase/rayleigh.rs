//! Scattering by particles much smaller than the wavelength (Rayleigh 1871): 3/(16π)·(1 + cos²θ).

use std::f64::consts::PI;

/// The density per steradian.
pub(super) fn at(cos_theta: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos_theta * cos_theta)
}

/// 1 − cos θ below which a share `u` in [0, 1) of the light is scattered: the real root of c³ + 3c = 4 − 8u, which is
/// 2 sinh(asinh(2 − 4u)/3) (Frisvad 2011 in another form).
pub(super) fn quantile(u: f64) -> f64 {
    (1.0 - 2.0 * ((2.0 - 4.0 * u).asinh() / 3.0).sinh()).clamp(0.0, 2.0)
}
