//! Selection of lights, and of wavelengths for all lights together.

use crate::math::distribution::DiscreteDistribution;
use crate::scene::Scene;
use crate::spectrum::{Spectrum, WavelengthDistribution};

/// The distributions that select a light and wavelengths.
#[derive(Debug, Clone)]
pub struct LightSampler {
    /// Selects a light. The probability of a light is a weighted mean of two shares: the light's
    /// share of the visual importance (X + Y + Z), and the light's share of the radiant power.
    pub lights: DiscreteDistribution,
    /// Samples wavelengths for all lights together: the pass's shared wavelengths, and the
    /// wavelengths of the path tracer.
    pub wavelengths: WavelengthDistribution,
    /// The power of all lights together, in W over the band.
    pub power_w: f64,
}

/// The fraction of the photons that lights receive in proportion to their radiant power. Without
/// this fraction, lights that emit only at the ends of the band would receive almost no photons.
const RADIANT_FRACTION: f64 = 0.15;

impl LightSampler {
    /// Creates the distributions for a scene, or `None` if its lights emit no power in the band.
    pub fn new(scene: &Scene) -> Option<Self> {
        let powers: Vec<f64> = scene.lights.iter().map(|light| light.power_w(scene.extent())).collect();
        let visible: Vec<f64> = scene.lights.iter().zip(&powers).map(|(l, p)| l.importance_per_watt * p).collect();
        let (power_w, visible_sum) = (powers.iter().sum::<f64>(), visible.iter().sum::<f64>());
        if !(power_w > 0.0 && visible_sum > 0.0) {
            return None;
        }
        let probability =
            |i: usize| (1.0 - RADIANT_FRACTION) * visible[i] / visible_sum + RADIANT_FRACTION * powers[i] / power_w;
        let parts: Vec<(f64, &Spectrum)> =
            powers.iter().copied().zip(scene.lights.iter().map(|l| &l.spectrum)).collect();
        Some(Self {
            lights: DiscreteDistribution::new((0..powers.len()).map(probability))?,
            wavelengths: WavelengthDistribution::visually_weighted(&Spectrum::mix(&parts), scene.film.observer)?,
            power_w,
        })
    }
}
