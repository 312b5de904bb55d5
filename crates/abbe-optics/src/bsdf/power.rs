use glam::DVec3;

use super::sample::{BsdfSample, ScatterEvent};

/// The least probability of reflection and transmission, for the other wavelengths.
const MIN_PROBABILITY: f64 = 0.1;

/// The fractions of the power that a surface reflects and transmits; it absorbs the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerFractions {
    /// R for unpolarised light.
    pub reflected: f64,
    /// T for unpolarised light. R + T is at most 1.
    pub transmitted: f64,
}

impl PowerFractions {
    pub(super) fn reflection_probability(self) -> f64 {
        let either = (self.reflected + self.transmitted).max(f64::MIN_POSITIVE);
        (self.reflected / either).clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY)
    }

    /// Samples reflection, or transmission in a straight line, by a random number in \[0, 1).
    pub(super) fn sample_straight(wo: DVec3, probability: f64, u: f64) -> BsdfSample {
        if u < probability {
            BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, probability)
        } else {
            BsdfSample::delta(-wo, ScatterEvent::Transmission, 1.0 - probability)
        }
    }

    pub(super) fn of_event(self, event: ScatterEvent) -> f64 {
        match event {
            ScatterEvent::Reflection => self.reflected,
            ScatterEvent::Transmission => self.transmitted,
        }
    }

    /// Returns the fraction that the surface absorbs.
    pub fn absorbed(self) -> f64 {
        (1.0 - self.reflected - self.transmitted).max(0.0)
    }
}
