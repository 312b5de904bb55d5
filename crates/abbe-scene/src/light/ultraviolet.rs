use super::Light;
use abbe_spectra::spectrum::WavelengthDistribution;

impl Light {
    #[inline]
    pub fn photon_wavelengths(&self) -> &WavelengthDistribution {
        self.ultraviolet.as_deref().unwrap_or(&self.wavelengths)
    }

    /// Adds ultraviolet, which excites fluorophores, to the photons' wavelengths, sampled as in the
    /// band in proportion to the visual importance `value` of 1 W at a nm. It gets at most one
    /// half, so that the noise of visible light grows by at most √2.
    pub fn add_ultraviolet(&mut self, value: &dyn Fn(f64) -> f64) {
        const MOST: f64 = 0.5;
        let importance = self.spectrum.ultraviolet_sum(value);
        if importance > 0.0 {
            let (band, mass) = (&self.wavelengths, self.importance_per_watt);
            self.ultraviolet = self.spectrum.extended_wavelengths(Some(band), mass, value, MOST).map(Box::new);
            self.importance_per_watt += importance;
        }
    }
}
