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
    fn white_becomes_white() {
        let (a, d65) = ([1.0985, 1.0, 0.3558], [0.9505, 1.0, 1.0891]);
        for transform in [Transform::Bradford, Transform::Cat16] {
            let white = adapt(a, a, d65, transform);
            assert!(white.iter().zip(d65).all(|(value, known)| (value - known).abs() < 1e-14));
        }
    }
}
