//! Abbe: a spectral photon-mapping renderer.

pub mod colour;
pub mod emit;
pub mod error;
pub mod gather;
pub mod map;
pub mod math;
pub mod optics;
pub mod output;
pub mod plan;
pub mod render;
pub mod scene;
pub mod sensor;
pub mod spectrum;
pub mod walk;
