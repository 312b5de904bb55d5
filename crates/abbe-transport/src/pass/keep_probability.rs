//! The probabilities of storing photons.

use crate::plan::partition::PerClass;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KeepProbability {
    pub(crate) surface: f64,
    /// The probability that a scattering event in a medium is stored.
    pub(crate) points: f64,
    /// The probability that a path segment in a medium is stored.
    pub(crate) beams: f64,
}

impl KeepProbability {
    pub(crate) const ONE: Self = Self { surface: 1.0, points: 1.0, beams: 1.0 };
}

pub(crate) const KEEP_ALL: PerClass<KeepProbability> =
    PerClass { caustic: KeepProbability::ONE, indirect: KeepProbability::ONE };
