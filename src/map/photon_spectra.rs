//! The wavelengths of stored photons, in a compact form.

use crate::error::{Error, Result};
use crate::scene::light::Light;
use crate::spectrum::{LANES, WavelengthDistribution};

/// The wavelengths of a free photon. The photon's light sampled all of them from one random number.
/// The code consists of this number and of the number of the light's spectrum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WavelengthCode {
    /// The random number, rounded down to 16 bits.
    pub(super) quantile: u16,
    /// The number of the spectrum in [`PhotonSpectra`].
    pub(super) spectrum: u16,
}

/// The spectra from which free photons sample their wavelengths. Lights of equal spectra have the
/// same number. If the picture separates the lights, lights of different groups have different
/// numbers, so that a stored photon knows the group of its light.
#[derive(Debug, Clone)]
pub struct PhotonSpectra {
    distributions: Vec<WavelengthDistribution>,
    of_light: Vec<u16>,
    /// For each number, the first light that has it.
    first_lights: Vec<usize>,
    /// The number of different spectra.
    different: usize,
}

impl WavelengthCode {
    /// The number of quantiles.
    pub const QUANTILES: usize = 1 << u16::BITS;

    /// Returns the position of the code in a table that has a row of `cells` cells for each
    /// spectrum. The cells divide the quantiles into equal parts.
    #[inline]
    pub fn cell(self, cells: usize) -> usize {
        usize::from(self.spectrum) * cells + usize::from(self.quantile) / (Self::QUANTILES / cells)
    }
}

impl PhotonSpectra {
    /// Numbers the spectra of the lights. If `by_group` is true, lights of different groups have
    /// different numbers.
    ///
    /// # Errors
    /// Returns an input error if the lights have more different spectra than the numbers can
    /// distinguish.
    pub fn new(lights: &[Light], by_group: bool) -> Result<Self> {
        let mut distributions: Vec<WavelengthDistribution> = Vec::new();
        let mut first_lights: Vec<usize> = Vec::new();
        let mut different = 0;
        let of_light = lights.iter().enumerate().map(|(light_number, light)| {
            let spectrum = |number: &usize| distributions[*number] == light.wavelengths;
            let group = |number: &usize| !by_group || lights[first_lights[*number]].group == light.group;
            let numbers = 0..distributions.len();
            let known = numbers.clone().find(|number| group(number) && spectrum(number));
            let is_new = known.is_none() && !numbers.clone().any(|number| spectrum(&number));
            different += usize::from(is_new);
            if known.is_none() {
                distributions.push(light.wavelengths.clone());
                first_lights.push(light_number);
            }
            let number = known.unwrap_or(numbers.end);
            u16::try_from(number).map_err(|_| {
                Error::input("the lights have too many different spectra").expected("at most 65536 different spectra")
            })
        });
        let of_light = of_light.collect::<Result<_>>()?;
        Ok(Self { distributions, of_light, first_lights, different })
    }

    /// Returns the number of different spectra. It does not depend on the groups of the lights.
    pub fn different(&self) -> usize {
        self.different
    }

    /// Returns the number of a light that has the spectrum of a code. If the picture separates the
    /// lights, it also has the group of the photon's light.
    #[inline]
    pub fn light_of(&self, code: WavelengthCode) -> usize {
        self.first_lights[usize::from(code.spectrum)]
    }

    /// Returns the number of numbered spectra.
    pub fn len(&self) -> usize {
        self.distributions.len()
    }

    /// Returns true if there are no lights.
    pub fn is_empty(&self) -> bool {
        self.distributions.is_empty()
    }

    /// Returns the code of the wavelengths that a light samples from the number `u` in [0, 1).
    #[inline]
    pub fn code(&self, light: usize, u: f64) -> WavelengthCode {
        WavelengthCode { quantile: (u * WavelengthCode::QUANTILES as f64) as u16, spectrum: self.of_light[light] }
    }

    /// Returns the wavelength (nm) of one lane. The wavelength belongs to the middle of the
    /// quantile.
    #[inline]
    pub fn wavelength(&self, code: WavelengthCode, lane: usize) -> f64 {
        let u = (f64::from(code.quantile) + 0.5) / WavelengthCode::QUANTILES as f64;
        self.wavelength_at(usize::from(code.spectrum), u, lane)
    }

    /// Returns the wavelength (nm) of one lane that a light of a spectrum samples from the number
    /// `u` in [0, 1).
    #[inline]
    pub fn wavelength_at(&self, spectrum: usize, u: f64, lane: usize) -> f64 {
        self.distributions[spectrum].sample((u + lane as f64) / LANES as f64).0
    }
}
