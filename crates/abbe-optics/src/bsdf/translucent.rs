//! A thin diffuse sheet that reflects and transmits light, such as paper or a leaf.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::check::{check_fraction, whole_nm};
use super::hemisphere::{cosine_pdf, same_side, sample_cosine, z_sign};
use super::sample::{BsdfSample, ScatterEvent};
use super::texels::Texels;
use crate::texture::SurfaceSpectrum;
use abbe_spectra::error::{Error, Result};

/// The probability of reflection is the mean of ρ/(ρ + τ) at the hero wavelength and, with this
/// weight, of the band averages: a leaf that transmits only green light must also transmit on a
/// path with a red hero.
const BAND_WEIGHT: f64 = 0.25;

/// In nm, between the wavelengths at which all texels of a texture are checked.
const TEXTURE_STEP_NM: usize = 20;

/// A thin diffuse sheet: ρ(λ)/π on the side of `wo` and τ(λ)/π on the other side. Both sides behave
/// alike. The sheet is thin, so radiance is not scaled by n².
#[derive(Debug, Clone, PartialEq)]
pub struct Translucent {
    pub(super) reflectance: SurfaceSpectrum,
    pub(super) transmittance: SurfaceSpectrum,
    /// The average of ρ over the band, divided by that of ρ + τ. `None` for a black sheet.
    band_reflected: Option<f64>,
}

impl Translucent {
    /// Creates a sheet, or returns an error if a value is negative or ρ + τ exceeds 1.
    pub fn new(reflectance: impl Into<SurfaceSpectrum>, transmittance: impl Into<SurfaceSpectrum>) -> Result<Self> {
        let (reflectance, transmittance) = (reflectance.into(), transmittance.into());
        check_fraction("reflectance", &reflectance)?;
        check_fraction("transmittance", &transmittance)?;
        let step_nm = if reflectance.is_textured() || transmittance.is_textured() { TEXTURE_STEP_NM } else { 1 };
        for nm in whole_nm().step_by(step_nm) {
            let (r, t) = (reflectance.largest_at(nm), transmittance.largest_at(nm));
            // The tolerance accepts tables whose rounded values sum to slightly more than 1.
            if r + t > 1.0 + if step_nm > 1 { 1e-6 } else { 1e-9 } {
                let what = format!("reflectance {r} and transmittance {t} at {nm} nm sum to {}", r + t);
                return Err(Error::input(what).expected("a sum of at most 1"));
            }
        }
        let (mut reflected, mut transmitted) = (0.0, 0.0);
        let representative = [&reflectance, &transmittance].map(SurfaceSpectrum::representative);
        for nm in whole_nm() {
            reflected += representative[0].at(nm);
            transmitted += representative[1].at(nm);
        }
        let sum: f64 = reflected + transmitted;
        let band_reflected = (sum > 0.0).then(|| reflected / sum);
        Ok(Self { reflectance, transmittance, band_reflected })
    }

    pub(super) fn without_textures(self) -> Self {
        let (reflectance, transmittance) = (self.reflectance.without_texture(), self.transmittance.without_texture());
        Self { reflectance, transmittance, ..self }
    }

    /// Returns the reflectance ρ(λ).
    pub fn reflectance(&self) -> &SurfaceSpectrum {
        &self.reflectance
    }

    /// Returns the transmittance τ(λ).
    pub fn transmittance(&self) -> &SurfaceSpectrum {
        &self.transmittance
    }

    /// Returns the probability of reflection, or `None` for a black sheet.
    fn reflection_probability(&self, texels: Texels, nm: f64) -> Option<f64> {
        let band = self.band_reflected?;
        let (r, t) = (self.reflectance.at(texels.reflectance, nm), self.transmittance.at(texels.transmittance, nm));
        Some(if r + t > 0.0 { BAND_WEIGHT * band + (1.0 - BAND_WEIGHT) * r / (r + t) } else { band })
    }

    pub(super) fn sample(&self, wo: DVec3, texels: Texels, nm: f64, u: [f64; 3]) -> Option<BsdfSample> {
        let reflect = self.reflection_probability(texels, nm)?;
        let (event, sign, choice) = if u[2] < reflect {
            (ScatterEvent::Reflection, z_sign(wo), reflect)
        } else {
            (ScatterEvent::Transmission, -z_sign(wo), 1.0 - reflect)
        };
        let wi = sample_cosine(sign, u[0], u[1]);
        (choice > 0.0).then(|| BsdfSample::lobe(wi, event, choice * cosine_pdf(wi)))
    }

    pub(super) fn absorbed_fraction(&self, texels: Texels, nm: f64) -> f64 {
        let (r, t) = (self.reflectance.at(texels.reflectance, nm), self.transmittance.at(texels.transmittance, nm));
        (1.0 - r - t).max(0.0)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, texels: Texels, nm: f64) -> f64 {
        let fraction = if same_side(wo, wi) {
            self.reflectance.at(texels.reflectance, nm)
        } else {
            self.transmittance.at(texels.transmittance, nm)
        };
        if wi.z == 0.0 { 0.0 } else { fraction * FRAC_1_PI }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, texels: Texels, nm: f64) -> f64 {
        let reflect = self.reflection_probability(texels, nm).unwrap_or(0.0);
        let black = self.band_reflected.is_none();
        let choice = if same_side(wo, wi) { reflect } else { 1.0 - reflect };
        if black { 0.0 } else { choice * cosine_pdf(wi) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::{Outside, Spectrum};

    #[test]
    fn reflectance_plus_transmittance_above_one_is_refused() {
        let (low, high) = (Spectrum::constant(0.4), Spectrum::constant(0.7));
        let message = Translucent::new(high, low).unwrap_err().to_string();
        assert!(message.contains("sum to 1.1"), "{message}");
        assert!(Translucent::new(Spectrum::constant(0.6), Spectrum::constant(0.4)).is_ok());
    }

    /// If the hero is not transmitted, the other wavelengths still may be.
    #[test]
    fn other_wavelengths_keep_a_transmission_probability() {
        let green = Spectrum::table(&[500.0, 510.0, 560.0, 570.0], &[0.0, 0.5, 0.5, 0.0], Outside::Zero).unwrap();
        let sheet = Translucent::new(Spectrum::constant(0.2), green).unwrap();
        let sample = sheet.sample(DVec3::Z, Texels::default(), 700.0, [0.5, 0.5, 0.999]).unwrap();
        assert_eq!(sample.event, ScatterEvent::Transmission);
        assert!(sheet.eval(DVec3::Z, sample.wi, Texels::default(), 530.0) > 0.0);
    }
}
