//! Light as a function of wavelength: values, integrals, drawing wavelengths, observers and a library.
//!
//! A [`Spectrum`] is an exact piecewise-linear function over the band plus narrow lines of exact power. Whatever is
//! asked of it (a value, an integral, a product, a random wavelength) is answered for that function, so that no
//! line is ever lost between samples. What one writes down, tables, formulas, colours, becomes such a function once,
//! when it is read.

pub mod library;
pub mod read;

mod continuum;
mod daylight;
mod distribution;
mod index;
mod lanes;
mod line;
mod observer;
mod planck;
mod product;
mod rgb;
mod smooth;
mod sweep;
mod table;
mod value;

pub use continuum::Piece;
pub use daylight::DAYLIGHT_K;
pub(crate) use daylight::daylight_extended;
pub use distribution::WavelengthDistribution;
pub use lanes::{LANES, Lanes, Wavelengths};
pub use line::{DEFAULT_LINE_WIDTH_NM, LineSegment, MIN_WIDTH_NM, SpectralLine};
pub use observer::{LUMENS_PER_WATT, OBSERVER_NAMES, Observer};
pub use planck::planck;
pub use value::{Outside, Spectrum};

/// The band of wavelengths that Abbe simulates, in nm. Every power and every integral is meant over it.
pub const BAND_NM: (f64, f64) = (360.0, 830.0);
