//! Spectra and colour.

// Elementary functions of the C library differ between machines; see `math::elementary`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod colour;
pub mod error;
pub mod math;
pub mod spectrum;

pub use error::{Error, ErrorKind, ErrorLocation, Result};
pub use spectrum::{Observer, Spectrum};
