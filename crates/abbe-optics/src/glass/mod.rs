//! Refractive indices as functions of wavelength, and the catalogue of glasses.
//!
//! A [`RefractiveIndex`] consists of a [`Dispersion`] formula and its range of validity.
//! [`catalogue`] finds a [`Glass`] by name in `data/glass`, [`makers`] adds the glasses of the
//! makers and the old names of lens files, and [`AgfCatalogue`] reads further catalogues from Zemax
//! files. The complex indices of metals are spectra: [`abbe_spectra::spectrum::library::metal`].

mod agf;
pub mod catalogue;
mod dispersion;
mod extinction;
mod index;
mod index_file;
pub mod lines;
pub mod makers;

pub use agf::AgfCatalogue;
pub use catalogue::{CauchyFit, Glass, GlassKind};
pub use dispersion::{Dispersion, PowerTerm, SellmeierTerm};
pub use extinction::Extinction;
pub use index::{ReferenceMedium, RefractiveIndex, is_negligible};
pub use index_file::IndexFileData;
