//! A latitude–longitude image of the light from all directions.

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
    /// The weights of the basis spectra by pixel, with the relative radiance as their sum.
    weights: Vec<[f64; 3]>,
    /// Samples pixels in proportion to radiance times solid angle.
    pub(super) pixels: PiecewiseConstant2d,
    /// Each has integral 1 over the band.
    pub(super) basis: [Spectrum; 3],
}

impl EnvironmentMap {
    /// Creates a map from linear RGB pixels (row by row from the top) and the spectra of the three
    /// primaries. Returns `None` if the image is black.
    pub fn new(width: usize, height: usize, rgb: &[[f32; 3]], lights: [&Spectrum; 3]) -> Option<Self> {
        let powers = lights.map(Spectrum::integral);
        let mut weights: Vec<[f64; 3]> =
            rgb.iter().map(|p| std::array::from_fn(|c| f64::from(p[c].max(0.0)) * powers[c])).collect();
        let row_weight = |pixel: usize| row_solid_angle(pixel / width, height);
        let total: f64 = weights.iter().enumerate().map(|(i, w)| w.iter().sum::<f64>() * row_weight(i)).sum();
        let mean = total / (width as f64 * (0..height).map(|row| row_solid_angle(row, height)).sum::<f64>());
        if !(mean > 0.0 && mean.is_finite()) {
            return None;
        }
        weights.iter_mut().for_each(|w| w.iter_mut().for_each(|c| *c /= mean));
        let masses: Vec<f64> = weights.iter().enumerate().map(|(i, w)| w.iter().sum::<f64>() * row_weight(i)).collect();
        let basis = std::array::from_fn(|c| lights[c].scaled(1.0 / powers[c]));
        Some(Self { width, height, weights, pixels: PiecewiseConstant2d::new(width, &masses)?, basis })
    }

    /// The mean spectrum of all directions, with integral 1 over the band.
    pub fn mean_spectrum(&self) -> Spectrum {
        let mut sums = [0.0; 3];
        for (pixel, weight) in self.weights.iter().enumerate() {
            let solid_angle = row_solid_angle(pixel / self.width, self.height);
            (0..3).for_each(|c| sums[c] += weight[c] * solid_angle);
        }
        let total: f64 = sums.iter().sum();
        Spectrum::mix(&std::array::from_fn::<_, 3, _>(|c| (sums[c] / total, &self.basis[c])))
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
        let weights = self.weights[self.pixel(point)];
        let sum: f64 = weights.iter().sum();
        (sum, if sum > 0.0 { EmittedSpd::Mixed(weights.map(|w| w / sum)) } else { EmittedSpd::Own })
    }

    /// The fraction of the power that comes from pixels with more than `contrast` times the mean
    /// radiance.
    pub(super) fn fraction_above(&self, contrast: f64) -> f64 {
        let (mut above, mut all) = (0.0, 0.0);
        for (pixel, weights) in self.weights.iter().enumerate() {
            let radiance: f64 = weights.iter().sum();
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

/// The solid angle of a row of pixels, divided by 2π.
fn row_solid_angle(row: usize, height: usize) -> f64 {
    let edge = |r: usize| cos(PI * r as f64 / height as f64);
    edge(row) - edge(row + 1)
}
