//! The emission of a medium, such as hot soot or excited atoms.

use super::field::ScalarField;
use abbe_spectra::math::elementary::{exp, ln};
use abbe_spectra::spectrum::{Spectrum, planck};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::sync::Arc;

/// The emission coefficient of a medium at density 1.
#[derive(Debug, Clone)]
pub enum MediumEmission {
    /// The same spectrum (W/m³/sr/nm) everywhere, and its integral over the band.
    Uniform { spectrum: Spectrum, band: f64, is_thermal: bool },
    /// Thermal emission at a varying temperature: j = σ_a(λ) n²(λ) B_λ(T) (Kirchhoff).
    Thermal(Box<ThermalEmission>),
}

#[derive(Debug, Clone)]
pub struct ThermalEmission {
    temperature: Arc<ScalarField>,
    /// Times n² of the body that contains the medium.
    absorption: Spectrum,
    /// The log of the emission over the band in W/m³/sr, by equal steps of the inverse temperature
    /// from the hottest on, in which it is nearly linear (Wien's law).
    log_band: Vec<f64>,
    /// The inverse temperature of the first entry, and its step between entries, in 1/K.
    inverse: (f64, f64),
}

/// Thermal emission below this temperature in K counts as 0: dim glow is 10¹⁶ times stronger.
const COLDEST_K: f64 = 350.0;

/// The number of steps of the inverse temperature. The relative interpolation error is below 10⁻⁴,
/// and cancels in the product of the emission and the spectrum that the same value normalises.
const STEPS: usize = 256;

/// The bins per step of the histogram of temperatures for the mean spectrum.
const BINS_PER_STEP: f64 = 8.0;

impl MediumEmission {
    /// Creates the emission of the same spectrum (W/m³/sr/nm at density 1) everywhere.
    pub fn uniform(spectrum: Spectrum) -> Self {
        let band = spectrum.integral();
        Self::Uniform { spectrum, band, is_thermal: false }
    }

    /// Creates thermal emission from absorption (1/m at density 1) and one temperature (K).
    pub fn blackbody(absorption: &Spectrum, kelvin: f64) -> Self {
        let spectrum = absorption.product(&Spectrum::blackbodies(&[(kelvin, 1.0)]));
        Self::Uniform { band: spectrum.integral(), spectrum, is_thermal: true }
    }

    pub fn is_thermal(&self) -> bool {
        !matches!(self, Self::Uniform { is_thermal: false, .. })
    }

    /// Multiplies thermal emission by the squared refractive index: inside of a body, the radiance
    /// of a black body is n² B, so that it is B outside.
    #[must_use]
    pub fn in_index(&self, squared: &Spectrum) -> Self {
        match self {
            Self::Uniform { is_thermal: false, .. } => self.clone(),
            Self::Uniform { spectrum, .. } => {
                let spectrum = spectrum.product(squared);
                Self::Uniform { band: spectrum.integral(), spectrum, is_thermal: true }
            }
            Self::Thermal(thermal) => {
                Self::thermal(thermal.absorption.product(squared), Arc::clone(&thermal.temperature))
            }
        }
    }

    /// Creates thermal emission from absorption (1/m at density 1) and temperature (K).
    pub fn thermal(absorption: Spectrum, temperature: Arc<ScalarField>) -> Self {
        let hottest = temperature.max().max(1.01 * COLDEST_K);
        let first = 1.0 / hottest;
        let step = (1.0 / COLDEST_K - first) / STEPS as f64;
        let band = |i: usize| {
            let body = Spectrum::blackbodies(&[(1.0 / (first + i as f64 * step), 1.0)]);
            ln(absorption.product_integral(&body).max(f64::MIN_POSITIVE))
        };
        let log_band = (0..STEPS + 1).into_par_iter().map(band).collect();
        Self::Thermal(Box::new(ThermalEmission { temperature, absorption, log_band, inverse: (first, step) }))
    }

    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        match self {
            Self::Uniform { .. } => self.clone(),
            Self::Thermal(thermal) => {
                let temperature = Arc::new(thermal.temperature.moved(map));
                Self::Thermal(Box::new(ThermalEmission { temperature, ..(**thermal).clone() }))
            }
        }
    }

    /// In W/m³/sr/nm at density 1.
    pub fn at(&self, point: DVec3, nm: f64) -> f64 {
        match self {
            Self::Uniform { spectrum, .. } => spectrum.at(nm),
            Self::Thermal(thermal) => {
                let temperature = thermal.temperature.at(point);
                if temperature > COLDEST_K { thermal.spectral(temperature, nm) } else { 0.0 }
            }
        }
    }

    /// The emission over the band in W/m³/sr at density 1, and the temperature in K if thermal.
    pub fn band_at(&self, point: DVec3) -> (f64, Option<f64>) {
        match self {
            Self::Uniform { band, .. } => (*band, None),
            Self::Thermal(thermal) => {
                let temperature = thermal.temperature.at(point);
                (thermal.band(temperature), Some(temperature))
            }
        }
    }

    /// The relative spectrum at a temperature in K: per nm, with integral 1 over the band.
    pub fn spd_at(&self, temperature: f64, nm: f64) -> f64 {
        match self {
            Self::Uniform { spectrum, band, .. } => spectrum.at(nm) / band,
            Self::Thermal(thermal) => thermal.spectral(temperature, nm) / thermal.band(temperature),
        }
    }

    /// The spectrum of the total emission, up to a factor, by pairs of a temperature (K) and an
    /// amount.
    pub fn mean_spectrum(&self, weights: impl Iterator<Item = (f64, f64)>) -> Spectrum {
        match self {
            Self::Uniform { spectrum, .. } => spectrum.clone(),
            Self::Thermal(thermal) => {
                let temperature_at =
                    |i: usize| 1.0 / (thermal.inverse.0 + i as f64 / BINS_PER_STEP * thermal.inverse.1);
                let mut bodies: Vec<(f64, f64)> =
                    (0..=STEPS * BINS_PER_STEP as usize).map(|i| (temperature_at(i), 0.0)).collect();
                for (temperature, weight) in weights.filter(|(temperature, _)| *temperature > COLDEST_K) {
                    bodies[(BINS_PER_STEP * thermal.entry(temperature)).round() as usize].1 += weight;
                }
                bodies.retain(|(_, weight)| *weight > 0.0);
                thermal.absorption.product(&Spectrum::blackbodies(&bodies))
            }
        }
    }

    /// Multiplies the emission by a factor. Thermal emission stays unchanged.
    pub fn scale(&mut self, factor: f64) {
        if let Self::Uniform { spectrum, is_thermal: false, .. } = self {
            *self = Self::uniform(spectrum.scaled(factor));
        }
    }
}

impl ThermalEmission {
    fn spectral(&self, temperature: f64, nm: f64) -> f64 {
        self.absorption.at(nm) * planck(nm, temperature) * 1e-9
    }

    /// The fractional index in `log_band` of a temperature.
    fn entry(&self, temperature: f64) -> f64 {
        ((1.0 / temperature - self.inverse.0) / self.inverse.1).clamp(0.0, STEPS as f64)
    }

    /// The emission at a temperature in K over the band, in W/m³/sr at density 1.
    fn band(&self, temperature: f64) -> f64 {
        if temperature <= COLDEST_K {
            return 0.0;
        }
        let entry = self.entry(temperature);
        let first = (entry as usize).min(STEPS - 1);
        let fraction = entry - first as f64;
        exp((1.0 - fraction) * self.log_band[first] + fraction * self.log_band[first + 1])
    }
}
