//! The arguments and the result of a texture lookup.

use abbe_spectra::math::random::hash64;

/// The number of a texel, which is not used if a quantity does not vary.
pub type Texel = u32;

/// A point at which textures are evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturePoint {
    /// The texture coordinates.
    pub uv: [f64; 2],
    /// Two edges of a parallelogram, in texture coordinates, centred at `uv`: the footprint of a
    /// camera ray. That of a photon has size 0.
    pub footprint: [[f64; 2]; 2],
}

impl TexturePoint {
    /// Returns a point without footprint.
    pub fn new(uv: [f64; 2]) -> Self {
        Self { uv, footprint: [[0.0; 2]; 2] }
    }

    /// Returns the point `uv` + s · first edge + t · second edge.
    pub(super) fn moved(&self, s: f64, t: f64) -> [f64; 2] {
        let [first, second] = self.footprint;
        std::array::from_fn(|i| self.uv[i] + s * first[i] + t * second[i])
    }
}

/// A short sequence of random numbers that one random number determines.
#[derive(Debug, Clone)]
pub struct LookupRandom {
    seed: u64,
    count: u64,
}

impl LookupRandom {
    /// Creates the sequence of the random number `u` in \[0, 1).
    pub fn new(u: f64) -> Self {
        Self { seed: u.to_bits(), count: 0 }
    }

    /// Returns an independent sequence of the same random number for each value of `stream`.
    #[must_use]
    pub fn split(&self, stream: u64) -> Self {
        Self { seed: hash64([self.seed, stream]), count: 0 }
    }

    /// Returns the next number, uniform in \[0, 1).
    pub fn uniform(&mut self) -> f64 {
        const TO_UNIT: f64 = 1.0 / (1_u64 << 53) as f64;
        self.count += 1;
        (hash64([self.seed, self.count]) >> 11) as f64 * TO_UNIT
    }

    /// Returns `low` or `low` + 1, with the expected value `low` + `fraction`.
    pub(super) fn round(&mut self, low: f64, fraction: f64) -> f64 {
        if self.uniform() < fraction { low + 1.0 } else { low }
    }
}
