//! Gauss–Legendre quadrature. A rule with n points is exact for polynomials up to degree 2n − 1.

use super::elementary::cos;
use std::f64::consts::PI;

/// The positive nodes in (0, 1) with their weights, of which the negative nodes are mirror images.
const TWO: [(f64, f64); 1] = [(0.577_350_269_189_625_8, 1.0)];
const FOUR: [(f64, f64); 2] =
    [(0.339_981_043_584_856_26, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_85)];
const SIXTEEN: [(f64, f64); 8] = [
    (0.09501250983763744, 0.18945061045506864),
    (0.2816035507792589, 0.18260341504492364),
    (0.45801677765722737, 0.16915651939500265),
    (0.6178762444026438, 0.1495959888165767),
    (0.755404408355003, 0.12462897125553407),
    (0.8656312023878318, 0.0951585116824926),
    (0.9445750230732326, 0.062253523938647456),
    (0.9894009349916499, 0.027152459411754176),
];

/// Integrates `f` over an interval by the two-point rule, which is exact for cubic polynomials.
pub fn gauss2((from, to): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    symmetric(&TWO, (from, to), f)
}

/// Integrates `f` over an interval with four points, exactly for polynomials of degree 7.
pub fn gauss4((from, to): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    symmetric(&FOUR, (from, to), f)
}

/// Integrates `f` over an interval with sixteen points, exactly for polynomials of degree 31.
pub fn gauss16((from, to): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    symmetric(&SIXTEEN, (from, to), f)
}

/// Computes the nodes and weights of the Gauss–Legendre rule on \[0, 1\], whose nodes are the roots
/// of a Legendre polynomial, by Newton's method.
pub fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    (0..points)
        .map(|i| {
            let mut x = cos(PI * (i as f64 + 0.75) / (n + 0.5));
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut previous, mut current) = (1.0, x);
                for k in 2..=points {
                    let k = k as f64;
                    (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
                }
                slope = n * (x * current - previous) / (x * x - 1.0);
                x -= current / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

fn symmetric(half: &[(f64, f64)], (from, to): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half_width) = (0.5 * (from + to), 0.5 * (to - from));
    half_width
        * half
            .iter()
            .map(|&(x, weight)| weight * (f(middle - half_width * x) + f(middle + half_width * x)))
            .sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each rule must be exact up to the documented degree, and not beyond it.
    #[test]
    fn rules_are_exact_up_to_the_promised_degree() {
        // The integral of xⁿ from 0 to 2, where no term cancels by symmetry.
        let power = |n: i32| move |x: f64| x.powi(n);
        let exact = |n: i32| 2.0_f64.powi(n + 1) / f64::from(n + 1);
        for n in 0..=33 {
            let checks = [
                (3, gauss2((0.0, 2.0), power(n))),
                (7, gauss4((0.0, 2.0), power(n))),
                (31, gauss16((0.0, 2.0), power(n))),
            ];
            for (degree, got) in checks {
                let off = (got / exact(n) - 1.0).abs();
                assert!(off < 1e-14 || n > degree, "degree {n} of {degree}: off by {off:e}");
                assert!(off > 1e-12 || n != degree + 1 || degree == 31, "degree {n} should not be exact: {off:e}");
            }
        }
    }

    #[test]
    fn gauss_rule_is_exact_up_to_degree_2n_minus_1() {
        for points in [4, 5, 32] {
            let degree = 2 * points - 1;
            let sum: f64 = gauss_legendre(points).iter().map(|(x, weight)| weight * x.powi(degree as i32)).sum();
            assert!((sum * (degree + 1) as f64 - 1.0).abs() < 1e-13, "{points} points: {sum}");
        }
    }
}
