//! Where transport hands over what it found.

/// Takes contributions at single wavelengths; transport itself never sees XYZ, RGB or bands.
pub trait Sink {
    /// Adds radiance: `weight` (W/m²/sr) is already divided by every density, that of the wavelength included.
    fn radiance(&mut self, nm: f64, weight: f64);

    /// Adds radiance that is off in the mean, by its kernel or by steps through a medium, with its estimated bias (both like `weight` above).
    fn biased(&mut self, nm: f64, weight: f64, bias: f64);
}
