//! The ideal matt surface.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::hemisphere::{cosine_density, same_side, sample_cosine, side};
use super::{Event, Scatter, check_within};
use crate::error::Result;
use crate::spectrum::Spectrum;

/// Lambert's surface: reflects the fraction ρ(λ) of what arrives, with equal radiance in all directions of the side it
/// arrived on; both sides are alike. f = ρ/π.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffuse {
    pub(super) reflectance: Spectrum,
}

impl Diffuse {
    /// A matt surface of this reflectance, in \[0, 1\]; fails outside.
    pub fn new(reflectance: Spectrum) -> Result<Self> {
        check_within("reflectance", &reflectance, 1.0)?;
        Ok(Self { reflectance })
    }

    /// The fraction reflected.
    pub fn reflectance(&self) -> &Spectrum {
        &self.reflectance
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 3]) -> Scatter {
        let wi = sample_cosine(side(wo), u[0], u[1]);
        Scatter::spread(wi, Event::Reflection, cosine_density(wi))
    }

    pub(super) fn absorbed(&self, nm: f64) -> f64 {
        1.0 - self.reflectance.at(nm)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        if same_side(wo, wi) { self.reflectance.at(nm) * FRAC_1_PI } else { 0.0 }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if same_side(wo, wi) { cosine_density(wi) } else { 0.0 }
    }
}
