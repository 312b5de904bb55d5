//! The light below the band, which excites fluorophores.

use super::Light;
use abbe_spectra::spectrum::WavelengthDistribution;

impl Light {
    /// Returns the distribution of the wavelengths of the light's photons.
    #[inline]
    pub fn photon_wavelengths(&self) -> &WavelengthDistribution {
        self.ultraviolet.as_deref().unwrap_or(&self.wavelengths)
    }

    /// Adds ultraviolet to the wavelengths of the photons. `value` is the visual importance of 1 W
    /// at a wavelength in nm. Photons below the band are sampled in proportion to their importance,
    /// as photons of the band are. Their share is at most one half, so that the noise of visible
    /// light grows by at most √2.
    pub fn add_ultraviolet(&mut self, value: &dyn Fn(f64) -> f64) {
        /// The largest share of the ultraviolet.
        const MOST: f64 = 0.5;
        let importance = self.spectrum.ultraviolet_sum(value);
        if importance > 0.0 {
            let (band, mass) = (&self.wavelengths, self.importance_per_watt);
            self.ultraviolet = self.spectrum.extended_wavelengths(Some(band), mass, value, MOST).map(Box::new);
            self.importance_per_watt += importance;
        }
    }
}
