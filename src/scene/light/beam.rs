//! A disk of light: parallel, or a narrow cone of constant radiance from every point of it. It cannot be seen itself.

use super::{Emission, EmissionNumbers, Incident, Tint};
use crate::math::frame::Frame;
use crate::math::warp;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// What a map does to lengths, in the mean: the cube root of what it does to volumes.
pub fn mean_stretch(map: &DAffine3) -> f64 {
    map.matrix3.determinant().abs().cbrt()
}

/// A uniform disk that shines along its axis.
#[derive(Debug, Clone)]
pub struct Beam {
    /// Power in W over the band.
    pub power_w: f64,
    centre: DVec3,
    axis: DVec3,
    frame: Frame,
    radius_m: f64,
    /// Sine of the cone's half-angle; 0 is parallel light.
    sin_divergence: f64,
    one_minus_cos_divergence: f64,
}

impl Beam {
    /// A disk around `centre` of this radius that shines along the unit vector `axis`, into cones of half-angle
    /// `divergence` (radians, below π/2).
    pub fn new(centre: DVec3, axis: DVec3, radius_m: f64, divergence: f64, power_w: f64) -> Self {
        Self {
            power_w,
            centre,
            axis,
            frame: Frame::new(axis),
            radius_m,
            sin_divergence: divergence.sin(),
            one_minus_cos_divergence: warp::one_minus_cos(divergence),
        }
    }

    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        let (centre, axis) = (map.transform_point3(self.centre), map.transform_vector3(self.axis).normalize());
        let radius_m = self.radius_m * mean_stretch(map);
        Self { centre, axis, frame: Frame::new(axis), radius_m, ..*self }
    }

    /// The disk's centre.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The unit vector along which it shines.
    pub(super) fn axis(&self) -> DVec3 {
        self.axis
    }

    /// The disk's radius in m.
    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// The cone that holds all of the light: its apex behind the disk, and 1 − cos of its half-angle; `None` of parallel light.
    pub(super) fn cone(&self) -> Option<(DVec3, f64)> {
        let tangent = self.sin_divergence / (1.0 - self.one_minus_cos_divergence);
        let behind = self.radius_m / tangent;
        (!self.is_parallel()).then(|| (self.centre - behind * self.axis, self.one_minus_cos_divergence))
    }

    /// Whether the light is parallel.
    pub fn is_parallel(&self) -> bool {
        self.sin_divergence == 0.0
    }

    fn area(&self) -> f64 {
        PI * self.radius_m * self.radius_m
    }

    /// Radiance inside the cones, from Φ = L · A · π sin².
    fn radiance(&self) -> f64 {
        self.power_w / (self.area() * PI * self.sin_divergence * self.sin_divergence)
    }

    pub(super) fn emit(&self, u: EmissionNumbers) -> Emission {
        let (place, way) = (warp::disk(u.aim), warp::disk([u.rest[0], u.rest[1]]) * self.sin_divergence);
        let direction = way.extend((1.0 - way.length_squared()).max(0.0).sqrt());
        Emission {
            origin: self.centre + self.frame.to_world((place * self.radius_m).extend(0.0)),
            direction: self.frame.to_world(direction),
            from: None,
            flux_w: self.power_w,
            tint: Tint::Own,
        }
    }

    pub(super) fn towards(&self, from: DVec3, u: [f64; 3]) -> Option<Incident> {
        let local = self.frame.to_local(from - self.centre);
        if local.z <= 0.0 {
            return None;
        }
        if self.is_parallel() {
            let inside = DVec2::new(local.x, local.y).length() <= self.radius_m;
            let irradiance = self.power_w / self.area();
            return inside.then(|| self.incident(-self.axis, local.z, irradiance));
        }
        // Draw where fewer draws are lost: over the disk, or over the cone of directions.
        let disk_solid_angle = self.area() / (local.z * local.z);
        let cone_solid_angle = 2.0 * PI * self.one_minus_cos_divergence;
        if disk_solid_angle < cone_solid_angle {
            let source = (warp::disk([u[0], u[1]]) * self.radius_m).extend(0.0);
            let way = local - source;
            let distance = way.length();
            let cos = way.z / distance;
            let inside = 1.0 - cos <= self.one_minus_cos_divergence;
            let irradiance = self.radiance() * self.area() * cos / (distance * distance);
            inside.then(|| self.incident(self.frame.to_world(-way / distance), distance, irradiance))
        } else {
            let way = warp::cone(self.one_minus_cos_divergence, [u[0], u[1]]);
            let distance = local.z / way.z;
            let source = local - way * distance;
            let inside = DVec2::new(source.x, source.y).length() <= self.radius_m;
            inside.then(|| self.incident(self.frame.to_world(-way), distance, self.radiance() * cone_solid_angle))
        }
    }

    fn incident(&self, direction: DVec3, distance: f64, irradiance: f64) -> Incident {
        Incident { direction, distance, target: None, irradiance, pdf_solid_angle: None, tint: Tint::Own }
    }
}
