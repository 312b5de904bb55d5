//! Abbe: a spectral photon-mapping renderer.

pub mod error;
pub mod scene;
pub mod spectrum;
