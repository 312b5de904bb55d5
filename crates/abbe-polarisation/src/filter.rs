//! Polarisers and retarders.

use super::diattenuating_retarder::DiattenuatingRetarder;
use super::frame::Rotation;
use super::mueller::Mueller;
use abbe_spectra::math::complex::Complex;

/// The ideal linear polariser that transmits x.
pub const IDEAL_POLARISER: DiattenuatingRetarder =
    DiattenuatingRetarder { s: 1.0, p: 0.0, cross: Complex::new(0.0, 0.0) };

/// Returns a linear polariser whose principal transmittances along x and y are `k1` and `k2`, both
/// from 0 to 1. It has no retardance.
pub fn linear_polariser(k1: f64, k2: f64) -> DiattenuatingRetarder {
    DiattenuatingRetarder { s: k1, p: k2, cross: (k1 * k2).sqrt().into() }
}

/// Returns a retarder with the fast axis along x. The component along y lags by the retardance, in
/// radians.
pub fn retarder(retardance: f64) -> DiattenuatingRetarder {
    DiattenuatingRetarder { cross: Complex::unit(-retardance), ..DiattenuatingRetarder::IDENTITY }
}

/// The sense in which the field of circular light rotates, as the receiver sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handedness {
    /// Clockwise: S3 > 0.
    Right,
    /// Counter-clockwise: S3 < 0.
    Left,
}

/// Returns a circular polariser: an ideal polariser along x, then a retarder with its fast axis at
/// 45° for right-circular or −45° for left-circular light, which is a quarter-wave plate at the
/// retardance π/2.
pub fn circular_polariser(handedness: Handedness, retardance: f64) -> Mueller {
    let angle_deg = match handedness {
        Handedness::Right => 45.0,
        Handedness::Left => -45.0,
    };
    Mueller::from(retarder(retardance)).turned(Rotation::degrees(angle_deg)) * Mueller::from(IDEAL_POLARISER)
}
