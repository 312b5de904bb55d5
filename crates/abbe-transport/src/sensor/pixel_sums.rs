//! The sums of a pixel of the film.

use abbe_spectra::math::random::REPLICATES;
use abbe_spectra::math::sum::ExactSum;

/// The sums of one pixel over all passes. They take 192 bytes. Each channel takes 16 more bytes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PixelSums {
    pub(super) x: ExactSum,
    pub(super) z: ExactSum,
    pub(super) y: [ExactSum; REPLICATES],
    /// Over the even and over the odd replicates, with independent noise.
    pub(super) bias: [ExactSum; 2],
}

/// The sums of radiance times a colour-matching function in W/m²/sr, and Y by replicate.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelMean {
    pub(super) xyz: [f64; 3],
    pub(super) y: [f64; REPLICATES],
    pub(super) bias: [f64; 2],
}

impl PixelSums {
    /// Returns the light of sums whose terms were divided by `unit`, in W/m²/sr.
    pub(super) fn light(&self, unit: f64) -> PixelMean {
        let value = |sum: ExactSum| unit * sum.value();
        let y = self.y.map(value);
        PixelMean { xyz: [value(self.x), y.iter().sum(), value(self.z)], y, bias: self.bias.map(value) }
    }
}

pub(super) fn replicate(pass: u64) -> usize {
    (pass % REPLICATES as u64) as usize
}

/// Returns the number of passes of the even replicates and of the odd replicates.
pub(super) fn passes_by_half(passes: [u64; REPLICATES]) -> [u64; 2] {
    [0, 1].map(|parity| passes.iter().skip(parity).step_by(2).sum())
}
