//! The Lambertian surface.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::check::check_within;
use super::hemisphere::{cosine_pdf, same_side, sample_cosine, z_sign};
use super::sample::{BsdfSample, ScatterEvent};
use crate::error::Result;
use crate::spectrum::Spectrum;

/// A Lambertian reflector with f = ρ(λ)/π.
///
/// The fraction ρ(λ) of the arriving power is reflected. On the side where the light arrived, the
/// reflected radiance is equal in all directions. Both sides behave alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffuse {
    pub(super) reflectance: Spectrum,
}

impl Diffuse {
    /// Creates a Lambertian reflector. Returns an error if the reflectance is outside \[0, 1\] at
    /// any wavelength.
    pub fn new(reflectance: Spectrum) -> Result<Self> {
        check_within("reflectance", &reflectance, 1.0)?;
        Ok(Self { reflectance })
    }

    /// Returns the reflectance ρ(λ).
    pub fn reflectance(&self) -> &Spectrum {
        &self.reflectance
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 3]) -> BsdfSample {
        let wi = sample_cosine(z_sign(wo), u[0], u[1]);
        BsdfSample::lobe(wi, ScatterEvent::Reflection, cosine_pdf(wi))
    }

    pub(super) fn absorbed_fraction(&self, nm: f64) -> f64 {
        1.0 - self.reflectance.at(nm)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        if same_side(wo, wi) { self.reflectance.at(nm) * FRAC_1_PI } else { 0.0 }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if same_side(wo, wi) { cosine_pdf(wi) } else { 0.0 }
    }
}
