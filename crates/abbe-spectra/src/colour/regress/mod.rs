//! The regression sets: spectra with known colours, for tests of code that converts spectra to RGB.
//!
//! A set has a name with a version, and the cases and the values of a published set never change.
//! The expected values of lights and surfaces are computed by [`report`](super::report).

mod cause;
mod comparison;
mod converter;
mod form;
mod set;

pub use cause::{CauseName, LARGEST_RESIDUAL, LikelyCause};
pub use comparison::{
    CaseComparison, ColourComparison, GroupSummary, RegressionReport, RegressionTolerances, compare_given,
    compare_groups,
};
pub use form::{ColourForm, FormColours};
pub use set::{CaseGroup, RegressionCase, RegressionSet, RegressionSpectrum, SpectrumRole};
