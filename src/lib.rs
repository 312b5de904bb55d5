//! Abbe: a spectral photon-mapping renderer.

pub mod colour;
pub mod error;
pub mod spectrum;
