//! A light that replays the rays of a file, as makers of LEDs publish them.
//!
//! The file is a sample of the light, so only its rays are known, and no direction from a point to
//! the light: shadow rays and camera rays do not find it, and photons carry all of its light.

use super::sample::{EmittedSpd, LeRandoms, LeSample};
use abbe_spectra::math::elementary::atan2_f32;
use glam::{DAffine3, DVec3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A ray in the frame of its light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmittedRay {
    /// In m.
    pub origin: Vec3,
    /// A unit vector.
    pub direction: Vec3,
    /// The flux, on any scale.
    pub flux: f32,
}

/// The rays of a file in rows of similar polar angle, and by azimuth in each row, so that two
/// random numbers select rays with evenly distributed directions.
#[derive(Debug)]
pub struct RaySet {
    rays: Vec<EmittedRay>,
    /// For each ray, the flux of all rays up to it.
    flux_up_to: Vec<f64>,
    /// The index of the first ray of each row, and the number of rays.
    rows: Vec<usize>,
}

impl RaySet {
    /// Returns `None` if no ray carries light.
    pub fn new(mut rays: Vec<EmittedRay>) -> Option<Self> {
        rays.retain(|ray| ray.flux > 0.0);
        let count = rays.len();
        let per_row = (count as f64).sqrt().ceil().max(1.0) as usize;
        rays.sort_by(|a, b| a.direction.z.total_cmp(&b.direction.z));
        for row in rays.chunks_mut(per_row) {
            row.sort_by_cached_key(|ray| azimuth_rank(ray.direction));
        }
        let mut flux = 0.0;
        let flux_up_to = rays.iter().map(|ray| {
            flux += f64::from(ray.flux);
            flux
        });
        let flux_up_to: Vec<f64> = flux_up_to.collect();
        let rows = (0..count).step_by(per_row).chain([count]).collect();
        (count > 0).then_some(Self { rays, flux_up_to, rows })
    }

    /// The sum of the flux of all rays.
    pub fn flux(&self) -> f64 {
        self.flux_before(self.rays.len())
    }

    fn flux_before(&self, index: usize) -> f64 {
        index.checked_sub(1).map_or(0.0, |last| self.flux_up_to[last])
    }

    /// Selects a ray with a probability in proportion to its flux.
    fn sample(&self, u: [f64; 2]) -> EmittedRay {
        let flux = u[0] * self.flux();
        let row = self.rows[1..].partition_point(|&end| self.flux_before(end) <= flux).min(self.rows.len() - 2);
        let (first, end) = (self.rows[row], self.rows[row + 1]);
        let before = self.flux_before(first);
        let flux = before + u[1] * (self.flux_before(end) - before);
        let index = first + self.flux_up_to[first..end].partition_point(|&up_to| up_to <= flux);
        self.rays[index.min(end - 1)]
    }
}

/// Orders directions by their azimuth.
fn azimuth_rank(direction: Vec3) -> u32 {
    let turns = f64::from(atan2_f32(direction.y, direction.x)) / TAU;
    (turns.rem_euclid(1.0) * f64::from(u32::MAX)) as u32
}

#[derive(Debug, Clone)]
pub struct RaySetLight {
    /// In W over the band.
    pub power_w: f64,
    rays: Arc<RaySet>,
    /// From the frame of the rays to the world, in m.
    to_world: DAffine3,
    /// A box around the origins of the rays, in m relative to the scene's centre.
    bounds: (DVec3, DVec3),
}

impl RaySetLight {
    /// Creates a light from rays and the map of their frame (m) to the world (m, relative to the
    /// scene's centre). A scale of the map moves the origins apart, and leaves the power.
    pub fn new(rays: Arc<RaySet>, to_world: DAffine3, power_w: f64) -> Self {
        let origins = rays.rays.iter().map(|ray| to_world.transform_point3(ray.origin.as_dvec3()));
        let nowhere = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let bounds = origins.fold(nowhere, |(low, high), origin| (low.min(origin), high.max(origin)));
        Self { power_w, rays, to_world, bounds }
    }

    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        Self::new(Arc::clone(&self.rays), *map * self.to_world, self.power_w)
    }

    /// The middle of the origins of the rays.
    pub(super) fn centre(&self) -> DVec3 {
        0.5 * (self.bounds.0 + self.bounds.1)
    }

    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        self.bounds
    }

    pub(super) fn sample_le(&self, u: LeRandoms) -> LeSample {
        let EmittedRay { origin, direction, .. } = self.rays.sample(u.aim);
        LeSample {
            origin: self.to_world.transform_point3(origin.as_dvec3()),
            direction: self.to_world.transform_vector3(direction.as_dvec3()).normalize(),
            from: None,
            flux_w: self.power_w,
            spd: EmittedSpd::Own,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;

    /// Each ray is sampled as often as its flux demands.
    #[test]
    fn rays_are_sampled_by_their_flux() {
        let ray = |number: u32| {
            let (angle, tilt) = (f64::from(number) * 2.399, f64::from(number) / 50.0);
            let direction = DVec3::new(tilt * angle.cos(), tilt * angle.sin(), 1.0).normalize().as_vec3();
            EmittedRay { origin: Vec3::splat(number as f32), direction, flux: number as f32 }
        };
        let set = RaySet::new((0..50).map(ray).collect()).unwrap();
        assert_eq!(set.flux(), 1225.0);
        let (sobol, count) = (Sobol::new(0), 1 << 16);
        let mut sampled = [0.0; 50];
        for i in 0..count {
            let ray = set.sample([sobol.at(i, 0), sobol.at(i, 1)]);
            sampled[ray.origin.x as usize] += 1225.0 / f64::from(count);
        }
        for (number, flux) in sampled.iter().enumerate() {
            assert!((flux - number as f64).abs() < 0.15, "{number}: {flux}");
        }
    }

    #[test]
    fn rays_without_light_make_no_set() {
        let dark = EmittedRay { origin: Vec3::ZERO, direction: Vec3::Z, flux: 0.0 };
        assert!(RaySet::new(vec![dark]).is_none());
    }
}
