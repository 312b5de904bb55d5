//! Which spectra of the lights the shared wavelengths have sampled.

use super::light_sampler::{is_visible, spectrum_groups};
use abbe_scene::Scene;
use abbe_scene::light::Light;
use abbe_spectra::spectrum::{Lanes, WavelengthDistribution};

/// A pass samples a spectrum if the mean of p/q over its wavelengths is at least this number, for
/// the density p of wavelengths for the spectrum alone and q for all lights. Over many passes, the
/// mean of p/q is 1, so the tail of a line does not suffice.
const LEAST_FRACTION: f64 = 0.1;

/// The different spectra of the lights that no pass has sampled so far. Behind dispersive glass,
/// the picture lacks the light of these lights, and the replicates do not show it.
#[derive(Debug, Default)]
pub struct SpectrumCoverage {
    /// The spectra that no pass has sampled: the name of a light, and its wavelengths.
    missing: Vec<(String, WavelengthDistribution)>,
}

impl SpectrumCoverage {
    pub fn before_first_pass(scene: &Scene) -> Self {
        let powers: Vec<f64> = scene.lights.iter().map(|light| light.power_w(scene.extent())).collect();
        let groups = spectrum_groups(&scene.lights, &powers);
        let alone = |light: &Light| {
            Some((light.name.clone(), WavelengthDistribution::visually_weighted(&light.spectrum, scene.film.observer)?))
        };
        Self { missing: groups.iter().filter(is_visible).filter_map(|(_, light)| alone(light)).collect() }
    }

    /// Removes the spectra that a pass with these wavelengths (nm) samples.
    pub fn add_pass(&mut self, nm: &Lanes, pdf: &Lanes) {
        self.missing.retain(|(_, alone)| {
            let fractions = nm.iter().zip(pdf).map(|(&nm, &pdf)| alone.pdf(nm) / pdf);
            fractions.sum::<f64>() < LEAST_FRACTION * nm.len() as f64
        });
    }

    pub fn is_complete(&self) -> bool {
        self.missing.is_empty()
    }

    /// Returns the name of one light of each spectrum that no pass has sampled.
    pub fn missing(&self) -> impl Iterator<Item = &str> {
        self.missing.iter().map(|(name, _)| name.as_str())
    }
}
