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
    /// The same spectrum everywhere.
    Uniform {
        /// The coefficient in W/m³/sr/nm.
        spectrum: Spectrum,
        /// The integral of the spectrum over the band, in W/m³/sr.
        band: f64,
    },
    /// Thermal emission. By Kirchhoff's law, the emission coefficient is j = σ_a(λ) B_λ(T). The
    /// temperature varies in space.
    Thermal(Box<ThermalEmission>),
}

/// Thermal emission of matter whose temperature varies in space.
#[derive(Debug, Clone)]
pub struct ThermalEmission {
    temperature: Arc<ScalarField>,
    absorption: Spectrum,
    /// The logarithm of the emission, integrated over the band. The emission is in W/m³/sr. The
    /// first entry is for the highest temperature. From each entry to the next, the inverse
    /// temperature increases by the same step. By Wien's law, the logarithm is a nearly linear
    /// function of the inverse temperature.
    log_band: Vec<f64>,
    /// The inverse temperature of the first entry, and the step of the inverse temperature between
    /// entries. Both are in 1/K.
    inverse: (f64, f64),
}

/// Below this temperature in K, thermal emission counts as 0. Matter that glows dimly emits more
/// than 10¹⁶ times as much light as matter at this temperature.
const COLDEST_K: f64 = 350.0;

/// The number of steps of the inverse temperature. The relative interpolation error is below 10⁻⁴.
/// The error cancels in the product of the emission and its normalised spectrum, because the same
/// interpolated value normalises the spectrum.
const STEPS: usize = 256;

/// The mean spectrum is computed from a histogram of temperatures. This is the number of bins in
/// each step of the inverse temperature.
const BINS_PER_STEP: f64 = 8.0;

impl MediumEmission {
    /// Creates an emission with the same spectrum (W/m³/sr/nm at density 1) everywhere.
    pub fn uniform(spectrum: Spectrum) -> Self {
        let band = spectrum.integral();
        Self::Uniform { spectrum, band }
    }

    /// Creates the thermal emission for an absorption coefficient (1/m at density 1) and a field of
    /// temperatures in K.
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

    /// The emission transformed by a map of the scene's positions.
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

    /// The emission coefficient at a point, in W/m³/sr/nm at density 1.
    pub fn at(&self, point: DVec3, nm: f64) -> f64 {
        match self {
            Self::Uniform { spectrum, .. } => spectrum.at(nm),
            Self::Thermal(thermal) => {
                let temperature = thermal.temperature.at(point);
                if temperature > COLDEST_K { thermal.spectral(temperature, nm) } else { 0.0 }
            }
        }
    }

    /// The emission at a point, integrated over the band. The unit is W/m³/sr at density 1. For
    /// thermal emission, the function also returns the temperature in K.
    pub fn band_at(&self, point: DVec3) -> (f64, Option<f64>) {
        match self {
            Self::Uniform { band, .. } => (*band, None),
            Self::Thermal(thermal) => {
                let temperature = thermal.temperature.at(point);
                (thermal.band(temperature), Some(temperature))
            }
        }
    }

    /// The relative spectrum of the emission at a temperature in K: a density per nm with integral
    /// 1 over the band.
    pub fn spd_at(&self, temperature: f64, nm: f64) -> f64 {
        match self {
            Self::Uniform { spectrum, band } => spectrum.at(nm) / band,
            Self::Thermal(thermal) => thermal.spectral(temperature, nm) / thermal.band(temperature),
        }
    }

    /// The spectrum of the total emission, up to a constant factor. `weights` are pairs of a
    /// temperature in K and the amount of matter at this temperature.
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
        match self {
            Self::Uniform { spectrum, .. } => *self = Self::uniform(spectrum.scaled(factor)),
            Self::Thermal(_) => {}
        }
    }
}

impl ThermalEmission {
    fn spectral(&self, temperature: f64, nm: f64) -> f64 {
        self.absorption.at(nm) * planck(nm, temperature) * 1e-9
    }

    /// The fractional index in `log_band` that corresponds to a temperature.
    fn entry(&self, temperature: f64) -> f64 {
        ((1.0 / temperature - self.inverse.0) / self.inverse.1).clamp(0.0, STEPS as f64)
    }

    /// The emission at a temperature in K, integrated over the band. The unit is W/m³/sr at density
    /// 1.
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
