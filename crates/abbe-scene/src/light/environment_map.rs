//! A latitude–longitude image of the light from all directions.

use super::environment_bands::EnvironmentBands;
use super::sample::EmittedSpd;
use abbe_spectra::math::distribution::PiecewiseConstant2d;
use abbe_spectra::math::elementary::{acos, atan2, cos, sin, sin_cos};
use abbe_spectra::spectrum::Spectrum;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A latitude–longitude image with mean radiance 1. The rows go from +y (top) to −y, and the
/// columns around the y axis, with −z in the middle (see [`EnvironmentMap::direction`]).
#[derive(Debug)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    texels: Texels,
    /// Samples pixels in proportion to radiance times solid angle.
    pub(super) pixels: PiecewiseConstant2d,
}

/// The light of each pixel.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "an environment has one, whose basis spectra are read for each ray")]
enum Texels {
    Mixed {
        /// The weights of the basis spectra by pixel, with the relative radiance as their sum.
        weights: Vec<[f64; 3]>,
        /// Each has integral 1 over the band.
        basis: [Spectrum; 3],
    },
    Bands {
        bands: EnvironmentBands,
        /// The factor from the radiance of the bands to the relative radiance.
        scale: f64,
    },
}

impl EnvironmentMap {
    /// Creates a map from linear RGB pixels (row by row from the top) and the spectra of the three
    /// primaries. Returns `None` if the image is black.
    pub fn new(width: usize, height: usize, rgb: &[[f32; 3]], lights: [&Spectrum; 3]) -> Option<Self> {
        let powers = lights.map(Spectrum::integral);
        let mut weights: Vec<[f64; 3]> =
            rgb.iter().map(|p| std::array::from_fn(|c| f64::from(p[c].max(0.0)) * powers[c])).collect();
        let mean = mean(width, height, |pixel| weights[pixel].iter().sum())?;
        weights.iter_mut().for_each(|w| w.iter_mut().for_each(|c| *c /= mean));
        let pixels = pixels(width, height, |pixel| weights[pixel].iter().sum())?;
        let basis = std::array::from_fn(|c| lights[c].scaled(1.0 / powers[c]));
        Some(Self { width, height, texels: Texels::Mixed { weights, basis }, pixels })
    }

    /// Creates a map from spectral radiances (row by row from the top), and returns it with the
    /// mean radiance over all directions in W/m²/sr over the band. Returns `None` if the image is
    /// black.
    pub fn from_bands(width: usize, height: usize, bands: EnvironmentBands) -> Option<(Self, f64)> {
        let mean = mean(width, height, |pixel| bands.radiance(pixel))?;
        let pixels = pixels(width, height, |pixel| bands.radiance(pixel) / mean)?;
        Some((Self { width, height, texels: Texels::Bands { bands, scale: 1.0 / mean }, pixels }, mean))
    }

    /// The mean spectrum of all directions, with integral 1 over the band.
    pub fn mean_spectrum(&self) -> Spectrum {
        let solid_angle = |pixel: usize| row_solid_angle(pixel / self.width, self.height);
        match &self.texels {
            Texels::Mixed { weights, basis } => {
                let mut sums = [0.0; 3];
                for (pixel, weight) in weights.iter().enumerate() {
                    (0..3).for_each(|c| sums[c] += weight[c] * solid_angle(pixel));
                }
                let total: f64 = sums.iter().sum();
                Spectrum::mix(&std::array::from_fn::<_, 3, _>(|c| (sums[c] / total, &basis[c])))
            }
            Texels::Bands { bands, .. } => {
                let sum = bands.weighted_sum(solid_angle);
                sum.scaled(1.0 / sum.integral())
            }
        }
    }

    /// The value per nm of the mixture of the basis spectra with these weights.
    #[inline]
    pub(super) fn mixture_at(&self, weights: [f64; 3], nm: f64) -> f64 {
        match &self.texels {
            Texels::Mixed { basis, .. } => (0..3).map(|c| weights[c] * basis[c].at(nm)).sum(),
            Texels::Bands { .. } => 0.0,
        }
    }

