//! The ideal mirror.

use glam::DVec3;

use super::check::check_fraction;
use super::sample::{BsdfSample, ScatterEvent};
use crate::texture::{SurfaceSpectrum, Texel};
use abbe_spectra::error::Result;

/// A mirror with the reflectance ρ(λ), which does not depend on the angle. Both sides behave alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Mirror {
    pub(super) reflectance: SurfaceSpectrum,
}

impl Mirror {
    /// Creates a mirror. Returns an error if the reflectance is outside \[0, 1\] at any wavelength.
    pub fn new(reflectance: impl Into<SurfaceSpectrum>) -> Result<Self> {
        let reflectance = reflectance.into();
        check_fraction("reflectance", &reflectance)?;
        Ok(Self { reflectance })
    }

    pub(super) fn sample(&self, wo: DVec3) -> BsdfSample {
        BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, 1.0)
    }

    pub(super) fn coefficient(&self, texel: Texel, nm: f64) -> f64 {
        self.reflectance.at(texel, nm)
    }

    pub(super) fn absorbed_fraction(&self, texel: Texel, nm: f64) -> f64 {
        1.0 - self.reflectance.at(texel, nm)
    }
}
