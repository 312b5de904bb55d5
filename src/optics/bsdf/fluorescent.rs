//! A Lambertian surface with a fluorophore.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::check::check_within;
use super::hemisphere::{cosine_pdf, same_side};
use super::sample::BsdfSample;
use super::{Diffuse, diffuse};
use crate::error::Result;
use crate::optics::fluorophore::Fluorophore;
use crate::spectrum::Spectrum;

/// A Lambertian surface with a fluorophore on a substrate.
///
/// The surface reflects the fraction ρ(λ) = s(λ)·(1 − a(λ)) of the light without a change of
/// wavelength. s is the reflectance of the substrate and a is the absorptance of the fluorophore.
/// The methods of [`LocalBsdf`](super::LocalBsdf) describe this reflection alone. The light that
/// the fluorophore emits leaves the surface on the side of arrival, with equal radiance in all
/// directions. The code of light transport adds this light.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluorescent {
    substrate: Spectrum,
    /// The reflectance ρ without a change of wavelength.
    reflected: Spectrum,
    /// The fluorophore.
    pub fluorophore: Fluorophore,
    /// The number of the fluorophore in the scene. The scene assigns it.
    pub number: usize,
}

impl Fluorescent {
    /// Creates a fluorescent surface. Returns an error if the reflectance of the substrate is
    /// outside \[0, 1\] at any wavelength.
    pub fn new(substrate: Spectrum, fluorophore: Fluorophore) -> Result<Self> {
        check_within("reflectance", &substrate, 1.0)?;
        let reflected = substrate.product(&fluorophore.transmittance()).with_origin_of(&substrate);
        Ok(Self { substrate, reflected, fluorophore, number: 0 })
    }

    /// Returns the fraction ρ of the power that is reflected without a change of wavelength.
    #[inline]
    pub fn reflected_fraction(&self, nm: f64) -> f64 {
        self.reflected.at(nm)
    }

    /// Returns the fraction of the power that the substrate absorbs.
    #[inline]
    pub fn absorbed_by_substrate(&self, nm: f64) -> f64 {
        (1.0 - self.substrate.at(nm)) * (1.0 - self.fluorophore.absorptance(nm))
    }

    /// Returns the emitted radiance per nm at the wavelength `nm`, for an excitation of 1 W·nm/m².
    #[inline]
    pub fn emitted_radiance(&self, nm: f64) -> f64 {
        self.fluorophore.emitted(nm) * FRAC_1_PI
    }

    /// Returns the reflectance ρ without a change of wavelength.
    pub fn reflectance(&self) -> &Spectrum {
        &self.reflected
    }

    /// Returns the surface that reflects as this surface and does not emit.
    pub(super) fn without_emission(&self) -> Result<Diffuse> {
        Diffuse::new(self.reflected.clone())
    }

    pub(super) fn is_upsampled(&self) -> bool {
        self.reflected.is_upsampled()
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 3]) -> BsdfSample {
        diffuse::sample(wo, u)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        if same_side(wo, wi) { diffuse::eval(self.reflected.at(nm)) } else { 0.0 }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if same_side(wo, wi) { cosine_pdf(wi) } else { 0.0 }
    }
}
