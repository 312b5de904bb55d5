//! The Henyey–Greenstein phase function (Henyey & Greenstein 1941), whose parameter g is the mean
//! cosine of the scattering angle.
//!
//! Backward scattering (g < 0) is the mirror image of forward scattering. For g ≥ 0, the pdf and
//! its quantile are written in terms of 1 − cos θ without cancellation, so neither g = 0 nor a very
//! narrow peak needs a special case.

use std::f64::consts::PI;

/// Largest |g| for which cosines in double precision resolve the peak of the phase function.
pub const MAX_MEAN_COSINE: f64 = 0.999_999;

/// Returns (1 − g²) / (4π((1 − g)² + 2g(1 − cos θ))^(3/2)) per sr for |g| ≤ [`MAX_MEAN_COSINE`].
pub(super) fn eval(g: f64, cos_theta: f64) -> f64 {
    let (g, cos) = if g < 0.0 { (-g, -cos_theta) } else { (g, cos_theta) };
    let apart = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos);
    (1.0 - g) * (1.0 + g) / (4.0 * PI * apart * apart.sqrt())
}

/// Returns the quantile of 1 − cos θ for a probability `u` in [0, 1) and g ≥ 0. The difference of
/// squares of the usual formula is factored to avoid cancellation.
pub(super) fn quantile(g: f64, u: f64) -> f64 {
    // The result keeps full precision at the peak, where `u` is small.
    let v = (1.0 - g) / (1.0 + g - 2.0 * g * u);
    2.0 * u * v * v * (1.0 + g - g * u)
}
