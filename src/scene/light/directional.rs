//! Light from one far direction, or from a round disk in the sky around it, such as the sun.

use super::{Emission, EmissionNumbers, Incident, Tint};
use crate::math::frame::Frame;
use crate::math::warp;
use glam::{DAffine3, DVec3};
use std::f64::consts::{PI, TAU};

/// A distant light.
#[derive(Debug, Clone)]
pub struct Directional {
    /// Where the light goes, unit.
    toward: DVec3,
    frame: Frame,
    /// Irradiance in W/m² over the band, on a plane across the light.
    irradiance: f64,
    /// 1 − cos of the disk's angular radius; 0 is parallel light.
    one_minus_cos: f64,
}

impl Directional {
    /// Light that goes along the unit vector `toward`, from a disk of `angular_radius` (radians).
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

    /// What passes the scene's ball: the mean of π R² over directions that each cross it fully.
    pub(super) fn power_w(&self, world_radius_m: f64) -> f64 {
        self.fluence() * PI * world_radius_m * world_radius_m
    }

    /// Irradiance summed over directions each taken head-on, ∫ L dω; the irradiance itself is ∫ L cos θ dω = L π sin² θ_max.
    fn fluence(&self) -> f64 {
        self.irradiance / (1.0 - 0.5 * self.one_minus_cos)
    }

    /// Radiance of the disk.
    fn disk_radiance(&self) -> f64 {
        self.fluence() / (TAU * self.one_minus_cos)
    }

    pub(super) fn emit(&self, world_radius_m: f64, u: EmissionNumbers) -> Emission {
        let direction = if self.has_extent() {
            self.frame.to_world(warp::cone(self.one_minus_cos, [u.rest[0], u.rest[1]]))
        } else {
            self.toward
        };
        let across = (warp::disk(u.aim) * world_radius_m).extend(-world_radius_m);
        let origin = Frame::new(direction).to_world(across);
        Emission { origin, direction, from: None, flux_w: self.power_w(world_radius_m), tint: Tint::Own }
    }

    pub(super) fn towards(&self, u: [f64; 3]) -> Incident {
        let mut incident = Incident {
            direction: -self.toward,
            distance: f64::INFINITY,
            target: None,
            irradiance: self.irradiance,
            pdf_solid_angle: None,
            tint: Tint::Own,
        };
        if self.has_extent() {
            incident.direction = -self.frame.to_world(warp::cone(self.one_minus_cos, [u[0], u[1]]));
            incident.irradiance = self.fluence();
            incident.pdf_solid_angle = Some(1.0 / (TAU * self.one_minus_cos));
        }
        incident
    }

    pub(super) fn radiance(&self, direction: DVec3) -> Option<f64> {
        (self.pdf(direction) > 0.0).then(|| self.disk_radiance())
    }

    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let one_minus_cos = 0.5 * (direction + self.toward).length_squared();
        if self.has_extent() && one_minus_cos <= self.one_minus_cos { 1.0 / (TAU * self.one_minus_cos) } else { 0.0 }
    }
}
