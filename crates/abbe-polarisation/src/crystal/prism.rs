//! Polarising prisms.
//!
//! Light arrives along the normal of the first face. The interface of the two parts is inclined by
//! the wedge angle, and all optic axes are parallel or perpendicular to the plane of incidence, so
//! each beam obeys Snell's law with one index in each part.

use super::indices::UniaxialIndices;
use abbe_spectra::math::elementary::asin;

/// Returns the angle in degrees at which a beam leaves the second face into air, positive towards
/// the side where the second part is thicker, or `None` if it is totally reflected.
fn exit_deg(first: f64, second: f64, wedge_deg: f64) -> Option<f64> {
    let wedge = wedge_deg.to_radians();
    let sine = |x: f64| (x.abs() <= 1.0).then(|| asin(x));
    // The wave vector along the interface is continuous, and so is that along the last face.
    let inside = sine(first * abbe_spectra::math::elementary::sin(wedge) / second)?;
    let out = sine(second * abbe_spectra::math::elementary::sin(wedge - inside))?;
    Some(out.to_degrees())
}

/// Returns the exit angles in degrees of a Wollaston prism with the optic axes along x and then
/// along y, whose interface has the normal (sin w, 0, −cos w) with the wedge angle w in degrees:
/// first the beam with its field along x, then that along y. Angles towards +x are positive. A beam
/// that is totally reflected has no angle.
pub fn wollaston_exits_deg(indices: UniaxialIndices, wedge_deg: f64) -> [Option<f64>; 2] {
    let UniaxialIndices { ordinary: o, extraordinary: e } = indices;
    [exit_deg(e, o, wedge_deg), exit_deg(o, e, wedge_deg)]
}

/// Returns the exit angles in degrees of a Rochon prism, as [`wollaston_exits_deg`]. The optic axes
/// are along z and then along y, so the beam with its field along x is not deviated.
pub fn rochon_exits_deg(indices: UniaxialIndices, wedge_deg: f64) -> [Option<f64>; 2] {
    let UniaxialIndices { ordinary: o, extraordinary: e } = indices;
    [exit_deg(o, o, wedge_deg), exit_deg(o, e, wedge_deg)]
}

/// Returns the critical angles in degrees of the ordinary and the extraordinary wave at the air gap
/// of a Glan–Foucault prism, whose axes are perpendicular to the plane of incidence. Between both
/// angles, only one wave passes.
pub fn glan_foucault_angles_deg(indices: UniaxialIndices) -> [f64; 2] {
    [indices.ordinary, indices.extraordinary].map(|n| asin(1.0 / n).to_degrees())
}
