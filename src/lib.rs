//! Abbe: a spectral photon-mapping renderer.

pub mod error;
pub mod math;
pub mod optics;
pub mod output;
pub mod sensor;
pub mod spectrum;
