//! Spectra of real lamps and materials, standard observers, and the colours that follow from them.
//!
//! A [`Spectrum`] is a function of wavelength: a piecewise-linear continuum plus spectral lines of
//! exact power. An [`Observer`] turns it into XYZ, and a [`ColourReport`] contains everything that
//! colorimetry derives from it: chromaticity, correlated colour temperature and Duv, CRI, TM-30 and
//! the melanopic ratio. More than 190 measured lamps, illuminants and reflectances are built in.
//!
//! ```
//! use abbe_spectra::{ColourReport, Observer, spectrum::library};
//!
//! let lamp = library::find("FL11")?.spectrum;
//! let colour = ColourReport::of_light(&lamp, Observer::cie1931())?;
//! let temperature = colour.temperature.expect("FL11 is nearly white");
//! assert!((temperature.cct_k - 4000.0).abs() < 5.0);
//! assert!((colour.rendering.expect("an index").ra - 83.0).abs() < 0.5);
//! # Ok::<(), abbe_spectra::Error>(())
//! ```
//!
//! The folder `examples/` prints the colour of a lamp (`colour_of_a_spectrum`) and compares two
//! (`two_lamps`).
//!
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`spectrum`] | functions of wavelength, spectral lines, observers, the built-in library, readers of CSV and IES TM-27 |
//! | [`colour`] | XYZ, L\*a\*b\*, Oklab, RGB spaces, ΔE2000, CCT, CRI, TM-30, tone curves, comparisons of lamps |
//! | [`math`] | random streams, sampling, quadrature, exact sums, and elementary functions with the same bits on every machine |
//! | [`error`] | the [`Error`] of all crates of Abbe, with the position of the fault in a file |
//! | [`text`] | helpers of the readers of text files |
//!
//! # Units and conventions
//!
//! Wavelengths are in nm. The band is 360–830 nm, and integrals and colours refer to it; values
//! from 300 nm up to it exist only for fluorescence. A light is a power per nm in any unit, because
//! library lamps have no common scale, and it is 0 outside its table. Reflectances and
//! transmittances run from 0 to 1, coefficients are in 1/m, and both keep their end values outside
//! the table. XYZ is the plain integral without the factor 683 lm/W, except in a [`ColourReport`],
//! where a light or the perfect diffuser has Y = 100.
//!
//! # Dependencies
//!
//! This crate depends on no other crate of Abbe. Its tables are in `data/`, and `data/SOURCES.md`
//! names their sources.

#![warn(missing_docs)]
// Elementary functions of the C library differ between machines; see `math::elementary`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod colour;
pub mod error;
pub mod math;
pub mod spectrum;
pub mod text;

pub use colour::ColourReport;
pub use error::{Error, ErrorKind, ErrorLocation, Result};
pub use spectrum::{Observer, Spectrum};
