//! Output files: [`exr`] for the measured picture with absolute XYZ, error bars, spectrum and
//! metadata, [`png`] for an image on a display, comparisons of pictures ([`compare`]), plots and
//! reports.

pub mod axis;
mod block_test;
pub mod chromaticity;
pub mod colour_vectors;
pub mod compare;
#[cfg(feature = "pages")]
pub mod comparison_page;
pub mod data_uri;
#[cfg(feature = "pages")]
pub mod date;
pub mod drawing;
pub mod exr;
pub mod figures;
pub mod file;
pub mod gates;
pub mod graph;
pub mod hash;
pub mod heat;
mod icc;
#[cfg(test)]
mod icc_tests;
pub mod junit;
#[cfg(feature = "pages")]
pub mod lamps_page;
#[cfg(feature = "pages")]
pub mod lens_page;
#[cfg(feature = "pages")]
pub mod luminaire_page;
pub mod metadata;
#[cfg(feature = "pages")]
pub mod meters_page;
#[cfg(feature = "pages")]
pub mod page;
#[cfg(feature = "pages")]
pub mod plan_map;
pub mod plot;
pub mod plot_grid;
pub mod png;
pub mod polar;
#[cfg(feature = "pages")]
pub mod regress_page;
pub mod relight;
pub mod selection;
pub mod spot_figure;
pub mod stokes;
pub mod strip;
mod svg;
pub mod tev;

pub use metadata::Metadata;
