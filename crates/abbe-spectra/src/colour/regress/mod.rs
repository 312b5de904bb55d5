//! The regression set: spectra with known colours, for tests of code that converts spectra to RGB.
//!
//! A set has a name with a version, and the cases and the values of a published set never change.
//! The expected values are computed by [`report`](super::report) for the CIE 1931 observer.

mod comparison;
mod set;

pub use comparison::{
    CaseComparison, ColourComparison, ConvertedColour, RegressionReport, RegressionTolerances, compare_given,
    compare_groups,
};
pub use set::{CaseColour, CaseGroup, REGRESSION_SET, RegressionCase, RegressionSet, RegressionSpectrum};
