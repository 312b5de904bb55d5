//! The two sides of a surface, and directions drawn on one of them.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

/// +1 where `w` lies on the outward side (or in the surface), −1 where it lies behind.
pub(super) fn side(w: DVec3) -> f64 {
    if w.z < 0.0 { -1.0 } else { 1.0 }
}

/// `w` mirrored in z when `side` is −1: what is seen from behind then looks as from the front.
pub(super) fn turned(w: DVec3, side: f64) -> DVec3 {
    DVec3::new(w.x, w.y, w.z * side)
}

/// Whether `wi` leaves on `wo`'s side.
pub(super) fn same_side(wo: DVec3, wi: DVec3) -> bool {
    wi.z * side(wo) > 0.0
}

/// A direction of density |cosθ|/π on the given side, by projecting a uniform point of the unit disk.
pub(super) fn sample_cosine(side: f64, u: f64, v: f64) -> DVec3 {
    let (sin, cos) = (2.0 * PI * v).sin_cos();
    let radius = u.sqrt();
    // 1 − u keeps a positive cosine for every u below 1; the bound covers a u that was rounded up to 1.
    let z = (1.0 - u).max(f64::EPSILON * f64::EPSILON).sqrt();
    DVec3::new(radius * cos, radius * sin, z * side)
}

/// The density of [`sample_cosine`] on `wi`'s own side, per solid angle.
pub(super) fn cosine_density(wi: DVec3) -> f64 {
    wi.z.abs() * FRAC_1_PI
}
