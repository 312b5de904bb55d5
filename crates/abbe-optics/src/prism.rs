//! Exact formulas for the principal section of a prism, as a reference for tests.
//!
//! All angles are in degrees. `n` is the prism's refractive index relative to the surrounding
//! medium. `apex_deg` lies in (0, 180). `incidence_deg` is measured from the normal of the first
//! face; it is positive if the ray arrives from the side of the base.

use abbe_spectra::math::elementary::{asin, sin};

/// Returns the deviation δ = i₁ + i₂ − α of a ray, or `None` if the second face reflects the ray
/// totally.
///
/// Here i₁ is the angle of incidence, i₂ is the angle at which the ray leaves, and α is the apex
/// angle. Source: Born & Wolf, *Principles of Optics*, §4.7.2.
pub fn deviation_deg(n: f64, apex_deg: f64, incidence_deg: f64) -> Option<f64> {
    let apex = apex_deg.to_radians();
    let refracted = asin(sin(incidence_deg.to_radians()) / n);
    let sin_out = n * sin(apex - refracted);
    (sin_out.abs() <= 1.0).then(|| incidence_deg + asin(sin_out).to_degrees() - apex_deg)
}

/// Returns the angle of incidence asin(n·sin(α/2)), at which the path of the ray is symmetric and
/// the deviation smallest. Returns `None` if no ray passes the prism.
pub fn minimum_deviation_incidence_deg(n: f64, apex_deg: f64) -> Option<f64> {
    let sin_in = n * sin(0.5 * apex_deg.to_radians());
    (sin_in <= 1.0).then(|| asin(sin_in).to_degrees())
}

/// Returns the minimum deviation 2·asin(n·sin(α/2)) − α, or `None` if no ray passes the prism.
pub fn minimum_deviation_deg(n: f64, apex_deg: f64) -> Option<f64> {
    minimum_deviation_incidence_deg(n, apex_deg).map(|incidence_deg| 2.0 * incidence_deg - apex_deg)
}

/// Returns the smallest signed angle of incidence at which the ray still leaves through the second
/// face. Returns `None` if no ray passes or if every ray passes.
pub fn least_passing_incidence_deg(n: f64, apex_deg: f64) -> Option<f64> {
    let sin_in = n * sin(apex_deg.to_radians() - asin(1.0 / n));
    (sin_in.abs() <= 1.0).then(|| asin(sin_in).to_degrees())
}
