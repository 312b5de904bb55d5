//! The interface between light transport and the sensor.

use crate::plan::{LightOrigin, PathClass};

/// Receives contributions at single wavelengths: light transport uses no XYZ, RGB or bands. To save
/// time, a table may hold the responses of the sensor to many wavelengths, which light transport
/// adds and scales but does not interpret.
pub trait Sink {
    /// Adds unbiased radiance of this origin at the wavelength `nm`. `weight` (W/m²/sr) is already
    /// divided by all densities, also that of the wavelength.
    fn radiance(&mut self, origin: LightOrigin, nm: f64, weight: f64);

    /// Adds radiance and its estimated bias from the kernels of density estimation or from ray
    /// marching, both in the unit of [`Sink::radiance`].
    fn biased(&mut self, origin: LightOrigin, nm: f64, weight: f64, bias: f64);

    /// Adds S1, S2 and S3 of radiance at the wavelength `nm` in the frame of the picture, in the unit of
    /// [`Sink::radiance`], which adds S0.
    fn stokes(&mut self, _nm: f64, _stokes: [f64; 3]) {}

    /// Adds the response of the sensor to radiance of all lights and to its estimated bias.
    fn respond(&mut self, class: PathClass, radiance: SensorResponse, bias: SensorResponse);

    /// Returns true if the sensor separates the lights. The caller of [`Self::respond`] then also
    /// calls [`Self::respond_of_light`] for each part of the radiance.
    fn separates_lights(&self) -> bool {
        false
    }

    /// Adds the part of one light of the response that the next call of [`Self::respond`] adds.
    fn respond_of_light(&mut self, _light: usize, _radiance: SensorResponse) {}
}

/// The sensor's responses over all wavelengths. Only the sensor knows the three components.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SensorResponse(pub [f64; 3]);

impl SensorResponse {
    #[inline]
    pub fn add_scaled(&mut self, response: [f64; 3], factor: f64) {
        (0..3).for_each(|component| self.0[component] += response[component] * factor);
    }

    #[inline]
    pub fn scaled(self, factor: f64) -> Self {
        let [x, y, z] = self.0;
        Self([x * factor, y * factor, z * factor])
    }
}
