//! The probabilities of storing photons.

use crate::plan::partition::PerClass;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KeepProbability {
    /// For photons on surfaces.
    pub(crate) surface: f64,
    /// For scattering events in media.
    pub(crate) points: f64,
    /// For path segments in media.
    pub(crate) beams: f64,
}

impl KeepProbability {
    pub(crate) const ONE: Self = Self { surface: 1.0, points: 1.0, beams: 1.0 };
}

pub(crate) const KEEP_ALL: PerClass<KeepProbability> =
    PerClass { caustic: KeepProbability::ONE, indirect: KeepProbability::ONE };
