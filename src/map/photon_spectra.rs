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
/// same number.
#[derive(Debug, Clone)]
pub struct PhotonSpectra {
    distributions: Vec<WavelengthDistribution>,
    of_light: Vec<u16>,
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
    /// Numbers the spectra of the lights.
    ///
    /// # Errors
    /// Returns an input error if the lights have more different spectra than the numbers can
    /// distinguish.
    pub fn new(lights: &[Light]) -> Result<Self> {
        let mut distributions: Vec<WavelengthDistribution> = Vec::new();
        let of_light = lights.iter().map(|light| {
            let number = distributions.iter().position(|known| *known == light.wavelengths).unwrap_or_else(|| {
                distributions.push(light.wavelengths.clone());
                distributions.len() - 1
            });
            u16::try_from(number).map_err(|_| {
                Error::input("the lights have too many different spectra").expected("at most 65536 different spectra")
            })
        });
        let of_light = of_light.collect::<Result<_>>()?;
        Ok(Self { distributions, of_light })
    }

    /// Returns the number of different spectra.
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
