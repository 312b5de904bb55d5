//! A distant light: parallel, or from a round disk in the sky such as the sun.

use super::sample::{EmittedSpd, LeRandoms, LeSample, LiSample, distant_origin};
use super::virtual_light::VirtualLight;
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use glam::{DAffine3, DVec3};
use std::f64::consts::{PI, TAU};

#[derive(Debug, Clone)]
pub struct DirectionalLight {
    /// The direction in which the light travels, as a unit vector.
    toward: DVec3,
    frame: Frame,
    /// On a plane perpendicular to `toward`, in W/m² over the band.
    irradiance: f64,
    /// 1 − cos of the angular radius of the disk, or 0 for parallel light.
    one_minus_cos: f64,
}

impl DirectionalLight {
    /// Creates a distant light that travels along the unit vector `toward`, from a disk of this
    /// angular radius (rad) in the sky. `irradiance` is in W/m² over the band.
    pub fn new(toward: DVec3, angular_radius: f64, irradiance: f64) -> Self {
        Self { toward, frame: Frame::new(toward), irradiance, one_minus_cos: warp::one_minus_cos(angular_radius) }
    }

    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        let toward = map.transform_vector3(self.toward).normalize();
        Self { toward, frame: Frame::new(toward), ..*self }
    }

    pub(super) fn has_extent(&self) -> bool {
        self.one_minus_cos > 0.0
    }

    /// The power in W that enters the bounding sphere, of cross-section π R², from each direction.
    pub(super) fn power_w(&self, world_radius_m: f64) -> f64 {
        self.fluence() * PI * world_radius_m * world_radius_m
    }

    /// The fluence rate ∫ L dω in W/m². The irradiance ∫ L cos θ dω is L π sin² θ_max.
    fn fluence(&self) -> f64 {
        self.irradiance / (1.0 - 0.5 * self.one_minus_cos)
    }

    /// In W/m²/sr.
    fn disk_radiance(&self) -> f64 {
        self.fluence() / (TAU * self.one_minus_cos)
    }

    fn sample_direction(&self, u: LeRandoms) -> DVec3 {
        if self.has_extent() {
            self.frame.to_world(warp::cone(self.one_minus_cos, [u.rest[0], u.rest[1]]))
        } else {
            self.toward
        }
    }

    pub(super) fn sample_le_through(&self, world_radius_m: f64, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let direction = self.sample_direction(u);
        let origin = distant_origin(sphere.sample_offset(direction, u.aim), direction, world_radius_m);
        let flux_w = origin.map_or(0.0, |_| self.fluence() * sphere.cross_section_m2());
        LeSample { origin: origin.unwrap_or_default(), direction, from: None, flux_w, spd: EmittedSpd::Own }
    }

    pub(super) fn sample_le(&self, world_radius_m: f64, u: LeRandoms) -> LeSample {
        let direction = self.sample_direction(u);
        let across = (warp::disk(u.aim) * world_radius_m).extend(-world_radius_m);
        let origin = Frame::new(direction).to_world(across);
        LeSample { origin, direction, from: None, flux_w: self.power_w(world_radius_m), spd: EmittedSpd::Own }
    }

    pub(super) fn sample_li(&self, u: [f64; 3]) -> LiSample {
        let mut incident = LiSample {
            direction: -self.toward,
            distance: f64::INFINITY,
            target: None,
            irradiance: self.irradiance,
            pdf_solid_angle: None,
            spd: EmittedSpd::Own,
        };
        if self.has_extent() {
            incident.direction = -self.frame.to_world(warp::cone(self.one_minus_cos, [u[0], u[1]]));
            incident.irradiance = self.fluence();
            incident.pdf_solid_angle = Some(1.0 / (TAU * self.one_minus_cos));
        }
        incident
    }

    pub(super) fn virtual_light(&self, u: [f64; 3]) -> VirtualLight {
        VirtualLight::parallel(self.sample_li(u).direction, None, u)
    }

    /// The radiance in W/m²/sr of a ray that leaves along `direction`, `None` beside the disk.
    pub(super) fn le(&self, direction: DVec3) -> Option<f64> {
        (self.pdf_li(direction) > 0.0).then(|| self.disk_radiance())
    }

    /// The pdf of [`sample_li`](Self::sample_li) for `direction`, per steradian.
    pub(super) fn pdf_li(&self, direction: DVec3) -> f64 {
        let one_minus_cos = 0.5 * (direction + self.toward).length_squared();
        if self.has_extent() && one_minus_cos <= self.one_minus_cos { 1.0 / (TAU * self.one_minus_cos) } else { 0.0 }
    }
}