    /// The spectrum per nm of a pixel with spectral bands, with integral 1 over the band.
    #[inline]
    pub(super) fn bands_at(&self, pixel: u32, nm: f64) -> f64 {
        match &self.texels {
            Texels::Mixed { .. } => 0.0,
            Texels::Bands { bands, .. } => bands.at(pixel as usize, nm) / bands.radiance(pixel as usize),
        }
    }

    /// The radiance of a pixel, divided by the mean radiance.
    fn radiance(&self, pixel: usize) -> f64 {
        match &self.texels {
            Texels::Mixed { weights, .. } => weights[pixel].iter().sum(),
            Texels::Bands { bands, scale } => bands.radiance(pixel) * scale,
        }
    }

    /// The direction towards a point of the image, with coordinates in [0, 1]: −z in the middle, +x
    /// at three quarters of the width, and +y in the top row.
    pub fn direction(point: [f64; 2]) -> DVec3 {
        let (sin_theta, cos_theta) = sin_cos(PI * point[1]);
        let (sin_phi, cos_phi) = sin_cos(TAU * (point[0] - 0.5));
        DVec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
    }

    /// The point of the image in a direction: the inverse of [`EnvironmentMap::direction`].
    pub fn point(direction: DVec3) -> [f64; 2] {
        let phi = atan2(direction.x, -direction.z);
        [(phi / TAU + 0.5).clamp(0.0, 1.0), acos(direction.y.clamp(-1.0, 1.0)) / PI]
    }

    pub(super) fn pixel(&self, point: [f64; 2]) -> usize {
        let column = ((point[0] * self.width as f64) as usize).min(self.width - 1);
        let row = ((point[1] * self.height as f64) as usize).min(self.height - 1);
        row * self.width + column
    }

    /// The radiance at a point of the image, divided by the mean radiance, and the spectrum there.
    pub(super) fn le(&self, point: [f64; 2]) -> (f64, EmittedSpd) {
        let pixel = self.pixel(point);
        let radiance = self.radiance(pixel);
        let spd = match &self.texels {
            _ if radiance <= 0.0 => EmittedSpd::Own,
            Texels::Mixed { weights, .. } => EmittedSpd::Mixed(weights[pixel].map(|w| w / radiance)),
            Texels::Bands { .. } => EmittedSpd::Bands(pixel as u32),
        };
        (radiance, spd)
    }

    /// The fraction of the power that comes from pixels with more than `contrast` times the mean
    /// radiance.
    pub(super) fn fraction_above(&self, contrast: f64) -> f64 {
        let (mut above, mut all) = (0.0, 0.0);
        for pixel in 0..self.width * self.height {
            let radiance = self.radiance(pixel);
            let power = radiance * row_solid_angle(pixel / self.width, self.height);
            all += power;
            above += if radiance > contrast { power } else { 0.0 };
        }
        above / all
    }

    /// The pdf of a point per steradian: dA of the unit square covers 2π² sin θ dA.
    pub(super) fn pdf_solid_angle(&self, point: [f64; 2]) -> f64 {
        let sin_theta = sin(PI * point[1]);
        if sin_theta > 0.0 { self.pixels.pdf(point) / (2.0 * PI * PI * sin_theta) } else { 0.0 }
    }
}

/// The mean of a function of the pixels over all directions. `None` if it is not above 0.
fn mean(width: usize, height: usize, radiance: impl Fn(usize) -> f64) -> Option<f64> {
    let row_weight = |pixel: usize| row_solid_angle(pixel / width, height);
    let total: f64 = (0..width * height).map(|pixel| radiance(pixel) * row_weight(pixel)).sum();
    let mean = total / (width as f64 * (0..height).map(|row| row_solid_angle(row, height)).sum::<f64>());
    (mean > 0.0 && mean.is_finite()).then_some(mean)
}

/// The distribution of pixels in proportion to radiance times solid angle.
fn pixels(width: usize, height: usize, radiance: impl Fn(usize) -> f64) -> Option<PiecewiseConstant2d> {
    let mass = |pixel: usize| radiance(pixel) * row_solid_angle(pixel / width, height);
    PiecewiseConstant2d::new(width, &(0..width * height).map(mass).collect::<Vec<f64>>())
}

/// The solid angle of a row of pixels, divided by 2π.
fn row_solid_angle(row: usize, height: usize) -> f64 {
    let edge = |r: usize| cos(PI * r as f64 / height as f64);
    edge(row) - edge(row + 1)
}
