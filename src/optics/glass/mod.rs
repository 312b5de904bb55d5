//! The index of refraction as a function of wavelength, and the catalogue of glasses and metals.
//!
//! [`Index`] is what a material holds: a dispersion formula ([`Dispersion`]) and the range in which it holds.
//! [`catalogue`] finds a [`Glass`] by name, [`metal`] a [`Metal`]; both read the files of `data/glass`.

pub mod catalogue;
mod dispersion;
mod extinction;
mod index;
pub mod lines;
pub mod metal;

pub use catalogue::{CauchyFit, Glass, Kind, RelativeTo};
pub use dispersion::{Dispersion, Pole, Power};
pub use extinction::Extinction;
pub use index::Index;
pub use metal::Metal;
