//! Light from everywhere far away: uniform, or an image of the surroundings.

use super::{Emission, EmissionNumbers, Incident, Tint};
use crate::math::distribution::Grid;
use crate::math::frame::Frame;
use crate::math::warp;
use crate::spectrum::Spectrum;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

/// The surroundings as a light.
#[derive(Debug, Clone)]
pub struct Environment {
    /// Mean radiance over all directions, in W/m²/sr over the band.
    pub mean_radiance: f64,
    /// The image, if it is not the same everywhere.
    pub map: Option<Arc<EnvironmentMap>>,
    /// From directions of the image to those of the world.
    turn: DMat3,
}

/// A latitude–longitude image: rows from +y (top) to −y, columns around y, the middle one towards −z (see
/// [`EnvironmentMap::direction`]); mean radiance 1.
#[derive(Debug)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    /// Power shares of the three basis lights, per pixel; their sum is the pixel's radiance relative to the mean.
    weights: Vec<[f64; 3]>,
    /// Draws pixels by radiance × solid angle.
    pixels: Grid,
    /// The basis lights, each with integral 1.
    basis: [Spectrum; 3],
}

impl EnvironmentMap {
    /// A map from linear RGB pixels (row by row from the top) and the spectra of the lights red, green and blue.
    /// `None` if the image is black.
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
        Some(Self { width, height, weights, pixels: Grid::new(width, &masses)?, basis })
    }

    /// The spectrum of all directions together, with integral 1.
    pub fn mean_spectrum(&self) -> Spectrum {
        let mut sums = [0.0; 3];
        for (pixel, weight) in self.weights.iter().enumerate() {
            let solid_angle = row_solid_angle(pixel / self.width, self.height);
            (0..3).for_each(|c| sums[c] += weight[c] * solid_angle);
        }
        let total: f64 = sums.iter().sum();
        Spectrum::mix(&std::array::from_fn::<_, 3, _>(|c| (sums[c] / total, &self.basis[c])))
    }

    /// The direction *from* which light comes, seen at a point of the unit square: the middle of the image is −z, its
    /// right quarter +x, the top +y.
    pub fn direction(point: [f64; 2]) -> DVec3 {
        let (sin_theta, cos_theta) = (PI * point[1]).sin_cos();
        let (sin_phi, cos_phi) = (TAU * (point[0] - 0.5)).sin_cos();
        DVec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
    }

    /// The point of the unit square for a direction; the inverse of [`EnvironmentMap::direction`].
    pub fn point(direction: DVec3) -> [f64; 2] {
        let phi = direction.x.atan2(-direction.z);
        [(phi / TAU + 0.5).clamp(0.0, 1.0), direction.y.clamp(-1.0, 1.0).acos() / PI]
    }

    fn pixel(&self, point: [f64; 2]) -> usize {
        let column = ((point[0] * self.width as f64) as usize).min(self.width - 1);
        let row = ((point[1] * self.height as f64) as usize).min(self.height - 1);
        row * self.width + column
    }

    /// Radiance relative to the mean, and colour, seen from `direction`.
    fn look(&self, point: [f64; 2]) -> (f64, Tint) {
        let weights = self.weights[self.pixel(point)];
        let sum: f64 = weights.iter().sum();
        (sum, if sum > 0.0 { Tint::Mixed(weights.map(|w| w / sum)) } else { Tint::Own })
    }

    /// From density over the unit square to density per steradian: the square maps to 2π² sin θ.
    fn pdf(&self, point: [f64; 2]) -> f64 {
        let sin_theta = (PI * point[1]).sin();
        if sin_theta > 0.0 { self.pixels.density(point) / (2.0 * PI * PI * sin_theta) } else { 0.0 }
    }
}

/// The solid angle of a row of pixels, up to a constant factor.
fn row_solid_angle(row: usize, height: usize) -> f64 {
    let edge = |r: usize| (PI * r as f64 / height as f64).cos();
    edge(row) - edge(row + 1)
}

impl Environment {
    /// Surroundings of this mean radiance (W/m²/sr over the band); uniform without an image.
    pub fn new(mean_radiance: f64, map: Option<Arc<EnvironmentMap>>) -> Self {
        Self { mean_radiance, map, turn: DMat3::IDENTITY }
    }

    /// The surroundings turned about the scene.
    pub(super) fn turned(&self, by: DQuat) -> Self {
        Self { turn: DMat3::from_quat(by) * self.turn, ..self.clone() }
    }

    /// The point of the image's unit square for a direction of the world; the turn's transpose is its inverse.
    fn point(&self, direction: DVec3) -> [f64; 2] {
        EnvironmentMap::point(self.turn.transpose() * direction)
    }

    pub(super) fn power_w(&self, world_radius_m: f64) -> f64 {
        self.mean_radiance * 4.0 * PI * PI * world_radius_m * world_radius_m
    }

    /// Radiance and colour of a ray that leaves the scene along `direction`.
    pub(super) fn radiance(&self, direction: DVec3) -> (f64, Tint) {
        match &self.map {
            None => (self.mean_radiance, Tint::Own),
            Some(map) => {
                let (relative, tint) = map.look(self.point(direction));
                (self.mean_radiance * relative, tint)
            }
        }
    }

    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        self.map.as_ref().map_or(0.25 * FRAC_1_PI, |map| map.pdf(self.point(direction)))
    }

    fn draw(&self, u: [f64; 2]) -> Option<(DVec3, f64, f64, Tint)> {
        let Some(map) = &self.map else {
            return Some((warp::sphere(u), 0.25 * FRAC_1_PI, self.mean_radiance, Tint::Own));
        };
        let (point, _) = map.pixels.sample(u);
        let pdf = map.pdf(point);
        let (relative, tint) = map.look(point);
        (pdf > 0.0).then(|| (self.turn * EnvironmentMap::direction(point), pdf, self.mean_radiance * relative, tint))
    }

    pub(super) fn emit(&self, world_radius_m: f64, u: EmissionNumbers) -> Emission {
        let drawn = self.draw([u.rest[0], u.rest[1]]);
        let (from, pdf, radiance, tint) = drawn.unwrap_or((DVec3::Y, 1.0, 0.0, Tint::Own));
        let direction = -from;
        let origin = Frame::new(direction).to_world((warp::disk(u.aim) * world_radius_m).extend(-world_radius_m));
        let flux_w = radiance / pdf * PI * world_radius_m * world_radius_m;
        Emission { origin, direction, from: None, flux_w, tint }
    }

    pub(super) fn towards(&self, u: [f64; 3]) -> Option<Incident> {
        let (direction, pdf, radiance, tint) = self.draw([u[0], u[1]])?;
        Some(Incident {
            direction,
            distance: f64::INFINITY,
            target: None,
            irradiance: radiance / pdf,
            pdf_solid_angle: Some(pdf),
            tint,
        })
    }

    pub(super) fn mixed_at(&self, weights: [f64; 3], nm: f64) -> f64 {
        self.map.as_ref().map_or(0.0, |map| (0..3).map(|c| weights[c] * map.basis[c].at(nm)).sum())
    }
}
