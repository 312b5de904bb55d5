//! Light as a function of wavelength: values, integrals, wavelength sampling, observers and a
//! library of measured spectra.
//!
//! A [`Spectrum`] is the sum of a piecewise-linear function over the simulated band and narrow
//! lines of exact power. Values, integrals, products and sampled wavelengths are computed for
//! exactly that function, so no line is lost between samples. When a table, formula or colour is
//! read, it is converted to such a function once.

pub mod library;
pub mod read;

mod band_channel;
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

pub use band_channel::{emissive_channel, emissive_wavelength_nm, reflective_wavelength_nm};
pub use continuum::LinearPiece;
pub use daylight::DAYLIGHT_K;
pub(crate) use daylight::daylight_extended;
pub use distribution::WavelengthDistribution;
pub use lanes::{LANES, Lanes, Wavelengths};
pub use line::{DEFAULT_LINE_WIDTH_NM, LineSegment, MIN_WIDTH_NM, SpectralLine};
pub use observer::{LUMENS_PER_WATT, MELANOPIC_W_PER_LM_OF_D65, OBSERVER_NAMES, Observer};
pub use planck::planck;
pub use smooth_reflectance::SmoothReflectance;
pub use table::Outside;
pub use ultraviolet::ULTRAVIOLET_FROM_NM;
pub use value::Spectrum;

/// The simulated band of wavelengths in nm. All powers and integrals refer to this band.
pub const BAND_NM: (f64, f64) = (360.0, 830.0);

/// The green wavelength, in nm, that represents the whole band. If a path has no wavelengths yet,
/// sampling decisions use this wavelength. Two quantities are computed for this wavelength: the
/// size of the Airy disk, and the optical depth by which media are classified.
pub const REFERENCE_NM: f64 = 550.0;
