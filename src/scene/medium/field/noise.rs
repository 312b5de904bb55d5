//! Fractal noise, for clouds and smoke: computed once at the centres of a grid, so that the field *is* that grid.

use super::ball::fade;
use super::grid::Grid;
use crate::error::Result;
use crate::math::random::mix64;
use glam::DVec3;

/// Fractal gradient noise (Perlin 2002): octaves of half the size and half the weight, from 0 to 1, cut off below a threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// The largest value.
    pub value: f64,
    /// Size of the largest lumps.
    pub scale: f64,
    /// Number of octaves.
    pub octaves: u32,
    /// The share of the noise, from 0 to 1, that is cut to 0.
    pub threshold: f64,
    /// The share of the half-axes, from 0 to 1, over which the noise fades towards the ellipsoid inscribed in its box; 0 fills the box.
    pub falloff: f64,
    /// The seed.
    pub seed: u32,
}

/// The grid has this many cells to the smallest lump, …
const CELLS_PER_LUMP: f64 = 2.0;
/// … but no more than this along the longest side of the box.
const MAX_CELLS: f64 = 128.0;

/// Gradient noise of a slope of at most √2 stays within ±0.82 or so; a lump's middle is to be near 1.
const GAIN: f64 = 0.75;

impl Noise {
    /// The noise over a box.
    ///
    /// # Errors
    /// A value beyond what single precision holds.
    pub fn grid(&self, (low, high): (DVec3, DVec3)) -> Result<Grid> {
        let size = high - low;
        let smallest = self.scale / f64::from(1_u32 << (self.octaves - 1));
        let side = (smallest / CELLS_PER_LUMP).max(size.max_element() / MAX_CELLS);
        let resolution = (size / side).to_array().map(|cells| cells.ceil().clamp(1.0, MAX_CELLS) as usize);
        let [x, y, _] = resolution;
        let cell = size / DVec3::from(resolution.map(|cells| cells as f64));
        let place = |i: usize| DVec3::new((i % x) as f64, (i / x % y) as f64, (i / (x * y)) as f64) + 0.5;
        let values = (0..resolution.iter().product()).map(|i: usize| self.at(cell * place(i), size));
        Grid::new(resolution, values)
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
        // The weights sum to 2 − 2·weight.
        let share = (0.5 + GAIN * sum / (2.0 - 2.0 * weight)).clamp(0.0, 1.0);
        let kept = if self.threshold < 1.0 { (share - self.threshold).max(0.0) / (1.0 - self.threshold) } else { 0.0 };
        self.value * inside * kept
    }
}

/// Noise of slopes drawn at the points of the unit lattice, 0 on the points themselves.
fn gradient_noise(place: DVec3, seed: u64) -> f64 {
    let corner = place.floor();
    let within = place - corner;
    let share = within * within * within * (within * (6.0 * within - 15.0) + 10.0);
    let slope = |x: f64, y: f64, z: f64| {
        let offset = DVec3::new(x, y, z);
        let [x, y, z] = (corner + offset).to_array().map(|c| c as i64 as u64 & 0x1f_ffff);
        let [a, b, c] = (within - offset).to_array();
        // One of the twelve directions to the middles of a cube's edges.
        match mix64(seed ^ mix64(x | y << 21 | z << 42)) % 12 {
            0 => a + b,
            1 => a - b,
            2 => b - a,
            3 => -a - b,
            4 => a + c,
            5 => a - c,
            6 => c - a,
            7 => -a - c,
            8 => b + c,
            9 => b - c,
            10 => c - b,
            _ => -b - c,
        }
    };
    let mix = |a: f64, b: f64, share: f64| a + share * (b - a);
    let along_x = |y: f64, z: f64| mix(slope(0.0, y, z), slope(1.0, y, z), share.x);
    let along_y = |z: f64| mix(along_x(0.0, z), along_x(1.0, z), share.y);
    mix(along_y(0.0), along_y(1.0), share.z)
}
