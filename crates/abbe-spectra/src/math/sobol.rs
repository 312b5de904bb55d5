//! Owen-scrambled Sobol points: each prefix of the sequence is evenly spread in every dimension and
//! in every pair of dimensions.
//!
//! The primitive polynomials and the initial direction numbers are those of Joe & Kuo 2008. Nested
//! uniform scrambling hashes the higher bits of the points (Laine & Karras 2011, in the form of
//! Burley 2020), with the hash function of Vegdahl 2021. Numbers have 32 bits, so the sequence
//! repeats after 2³² points.

use super::random::{StreamKey, mix64};

/// The number of dimensions.
pub const DIMENSIONS: usize = 8;

/// The polynomial's degree, its coefficient bits and the initial direction numbers of the
/// dimensions 1 to 7. Dimension 0 is the van der Corput sequence.
const JOE_KUO: [(u32, u32, [u32; 5]); DIMENSIONS - 1] = [
    (1, 0, [1, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0]),
    (4, 4, [1, 3, 5, 13, 0]),
    (5, 2, [1, 1, 5, 5, 17]),
];

/// The columns of the generator matrices, side by side for all dimensions, with the most
/// significant digit in bit 0, as the scrambling needs it.
static DIRECTIONS: [[u32; DIMENSIONS]; 32] = directions();

const fn directions() -> [[u32; DIMENSIONS]; 32] {
    let mut all = [[0_u32; 32]; DIMENSIONS];
    let mut bit = 0;
    while bit < 32 {
        all[0][bit] = 1 << (31 - bit);
        bit += 1;
    }
    let mut dimension = 1;
    while dimension < DIMENSIONS {
        let (degree, coefficients, initial) = JOE_KUO[dimension - 1];
        let degree = degree as usize;
        let mut i = 0;
        while i < 32 {
            all[dimension][i] = if i < degree {
                initial[i] << (31 - i)
            } else {
                let mut v = all[dimension][i - degree] ^ (all[dimension][i - degree] >> degree);
                let mut k = 1;
                while k < degree {
                    if (coefficients >> (degree - 1 - k)) & 1 == 1 {
                        v ^= all[dimension][i - k];
                    }
                    k += 1;
                }
                v
            };
            i += 1;
        }
        dimension += 1;
    }
    let mut columns = [[0_u32; DIMENSIONS]; 32];
    let mut entry = 0;
    while entry < 32 * DIMENSIONS {
        let (bit, dimension) = (entry / DIMENSIONS, entry % DIMENSIONS);
        columns[bit][dimension] = all[dimension][bit].reverse_bits();
        entry += 1;
    }
    columns
}

/// A scrambled point set. Different seeds give independent scramblings.
#[derive(Debug, Clone, Copy)]
pub struct Sobol {
    scrambles: [u32; DIMENSIONS],
}

impl Sobol {
    /// Returns the point set of a key.
    #[inline]
    pub fn of(key: StreamKey) -> Self {
        Self::new(key.hash())
    }

    /// Returns the point set with a fixed scrambling, for integrals that belong to no render.
    pub fn new(seed: u64) -> Self {
        Self { scrambles: std::array::from_fn(|dimension| mix64(seed ^ ((dimension as u64 + 1) << 56)) as u32) }
    }

    /// Returns point `index`; all coordinates are in [0, 1).
    #[inline(always)]
    pub fn point(&self, index: u32) -> [f64; DIMENSIONS] {
        let mut digits = [0_u32; DIMENSIONS];
        let mut rest = index;
        while rest != 0 {
            let columns = &DIRECTIONS[rest.trailing_zeros() as usize];
            (0..DIMENSIONS).for_each(|dimension| digits[dimension] ^= columns[dimension]);
            rest &= rest - 1;
        }
        (0..DIMENSIONS).for_each(|dimension| digits[dimension] = owen(digits[dimension], self.scrambles[dimension]));
        digits.map(|digits| f64::from(digits.reverse_bits()) * (1.0 / 4_294_967_296.0))
    }

    /// Returns coordinate `dimension` (below [`DIMENSIONS`]) of point `index`, in [0, 1).
    #[inline]
    pub fn at(&self, index: u32, dimension: usize) -> f64 {
        self.point(index)[dimension]
    }
}

/// Applies nested uniform scrambling to digits, the most significant of which is in bit 0: a hash
/// of the lower bits decides whether a bit is flipped.
#[inline]
fn owen(digits: u32, seed: u32) -> u32 {
    let mut x = digits;
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dimension_fills_every_stratum_once() {
        for seed in [0, 1, 99] {
            let sobol = Sobol::new(seed);
            for dimension in 0..DIMENSIONS {
                let mut seen = [false; 256];
                for index in 0..256 {
                    seen[(sobol.at(index, dimension) * 256.0) as usize] = true;
                }
                assert!(seen.iter().all(|&s| s), "seed {seed} dimension {dimension}");
            }
        }
    }

    #[test]
    fn the_first_two_dimensions_are_a_zero_two_sequence() {
        let sobol = Sobol::new(5);
        for rows in [1_usize, 2, 4, 8, 16] {
            let columns = 16 / rows;
            let mut seen = [0; 16];
            for index in 0..16 {
                let (a, b) = (sobol.at(index, 0), sobol.at(index, 1));
                seen[(a * rows as f64) as usize * columns + (b * columns as f64) as usize] += 1;
            }
            assert!(seen.iter().all(|&s| s == 1), "{rows} rows: {seen:?}");
        }
    }

    #[test]
    fn an_integral_converges_faster_than_random() {
        // The integral of Π (0.5 + u_d) is 1. 4096 random numbers would err by about 0.01.
        let sobol = Sobol::new(11);
        let n = 4096;
        let product = |index| (0..DIMENSIONS).map(|d| 0.5 + sobol.at(index, d)).product::<f64>();
        let mean = (0..n).map(product).sum::<f64>() / f64::from(n);
        assert!((mean - 1.0).abs() < 2e-3, "{mean}");
    }
}
