//! Refractive indices as functions of wavelength, and the catalogue of glasses.
//!
//! A material has a [`RefractiveIndex`], which consists of a [`Dispersion`] formula and its range
//! of validity. [`catalogue`] finds a [`Glass`] by name in the data of `data/glass`, and
//! [`AgfCatalogue`] reads further catalogues from Zemax files. The complex indices of metals are
//! spectra of the library: [`abbe_spectra::spectrum::library::metal`].

mod agf;
pub mod catalogue;
mod dispersion;
mod extinction;
mod index;
mod index_file;
pub mod lines;

pub use agf::AgfCatalogue;
pub use catalogue::{CauchyFit, Glass, GlassKind};
pub use dispersion::{Dispersion, PowerTerm, SellmeierTerm};
pub use extinction::Extinction;
pub use index::{ReferenceMedium, RefractiveIndex};
pub use index_file::IndexFileData;
