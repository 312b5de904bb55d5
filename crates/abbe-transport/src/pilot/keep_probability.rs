//! Limits of the numbers of photons that media store.
//!
//! A few photons near each camera ray are enough. More photons would make every pass slower. If the
//! same time is spent on additional passes, the noise decreases more.

use crate::pass::{KeepProbability, VolumeDeposits};

/// The largest number of photon points of one class that a photon set stores in a pass. A photon in
/// a dense medium leaves hundreds of points. Most of these points add little information.
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
    /// Counts the photons that the pilot stored. `pass_per_pilot` is the number of photon paths in
    /// a pass, divided by the number of photon paths in the pilot.
    pub(super) fn of(deposits: &VolumeDeposits, pass_per_pilot: f64) -> Self {
        let scaled = |count: usize| count as f64 * pass_per_pilot;
        Self { points: scaled(deposits.points.len()), beams: scaled(deposits.beams.len()) }
    }

    /// Compares the counts of two sets or two shutter times. Returns the larger value of each
    /// count.
    pub(super) fn max(self, other: Self) -> Self {
        Self { points: self.points.max(other.points), beams: self.beams.max(other.beams) }
    }
}

impl KeepProbability {
    /// Returns the probabilities with which a photon set stores at most [`MAX_POINTS`] points and
    /// [`MAX_BEAMS`] beams in a pass. `stored` is the number of photons if all were stored.
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
