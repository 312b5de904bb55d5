//! Abbe: a spectral photon-mapping renderer.

pub mod error;
pub mod math;
pub mod spectrum;
