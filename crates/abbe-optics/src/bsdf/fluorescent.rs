//! A Lambertian surface with a fluorophore.

use glam::DVec3;

use super::check::check_within;
use super::diffuse::{self, Diffuse};
use super::hemisphere::{cosine_pdf, same_side};
use super::sample::BsdfSample;
use crate::fluorophore::Fluorophore;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Spectrum;

/// The rounding error that the sum of measured reflectance and emission may have.
const ROUNDING: f64 = 1e-6;

/// A Lambertian surface with a fluorophore.
///
/// It reflects the fraction ρ(λ) of the light without a change of wavelength: a measured value, or
/// s(λ)·(1 − a(λ)) for a dye of absorptance a on a substrate of reflectance s. The methods of
/// [`LocalBsdf`](super::LocalBsdf) describe this reflection alone. The light transport adds the
/// light of the fluorophore, which leaves on the side of arrival with equal radiance.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluorescent {
    reflected: Spectrum,
    /// Its emission follows the reflection.
    pub fluorophore: Fluorophore,
}

impl Fluorescent {
    /// Creates a surface, or returns an error if the substrate's reflectance leaves \[0, 1\].
    pub fn new(substrate: Spectrum, fluorophore: Fluorophore) -> Result<Self> {
        check_within("reflectance", &substrate, 1.0)?;
        let transmittance = fluorophore.absorptance_spectrum().complement();
        let reflected = substrate.product(&transmittance).with_origin_of(&substrate);
        Ok(Self { reflected, fluorophore })
    }

    /// Creates a surface that reflects the fraction `reflected` of the light without a change of
    /// wavelength, and whose fluorophore has a measured matrix. Returns an error if the reflectance
    /// is outside \[0, 1\], or if more photons leave the surface than arrive.
    pub fn measured(reflected: Spectrum, fluorophore: Fluorophore) -> Result<Self> {
        check_within("reflectance", &reflected, 1.0)?;
        let returned = Spectrum::mix(&[(1.0, &reflected), (1.0, fluorophore.absorptance_spectrum())]).max();
        if returned > 1.0 + ROUNDING {
            let what = format!("{returned:.4} reflected and emitted photons for each arriving photon");
            return Err(Error::input(what).expected("at most 1 photon for each arriving photon"));
        }
        // A reflectance that is held below its table may be too large for the absorptance there.
        let reflected = reflected.limited_below_band(fluorophore.absorptance_spectrum());
        Ok(Self { reflected, fluorophore })
    }

    /// Returns the fraction ρ of the power that is reflected without a change of wavelength.
    #[inline]
    pub fn reflected_fraction(&self, nm: f64) -> f64 {
        self.reflected.at(nm)
    }

    /// Returns the fraction of the power that the surface absorbs without exciting the fluorophore.
    #[inline]
    pub fn absorbed_by_substrate(&self, nm: f64) -> f64 {
        1.0 - self.reflected.at(nm) - self.fluorophore.absorptance(nm)
    }

    /// Returns the reflectance ρ without a change of wavelength.
    pub fn reflectance(&self) -> &Spectrum {
        &self.reflected
    }

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
