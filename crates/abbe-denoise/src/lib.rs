//! A statistical denoiser with error bars.

#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod bars;
mod features;
mod filter;
mod half;
mod planes;
mod samples;

pub use samples::{Feature, Samples};

/// The number of replicates of a picture.
pub const REPLICATES: usize = 8;

/// The number of groups of replicates whose X and Z are known.
pub const GROUPS: usize = 4;

/// A denoised picture, row by row from the top, in the unit of its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Denoised {
    /// X, Y and Z of each pixel.
    pub xyz: Vec<[f32; 3]>,
    /// The standard error of Y.
    pub noise: Vec<f32>,
    /// The magnitude of the bias of Y that the denoiser adds, estimated from the replicates.
    pub bias: Vec<f32>,
}

/// Denoises a picture on the current thread pool.
pub fn denoise(samples: &Samples) -> Denoised {
    let demodulation = features::Demodulation::new(samples);
    let surfaces = features::Surfaces::new(samples);
    let halves = [0, 1].map(|half| half::Half::new(samples, &demodulation, half).filtered(&surfaces));
    bars::combine(samples, &demodulation, &halves)
}
