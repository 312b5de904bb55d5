//! Which light, and which wavelengths for all lights together.

use crate::math::distribution::Discrete;
use crate::scene::Scene;
use crate::spectrum::{Spectrum, WavelengthDistribution};

/// The lights as one source.
#[derive(Debug, Clone)]
pub struct LightChoice {
    /// Draws a light by its visible power, with a share by its plain power.
    pub lights: Discrete,
    /// Draws wavelengths for all lights together: for the pass's shared wavelengths and for the path tracer.
    pub wavelengths: WavelengthDistribution,
    /// The power of all lights in W over the band.
    pub power_w: f64,
}

/// The share of photons that goes by watts, so that light at the ends of the band is not starved.
const BY_WATTS: f64 = 0.15;

impl LightChoice {
    /// Looks the scene's lights over; `None` if they give no light in the band.
    pub fn new(scene: &Scene) -> Option<Self> {
        let powers: Vec<f64> = scene.lights.iter().map(|light| light.power_w(scene.world())).collect();
        let visible: Vec<f64> = scene.lights.iter().zip(&powers).map(|(l, p)| l.importance_per_watt * p).collect();
        let (power_w, visible_sum) = (powers.iter().sum::<f64>(), visible.iter().sum::<f64>());
        if !(power_w > 0.0 && visible_sum > 0.0) {
            return None;
        }
        let share = |i: usize| (1.0 - BY_WATTS) * visible[i] / visible_sum + BY_WATTS * powers[i] / power_w;
        let parts: Vec<(f64, &Spectrum)> =
            powers.iter().copied().zip(scene.lights.iter().map(|l| &l.spectrum)).collect();
        Some(Self {
            lights: Discrete::new((0..powers.len()).map(share))?,
            wavelengths: WavelengthDistribution::important(&Spectrum::mix(&parts), scene.film.observer)?,
            power_w,
        })
    }
}
