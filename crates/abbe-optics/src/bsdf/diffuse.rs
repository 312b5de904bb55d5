//! The Lambertian surface.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::check::check_fraction;
use super::hemisphere::{cosine_pdf, same_side, sample_cosine, z_sign};
use super::sample::{BsdfSample, ScatterEvent};
use crate::texture::{SurfaceSpectrum, Texel};
use abbe_spectra::error::Result;

/// A Lambertian reflector with f = ρ(λ)/π, which reflects the fraction ρ(λ) of the power with equal
/// radiance in all directions of the side of arrival. Both sides behave alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffuse {
    pub(super) reflectance: SurfaceSpectrum,
}

impl Diffuse {
    /// Creates a reflector, or returns an error if the reflectance leaves \[0, 1\].
    pub fn new(reflectance: impl Into<SurfaceSpectrum>) -> Result<Self> {
        let reflectance = reflectance.into();
        check_fraction("reflectance", &reflectance)?;
        Ok(Self { reflectance })
    }

    /// Returns the reflectance ρ(λ).
    pub fn reflectance(&self) -> &SurfaceSpectrum {
        &self.reflectance
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 3]) -> BsdfSample {
        sample(wo, u)
    }

    pub(super) fn absorbed_fraction(&self, texel: Texel, nm: f64) -> f64 {
        absorbed_fraction(self.reflectance.at(texel, nm))
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, texel: Texel, nm: f64) -> f64 {
        if same_side(wo, wi) { eval(self.reflectance.at(texel, nm)) } else { 0.0 }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if same_side(wo, wi) { cosine_pdf(wi) } else { 0.0 }
    }
}

/// Samples a direction on the side of `wo` in proportion to the cosine.
pub(super) fn sample(wo: DVec3, u: [f64; 3]) -> BsdfSample {
    let wi = sample_cosine(z_sign(wo), u[0], u[1]);
    BsdfSample::lobe(wi, ScatterEvent::Reflection, cosine_pdf(wi))
}

pub(super) fn eval(reflectance: f64) -> f64 {
    reflectance * FRAC_1_PI
}

pub(super) fn absorbed_fraction(reflectance: f64) -> f64 {
    1.0 - reflectance
}
