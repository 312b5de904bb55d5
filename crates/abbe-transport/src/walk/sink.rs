//! The interface between light transport and the sensor.

use crate::plan::{LightOrigin, PathClass};

/// Receives contributions at single wavelengths. The code of light transport does not use XYZ, RGB
/// or bands.
///
/// One exception saves time: a table may hold the responses of the sensor to many wavelengths. The
/// code of light transport adds and scales these responses, but it does not interpret them.
pub trait Sink {
    /// Adds unbiased radiance of this origin at the wavelength `nm`. `weight` (W/m²/sr) is already
    /// divided by all densities, including the density of the wavelength.
    fn radiance(&mut self, origin: LightOrigin, nm: f64, weight: f64);

    /// Adds radiance and an estimate of its bias. The bias comes from the kernels of density
    /// estimation or from ray marching through a medium. `weight` and `bias` have the unit of
    /// [`Sink::radiance`].
    fn biased(&mut self, origin: LightOrigin, nm: f64, weight: f64, bias: f64);

    /// Adds the response of the sensor to radiance of all lights, and the response to the estimated
    /// bias of this radiance. See [`Self::biased`].
    fn respond(&mut self, class: PathClass, radiance: SensorResponse, bias: SensorResponse);

    /// Returns true if the sensor separates the lights. The caller of [`Self::respond`] then also
    /// calls [`Self::respond_of_light`] for each part of the radiance.
    fn separates_lights(&self) -> bool {
        false
    }

    /// Adds a part of the response that the next call of [`Self::respond`] adds: the part of one
    /// light. Only sensors that separate the lights use it.
    fn respond_of_light(&mut self, _light: usize, _radiance: SensorResponse) {}
}

/// The response of the sensor to light: the sum of its responses at all wavelengths. The meaning of
/// the three components is known only to the sensor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SensorResponse(pub [f64; 3]);

impl SensorResponse {
    /// Adds `factor` times another response.
    #[inline]
    pub fn add_scaled(&mut self, response: [f64; 3], factor: f64) {
        (0..3).for_each(|component| self.0[component] += response[component] * factor);
    }

    /// Returns `factor` times this response.
    pub fn scaled(self, factor: f64) -> Self {
        Self(self.0.map(|component| component * factor))
    }
}
