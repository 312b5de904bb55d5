//! Sums that do not depend on the order of their terms.

use std::ops::AddAssign;

/// An exact sum in 128-bit fixed point with a quantum of 2⁻⁶⁴, to which each term is rounded once,
/// so its bits do not depend on the order of addition. The caller divides the terms by a unit, so
/// that they are neither close to the quantum nor beyond 9·10¹⁸, where the sum saturates and
/// [`overflowed`](Self::overflowed) returns true.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ExactSum(i128);

const SCALE: f64 = 18_446_744_073_709_551_616.0;

impl ExactSum {
    /// Returns the sum of the terms so far.
    pub fn value(self) -> f64 {
        self.0 as f64 / SCALE
    }

    /// Returns true if a term was NaN, or if a term or the sum was too large.
    pub fn overflowed(self) -> bool {
        self.0 == i128::MAX || self.0 == i128::MIN
    }

    /// Returns the bits of the sum, for checkpoints and merging.
    pub fn bits(self) -> i128 {
        self.0
    }

    /// Builds a sum from its bits.
    pub fn from_bits(bits: i128) -> Self {
        Self(bits)
    }
}

/// Rounds a term to quanta, without a bias. The cast saturates, but NaN is marked as out of range.
fn quanta(term: f64) -> i128 {
    if term.is_nan() { i128::MAX } else { (term * SCALE).round_ties_even() as i128 }
}

impl AddAssign<f64> for ExactSum {
    fn add_assign(&mut self, term: f64) {
        self.0 = self.0.saturating_add(quanta(term));
    }
}

impl AddAssign for ExactSum {
    fn add_assign(&mut self, other: Self) {
        self.0 = self.0.saturating_add(other.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_terms_does_not_matter() {
        let terms: Vec<f64> = (1..2000).map(|i| (f64::from(i) * 0.7).sin() * 10f64.powi(i % 12 - 6)).collect();
        let (mut forward, mut backward) = (ExactSum::default(), ExactSum::default());
        terms.iter().for_each(|&t| forward += t);
        terms.iter().rev().for_each(|&t| backward += t);
        assert_eq!(forward, backward);
        assert!((forward.value() - terms.iter().sum::<f64>()).abs() < 1e-9);
    }

    #[test]
    fn a_hundred_million_small_powers_add_exactly() {
        let mut sum = ExactSum::default();
        (0..100_000).for_each(|_| sum += 1e-8);
        assert!((sum.value() - 1e-3).abs() < 1e-14);
    }

    /// Terms below the quantum add up in the mean, and none of them is lost to one side.
    #[test]
    fn terms_are_rounded_and_not_truncated() {
        let mut sum = ExactSum::default();
        (0..1000).for_each(|i| sum += (f64::from(i) + 0.5) / 1000.0 / SCALE);
        assert_eq!(sum.bits(), 500);
    }

    #[test]
    fn overflow_and_nan_are_noticed() {
        let mut sum = ExactSum::default();
        sum += 1e30;
        assert!(sum.overflowed());
        let mut sum = ExactSum::default();
        sum += f64::NAN;
        assert!(sum.overflowed());
    }
}
