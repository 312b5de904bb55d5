//! Kronecker sequences: multiples of an irrational number, modulo 1. Any number of points is evenly spread, and none needs to know how many follow.
//!
//! The two here, by the golden ratio and by √3, share no rational relation: together they fill the square (Weyl 1916). A few points of both are no more
//! correlated than independent numbers, and many far less. (The golden ratio and √2 would be: 1/φ + √2 = 2.03 ties a dozen points to a line.)

/// Point `index` of the golden-ratio sequence, shifted by a hash.
pub fn golden(index: u32, shift: u64) -> f64 {
    // 2⁶⁴/φ.
    multiple(0x9e37_79b9_7f4a_7c15, index, shift)
}

/// Point `index` of the sequence of multiples of √3, Theodorus' constant, shifted by a hash.
pub fn theodorus(index: u32, shift: u64) -> f64 {
    // 2⁶⁴·(√3 − 1).
    multiple(0xbb67_ae85_84ca_a73b, index, shift)
}

/// A multiple of a step of 2⁻⁶⁴ths; the product wraps around as the sequence wants.
fn multiple(step: u64, index: u32, shift: u64) -> f64 {
    let turned = u64::from(index).wrapping_mul(step).wrapping_add(shift);
    (turned >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_points_is_evenly_spread() {
        for sequence in [golden, theodorus] {
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
            seen[(golden(i, 1) * 8.0) as usize * 8 + (theodorus(i, 2) * 8.0) as usize] += 1;
        }
        assert!(seen.iter().all(|count| (56..=72).contains(count)), "{seen:?}");
    }

    #[test]
    fn a_few_points_of_both_are_no_more_correlated_than_independent_numbers() {
        for count in [8_u32, 11, 16, 32] {
            let shifts: Vec<u64> = (0..256).map(crate::math::random::mix64).collect();
            let square = |pair: &[u64]| {
                let points: Vec<[f64; 2]> = (0..count).map(|i| [golden(i, pair[0]), theodorus(i, pair[1])]).collect();
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
