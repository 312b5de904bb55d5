//! Limits of the photons that media store. A few photons near each camera ray are enough: more
//! would slow down every pass, and the noise falls more if this time is spent on passes.

use crate::pass::{KeepProbability, VolumeDeposits};

/// The most photon points of one class that a set stores in a pass. A photon in a dense medium
/// leaves hundreds, most of which add little information.
const MAX_POINTS: f64 = 50_000.0;

/// The largest number of photon beams of one class that a photon set stores in a pass.
const MAX_BEAMS: f64 = 15_000.0;

/// The number of photons of one class that the media would store in a pass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct DepositCounts {
    points: f64,
    beams: f64,
}

impl DepositCounts {
    /// Counts the photons that the pilot stored. `pass_per_pilot` is the ratio of the photon paths
    /// of a pass and of the pilot.
    pub(super) fn of(deposits: &VolumeDeposits, pass_per_pilot: f64) -> Self {
        let scaled = |count: usize| count as f64 * pass_per_pilot;
        Self { points: scaled(deposits.points.len()), beams: scaled(deposits.beams.len()) }
    }

    /// Returns the larger of each count, of two sets or shutter times.
    pub(super) fn max(self, other: Self) -> Self {
        Self { points: self.points.max(other.points), beams: self.beams.max(other.beams) }
    }
}

impl KeepProbability {
    /// Stores at most [`MAX_POINTS`] and [`MAX_BEAMS`] in a pass that would store these.
    pub(super) fn within_limits(stored: DepositCounts) -> Self {
        let at_most = |count: f64, most: f64| most / count.max(most);
        Self { surface: 1.0, points: at_most(stored.points, MAX_POINTS), beams: at_most(stored.beams, MAX_BEAMS) }
    }

    /// Multiplies the probabilities in media by a factor. They do not exceed 1.
    pub(super) fn with_medium_factor(self, factor: f64) -> Self {
        let times = |probability: f64| (factor * probability).min(1.0);
        Self { points: times(self.points), beams: times(self.beams), ..self }
    }

    /// Returns the largest factor of [`Self::with_medium_factor`] that has an effect.
    pub(super) fn largest_medium_factor(self) -> f64 {
        1.0 / self.points.min(self.beams)
    }
}
