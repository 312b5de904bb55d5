//! The probabilities of storing photons in media.
//!
//! A few photons near each camera ray are enough. More photons would make every pass slower. If the
//! same time is spent on additional passes, the noise decreases more.

use crate::plan::partition::PerClass;

/// The probabilities with which media store the photons of one class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KeepProbability {
    /// The probability that a scattering event is stored.
    pub(super) points: f64,
    /// The probability that a path segment is stored.
    pub(super) beams: f64,
}

impl KeepProbability {
    /// All photons are stored.
    pub(super) const ONE: Self = Self { points: 1.0, beams: 1.0 };
}

/// All photons of both classes are stored.
pub(super) const KEEP_ALL: PerClass<KeepProbability> =
    PerClass { caustic: KeepProbability::ONE, indirect: KeepProbability::ONE };
