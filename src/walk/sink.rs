//! The interface between light transport and the sensor.

/// Receives contributions at single wavelengths. The code of light transport does not use XYZ, RGB
/// or bands.
pub trait Sink {
    /// Adds unbiased radiance at the wavelength `nm`. `weight` (W/m²/sr) is already divided by all
    /// densities, including the density of the wavelength.
    fn radiance(&mut self, nm: f64, weight: f64);

    /// Adds radiance and an estimate of its bias. The bias comes from the kernels of density
    /// estimation or from ray marching through a medium. `weight` and `bias` have the unit of
    /// [`Sink::radiance`].
    fn biased(&mut self, nm: f64, weight: f64, bias: f64);
}
