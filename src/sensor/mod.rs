//! Film sums, noise and bias, diffraction, exposure, develop: from (pixel, wavelength, weight) to XYZ with error bars, and to what a display
//! shows of it.

mod channels;
pub mod develop;
pub mod diffraction;
mod error_bars;
pub mod exposure;
pub mod film;
pub mod picture;

pub use develop::{Codes, Development, Screen, develop};
pub use diffraction::Diffraction;
pub use error_bars::ErrorSquares;
pub use film::{Film, PixelSink, SplatSink};
pub use picture::{Bands, Picture};
