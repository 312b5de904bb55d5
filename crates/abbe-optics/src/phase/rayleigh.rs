//! Scattering by very small particles: p = 3/(16π)·(1 + cos²θ) (Rayleigh 1871).

use abbe_spectra::math::elementary::{asinh, sinh};
use std::f64::consts::PI;

pub(super) fn eval(cos_theta: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos_theta * cos_theta)
}

/// Returns the quantile of 1 − cos θ for a probability `u` in [0, 1): cos θ is the real root
/// 2·sinh(asinh(2 − 4u)/3) of c³ + 3c = 4 − 8u, which Frisvad 2011 writes in another form.
pub(super) fn quantile(u: f64) -> f64 {
    (1.0 - 2.0 * sinh(asinh(2.0 - 4.0 * u) / 3.0)).clamp(0.0, 2.0)
}
