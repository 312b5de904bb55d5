//! Abbe: a spectral photon-mapping renderer.

pub mod error;
pub mod optics;
pub mod spectrum;
