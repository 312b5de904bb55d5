//! The textbook angles of a prism, in its principal section: closed forms that the rest is tested against.
//!
//! Angles are in degrees; `n` is the prism's index relative to the medium around; `apex_deg` lies in (0, 180);
//! `incidence_deg` is measured from the first face's normal, positive when the ray comes from the side of the base.

/// By how much a prism turns a ray, δ = i₁ + i₂ − α, or `None` where the second face reflects it totally.
///
/// (Born & Wolf, Principles of Optics, §4.7.2.)
pub fn deviation_deg(n: f64, apex_deg: f64, incidence_deg: f64) -> Option<f64> {
    let apex = apex_deg.to_radians();
    let refracted = (incidence_deg.to_radians().sin() / n).asin();
    let sin_out = n * (apex - refracted).sin();
    (sin_out.abs() <= 1.0).then(|| incidence_deg + sin_out.asin().to_degrees() - apex_deg)
}

/// The angle of incidence of least deviation, where the ray passes symmetrically: asin(n·sin(α/2)); `None` where no ray passes.
pub fn minimum_deviation_incidence_deg(n: f64, apex_deg: f64) -> Option<f64> {
    let sin_in = n * (0.5 * apex_deg.to_radians()).sin();
    (sin_in <= 1.0).then(|| sin_in.asin().to_degrees())
}

/// The least deviation, 2·asin(n·sin(α/2)) − α; `None` where no ray passes.
pub fn minimum_deviation_deg(n: f64, apex_deg: f64) -> Option<f64> {
    minimum_deviation_incidence_deg(n, apex_deg).map(|incidence_deg| 2.0 * incidence_deg - apex_deg)
}

/// The smallest angle of incidence (signed) whose ray still leaves through the second face; `None` where no ray passes, or
/// where all do.
pub fn least_passing_incidence_deg(n: f64, apex_deg: f64) -> Option<f64> {
    let sin_in = n * (apex_deg.to_radians() - (1.0 / n).asin()).sin();
    (sin_in.abs() <= 1.0).then(|| sin_in.asin().to_degrees())
}
