//! The Stokes vector of a beam.

use abbe_spectra::math::elementary::atan2;
use std::ops::{Add, AddAssign, Mul};

/// The Stokes vector (S0, S1, S2, S3) of a beam in the frame that its owner states. S0 is the total
/// power, in any unit. A photon may store `Stokes<f32>`; all operations compute with `f64`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stokes<T = f64>(pub [T; 4]);

impl Stokes {
    /// Returns unpolarised light of a power.
    #[inline]
    pub const fn unpolarised(power: f64) -> Self {
        Self([power, 0.0, 0.0, 0.0])
    }

    /// Returns the total power S0.
    #[inline]
    pub const fn power(&self) -> f64 {
        self.0[0]
    }

    /// Returns the degree of polarisation, from 0 to 1 for physical light, and 0 without light.
    pub fn degree_of_polarisation(&self) -> f64 {
        let [s0, s1, s2, s3] = self.0;
        if s0 > 0.0 { (s1 * s1 + s2 * s2 + s3 * s3).sqrt() / s0 } else { 0.0 }
    }

    /// Returns the degree of linear polarisation, from 0 to 1, and 0 without light.
    pub fn degree_of_linear_polarisation(&self) -> f64 {
        let [s0, s1, s2, _] = self.0;
        if s0 > 0.0 { (s1 * s1 + s2 * s2).sqrt() / s0 } else { 0.0 }
    }

    /// Returns the angle of polarisation in degrees above −90 and up to 90: that of the major axis
    /// from x, counter-clockwise as the receiver sees it. It is 0 if the light is not linearly
    /// polarised.
    pub fn angle_of_polarisation_deg(&self) -> f64 {
        0.5 * atan2(self.0[2], self.0[1]).to_degrees()
    }
}

impl From<Stokes<f32>> for Stokes {
    #[inline]
    fn from(stokes: Stokes<f32>) -> Self {
        Self(stokes.0.map(f64::from))
    }
}

impl From<Stokes> for Stokes<f32> {
    #[inline]
    fn from(stokes: Stokes) -> Self {
        Self(stokes.0.map(|component| component as f32))
    }
}

impl Add for Stokes {
    type Output = Self;

    /// Adds incoherent beams in the same frame.
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl AddAssign for Stokes {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Stokes {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|component| component * factor))
    }
}
