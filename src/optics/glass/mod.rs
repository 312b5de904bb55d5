//! The index of refraction as a function of wavelength, and the catalogue of glasses.
//!
//! [`Index`] is what a material holds: a dispersion formula ([`Dispersion`]) and the range in which it holds.
//! [`catalogue`] finds a [`Glass`] by name; it reads the file of `data/glass`. (Metals, whose index is complex, are spectra of
//! the library: [`crate::spectrum::library::metal`].)
//! Other catalogues are read from files ([`GlassFile`]).

mod agf;
pub mod catalogue;
mod dispersion;
mod extinction;
mod index;
pub mod lines;

pub use agf::GlassFile;
pub use catalogue::{CauchyFit, Glass, Kind, RelativeTo};
pub use dispersion::{Dispersion, Pole, Power};
pub use extinction::Extinction;
pub use index::Index;
