//! The two hemispheres of a surface, and cosine-weighted sampling of one of them.

use abbe_spectra::math::elementary::sin_cos;
use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

/// Returns −1 if `w` points below the surface, otherwise +1.
pub(super) fn z_sign(w: DVec3) -> f64 {
    if w.z < 0.0 { -1.0 } else { 1.0 }
}

/// Multiplies z by `sign`. With `z_sign(wo)`, it maps `wo` to the upper hemisphere.
pub(super) fn flip_z(w: DVec3, sign: f64) -> DVec3 {
    DVec3::new(w.x, w.y, w.z * sign)
}

pub(super) fn same_side(wo: DVec3, wi: DVec3) -> bool {
    wi.z * z_sign(wo) > 0.0
}

/// Samples a direction on the side given by `sign` with the pdf |cosθ|/π, by projecting a uniform
/// point of the unit disk onto the hemisphere (Malley's method).
pub(super) fn sample_cosine(sign: f64, u: f64, v: f64) -> DVec3 {
    let (sin, cos) = sin_cos(2.0 * PI * v);
    let radius = u.sqrt();
    // 1 − u is positive for u < 1, and the lower bound for a u that was rounded up to 1.
    let z = (1.0 - u).max(f64::EPSILON * f64::EPSILON).sqrt();
    DVec3::new(radius * cos, radius * sin, z * sign)
}

/// Returns the pdf per solid angle of [`sample_cosine`] on the side of `wi`.
pub(super) fn cosine_pdf(wi: DVec3) -> f64 {
    wi.z.abs() * FRAC_1_PI
}
