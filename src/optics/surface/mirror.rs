//! The ideal mirror.

use glam::DVec3;

use super::{Event, Scatter, check_within};
use crate::error::Result;
use crate::spectrum::Spectrum;

/// Reflects the fraction ρ(λ), the same at every angle, into the mirror direction; both sides are alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Mirror {
    pub(super) reflectance: Spectrum,
}

impl Mirror {
    /// A mirror of this reflectance, in \[0, 1\]; fails outside.
    pub fn new(reflectance: Spectrum) -> Result<Self> {
        check_within("reflectance", &reflectance, 1.0)?;
        Ok(Self { reflectance })
    }

    pub(super) fn sample(&self, wo: DVec3) -> Scatter {
        Scatter::delta(DVec3::new(-wo.x, -wo.y, wo.z), Event::Reflection, 1.0)
    }

    pub(super) fn coefficient(&self, nm: f64) -> f64 {
        self.reflectance.at(nm)
    }

    pub(super) fn absorbed(&self, nm: f64) -> f64 {
        1.0 - self.reflectance.at(nm)
    }
}
