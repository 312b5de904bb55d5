//! Film sums, noise and bias, exposure, develop: from (pixel, wavelength, weight) to XYZ with error bars.

pub mod exposure;
pub mod film;
pub mod picture;

pub use film::{Film, PixelSink, SplatSink};
pub use picture::{Bands, Picture};
