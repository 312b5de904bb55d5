use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer, Spectrum};

/// The relative spectral power distribution of a light and its luminous efficacy.
#[derive(Debug, Clone)]
pub struct LightSpectrum {
    spectrum: Spectrum,
    lumens_per_watt: f64,
}

impl LightSpectrum {
    /// Normalises a spectrum to integral 1 over the band 360–830 nm. Photometric quantities always
    /// use ȳ of the CIE 1931 observer, even if the film has another observer.
    pub fn new(spectrum: &Spectrum) -> Self {
        let spectrum = spectrum.scaled(1.0 / spectrum.integral());
        let lumens_per_watt = LUMENS_PER_WATT * Observer::cie1931().xyz(&spectrum)[1];
        Self { spectrum, lumens_per_watt }
    }

    /// The normalised spectrum: a density per nm with integral 1 over the band.
    pub fn normalised(&self) -> &Spectrum {
        &self.spectrum
    }

    /// Converts a power in W over the band to a luminous flux in lm.
    pub fn lumens_from_watts(&self, watts: f64) -> f64 {
        watts * self.lumens_per_watt
    }

    /// Converts a photometric quantity (lm, cd, cd/m², lx) to the radiometric one in W over the
    /// band, or returns an error if it is positive but the spectrum has no visible light.
    pub fn watts_from_lumens(&self, value: f64) -> Result<f64> {
        if value > 0.0 && self.lumens_per_watt <= 0.0 {
            return Err(Error::input("the spectrum has no visible light")
                .expected("a spectrum with visible light, or a quantity in W"));
        }
        Ok(if value > 0.0 { value / self.lumens_per_watt } else { 0.0 })
    }
}
