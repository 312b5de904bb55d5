//! A thin matt sheet that light comes through: paper, a leaf.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::hemisphere::{cosine_density, same_side, sample_cosine, side};
use super::{Event, Scatter, check_within, checked_nm};
use crate::error::{Error, Result};
use crate::spectrum::Spectrum;

/// How much of the choice between the sides follows the whole band rather than the hero wavelength. The other wavelengths of the
/// path need a chance where the hero has none: a leaf that transmits only green must transmit green for a red hero too.
const BAND_SHARE: f64 = 0.25;

/// Reflects the fraction ρ(λ) and transmits τ(λ), each with equal radiance in all directions of its side; both sides are alike.
/// f = ρ/π on `wo`'s side, τ/π on the other. The sheet is thin: no n² factor applies.
#[derive(Debug, Clone, PartialEq)]
pub struct Translucent {
    pub(super) reflectance: Spectrum,
    pub(super) transmittance: Spectrum,
    /// Over the band, the part of ρ + τ that is reflected; `None` for a black sheet.
    band_reflected: Option<f64>,
}

impl Translucent {
    /// A sheet of these fractions, each ≥ 0 and together at most 1 at every wavelength; fails otherwise.
    pub fn new(reflectance: Spectrum, transmittance: Spectrum) -> Result<Self> {
        check_within("reflectance", &reflectance, 1.0)?;
        check_within("transmittance", &transmittance, 1.0)?;
        let (mut reflected, mut transmitted) = (0.0, 0.0);
        for nm in checked_nm() {
            let (r, t) = (reflectance.at(nm), transmittance.at(nm));
            // Tables that should sum to 1 may miss it by the rounding of their decimals.
            if r + t > 1.0 + 1e-9 {
                let what = format!("reflectance {r} and transmittance {t} at {nm} nm sum to {}", r + t);
                return Err(Error::input(what).expected("a sum of at most 1"));
            }
            reflected += r;
            transmitted += t;
        }
        let sum: f64 = reflected + transmitted;
        let band_reflected = (sum > 0.0).then(|| reflected / sum);
        Ok(Self { reflectance, transmittance, band_reflected })
    }

    /// The fraction reflected.
    pub fn reflectance(&self) -> &Spectrum {
        &self.reflectance
    }

    /// The fraction transmitted.
    pub fn transmittance(&self) -> &Spectrum {
        &self.transmittance
    }

    /// The probability of reflection; `None` for a black sheet.
    fn chance_to_reflect(&self, nm: f64) -> Option<f64> {
        let band = self.band_reflected?;
        let (r, t) = (self.reflectance.at(nm), self.transmittance.at(nm));
        Some(if r + t > 0.0 { BAND_SHARE * band + (1.0 - BAND_SHARE) * r / (r + t) } else { band })
    }

    pub(super) fn sample(&self, wo: DVec3, nm: f64, u: [f64; 3]) -> Option<Scatter> {
        let reflect = self.chance_to_reflect(nm)?;
        let (event, side, choice) = if u[2] < reflect {
            (Event::Reflection, side(wo), reflect)
        } else {
            (Event::Transmission, -side(wo), 1.0 - reflect)
        };
        let wi = sample_cosine(side, u[0], u[1]);
        (choice > 0.0).then(|| Scatter::spread(wi, event, choice * cosine_density(wi)))
    }

    pub(super) fn absorbed(&self, nm: f64) -> f64 {
        (1.0 - self.reflectance.at(nm) - self.transmittance.at(nm)).max(0.0)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        let fraction = if same_side(wo, wi) { &self.reflectance } else { &self.transmittance };
        if wi.z == 0.0 { 0.0 } else { fraction.at(nm) * FRAC_1_PI }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        let reflect = self.chance_to_reflect(nm).unwrap_or(0.0);
        let black = self.band_reflected.is_none();
        let choice = if same_side(wo, wi) { reflect } else { 1.0 - reflect };
        if black { 0.0 } else { choice * cosine_density(wi) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Outside;

    #[test]
    fn more_than_all_light_is_refused() {
        let (low, high) = (Spectrum::constant(0.4), Spectrum::constant(0.7));
        let message = Translucent::new(high, low).unwrap_err().to_string();
        assert!(message.contains("sum to 1.1"), "{message}");
        assert!(Translucent::new(Spectrum::constant(0.6), Spectrum::constant(0.4)).is_ok());
    }

    #[test]
    fn a_hero_that_is_not_transmitted_leaves_the_others_a_chance() {
        let green = Spectrum::table(&[500.0, 510.0, 560.0, 570.0], &[0.0, 0.5, 0.5, 0.0], Outside::Zero).unwrap();
        let sheet = Translucent::new(Spectrum::constant(0.2), green).unwrap();
        let scatter = sheet.sample(DVec3::Z, 700.0, [0.5, 0.5, 0.999]).unwrap();
        assert_eq!(scatter.event, Event::Transmission);
        assert!(sheet.eval(DVec3::Z, scatter.wi, 530.0) > 0.0);
    }
}
