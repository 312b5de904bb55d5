//! Jones vectors and matrices: fully polarised fields and elements that do not depolarise.

use super::mueller::Mueller;
use super::stokes::Stokes;
use abbe_spectra::math::complex::Complex;
use std::ops::Mul;

/// The components of a field along x and y. Fields vary as exp(−iωt).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct JonesVector(pub [Complex; 2]);

/// A Jones matrix, row by row, in frames with the axes x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jones(pub [[Complex; 2]; 2]);

impl JonesVector {
    /// Returns the Stokes vector, whose power is |Ex|² + |Ey|².
    pub fn stokes(&self) -> Stokes {
        stokes_of(self.0, self.0)
    }
}

/// Returns the Stokes parameters as a form of two fields, which is real in the sum of both orders.
fn stokes_of(a: [Complex; 2], b: [Complex; 2]) -> Stokes {
    let product = |x: Complex, y: Complex| x * y.conjugate();
    let (xx, yy) = (product(a[0], b[0]).re, product(a[1], b[1]).re);
    let (xy, yx) = (product(a[0], b[1]), product(b[0], a[1]));
    Stokes([xx + yy, xx - yy, xy.re + yx.re, xy.im + yx.im])
}

impl Jones {
    /// Returns the matrix of an element that does not mix x and y.
    pub const fn diagonal(x: Complex, y: Complex) -> Self {
        const ZERO: Complex = Complex::new(0.0, 0.0);
        Self([[x, ZERO], [ZERO, y]])
    }

    /// Returns the Mueller matrix, whose powers are squares of amplitudes. A change of medium needs
    /// the further factor n₂cosθ₂/(n₁cosθ₁).
    pub fn mueller(&self) -> Mueller {
        let [x, y] = [0, 1].map(|j| [self.0[0][j], self.0[1][j]]);
        let i = |field: [Complex; 2]| field.map(|part| part * Complex::new(0.0, 1.0));
        let (xx, yy, xy, xiy) = (stokes_of(x, x), stokes_of(y, y), stokes_of(x, y), stokes_of(x, i(y)));
        // Columns: the images of unpolarised light, and of differences of two orthogonal states.
        // The right-circular state is (x − iy)/√2.
        let columns = [(xx + yy) * 0.5, (xx + yy * -1.0) * 0.5, xy, xiy * -1.0];
        Mueller(std::array::from_fn(|row| columns.map(|column| column.0[row])))
    }
}

impl Mul for Jones {
    type Output = Self;

    /// Returns the matrix of `first`, then `self`.
    fn mul(self, first: Self) -> Self {
        let Self(b) = first;
        Self(self.0.map(|row| [0, 1].map(|j| row[0] * b[0][j] + row[1] * b[1][j])))
    }
}

impl Mul<JonesVector> for Jones {
    type Output = JonesVector;

    fn mul(self, JonesVector([x, y]): JonesVector) -> JonesVector {
        JonesVector(self.0.map(|row| row[0] * x + row[1] * y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two matrices without any symmetry.
    fn examples() -> [Jones; 2] {
        let c = Complex::new;
        [
            Jones([[c(0.3, -0.2), c(0.5, 0.9)], [c(-0.7, 0.1), c(0.2, 0.4)]]),
            Jones([[c(-0.1, 0.8), c(0.3, 0.3)], [c(0.6, -0.5), c(-0.9, 0.2)]]),
        ]
    }

    #[test]
    fn the_mueller_matrix_acts_as_the_jones_matrix_does() {
        for field in [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.6, 0.1, -0.4, 0.9]] {
            let field = JonesVector([Complex::new(field[0], field[1]), Complex::new(field[2], field[3])]);
            for matrix in examples() {
                let (found, known) = (matrix.mueller() * field.stokes(), (matrix * field).stokes());
                assert!((0..4).all(|i| (found.0[i] - known.0[i]).abs() < 1e-14), "{found:?} {known:?}");
                assert!((known.degree_of_polarisation() - 1.0).abs() < 1e-14);
            }
        }
        let [a, b] = examples();
        let (found, known) = ((a * b).mueller(), a.mueller() * b.mueller());
        assert!((0..16).all(|i| (found.0[i / 4][i % 4] - known.0[i / 4][i % 4]).abs() < 1e-14));
    }

    /// In exp(−iωt), the y component of right-circular light lags by a quarter of a period.
    #[test]
    fn right_circular_light_has_positive_s3() {
        let field = JonesVector([Complex::new(1.0, 0.0), Complex::new(0.0, -1.0)]);
        assert_eq!(field.stokes(), Stokes([2.0, 0.0, 0.0, 2.0]));
    }
}
