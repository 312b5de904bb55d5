//! The input of the denoiser: means over the replicates of a picture.

use crate::{GROUPS, REPLICATES};

/// The means of a picture over groups of its passes, row by row from the top.
///
/// All planes have `width` × `height` values in one unit, such as cd/m².
#[derive(Debug, Clone, Default)]
pub struct Samples {
    /// The number of columns.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// The number of passes of each replicate. None may be 0.
    pub passes: [u64; REPLICATES],
    /// The mean Y of each replicate.
    pub y: [Vec<f32>; REPLICATES],
    /// The mean X of each group: the replicates r whose remainder modulo [`GROUPS`] is its number.
    pub x: [Vec<f32>; GROUPS],
    /// The mean Z of each group.
    pub z: [Vec<f32>; GROUPS],
    /// What camera rays hit first, measured twice with independent samples.
    pub features: [Vec<Feature>; 2],
}

/// The first surfaces of a pixel: means over its camera samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// The fraction of light that the surface reflects or transmits, as X, Y and Z relative to
    /// those of white. Samples that hit no surface count as white.
    pub albedo: [f32; 3],
    /// The mean of the unit normals. Samples that hit no surface count as 0.
    pub normal: [f32; 3],
    /// The mean binary logarithm of the distance, over samples that hit a surface.
    pub log_depth: f32,
}

impl Feature {
    /// A pixel whose samples hit no surface.
    pub const NONE: Self = Self { albedo: [1.0; 3], normal: [0.0; 3], log_depth: 0.0 };
}

impl Samples {
    /// Returns the mean of one channel over all passes.
    pub(crate) fn weights_of_half(&self, half: usize) -> [f32; REPLICATES / 2] {
        let passes: [u64; REPLICATES / 2] = std::array::from_fn(|k| self.passes[2 * k + half]);
        let all: u64 = passes.iter().sum();
        passes.map(|passes| passes as f32 / all as f32)
    }

    /// Returns the fraction of all passes that belongs to each half.
    pub(crate) fn fractions_of_halves(&self) -> [f32; 2] {
        let of_half = |half: usize| self.passes.iter().skip(half).step_by(2).sum::<u64>() as f32;
        let halves = [of_half(0), of_half(1)];
        halves.map(|half| half / (halves[0] + halves[1]))
    }
}
