//! Abbe: a spectral photon-mapping renderer.

pub mod error;
