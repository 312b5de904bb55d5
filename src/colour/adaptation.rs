//! Chromatic adaptation: what a colour under one white looks like under another.

use super::Xyz;
use super::matrix::{Matrix, apply, diagonal, inverse, product};

/// A linear cone-like space in which adaptation scales the three components (von Kries).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transform {
    /// Bradford (Lam 1985), as ICC profiles use it.
    Bradford,
    /// CAT16 (Li et al. 2017), that of CIECAM16, for complete adaptation.
    Cat16,
}

const BRADFORD: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
const CAT16: Matrix =
    [[0.401_288, 0.650_173, -0.051_461], [-0.250_268, 1.204_414, 0.045_854], [-0.002_079, 0.048_952, 0.953_127]];

impl Transform {
    fn matrix(self) -> &'static Matrix {
        match self {
            Self::Bradford => &BRADFORD,
            Self::Cat16 => &CAT16,
        }
    }

    /// Whether light of this colour can be taken for white: each of the three components must see at least a hundredth
    /// of what the strongest sees. Light of a single line leaves one of them without a response, or below zero; to
    /// adapt to it would multiply noise, or turn colours inside out.
    pub fn can_adapt_from(self, white: Xyz) -> bool {
        const LEAST: f64 = 0.01;
        let seen = apply(self.matrix(), white);
        let strongest = seen.into_iter().fold(0.0, f64::max);
        strongest.is_finite() && strongest > 0.0 && seen.iter().all(|response| *response >= LEAST * strongest)
    }
}

/// The rows that turn XYZ under the white `from` into XYZ under the white `to`. Whites are taken at Y = 1, so that
/// luminance keeps its scale.
pub fn adaptation(from: Xyz, to: Xyz, transform: Transform) -> [[f64; 3]; 3] {
    let cones = transform.matrix();
    let seen = |white: Xyz| apply(cones, white.map(|value| value / white[1]));
    let (from, to) = (seen(from), seen(to));
    let scale = diagonal([to[0] / from[0], to[1] / from[1], to[2] / from[2]]);
    product(&inverse(cones), &product(&scale, cones))
}

/// XYZ under the white `to` that looks as `xyz` under the white `from`.
pub fn adapt(xyz: Xyz, from: Xyz, to: Xyz, transform: Transform) -> Xyz {
    apply(&adaptation(from, to, transform), xyz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamps_can_be_adapted_from_and_lines_cannot() {
        let (candle, high_pressure_sodium) = ([1.24, 1.0, 0.13], [1.28, 1.0, 0.09]);
        let (low_pressure_sodium, violet, dark) = ([1.3299, 1.0, 0.0016], [25.0, 1.0, 120.0], [0.0; 3]);
        let can = |white: Xyz| Transform::Bradford.can_adapt_from(white);
        assert!([candle, high_pressure_sodium].into_iter().all(can));
        assert!(![low_pressure_sodium, violet, dark].into_iter().any(can));
    }

    #[test]
    fn white_becomes_white() {
        let (a, d65) = ([1.0985, 1.0, 0.3558], [0.9505, 1.0, 1.0891]);
        for transform in [Transform::Bradford, Transform::Cat16] {
            let white = adapt(a, a, d65, transform);
            assert!(white.iter().zip(d65).all(|(value, known)| (value - known).abs() < 1e-14));
        }
    }
}
