//! Chromatic adaptation: corresponding colours under different white points.

use super::matrix::{Matrix3, apply, diagonal, inverse, product};
use super::tristimulus::Xyz;

/// A von Kries chromatic adaptation transform, which scales components like cone responses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdaptationTransform {
    /// Bradford (Lam 1985), which ICC profiles use.
    Bradford,
    /// CAT16 (Li et al. 2017), the transform of CIECAM16. Adaptation is assumed to be complete.
    Cat16,
}

const BRADFORD: Matrix3 = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
const CAT16: Matrix3 =
    [[0.401_288, 0.650_173, -0.051_461], [-0.250_268, 1.204_414, 0.045_854], [-0.002_079, 0.048_952, 0.953_127]];

impl AdaptationTransform {
    fn matrix(self) -> &'static Matrix3 {
        match self {
            Self::Bradford => &BRADFORD,
            Self::Cat16 => &CAT16,
        }
    }

    /// Returns true if `white` can be a white point: each of the three cone responses to it must be
    /// at least 1/100 of the strongest. A single spectral line may have responses near 0 or below,
    /// and adaptation to it would amplify noise or invert colours.
    pub fn can_adapt_from(self, white: Xyz) -> bool {
        const LEAST_RESPONSE: f64 = 0.01;
        let seen = apply(self.matrix(), white);
        let strongest = seen.into_iter().fold(0.0, f64::max);
        strongest.is_finite() && strongest > 0.0 && seen.iter().all(|response| *response >= LEAST_RESPONSE * strongest)
    }
}

/// Returns the matrix from XYZ under the white `from` to the corresponding XYZ under the white
/// `to`. Both whites are normalised to Y = 1, so luminance keeps its scale.
pub fn adaptation(from: Xyz, to: Xyz, transform: AdaptationTransform) -> [[f64; 3]; 3] {
    let cones = transform.matrix();
    let seen = |white: Xyz| apply(cones, white.map(|value| value / white[1]));
    let (from, to) = (seen(from), seen(to));
    let scale = diagonal([to[0] / from[0], to[1] / from[1], to[2] / from[2]]);
    product(&inverse(cones), &product(&scale, cones))
}

/// Returns the XYZ under the white `to` that corresponds to `xyz` under the white `from`.
pub fn adapt(xyz: Xyz, from: Xyz, to: Xyz, transform: AdaptationTransform) -> Xyz {
    apply(&adaptation(from, to, transform), xyz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamps_are_usable_white_points_and_lines_are_not() {
        let (candle, high_pressure_sodium) = ([1.24, 1.0, 0.13], [1.28, 1.0, 0.09]);
        let (low_pressure_sodium, violet, dark) = ([1.3299, 1.0, 0.0016], [25.0, 1.0, 120.0], [0.0; 3]);
        let can = |white: Xyz| AdaptationTransform::Bradford.can_adapt_from(white);
        assert!([candle, high_pressure_sodium].into_iter().all(can));
        assert!(![low_pressure_sodium, violet, dark].into_iter().any(can));
    }

    #[test]
    fn white_becomes_white() {
        let (a, d65) = ([1.0985, 1.0, 0.3558], [0.9505, 1.0, 1.0891]);
        for transform in [AdaptationTransform::Bradford, AdaptationTransform::Cat16] {
            let white = adapt(a, a, d65, transform);
            assert!(white.iter().zip(d65).all(|(value, known)| (value - known).abs() < 1e-14));
        }
    }
}
