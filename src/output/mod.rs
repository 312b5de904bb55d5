//! What a render leaves behind: EXR and PNG pictures, the comparison of two of them, plots and reports.
//!
//! [`exr`] holds the measured picture (absolute XYZ, its error bars, its spectrum, where it comes from), [`png`] what a
//! screen shows of it, [`compare`] says how far two pictures are apart.

pub mod chromaticity;
pub mod compare;
pub mod comparison_page;
pub mod data_uri;
pub mod drawing;
pub mod exr;
pub mod figures;
pub mod file;
pub mod graph;
pub mod hash;
pub mod heat;
pub mod icc;
pub mod lamps_page;
pub mod metadata;
pub mod page;
pub mod plot;
pub mod png;

pub use metadata::Metadata;
