//! A statistical denoiser with error bars, for pictures that were rendered in independent
//! replicates.
//!
//! A renderer that keeps the mean of each of eight replicates knows more about its noise than a
//! variance: it knows how the noise of one pixel depends on that of another. Photon maps make this
//! necessary, because a photon brightens all pixels around it, and noise that neighbours share
//! neither tells them apart nor vanishes in their mean. The denoiser therefore tests differences
//! of pixels, whose noise is measured from the replicates, and never compares a difference with
//! the noise of a single pixel.
//!
//! ```
//! use abbe_denoise::{Feature, Samples, denoise};
//!
//! // A grey wall with noise in 16 × 8 pixels and eight replicates of one pass.
//! let noise = |i: usize, r: usize| 1.0 + 0.2 * ((i * 7919 + r * 104_729) % 1000) as f32 / 1000.0;
//! let plane = |r: usize| (0..128).map(|i| noise(i, r)).collect::<Vec<f32>>();
//! let pair = |i: usize, g: usize| 0.5 * (noise(i, g) + noise(i, g + 4));
//! let group = |g: usize| (0..128).map(|i| pair(i, g)).collect::<Vec<f32>>();
//! let features = std::array::from_fn(|_| vec![Feature::NONE; 128]);
//! let (y, x) = (std::array::from_fn(plane), std::array::from_fn(group));
//! let samples = Samples { width: 16, height: 8, passes: [1; 8], y, z: x.clone(), x, features };
//! let denoised = denoise(&samples);
//! let [_, luminance, _] = denoised.xyz[40];
//! assert!((luminance - 1.1).abs() < 0.05 && denoised.noise[40] < 0.02);
//! ```
//!
//! # Method
//!
//! The replicates form two halves. Each half decides which pixels are averaged, and the average is
//! taken of the other half, whose noise had no say in the choice ("cross-filtering", Rousselle et
//! al. 2012, "Adaptive rendering with non-local means filtering"). The result is the mean of both.
//! The test of two pixels resembles Welch's, as in Sakai et al. 2024, "A statistical approach to
//! Monte Carlo denoising", and is repeated at six scales, where the pixels are means of the scale
//! below. X and Z relative to Y are averaged more widely than Y, because eyes see colour clouds and
//! not their edges.
//!
//! The weights of one half are independent of the noise of the other. The spread of the filtered
//! replicates thus contains the noise that neighbours share, and the mean difference between a
//! filtered replicate and the original one is the bias of the filter, with a sign and with a
//! spread of its own. Where this bias is larger than the noise that the filter removes, the picture
//! returns to the original.
//!
//! # Units and conventions
//!
//! X, Y and Z have any common unit. Results have the same bits on any number of threads.
//!
//! # Dependencies
//!
//! This crate depends on no other crate of Abbe.

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
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Denoised {
    /// X, Y and Z of each pixel.
    pub xyz: Vec<[f32; 3]>,
    /// The standard error of Y.
    pub noise: Vec<f32>,
    /// The magnitude of the bias of Y that the denoiser adds, estimated from the replicates.
    pub bias: Vec<f32>,
}

/// The pixels of a strip, which limit the memory.
const STRIP_PIXELS: usize = 3 << 19;

/// The rows above and below a strip that influence it: those of all levels, and of the error bars.
const MARGIN_ROWS: usize = 2 * ((1 << filter::LEVELS) + filter::LEVELS * filter::LARGEST_PATCH);

/// Denoises a picture on the current thread pool.
///
/// # Panics
/// Panics if a plane of the samples has not `width` × `height` values, or a group has no passes.
pub fn denoise(samples: &Samples) -> Denoised {
    samples.check();
    let rows = (STRIP_PIXELS / samples.width.max(1)).max(2 * MARGIN_ROWS);
    if rows >= samples.height { whole(samples) } else { in_strips(samples, rows) }
}

fn whole(samples: &Samples) -> Denoised {
    let surfaces = features::Surfaces::new(samples);
    let halves = [0, 1].map(|half| filter::filtered(half::Half::new(samples, &surfaces, half), &surfaces));
    bars::combine(samples, &surfaces, &halves)
}

/// Denoises strips of `rows` rows, which need less memory than the whole picture and have its bits.
fn in_strips(samples: &Samples, rows: usize) -> Denoised {
    let (width, mut all) = (samples.width, Denoised::default());
    for first in (0..samples.height).step_by(rows) {
        let end = (first + rows).min(samples.height);
        let above = first.min(MARGIN_ROWS);
        let strip = whole(&samples.rows(first - above..(end + MARGIN_ROWS).min(samples.height)));
        let own = above * width..(above + end - first) * width;
        all.xyz.extend_from_slice(&strip.xyz[own.clone()]);
        all.noise.extend_from_slice(&strip.noise[own.clone()]);
        all.bias.extend_from_slice(&strip.bias[own]);
    }
    all
}

#[cfg(test)]
mod tests;
