//! Affine maps of texture coordinates.

use super::point::TexturePoint;
use abbe_spectra::math::elementary::sin_cos;

/// An affine map of uv: scale, then rotation, then translation (glTF's `KHR_texture_transform`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvTransform {
    matrix: [[f64; 2]; 2],
    offset: [f64; 2],
}

impl UvTransform {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self { matrix: [[1.0, 0.0], [0.0, 1.0]], offset: [0.0; 2] };

    /// Creates the map, which turns a picture by `turn` radians counter-clockwise.
    pub fn new(scale: [f64; 2], turn: f64, offset: [f64; 2]) -> Self {
        let (sin, cos) = sin_cos(turn);
        Self { matrix: [[cos * scale[0], sin * scale[1]], [-sin * scale[0], cos * scale[1]]], offset }
    }

    /// Returns the map followed by a scale of both coordinates.
    #[must_use]
    pub fn scaled(self, scale: f64) -> Self {
        let both = |pair: [f64; 2]| pair.map(|x| scale * x);
        Self { matrix: self.matrix.map(both), offset: both(self.offset) }
    }

    fn edge(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        self.matrix.map(|row| row[0] * u + row[1] * v)
    }

    /// Maps a point and its footprint.
    pub fn apply(&self, point: &TexturePoint) -> TexturePoint {
        let uv = self.edge(point.uv);
        TexturePoint {
            uv: [uv[0] + self.offset[0], uv[1] + self.offset[1]],
            footprint: point.footprint.map(|edge| self.edge(edge)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// The matrix of `KHR_texture_transform` for a scale of (2, 3), a quarter turn and an offset.
    #[test]
    fn scale_comes_before_rotation_and_offset() {
        let map = UvTransform::new([2.0, 3.0], FRAC_PI_2, [0.25, 0.5]);
        let TexturePoint { uv, footprint } =
            map.apply(&TexturePoint { uv: [1.0, 1.0], footprint: [[1.0, 0.0], [0.0, 1.0]] });
        let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(uv, [3.25, -1.5]), "{uv:?}");
        assert!(close(footprint[0], [0.0, -2.0]) && close(footprint[1], [3.0, 0.0]), "{footprint:?}");
    }
}
