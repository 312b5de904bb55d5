//! Fractal noise for clouds and smoke, computed once at the centres of a grid.

use super::ball::fade;
use super::grid::FieldGrid;
use abbe_spectra::error::Result;
use abbe_spectra::math::noise::gradient_noise;
use glam::DVec3;

/// Fractal gradient noise (Perlin 2002). Each octave has half the wavelength and half the weight of
/// the octave before. Noise below a threshold becomes 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// The largest value.
    pub value: f64,
    /// The wavelength of the first octave.
    pub scale: f64,
    pub octaves: u32,
    /// From 0 to 1.
    pub threshold: f64,
    /// The width of the region in which the noise fades to 0 at the surface of the ellipsoid
    /// inscribed in the box, as a fraction (0 to 1) of the half-axes. 0 means no fade.
    pub falloff: f64,
    pub seed: u32,
}

/// For the last octave.
const CELLS_PER_WAVELENGTH: f64 = 2.0;

/// Along the longest side of the box.
const MAX_CELLS: f64 = 128.0;

/// Stretches gradient noise, which stays within about ±0.82, to nearly the whole range from 0 to 1.
const GAIN: f64 = 0.75;

impl Noise {
    /// Computes the noise on a grid in a box with these corners. Returns an error if a value is not
    /// finite in single precision.
    pub fn grid(&self, (low, high): (DVec3, DVec3)) -> Result<FieldGrid> {
        let size = high - low;
        let smallest = self.scale / f64::from(1_u32 << (self.octaves - 1));
        let side = (smallest / CELLS_PER_WAVELENGTH).max(size.max_element() / MAX_CELLS);
        let resolution = (size / side).to_array().map(|cells| cells.ceil().clamp(1.0, MAX_CELLS) as usize);
        let [x, y, _] = resolution;
        let cell = size / DVec3::from(resolution.map(|cells| cells as f64));
        let place = |i: usize| DVec3::new((i % x) as f64, (i / x % y) as f64, (i / (x * y)) as f64) + 0.5;
        let values = (0..resolution.iter().product()).map(|i: usize| self.at(cell * place(i), size));
        FieldGrid::new(resolution, values)
    }

    /// The value at an offset from the lowest corner of a box of this size.
    fn at(&self, offset: DVec3, size: DVec3) -> f64 {
        let from_middle = 2.0 * offset / size - 1.0;
        let inside = if self.falloff > 0.0 { fade(from_middle.length_squared(), 1.0 - self.falloff, 1.0) } else { 1.0 };
        let (mut sum, mut weight, mut place) = (0.0, 1.0, offset / self.scale);
        for octave in 0..self.octaves {
            sum += weight * gradient_noise(place, u64::from(self.seed) << 32 | u64::from(octave));
            weight *= 0.5;
            place *= 2.0;
        }
        // The weights of all octaves sum to 2 − 2·weight.
        let fraction = (0.5 + GAIN * sum / (2.0 - 2.0 * weight)).clamp(0.0, 1.0);
        let kept =
            if self.threshold < 1.0 { (fraction - self.threshold).max(0.0) / (1.0 - self.threshold) } else { 0.0 };
        self.value * inside * kept
    }
}
