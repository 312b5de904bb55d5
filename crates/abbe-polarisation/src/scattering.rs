//! Scattering by air and by spheres. The frames of both directions have x perpendicular to the
//! scattering plane.

use super::diattenuating_retarder::DiattenuatingRetarder;
use super::mueller::Mueller;
use abbe_optics::phase::mie::MieMatrix;
use abbe_spectra::math::complex::Complex;
use std::f64::consts::PI;

/// The depolarisation of air: the ratio of the powers of p and s that natural light gives at 90°
/// (Young 1981, "On the Rayleigh-scattering optical depth of the atmosphere").
pub const AIR_DEPOLARISATION: f64 = 0.0279;

/// Returns the phase matrix of Rayleigh scattering in 1/sr, whose first element integrates to 1.
/// `depolarisation` is from 0 to 1/2; see [`AIR_DEPOLARISATION`] (Hansen & Travis 1974, equation
/// 2.15).
pub fn rayleigh(cos_theta: f64, depolarisation: f64) -> Mueller {
    let oriented = (1.0 - depolarisation) / (1.0 + 0.5 * depolarisation);
    let circular = (1.0 - 2.0 * depolarisation) / (1.0 - depolarisation);
    let (scale, c) = (oriented * 3.0 / (16.0 * PI), cos_theta);
    let (same, other, cross) = (scale * (1.0 + c * c), scale * (1.0 - c * c), scale * 2.0 * c);
    let isotropic = 0.25 / PI * (1.0 - oriented);
    Mueller([
        [same + isotropic, other, 0.0, 0.0],
        [other, same, 0.0, 0.0],
        [0.0, 0.0, cross, 0.0],
        [0.0, 0.0, 0.0, cross * circular],
    ])
}

/// Returns the phase matrix of spheres in 1/sr, from its elements in the notation of Bohren &
/// Huffman, whose first axis lies in the scattering plane.
pub fn spheres(MieMatrix { s11, s12, s33, s34 }: MieMatrix) -> DiattenuatingRetarder {
    DiattenuatingRetarder { s: s11 - s12, p: s11 + s12, cross: Complex::new(s33, -s34) }
}
