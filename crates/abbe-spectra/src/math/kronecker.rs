//! Kronecker sequences: the multiples of an irrational number, modulo 1.
//!
//! Every prefix of a sequence is evenly spread, so the number of points need not be known in
//! advance. The sequences of the golden ratio φ and of √3 together fill the unit square evenly,
//! because 1, φ and √3 are linearly independent over the rational numbers (Weyl 1916). A few pairs
//! of them are no more correlated than independent random numbers, and many are far less so. The
//! pair φ and √2 would be worse: 1/φ + √2 ≈ 2.03 is close to an integer, so a dozen consecutive
//! points would lie close to one line.

use super::random::unit_interval;

/// Returns point `index` of the golden-ratio sequence, shifted by the hash `shift`.
pub fn golden_ratio(index: u32, shift: u64) -> f64 {
    // 2⁶⁴/φ.
    kronecker_point(0x9e37_79b9_7f4a_7c15, index, shift)
}

/// Returns point `index` of the sequence of the multiples of √3, shifted by the hash `shift`.
pub fn sqrt3(index: u32, shift: u64) -> f64 {
    // 2⁶⁴·(√3 − 1).
    kronecker_point(0xbb67_ae85_84ca_a73b, index, shift)
}

/// Returns `index` × `step` + `shift` as a number in [0, 1). The unit of the integers is 2⁻⁶⁴, so
/// the wrapping of their product is the reduction modulo 1.
fn kronecker_point(step: u64, index: u32, shift: u64) -> f64 {
    let turned = u64::from(index).wrapping_mul(step).wrapping_add(shift);
    unit_interval(turned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_points_is_evenly_spread() {
        for sequence in [golden_ratio, sqrt3] {
            for count in [5_u32, 8, 37, 256] {
                let mut points: Vec<f64> = (0..count).map(|i| sequence(i, 0x1234_5678_9abc_def0)).collect();
                points.sort_by(f64::total_cmp);
                let gaps =
                    points.windows(2).map(|pair| pair[1] - pair[0]).chain([points[0] + 1.0 - points[points.len() - 1]]);
                let largest = gaps.fold(0.0, f64::max) * f64::from(count);
                assert!(largest < 2.5, "{largest} of {count}");
            }
        }
    }

    #[test]
    fn the_two_sequences_fill_the_square_together() {
        let mut seen = [0_u32; 64];
        for i in 0..64 * 64 {
            seen[(golden_ratio(i, 1) * 8.0) as usize * 8 + (sqrt3(i, 2) * 8.0) as usize] += 1;
        }
        assert!(seen.iter().all(|count| (56..=72).contains(count)), "{seen:?}");
    }

    #[test]
    fn few_pairs_of_points_are_uncorrelated() {
        for count in [8_u32, 11, 16, 32] {
            let shifts: Vec<u64> = (0..256).map(crate::math::random::mix64).collect();
            let square = |pair: &[u64]| {
                let points: Vec<[f64; 2]> = (0..count).map(|i| [golden_ratio(i, pair[0]), sqrt3(i, pair[1])]).collect();
                let n = f64::from(count);
                let mean = [0, 1].map(|d| points.iter().map(|p| p[d]).sum::<f64>() / n);
                let product =
                    |a: usize, b: usize| points.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum::<f64>();
                product(0, 1) * product(0, 1) / (product(0, 0) * product(1, 1))
            };
            let mean_square = shifts.chunks(2).map(square).sum::<f64>() / (shifts.len() / 2) as f64;
            assert!(mean_square < 1.0 / (f64::from(count) - 1.0), "{mean_square} of {count}");
        }
    }
}
