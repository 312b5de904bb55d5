//! Complex numbers.

use super::elementary::{exp, hypot, sin_cos};
use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// A complex number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Complex {
    /// The real part.
    pub re: f64,
    /// The imaginary part.
    pub im: f64,
}

impl Complex {
    /// Returns the number `re` + i·`im`.
    #[inline]
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// Returns the number of absolute value 1 whose angle in radians this is.
    pub fn unit(angle: f64) -> Self {
        let (im, re) = sin_cos(angle);
        Self { re, im }
    }

    /// Returns exp(i·z) of the number z.
    pub fn exp_i(self) -> Self {
        let unit = Self::unit(self.re);
        if self.im == 0.0 { unit } else { unit * exp(-self.im) }
    }

    /// Returns the complex conjugate.
    #[inline]
    pub fn conjugate(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// Returns the square of the absolute value.
    #[inline]
    pub fn norm_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// Returns the square root with a non-negative imaginary part. Its real part is not negative
    /// either if the imaginary part of the number is not.
    pub fn sqrt(self) -> Self {
        if self.im == 0.0 {
            let root = self.re.abs().sqrt();
            return if self.re >= 0.0 { Self::new(root, 0.0) } else { Self::new(0.0, root) };
        }
        // The larger part comes from a sum of positive numbers, and the other from the product.
        let larger = (0.5 * (hypot(self.re, self.im) + self.re.abs())).sqrt();
        let smaller = 0.5 * self.im.abs() / larger;
        let (re, im) = if self.re >= 0.0 { (larger, smaller) } else { (smaller, larger) };
        Self { re: re.copysign(self.im), im }
    }
}

impl From<f64> for Complex {
    fn from(re: f64) -> Self {
        Self { re, im: 0.0 }
    }
}

impl Add for Complex {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl AddAssign for Complex {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Complex {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Mul<f64> for Complex {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
}

impl Div for Complex {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        self * other.conjugate() * (1.0 / other.norm_squared())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_lies_in_the_upper_half_plane_and_squares_to_the_number() {
        for number in [
            Complex::new(4.0, 0.0),
            Complex::new(-4.0, 0.0),
            Complex::new(-3.0, 1e-9),
            Complex::new(2.0, 5.0),
            Complex::new(2.0, -5.0),
            Complex::new(-2.0, -1e-3),
            Complex::default(),
        ] {
            let root = number.sqrt();
            let error = root * root - number;
            assert!(root.im >= 0.0 && error.norm_squared() < 1e-28, "{number:?}: {root:?}");
            assert!(number.im < 0.0 || root.re >= 0.0, "{number:?}: {root:?}");
        }
    }

    #[test]
    fn division_inverts_multiplication() {
        let (a, b) = (Complex::new(0.3, -2.0), Complex::new(1.5, 0.7));
        assert!((a * b / b - a).norm_squared() < 1e-30);
        assert!((Complex::new(0.4, 0.9).exp_i() - Complex::unit(0.4) * (-0.9_f64).exp()).norm_squared() < 1e-30);
    }
}
