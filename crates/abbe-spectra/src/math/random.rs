//! Independent streams of random numbers, one for each path. A stream is seeded by a hash of the
//! path's identity.
//!
//! Every random number of a render comes from this module, from [`super::sobol`] or from
//! [`super::kronecker`]. Therefore the picture depends only on the seed, the passes and the paths.
//! The number of threads and the order of the work have no influence.

use rand::Rng;
use rand_pcg::Pcg32;

/// The largest `f64` below 1, and thus the largest value of a sampling argument `u` in [0, 1).
pub const ONE_MINUS_ULP: f64 = 1.0 - f64::EPSILON / 2.0;

/// The number of replicates. A replicate is one of eight independent subsets of the passes: pass i
/// belongs to replicate i mod 8. The noise is measured from the differences between the replicates.
pub const REPLICATES: usize = 8;

/// The purpose of a stream. Streams of different purposes are independent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// Photons of the free set, which have their own wavelengths.
    FreePhoton = 1,
    /// Photons of the shared set, which have the shared wavelengths of the pass.
    SharedPhoton,
    /// Camera paths.
    Camera,
    /// Numbers that are drawn once per pass, for example the shared wavelengths.
    Pass,
    /// The pilot, which fixes the aims, the first radii and the photon counts before pass 0.
    Pilot,
    /// The shutter time of a pass.
    Moment,
    /// The virtual lights of the light maps of a pass.
    LightMap,
    /// Photons whose paths are shown to the user.
    ShownPhoton,
}

/// Mixes the bits of a 64-bit word (the finaliser of SplitMix64, Steele, Lea & Flood 2014).
pub(crate) fn mix64(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Hashes several words. The result depends on the order of the words.
pub fn hash64<const N: usize>(words: [u64; N]) -> u64 {
    words.into_iter().fold(0x243f_6a88_85a3_08d3, |state, word| mix64(state ^ word))
}

/// Converts a word to a number in [0, 1). The number consists of the upper 53 bits of the word.
pub fn unit_interval(word: u64) -> f64 {
    (word >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// A stream of uniform random numbers for one path.
#[derive(Debug, Clone)]
pub struct Stream(Pcg32);

impl Stream {
    /// Returns the stream of path `path` in pass `pass`. The state and the sequence of the
    /// generator are hashed separately, because consecutive sequences with the same state are
    /// visibly correlated.
    pub fn new(seed: u64, purpose: Purpose, pass: u64, path: u64) -> Self {
        let key = hash64([seed, purpose as u64, pass, path]);
        Self(Pcg32::new(key, mix64(key)))
    }

    /// Returns a number in [0, 1) with 32 random bits.
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) * (1.0 / 4_294_967_296.0)
    }

    /// Returns two numbers in [0, 1).
    pub fn pair(&mut self) -> [f64; 2] {
        [self.uniform(), self.uniform()]
    }

    /// Returns three numbers in [0, 1).
    pub fn triple(&mut self) -> [f64; 3] {
        [self.uniform(), self.uniform(), self.uniform()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_streams_are_uncorrelated() {
        // The correlation of n pairs has the standard deviation 1/√n. The bound is four standard
        // deviations.
        let n = 20_000_u64;
        for (purpose, step) in [(Purpose::Camera, 1), (Purpose::FreePhoton, 1 << 32)] {
            let mut sum = 0.0;
            for path in 0..n {
                let a = Stream::new(7, purpose, 3, path * step).uniform() - 0.5;
                let b = Stream::new(7, purpose, 3, (path + 1) * step).uniform() - 0.5;
                sum += a * b * 12.0;
            }
            assert!((sum / n as f64).abs() < 4.0 / (n as f64).sqrt(), "correlation {}", sum / n as f64);
        }
    }

    #[test]
    fn a_stream_depends_on_all_its_words() {
        let first = |seed, purpose, pass, path| Stream::new(seed, purpose, pass, path).uniform();
        let base = first(1, Purpose::Camera, 2, 3);
        assert_eq!(base, first(1, Purpose::Camera, 2, 3));
        for other in [
            first(2, Purpose::Camera, 2, 3),
            first(1, Purpose::Pilot, 2, 3),
            first(1, Purpose::Camera, 3, 3),
            first(1, Purpose::Camera, 2, 4),
        ] {
            assert_ne!(base, other);
        }
    }
}
