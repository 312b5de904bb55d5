//! Selection of lights, and of wavelengths for all lights together.

use abbe_scene::Scene;
use abbe_scene::light::Light;
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::spectrum::{Spectrum, WavelengthDistribution};

#[derive(Debug, Clone)]
pub struct LightSampler {
    /// Selects a light by its fractions of the visual importance (X + Y + Z) and the radiant power.
    pub lights: DiscreteDistribution,
    /// Samples wavelengths for all lights together: the shared ones of a pass, and those of the
    /// path tracer. Half of them are sampled from the power of all lights; the other half is
    /// divided equally among the different spectra, also the emissions of fluorophores, so that a
    /// dim light with a line spectrum is sampled beside a bright light.
    pub wavelengths: WavelengthDistribution,
    /// For each fluorophore, the wavelengths that excite it, for the path tracer. `None` if it
    /// absorbs no light of the scene.
    pub excitation: Vec<Option<WavelengthDistribution>>,
    /// The power of all lights together, in W over the band.
    pub power_w: f64,
}

/// The fraction of the photons that lights receive in proportion to their radiant power. Without
/// it, lights that emit only at the ends of the band would receive almost no photons.
const RADIANT_FRACTION: f64 = 0.15;

/// The fraction of the wavelengths that the different spectra receive in equal parts.
const EQUAL_FRACTION: f64 = 0.5;

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
        let emissions = emission_spectra(scene);
        let mixture = Spectrum::mix(&defensive_mixture(&scene.lights, &powers, visible_sum, &emissions));
        Some(Self {
            lights: DiscreteDistribution::new((0..powers.len()).map(probability))?,
            wavelengths: WavelengthDistribution::visually_weighted(&mixture, scene.film.observer)?,
            excitation: scene.fluorophores().map(|fluorophore| fluorophore.absorbed_wavelengths(&mixture)).collect(),
            power_w,
        })
    }
}

/// The number of wavelengths of a spectrum at which densities are compared.
const COMPARED_WAVELENGTHS: u32 = 64;

impl LightSampler {
    /// Returns how many sampled wavelengths are worth one that is sampled from a single spectrum,
    /// for the worst spectrum: 1 if all lights have the same spectrum, large if many lights have
    /// different lines.
    ///
    /// It is the relative second moment ∫ p²/q of the estimate of the spectrum's light, for the
    /// density p of wavelengths for the spectrum alone and q for all lights (Kong 1992, "A note on
    /// importance sampling using standardized weights").
    pub fn wavelengths_per_useful_one(&self, scene: &Scene) -> f64 {
        let powers: Vec<f64> = scene.lights.iter().map(|light| light.power_w(scene.extent())).collect();
        let groups = spectrum_groups(&scene.lights, &powers);
        let second_moment = |(_, light): &(f64, &Light)| {
            let alone = WavelengthDistribution::visually_weighted(&light.spectrum, scene.film.observer)?;
            let ratio = |i: u32| {
                let (nm, pdf_per_nm) = alone.sample((f64::from(i) + 0.5) / f64::from(COMPARED_WAVELENGTHS));
                pdf_per_nm / self.wavelengths.pdf(nm)
            };
            Some((0..COMPARED_WAVELENGTHS).map(ratio).sum::<f64>() / f64::from(COMPARED_WAVELENGTHS))
        };
        groups.iter().filter(is_visible).filter_map(second_moment).fold(1.0, f64::max)
    }
}

/// Returns the different spectra of the lights and of the emissions of fluorophores, with their
/// weights in the mixture of [`LightSampler::wavelengths`]. `visible_sum` is the visual importance
/// of all lights, and `emissions` holds that of each emission.
fn defensive_mixture<'a>(
    lights: &'a [Light],
    powers: &[f64],
    visible_sum: f64,
    emissions: &'a [(f64, Spectrum)],
) -> Vec<(f64, &'a Spectrum)> {
    let groups = spectrum_groups(lights, powers);
    let count = (groups.iter().filter(is_visible).count() + emissions.len()) as f64;
    let weight = |group: &(f64, &Light)| {
        let equal = if is_visible(&group) { EQUAL_FRACTION / (count * group.1.importance_per_watt) } else { 0.0 };
        (1.0 - EQUAL_FRACTION) * group.0 / visible_sum + equal
    };
    let of_emissions = emissions.iter().map(|(visible, spectrum)| (EQUAL_FRACTION / (count * visible), spectrum));
    groups.iter().map(|group| (weight(group), &group.1.spectrum)).chain(of_emissions).collect()
}

/// Returns one light of each different spectrum, with the power in W of all such lights.
pub(super) fn spectrum_groups<'a>(lights: &'a [Light], powers: &[f64]) -> Vec<(f64, &'a Light)> {
    let mut groups: Vec<(f64, &Light)> = Vec::new();
    for (light, &power_w) in lights.iter().zip(powers) {
        match groups.iter_mut().find(|(_, known)| known.spectrum == light.spectrum) {
            Some((sum_w, _)) => *sum_w += power_w,
            None => groups.push((power_w, light)),
        }
    }
    groups
}

/// Returns true if the observer can see the light of a group.
pub(super) fn is_visible((power_w, light): &&(f64, &Light)) -> bool {
    *power_w > 0.0 && light.importance_per_watt > 0.0
}

/// Returns the visible emission spectra of fluorophores with their importance X + Y + Z.
fn emission_spectra(scene: &Scene) -> Vec<(f64, Spectrum)> {
    let spectra = scene.fluorophores().map(|fluorophore| fluorophore.emitted_power().clone());
    let weighed = spectra.map(|spectrum| (scene.film.observer.xyz(&spectrum).iter().sum::<f64>(), spectrum));
    weighed.filter(|(visible, _)| *visible > 0.0).collect()
}
