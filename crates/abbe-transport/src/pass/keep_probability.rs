//! The probabilities of storing photons.

use crate::plan::partition::PerClass;

/// The probabilities of storing the photons of one class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KeepProbability {
    /// The probability that a photon is stored on a surface.
    pub(crate) surface: f64,
    /// The probability that a scattering event in a medium is stored.
    pub(crate) points: f64,
    /// The probability that a path segment in a medium is stored.
    pub(crate) beams: f64,
}

impl KeepProbability {
    /// All photons are stored.
    pub(crate) const ONE: Self = Self { surface: 1.0, points: 1.0, beams: 1.0 };
}

/// All photons of both classes are stored.
pub(crate) const KEEP_ALL: PerClass<KeepProbability> =
    PerClass { caustic: KeepProbability::ONE, indirect: KeepProbability::ONE };
