//! Kronecker sequences: multiples of an irrational number, modulo 1. Any number of points is evenly spread, and none needs to know how many follow.
//!
//! The two here, with the golden and the silver ratio, share no rational relation: together they fill the square (Weyl 1916), so that what one
//! draws is correlated with nothing that the other draws.

/// Point `index` of the golden-ratio sequence, shifted by a hash.
pub fn golden(index: u32, shift: u64) -> f64 {
    // 2⁶⁴/φ.
    multiple(0x9e37_79b9_7f4a_7c15, index, shift)
}

/// Point `index` of the silver-ratio sequence, shifted by a hash.
pub fn silver(index: u32, shift: u64) -> f64 {
    // 2⁶⁴·(√2 − 1).
    multiple(0x6a09_e667_f3bc_c909, index, shift)
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
        for sequence in [golden, silver] {
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
            seen[(golden(i, 1) * 8.0) as usize * 8 + (silver(i, 2) * 8.0) as usize] += 1;
        }
        assert!(seen.iter().all(|count| (56..=72).contains(count)), "{seen:?}");
    }
}
