//! The wavelengths of stored photons, in a compact form.

use crate::emit::EmittedPower;
use abbe_optics::fluorophore::Fluorophore;
use abbe_scene::Scene;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{LANES, WavelengthDistribution};

/// The wavelengths of a free photon, all sampled from one random number: this number, and the
/// number of the spectrum of its light, or of the fluorophore that emitted it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WavelengthCode {
    /// The random number, rounded down to 16 bits.
    pub(super) quantile: u16,
    /// The number of the spectrum in [`PhotonSpectra`].
    pub(super) spectrum: u16,
}

/// The spectra from which free photons sample their wavelengths. Lights of equal spectra have the
/// same number. If the picture separates the lights, the number also tells the group of the light.
/// The spectra of the fluorophores follow: each emission has a number for each group.
#[derive(Debug, Clone)]
pub struct PhotonSpectra {
    distributions: Vec<WavelengthDistribution>,
    of_light: Vec<u16>,
    /// The power of each light spectrum, by its number.
    power: Vec<Option<EmittedPower>>,
    /// For each number, the first light that has it, or for a fluorophore a light of the group.
    first_lights: Vec<usize>,
    /// For each number of a light's spectrum, the group of the light.
    groups: Vec<usize>,
    /// The number of groups, and the number of spectra of the lights.
    group_count: usize,
    light_spectra: usize,
    /// For each fluorophore and each number of a light's spectrum, the wavelengths that the
    /// fluorophore absorbs. `None` if it absorbs nothing.
    excitation: Vec<Option<WavelengthDistribution>>,
    different: usize,
}

impl WavelengthCode {
    pub const QUANTILES: usize = 1 << u16::BITS;

    /// Returns the position of the code in a table with a row of `cells` cells for each spectrum,
    /// which divide the quantiles into equal parts.
    #[inline]
    pub fn cell(self, cells: usize) -> usize {
        usize::from(self.spectrum) * cells + usize::from(self.quantile) / (Self::QUANTILES / cells)
    }
}

impl PhotonSpectra {
    /// Numbers the spectra of the lights and of the fluorophores, with other numbers for each group
    /// if `by_group` is true. Returns an input error if there are more than the numbers can
    /// distinguish.
    pub fn new(scene: &Scene, by_group: bool) -> Result<Self> {
        let lights = &scene.lights;
        let mut distributions: Vec<WavelengthDistribution> = Vec::new();
        let mut first_lights: Vec<usize> = Vec::new();
        let mut different = 0;
        let of_light = lights.iter().enumerate().map(|(light_number, light)| {
            let spectrum = |number: &usize| &distributions[*number] == light.photon_wavelengths();
            let group = |number: &usize| !by_group || lights[first_lights[*number]].group == light.group;
            let numbers = 0..distributions.len();
            let known = numbers.clone().find(|number| group(number) && spectrum(number));
            let is_new = known.is_none() && !numbers.clone().any(|number| spectrum(&number));
            different += usize::from(is_new);
            if known.is_none() {
                distributions.push(light.photon_wavelengths().clone());
                first_lights.push(light_number);
            }
            code_number(known.unwrap_or(numbers.end))
        });
        let of_light = of_light.collect::<Result<_>>()?;
        let (light_spectra, mut groups, mut group_lights) = (distributions.len(), Vec::new(), Vec::<usize>::new());
        for &light in &first_lights {
            let same = |other: &usize| !by_group || lights[*other].group == lights[light].group;
            let group = group_lights.iter().position(same).unwrap_or(group_lights.len());
            if group == group_lights.len() {
                group_lights.push(light);
            }
            groups.push(group);
        }
        for emission in scene.fluorophores().flat_map(Fluorophore::emissions) {
            distributions.extend(group_lights.iter().map(|_| emission.wavelengths().clone()));
            first_lights.extend(&group_lights);
            different += 1;
        }
        let excited =
            |fluorophore: &Fluorophore, light: &usize| fluorophore.absorbed_wavelengths(&lights[*light].spectrum);
        let lights_of_spectra = &first_lights[..light_spectra];
        let excitation = scene
            .fluorophores()
            .flat_map(|fluorophore| lights_of_spectra.iter().map(move |light| excited(fluorophore, light)));
        let excitation = excitation.collect();
        let _last = code_number(distributions.len().saturating_sub(1))?;
        Ok(Self {
            power: first_lights[..light_spectra]
                .iter()
                .map(|&light| EmittedPower::of(&lights[light], scene.film.observer))
                .collect(),
            distributions,
            of_light,
            first_lights,
            groups,
            group_count: group_lights.len(),
            light_spectra,
            excitation,
            different,
        })
    }

    /// Returns the power that a light emits at each wavelength, or `None` if it emits none.
    pub fn power(&self, light: usize) -> Option<&EmittedPower> {
        self.power[usize::from(self.of_light[light])].as_ref()
    }

    /// Returns the wavelengths that a fluorophore absorbs in the light with the number `light`.
    pub fn excitation(&self, light: usize, fluorophore: usize) -> Option<&WavelengthDistribution> {
        self.excitation[fluorophore * self.light_spectra + usize::from(self.of_light[light])].as_ref()
    }

    /// Returns the code of the wavelengths that emission number `emission` of the scene samples
    /// from `u` in [0, 1). `excited_by` is the code of the absorbed photon.
    #[inline]
    pub fn code_of_emission(&self, emission: usize, excited_by: WavelengthCode, u: f64) -> WavelengthCode {
        let spectrum = usize::from(excited_by.spectrum);
        let group = match spectrum.checked_sub(self.light_spectra) {
            None => self.groups[spectrum],
            Some(number) => number % self.group_count,
        };
        let number = self.light_spectra + emission * self.group_count + group;
        WavelengthCode { quantile: quantile(u), spectrum: number as u16 }
    }

    /// Returns the number of different spectra. It does not depend on the groups of the lights.
    pub fn different(&self) -> usize {
        self.different
    }

    /// Returns a light that has the spectrum of a code and, if the picture separates the lights,
    /// the group of the photon's light.
    #[inline]
    pub fn light_of(&self, code: WavelengthCode) -> usize {
        self.first_lights[usize::from(code.spectrum)]
    }

    pub fn len(&self) -> usize {
        self.distributions.len()
    }

    pub fn is_empty(&self) -> bool {
        self.distributions.is_empty()
    }

    /// Returns the code of the wavelengths that a light samples from the number `u` in [0, 1).
    #[inline]
    pub fn code(&self, light: usize, u: f64) -> WavelengthCode {
        WavelengthCode { quantile: quantile(u), spectrum: self.of_light[light] }
    }

    /// Returns the wavelength (nm) of one lane, in the middle of the quantile.
    #[inline]
    pub fn wavelength(&self, code: WavelengthCode, lane: usize) -> f64 {
        let u = (f64::from(code.quantile) + 0.5) / WavelengthCode::QUANTILES as f64;
        self.wavelength_at(usize::from(code.spectrum), u, lane)
    }

    /// Returns the wavelength (nm) of one lane that a spectrum samples from `u` in [0, 1).
    #[inline]
    pub fn wavelength_at(&self, spectrum: usize, u: f64, lane: usize) -> f64 {
        self.distributions[spectrum].sample((u + lane as f64) / LANES as f64).0
    }
}

#[inline]
fn quantile(u: f64) -> u16 {
    (u * WavelengthCode::QUANTILES as f64) as u16
}

fn code_number(number: usize) -> Result<u16> {
    u16::try_from(number).map_err(|_| {
        Error::input("the lights and fluorophores have too many different spectra")
            .expected("at most 65536 different spectra")
    })
}
