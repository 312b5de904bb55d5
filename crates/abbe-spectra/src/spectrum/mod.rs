//! Light as a function of wavelength: values, integrals, wavelength sampling, observers and a
//! library of measured spectra.
//!
//! A [`Spectrum`] is the sum of a piecewise-linear function over the simulated band and narrow
//! lines of exact power. A table, formula or colour is converted to it once, when it is read, and
//! values, integrals, products and sampled wavelengths are computed for exactly that function, so
//! no line is missed between samples.

pub mod library;
pub mod read;

mod band;
mod band_channel;
mod below_band;
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
mod smooth_reflectance;
mod sweep;
mod table;
mod ultraviolet;
mod value;

pub use band::{BAND_NM, REFERENCE_NM, ULTRAVIOLET_FROM_NM};
pub use band_channel::{emissive_channel, emissive_wavelength_nm, reflective_wavelength_nm};
pub use continuum::LinearPiece;
pub use daylight::DAYLIGHT_K;
pub(crate) use daylight::daylight_extended;
pub use distribution::WavelengthDistribution;
pub use lanes::{LANES, Lanes, Wavelengths};
pub use line::{DEFAULT_LINE_WIDTH_NM, LineSegment, SpectralLine};
pub use observer::{LUMENS_PER_WATT, MELANOPIC_W_PER_LM_OF_D65, OBSERVER_NAMES, Observer};
pub use planck::planck;
pub use smooth_reflectance::SmoothReflectance;
pub use table::Outside;
pub use value::Spectrum;
