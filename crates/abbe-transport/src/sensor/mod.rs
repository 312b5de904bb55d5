//! The sensor: film sums, noise, bias, diffraction, exposure and display encoding. Samples of a
//! pixel, a wavelength and a weight become XYZ pictures with error bars, display images, and the
//! readings of meters.

pub mod bloom;
mod channels;
mod convolution;
pub mod cryptomatte;
pub mod denoising;
pub mod develop;
pub mod diffraction;
mod error_bars;
pub mod error_distribution;
pub mod exposure;
pub mod film;
pub mod first_surface;
pub mod layers;
pub mod picture;
mod pixel_sums;
mod reading_spectrum;
mod readings;
mod sink;
mod unit;

pub use develop::{Codes, Development, DisplayImage, develop, develop_with_reach};
pub use diffraction::DiffractionPsf;
pub use error_bars::{ErrorSquares, PictureErrors};
pub use film::Film;
pub use layers::LayerSet;
pub use picture::{DenoisedPicture, Picture, SpectralBands};
pub use reading_spectrum::{ReadingBands, ReadingSpectrum};
pub use readings::{Reading, ReadingLayout, ReadingOwner, half_interval_with_degrees};
pub use sink::{ExposedRow, FilmRow, PixelSink, SplatSink};
pub use unit::FilmUnit;
