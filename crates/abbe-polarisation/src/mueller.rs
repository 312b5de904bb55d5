//! Mueller matrices.

use super::frame::Rotation;
use super::stokes::Stokes;
use std::ops::{Add, Mul};

/// A Mueller matrix, row by row. It maps the Stokes vector of the arriving light to that of the
/// leaving light, each in its own frame. A camera path carries the product of the matrices between
/// a point and the camera, of which the first row is the sensor's response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mueller(pub [[f64; 4]; 4]);

impl Mueller {
    /// The matrix of nothing.
    pub const IDENTITY: Self = Self::diagonal([1.0; 4]);

    /// Returns a matrix with these diagonal elements and zeros elsewhere.
    #[inline]
    pub const fn diagonal(elements: [f64; 4]) -> Self {
        let [a, b, c, d] = elements;
        Self([[a, 0.0, 0.0, 0.0], [0.0, b, 0.0, 0.0], [0.0, 0.0, c, 0.0], [0.0, 0.0, 0.0, d]])
    }

    /// Returns the ideal depolariser that transmits a fraction of the power.
    #[inline]
    pub const fn depolariser(transmittance: f64) -> Self {
        Self::diagonal([transmittance, 0.0, 0.0, 0.0])
    }

    /// Returns the matrix of the element after a rotation, R(−θ) M R(θ): an element with its axis
    /// along x becomes one with its axis at θ.
    #[inline]
    #[must_use]
    pub fn turned(self, rotation: Rotation) -> Self {
        rotation.inverse() * (self * rotation)
    }

    /// Returns the matrix for light on the reversed path. The frames of the reversed path have the
    /// same x axes, so their y axes are opposite (reciprocity: Sekera 1966; van de Hulst 1957,
    /// §5.22).
    #[must_use]
    pub fn reversed(self) -> Self {
        const SIGNS: [f64; 4] = [1.0, 1.0, -1.0, 1.0];
        Self(std::array::from_fn(|i| std::array::from_fn(|j| SIGNS[i] * SIGNS[j] * self.0[j][i])))
    }
}

impl Mul<Stokes> for Mueller {
    type Output = Stokes;

    #[inline]
    fn mul(self, light: Stokes) -> Stokes {
        Stokes(self.0.map(|row| row.iter().zip(light.0).map(|(element, component)| element * component).sum()))
    }
}

impl Mul for Mueller {
    type Output = Self;

    /// Returns the matrix of `first`, then `self`.
    #[inline]
    fn mul(self, first: Self) -> Self {
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..4).map(|k| self.0[i][k] * first.0[k][j]).sum::<f64>())
        }))
    }
}

impl Mul<Rotation> for Mueller {
    type Output = Self;

    /// Returns the matrix for light in a frame that is rotated first.
    #[inline]
    fn mul(self, Rotation { cos, sin }: Rotation) -> Self {
        Self(self.0.map(|[a, b, c, d]| [a, b * cos - c * sin, b * sin + c * cos, d]))
    }
}

impl Mul<Mueller> for Rotation {
    type Output = Mueller;

    /// Returns the matrix for leaving light in the rotated frame.
    #[inline]
    fn mul(self, Mueller([a, b, c, d]): Mueller) -> Mueller {
        Mueller([a, combined([self.cos, self.sin], b, c), combined([-self.sin, self.cos], b, c), d])
    }
}

#[inline]
fn combined(weights: [f64; 2], a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| weights[0] * a[i] + weights[1] * b[i])
}

impl Add for Mueller {
    type Output = Self;

    /// Adds incoherent paths.
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[i][j] + other.0[i][j])))
    }
}

impl Mul<f64> for Mueller {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|row| row.map(|element| element * factor)))
    }
}
