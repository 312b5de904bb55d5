//! Elements that do not mix the components along their axes s and p.

use super::mueller::Mueller;
use super::stokes::Stokes;
use abbe_spectra::math::complex::Complex;
use std::ops::{Add, Mul};

/// The Mueller matrix of an element that treats s and p differently and does not mix them, in the
/// frame x = s, y = p: an interface, a film, a polariser, a retarder or a sphere. Products and sums
/// act on each of the four numbers alone, so this form is faster than [`Mueller`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DiattenuatingRetarder {
    /// The fraction of the power of s.
    pub s: f64,
    /// The fraction of the power of p.
    pub p: f64,
    /// The mean of a_s·a_p* over incoherent paths with the amplitudes a_s and a_p of fields that
    /// vary as exp(−iωt). The argument is δ, and the absolute value at most √(s·p).
    pub cross: Complex,
}

impl DiattenuatingRetarder {
    /// The element that changes nothing.
    pub const IDENTITY: Self = Self { s: 1.0, p: 1.0, cross: Complex::new(1.0, 0.0) };

    /// The element that transmits nothing.
    pub const OPAQUE: Self = Self { s: 0.0, p: 0.0, cross: Complex::new(0.0, 0.0) };

    /// Returns the element with the amplitudes of fields that vary as exp(−iωt).
    #[inline]
    pub fn from_amplitudes(s: Complex, p: Complex) -> Self {
        Self { s: s.norm_squared(), p: p.norm_squared(), cross: s * p.conjugate() }
    }

    /// Returns the fraction of the power of unpolarised light.
    #[inline]
    pub fn mean(&self) -> f64 {
        0.5 * (self.s + self.p)
    }

    /// Returns the sum 1 + a + a² + … over the repetitions of this element. A component of 1 gives
    /// 0, because no light arrives that would be repeated.
    #[must_use]
    pub(crate) fn repeated(self) -> Self {
        let inverse = |x: f64| if x < 1.0 { 1.0 / (1.0 - x) } else { 0.0 };
        let rest = Complex::from(1.0) - self.cross;
        let cross = if rest == Complex::default() { rest } else { Complex::from(1.0) / rest };
        Self { s: inverse(self.s), p: inverse(self.p), cross }
    }
}

impl From<DiattenuatingRetarder> for Mueller {
    #[inline]
    fn from(element: DiattenuatingRetarder) -> Self {
        let DiattenuatingRetarder { s, p, cross: Complex { re, im } } = element;
        let (a, b) = (0.5 * (s + p), 0.5 * (s - p));
        Self([[a, b, 0.0, 0.0], [b, a, 0.0, 0.0], [0.0, 0.0, re, -im], [0.0, 0.0, im, re]])
    }
}

impl Mul<Stokes> for DiattenuatingRetarder {
    type Output = Stokes;

    #[inline]
    fn mul(self, light: Stokes) -> Stokes {
        let ([s0, s1, s2, s3], Complex { re, im }) = (light.0, self.cross);
        let (s, p) = (0.5 * self.s * (s0 + s1), 0.5 * self.p * (s0 - s1));
        Stokes([s + p, s - p, re * s2 - im * s3, im * s2 + re * s3])
    }
}

impl Mul for DiattenuatingRetarder {
    type Output = Self;

    /// Returns the elements in series, which is the same in both orders.
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self { s: self.s * other.s, p: self.p * other.p, cross: self.cross * other.cross }
    }
}

impl Add for DiattenuatingRetarder {
    type Output = Self;

    /// Adds incoherent paths.
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { s: self.s + other.s, p: self.p + other.p, cross: self.cross + other.cross }
    }
}

impl Mul<f64> for DiattenuatingRetarder {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self { s: self.s * factor, p: self.p * factor, cross: self.cross * factor }
    }
}
