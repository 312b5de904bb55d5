//! Light that a medium emits by itself: hot soot, excited atoms.

use super::field::Field;
use crate::spectrum::{Spectrum, planck};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// The emission of a medium, per metre of way and at density 1.
#[derive(Debug, Clone)]
pub enum Glow {
    /// The same spectrum everywhere.
    Same {
        /// W/m³/sr/nm.
        spectrum: Spectrum,
        /// Its integral over the band, W/m³/sr.
        band: f64,
    },
    /// A black body's spectrum times the absorption, j = σ_a(λ) B_λ(T) (Kirchhoff's law), with a temperature that varies in space.
    Thermal(Box<Thermal>),
}

/// Hot matter of varying temperature.
#[derive(Debug, Clone)]
pub struct Thermal {
    temperature: Arc<Field>,
    absorption: Spectrum,
    /// The logarithm of the band's emission, W/m³/sr, at equal steps of the inverse temperature from the hottest on: nearly a
    /// straight line (Wien's law).
    log_band: Vec<f64>,
    /// Inverse temperature in 1/K of the first entry, and the step to the next.
    inverse: (f64, f64),
}

/// Colder matter, in K, emits nothing that could be seen: less than 10⁻¹⁶ of what glows dimly.
const COLDEST_K: f64 = 350.0;

/// Steps of the inverse temperature: interpolation is then exact to 10⁻⁴, and what it is off by cancels against the spectrum's shape.
const STEPS: usize = 256;

/// How much finer temperatures are told apart for the spectrum of all of it.
const FINER: f64 = 8.0;

impl Glow {
    /// The same emission everywhere, in W/m³/sr/nm at density 1.
    pub fn same(spectrum: Spectrum) -> Self {
        let band = spectrum.integral();
        Self::Same { spectrum, band }
    }

    /// Kirchhoff's law for the absorption σ_a (1/m at density 1) and a field of temperatures in K.
    pub fn thermal(absorption: Spectrum, temperature: Arc<Field>) -> Self {
        let hottest = temperature.max().max(1.01 * COLDEST_K);
        let first = 1.0 / hottest;
        let step = (1.0 / COLDEST_K - first) / STEPS as f64;
        let band = |i: usize| {
            let body = Spectrum::blackbodies(&[(1.0 / (first + i as f64 * step), 1.0)]);
            absorption.product_integral(&body).max(f64::MIN_POSITIVE).ln()
        };
        let log_band = (0..=STEPS).map(band).collect();
        Self::Thermal(Box::new(Thermal { temperature, absorption, log_band, inverse: (first, step) }))
    }

    /// The emission after a map of the scene's places.
    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        match self {
            Self::Same { .. } => self.clone(),
            Self::Thermal(thermal) => {
                let temperature = Arc::new(thermal.temperature.moved(map));
                Self::Thermal(Box::new(Thermal { temperature, ..(**thermal).clone() }))
            }
        }
    }

    /// W/m³/sr/nm at density 1.
    pub fn at(&self, point: DVec3, nm: f64) -> f64 {
        match self {
            Self::Same { spectrum, .. } => spectrum.at(nm),
            Self::Thermal(thermal) => {
                let temperature = thermal.temperature.at(point);
                if temperature > COLDEST_K { thermal.spectral(temperature, nm) } else { 0.0 }
            }
        }
    }

    /// Over the band, in W/m³/sr at density 1; and the temperature in K that decides the colour, where it varies.
    pub fn band_at(&self, point: DVec3) -> (f64, Option<f64>) {
        match self {
            Self::Same { band, .. } => (*band, None),
            Self::Thermal(thermal) => {
                let temperature = thermal.temperature.at(point);
                (thermal.band(temperature), Some(temperature))
            }
        }
    }

    /// The density per nm, with integral 1 over the band, of the emission at a temperature that [`band_at`](Self::band_at) found.
    pub fn shape_at(&self, temperature: f64, nm: f64) -> f64 {
        match self {
            Self::Same { spectrum, band } => spectrum.at(nm) / band,
            Self::Thermal(thermal) => thermal.spectral(temperature, nm) / thermal.band(temperature),
        }
    }

    /// The spectrum of all emission together: `weights` are temperatures in K with how much matter has them.
    pub fn mean_spectrum(&self, weights: impl Iterator<Item = (f64, f64)>) -> Spectrum {
        match self {
            Self::Same { spectrum, .. } => spectrum.clone(),
            Self::Thermal(thermal) => {
                let temperature_at = |i: usize| 1.0 / (thermal.inverse.0 + i as f64 / FINER * thermal.inverse.1);
                let mut bodies: Vec<(f64, f64)> =
                    (0..=STEPS * FINER as usize).map(|i| (temperature_at(i), 0.0)).collect();
                for (temperature, weight) in weights.filter(|(temperature, _)| *temperature > COLDEST_K) {
                    bodies[(FINER * thermal.place(temperature)).round() as usize].1 += weight;
                }
                bodies.retain(|(_, weight)| *weight > 0.0);
                thermal.absorption.product(&Spectrum::blackbodies(&bodies))
            }
        }
    }

    /// The emission times a factor; hot matter cannot be scaled.
    pub fn scale(&mut self, factor: f64) {
        match self {
            Self::Same { spectrum, .. } => *self = Self::same(spectrum.scaled(factor)),
            Self::Thermal(_) => {}
        }
    }
}

impl Thermal {
    fn spectral(&self, temperature: f64, nm: f64) -> f64 {
        self.absorption.at(nm) * planck(nm, temperature) * 1e-9
    }

    /// Where a temperature stands among the entries.
    fn place(&self, temperature: f64) -> f64 {
        ((1.0 / temperature - self.inverse.0) / self.inverse.1).clamp(0.0, STEPS as f64)
    }

    fn band(&self, temperature: f64) -> f64 {
        if temperature <= COLDEST_K {
            return 0.0;
        }
        let place = self.place(temperature);
        let first = (place as usize).min(STEPS - 1);
        let share = place - first as f64;
        ((1.0 - share) * self.log_band[first] + share * self.log_band[first + 1]).exp()
    }
}
