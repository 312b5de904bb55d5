//! Polarisers and retarders.

use super::diattenuating_retarder::DiattenuatingRetarder;
use super::frame::Rotation;
use super::jones::Jones;
use super::mueller::Mueller;
use abbe_spectra::math::complex::Complex;
use abbe_spectra::math::elementary::{hypot, sin_cos};

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

/// Returns a retarder whose fast axis turns evenly from x by `twist`, counter-clockwise as the
/// receiver sees it, such as a liquid crystal (Yeh & Gu, *Optics of Liquid Crystal Displays*,
/// chapter 4). Both angles are in radians, and the retardance is that without a twist.
pub fn twisted_retarder(retardance: f64, twist: f64) -> Mueller {
    let half = 0.5 * retardance;
    // In the frame that turns with the axis, the Jones vector changes by a constant matrix.
    let turn = hypot(half, twist);
    let (sin, cos) = sin_cos(turn);
    let sinc = if turn > 0.0 { sin / turn } else { 1.0 };
    let turning = Jones([
        [Complex::new(cos, -half * sinc), (twist * sinc).into()],
        [(-twist * sinc).into(), Complex::new(cos, half * sinc)],
    ]);
    let (sin, cos) = sin_cos(twist);
    let to_entrance = Jones([[cos.into(), (-sin).into()], [sin.into(), cos.into()]]);
    (to_entrance * turning).mueller()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stokes;

    /// A twisted retarder is the limit of a pile of thin retarders.
    #[test]
    fn a_twisted_retarder_is_a_pile_of_thin_ones() {
        for (retardance, twist) in [(3.0, 1.2), (7.0, -0.6), (0.0, 0.9), (2.0, 0.0)] {
            let count = 4000;
            let thin = Mueller::from(retarder(retardance / f64::from(count)));
            let pile = (0..count).fold(Mueller::IDENTITY, |pile, i| {
                let angle: f64 = twist * (f64::from(i) + 0.5) / f64::from(count);
                thin.turned(Rotation::degrees(angle.to_degrees())) * pile
            });
            let found = twisted_retarder(retardance, twist);
            let (found, pile) = (found.0.as_flattened(), pile.0.as_flattened());
            assert!(
                found.iter().zip(pile).all(|(a, b)| (a - b).abs() < 1e-6),
                "{retardance}, {twist}: {found:?} {pile:?}"
            );
        }
    }

    /// A cell that turns the axis by 90° transmits sin²(½π√(1 + u²))/(1 + u²) between parallel
    /// polarisers along its first axis, with u = 2dΔn/λ (Gooch & Tarry 1975).
    #[test]
    fn a_twisted_cell_transmits_as_gooch_and_tarry_say() {
        let polariser = Mueller::from(IDEAL_POLARISER);
        for u in [0.5, 3.0_f64.sqrt(), 2.7, 15.0_f64.sqrt()] {
            let quarter = std::f64::consts::FRAC_PI_2;
            let light =
                polariser * (twisted_retarder(u * 2.0 * quarter, quarter) * (polariser * Stokes::unpolarised(2.0)));
            let known = (quarter * (1.0 + u * u).sqrt()).sin().powi(2) / (1.0 + u * u);
            assert!((light.power() - known).abs() < 1e-12, "{u}: {} for {known}", light.power());
        }
    }
}
