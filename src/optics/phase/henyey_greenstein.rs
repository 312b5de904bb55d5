//! Henyey & Greenstein's function (1941), whose one parameter g is the mean cosine.
//!
//! Backward scattering (g < 0) is forward scattering mirrored. What is left, 0 ≤ g, is written in 1 − cos θ, without a difference
//! of nearly equal numbers in either the density or the draw; so g = 0 and the narrowest peaks need no branch of their own.

use std::f64::consts::PI;

/// The largest |g|: beyond it a cosine in double precision no longer resolves the peak.
pub const MAX_MEAN_COSINE: f64 = 0.999_999;

/// The density per steradian, |g| ≤ [`MAX_MEAN_COSINE`]: (1 − g²) / 4π((1 − g)² + 2g(1 − cos θ))^(3/2).
pub(super) fn at(g: f64, cos_theta: f64) -> f64 {
    let (g, cos) = if g < 0.0 { (-g, -cos_theta) } else { (g, cos_theta) };
    let apart = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos);
    (1.0 - g) * (1.0 + g) / (4.0 * PI * apart * apart.sqrt())
}

/// 1 − cos of the angle from the peak below which a share `u` in [0, 1) of the light is scattered, 0 ≤ g:
/// the usual inverse with its difference of squares multiplied out.
pub(super) fn quantile(g: f64, u: f64) -> f64 {
    // Counted from the far end, so that small `u` are near the peak with all their digits.
    let v = (1.0 - g) / (1.0 + g - 2.0 * g * u);
    2.0 * u * v * v * (1.0 + g - g * u)
}
