//! Exact formulas for the principal section of a prism, as a reference for tests. All angles are in
//! degrees: `apex_deg` in (0, 180), and `incidence_deg` from the normal of the first face, positive
//! towards the base. `n` is relative to the surrounding medium.

use abbe_spectra::math::elementary::{asin, sin};

/// Returns the deviation δ = i₁ + i₂ − α for the angle of incidence i₁, the angle i₂ at which the
/// ray leaves, and the apex angle α, or `None` under total reflection at the second face. Source:
/// Born & Wolf, *Principles of Optics*, §4.7.2.
pub fn deviation_deg(n: f64, apex_deg: f64, incidence_deg: f64) -> Option<f64> {
    let apex = apex_deg.to_radians();
    let refracted = asin(sin(incidence_deg.to_radians()) / n);
    let sin_out = n * sin(apex - refracted);
    (sin_out.abs() <= 1.0).then(|| incidence_deg + asin(sin_out).to_degrees() - apex_deg)
}

/// Returns the angle of incidence asin(n·sin(α/2)) of the symmetric path, which has the smallest
/// deviation, or `None` if no ray passes the prism.
pub fn minimum_deviation_incidence_deg(n: f64, apex_deg: f64) -> Option<f64> {
    let sin_in = n * sin(0.5 * apex_deg.to_radians());
    (sin_in <= 1.0).then(|| asin(sin_in).to_degrees())
}

/// Returns the minimum deviation 2·asin(n·sin(α/2)) − α, or `None` if no ray passes the prism.
pub fn minimum_deviation_deg(n: f64, apex_deg: f64) -> Option<f64> {
    minimum_deviation_incidence_deg(n, apex_deg).map(|incidence_deg| 2.0 * incidence_deg - apex_deg)
}

/// Returns the smallest signed angle of incidence at which the ray still leaves through the second
/// face, or `None` if no ray or every ray passes.
pub fn least_passing_incidence_deg(n: f64, apex_deg: f64) -> Option<f64> {
    let sin_in = n * sin(apex_deg.to_radians() - asin(1.0 / n));
    (sin_in.abs() <= 1.0).then(|| asin(sin_in).to_degrees())
}
