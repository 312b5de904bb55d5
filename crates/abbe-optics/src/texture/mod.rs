//! Textures: quantities that vary over a surface.
//!
//! A texture consists of a [`Pattern`] and of values. The pattern maps the texture coordinates
//! (u, v) of a surface point to the number of a *texel*. The values belong to the texels. A
//! [`SpectralTexture`] has a spectrum for each texel, and a [`ScalarTexture`] has a number.
//!
//! Filters are stochastic: a lookup selects one texel at random, and the probability of a texel is
//! its weight in the filter (M. Pharr, B. Wronski, M. Salvi and M. Fajardo, "Filtering After
//! Shading with Stochastic Texture Filtering", PACM CGIT 7, 2024). Radiance is linear in the
//! filtered quantity, so its expected value equals the value with the complete filter. A path
//! vertex stores only the numbers of its texels, and the spectrum of a texel is evaluated at any
//! wavelength.
//!
//! The texture coordinates (0, 0) denote the upper left corner of a picture. u increases to the
//! right, and v increases downwards, as in glTF.

mod mapping;
mod normal;
mod palette;
mod pattern;
mod pyramid;
mod scalar;
mod spectral;
mod value;

pub use mapping::UvTransform;
pub use normal::NormalMap;
pub use pattern::{GradientPattern, NoisePattern, Pattern};
pub use pyramid::{Filter, ImagePattern, ImageSize, Wrap};
pub use scalar::ScalarTexture;
pub use spectral::{SpectralTexture, Texel};
pub use value::{SurfaceScalar, SurfaceSpectrum};

use abbe_spectra::math::random::hash64;

/// A point at which textures are evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturePoint {
    /// The texture coordinates.
    pub uv: [f64; 2],
    /// The footprint of a camera ray: two edges of a parallelogram in texture coordinates. The
    /// parallelogram is centred at `uv`. Photons have a footprint of size 0.
    pub footprint: [[f64; 2]; 2],
}

impl TexturePoint {
    /// Returns a point without footprint.
    pub fn new(uv: [f64; 2]) -> Self {
        Self { uv, footprint: [[0.0; 2]; 2] }
    }

    /// Returns the point `uv` + s · first edge + t · second edge. The footprint of the result has
    /// size 0.
    fn moved(&self, s: f64, t: f64) -> [f64; 2] {
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

    /// Returns an independent sequence of the same random number. Different values of `stream`
    /// return different sequences.
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

    /// Returns `low` or `low` + 1. The expected value is `low` + `share`.
    fn round(&mut self, low: f64, share: f64) -> f64 {
        if self.uniform() < share { low + 1.0 } else { low }
    }
}
