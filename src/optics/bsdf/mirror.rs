//! The ideal mirror.

use glam::DVec3;

use super::check::check_within;
use super::sample::{BsdfSample, ScatterEvent};
use crate::error::Result;
use crate::spectrum::Spectrum;

/// A mirror with the reflectance ρ(λ), which does not depend on the angle. Both sides behave alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Mirror {
    pub(super) reflectance: Spectrum,
}

impl Mirror {
    /// Creates a mirror. Returns an error if the reflectance is outside \[0, 1\] at any wavelength.
    pub fn new(reflectance: Spectrum) -> Result<Self> {
        check_within("reflectance", &reflectance, 1.0)?;
        Ok(Self { reflectance })
    }

    pub(super) fn sample(&self, wo: DVec3) -> BsdfSample {
        BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, 1.0)
    }

    pub(super) fn coefficient(&self, nm: f64) -> f64 {
        self.reflectance.at(nm)
    }

    pub(super) fn absorbed_fraction(&self, nm: f64) -> f64 {
        1.0 - self.reflectance.at(nm)
    }
}
