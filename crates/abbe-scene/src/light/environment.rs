//! The environment: distant light from all directions, uniform, an image or a sky.

use super::environment_map::EnvironmentMap;
use super::sample::{EmittedSpd, LeRandoms, LeSample, LiSample, distant_origin};
use super::sky::StandardSky;
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

#[derive(Debug, Clone)]
pub struct EnvironmentLight {
    /// Over all directions, in W/m²/sr over the band.
    pub mean_radiance: f64,
    pub pattern: EnvironmentPattern,
    /// From directions of the pattern to directions of the world.
    rotation: DMat3,
}

#[derive(Debug, Clone)]
pub enum EnvironmentPattern {
    Uniform,
    Image(Arc<EnvironmentMap>),
    /// A standard sky with its ground.
    Sky(Arc<StandardSky>),
}

struct EnvironmentSample {
    /// Towards the environment.
    direction: DVec3,
    /// Per steradian.
    pdf: f64,
    /// In W/m²/sr over the band.
    radiance: f64,
    spd: EmittedSpd,
}

impl EnvironmentLight {
    /// Creates an environment with this mean radiance (W/m²/sr over the band).
    pub fn new(mean_radiance: f64, pattern: EnvironmentPattern) -> Self {
        Self { mean_radiance, pattern, rotation: DMat3::IDENTITY }
    }

    pub fn is_uniform(&self) -> bool {
        matches!(self.pattern, EnvironmentPattern::Uniform)
    }

    pub(super) fn rotated(&self, by: DQuat) -> Self {
        Self { rotation: DMat3::from_quat(by) * self.rotation, ..self.clone() }
    }

    /// The pattern's direction for one of the world, by the transposed rotation.
    fn in_pattern(&self, direction: DVec3) -> DVec3 {
        self.rotation.transpose() * direction
    }

    /// The point of the image in a direction of the world.
    fn point(&self, direction: DVec3) -> [f64; 2] {
        EnvironmentMap::point(self.in_pattern(direction))
    }

    pub(super) fn power_w(&self, world_radius_m: f64) -> f64 {
        self.mean_radiance * 4.0 * PI * PI * world_radius_m * world_radius_m
    }

    /// The radiance (W/m²/sr over the band) and spectrum of a ray that leaves the scene.
    pub(super) fn le(&self, direction: DVec3) -> (f64, EmittedSpd) {
        match &self.pattern {
            EnvironmentPattern::Uniform => (self.mean_radiance, EmittedSpd::Own),
            EnvironmentPattern::Image(map) => {
                let (relative, spd) = map.le(self.point(direction));
                (self.mean_radiance * relative, spd)
            }
            EnvironmentPattern::Sky(sky) => {
                (self.mean_radiance * sky.relative_radiance(self.in_pattern(direction)), EmittedSpd::Own)
            }
        }
    }

    /// The pdf of [`sample_li`](Self::sample_li) for `direction`, per steradian.
    pub(super) fn pdf_li(&self, direction: DVec3) -> f64 {
        match &self.pattern {
            EnvironmentPattern::Uniform => 0.25 * FRAC_1_PI,
            EnvironmentPattern::Image(map) => map.pdf_solid_angle(self.point(direction)),
            EnvironmentPattern::Sky(sky) => sky.pdf(self.in_pattern(direction)),
        }
    }

    /// Samples a direction towards the environment. Returns `None` if its pdf is 0.
    fn sample(&self, u: [f64; 2]) -> Option<EnvironmentSample> {
        let (direction, pdf, (radiance, spd)) = match &self.pattern {
            EnvironmentPattern::Uniform => (warp::sphere(u), 0.25 * FRAC_1_PI, (self.mean_radiance, EmittedSpd::Own)),
            EnvironmentPattern::Image(map) => {
                let (point, _) = map.pixels.sample(u);
                let (relative, spd) = map.le(point);
                let direction = self.rotation * EnvironmentMap::direction(point);
                (direction, map.pdf_solid_angle(point), (self.mean_radiance * relative, spd))
            }
            EnvironmentPattern::Sky(sky) => {
                let direction = sky.sample(u);
                let radiance = self.mean_radiance * sky.relative_radiance(direction);
                (self.rotation * direction, sky.pdf(direction), (radiance, EmittedSpd::Own))
            }
        };
        (pdf > 0.0).then_some(EnvironmentSample { direction, pdf, radiance, spd })
    }

    /// Samples a direction for an emitted ray, without light if its pdf is 0.
    fn sample_emission(&self, u: LeRandoms) -> EnvironmentSample {
        let none = EnvironmentSample { direction: DVec3::Y, pdf: 1.0, radiance: 0.0, spd: EmittedSpd::Own };
        self.sample([u.rest[0], u.rest[1]]).unwrap_or(none)
    }

    pub(super) fn sample_le_through(&self, world_radius_m: f64, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let EnvironmentSample { direction, pdf, radiance, spd } = self.sample_emission(u);
        let direction = -direction;
        let origin = distant_origin(sphere.sample_offset(direction, u.aim), direction, world_radius_m);
        let flux_w = origin.map_or(0.0, |_| radiance / pdf * sphere.cross_section_m2());
        LeSample { origin: origin.unwrap_or_default(), direction, from: None, flux_w, spd }
    }

    pub(super) fn sample_le(&self, world_radius_m: f64, u: LeRandoms) -> LeSample {
        let EnvironmentSample { direction, pdf, radiance, spd } = self.sample_emission(u);
        let direction = -direction;
        let origin = Frame::new(direction).to_world((warp::disk(u.aim) * world_radius_m).extend(-world_radius_m));
        let flux_w = radiance / pdf * PI * world_radius_m * world_radius_m;
        LeSample { origin, direction, from: None, flux_w, spd }
    }

    pub(super) fn sample_li(&self, u: [f64; 3]) -> Option<LiSample> {
        let EnvironmentSample { direction, pdf, radiance, spd } = self.sample([u[0], u[1]])?;
        Some(LiSample {
            direction,
            distance: f64::INFINITY,
            target: None,
            irradiance: radiance / pdf,
            pdf_solid_angle: Some(pdf),
            spd,
        })
    }

    /// The value of a mixture of the basis spectra at a wavelength in nm, per nm.
    pub(super) fn mixture_at(&self, weights: [f64; 3], nm: f64) -> f64 {
        match &self.pattern {
            EnvironmentPattern::Image(map) => map.mixture_at(weights, nm),
            EnvironmentPattern::Uniform | EnvironmentPattern::Sky(_) => 0.0,
        }
    }

    /// The spectrum of a pixel with spectral bands at a wavelength in nm, per nm.
    pub(super) fn bands_at(&self, pixel: u32, nm: f64) -> f64 {
        match &self.pattern {
            EnvironmentPattern::Image(map) => map.bands_at(pixel, nm),
            EnvironmentPattern::Uniform | EnvironmentPattern::Sky(_) => 0.0,
        }
    }
}
