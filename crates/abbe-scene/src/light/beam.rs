//! A beam from a uniform invisible disk, parallel or of constant radiance in a cone per point.

use super::intensity_bounds::IntensityBounds;
use super::lit_interval::{LitInterval, inside_cone, inside_cylinder};
use super::sample::{EmittedSpd, LeRandoms, LeSample, LiSample};
use super::virtual_light::VirtualLight;
#[cfg(test)]
use super::{Emitter, contract_tests::TestLight};
use crate::geometry::Ray;
use abbe_spectra::math::elementary::{cbrt, sin};
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// The mean factor by which a map scales lengths: the cube root of the factor for volumes.
pub fn mean_scale(map: &DAffine3) -> f64 {
    cbrt(map.matrix3.determinant().abs())
}

/// A uniform disk that emits along its axis.
#[derive(Debug, Clone)]
pub struct BeamLight {
    /// In W over the band.
    pub power_w: f64,
    centre: DVec3,
    axis: DVec3,
    frame: Frame,
    radius_m: f64,
    /// The sine of the half-angle of the cone of each point; 0 for parallel light.
    sin_divergence: f64,
    one_minus_cos_divergence: f64,
}

impl BeamLight {
    /// Creates a beam from a disk around `centre` (m, relative to the scene's centre) along the
    /// unit vector `axis`, with a cone of half-angle `divergence` < π/2 (rad) at each point.
    pub fn new(centre: DVec3, axis: DVec3, radius_m: f64, divergence: f64, power_w: f64) -> Self {
        Self {
            power_w,
            centre,
            axis,
            frame: Frame::new(axis),
            radius_m,
            sin_divergence: sin(divergence),
            one_minus_cos_divergence: warp::one_minus_cos(divergence),
        }
    }

    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        let (centre, axis) = (map.transform_point3(self.centre), map.transform_vector3(self.axis).normalize());
        let radius_m = self.radius_m * mean_scale(map);
        Self { centre, axis, frame: Frame::new(axis), radius_m, ..*self }
    }

    /// The centre of the disk in m, relative to the scene's centre.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Returns the apex, behind the disk, of the cone around the light, and 1 − cos of its
    /// half-angle. `None` for parallel light.
    fn cone(&self) -> Option<(DVec3, f64)> {
        let tangent = self.sin_divergence / (1.0 - self.one_minus_cos_divergence);
        let behind = self.radius_m / tangent;
        (!self.is_parallel()).then(|| (self.centre - behind * self.axis, self.one_minus_cos_divergence))
    }

    pub fn is_parallel(&self) -> bool {
        self.sin_divergence == 0.0
    }

    fn area(&self) -> f64 {
        PI * self.radius_m * self.radius_m
    }

    /// The radiance L inside the cones, from the power Φ = L A π sin² θ, where A is the area of the
    /// disk and θ is the half-angle of the cones.
    fn radiance(&self) -> f64 {
        self.power_w / (self.area() * PI * self.sin_divergence * self.sin_divergence)
    }

    fn sample_direction(&self, u: LeRandoms) -> DVec3 {
        let tilt = warp::disk([u.rest[0], u.rest[1]]) * self.sin_divergence;
        tilt.extend((1.0 - tilt.length_squared()).max(0.0).sqrt())
    }

    pub(super) fn sample_le_through(&self, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let local = self.sample_direction(u);
        let direction = self.frame.to_world(local);
        let through = self.frame.to_local(sphere.sample_offset(direction, u.aim) - self.centre);
        let on_disk = through - through.z / local.z * local;
        // A disk of the sphere's radius across the ray covers this area of the plane of the beam.
        let area = sphere.cross_section_m2() / local.z;
        let inside = on_disk.length_squared() <= self.radius_m * self.radius_m;
        LeSample {
            origin: self.centre + self.frame.to_world(on_disk),
            direction,
            from: None,
            flux_w: if inside { self.power_w * area / self.area() } else { 0.0 },
            spd: EmittedSpd::Own,
        }
    }

    pub(super) fn sample_le(&self, u: LeRandoms) -> LeSample {
        let place = warp::disk(u.aim);
        LeSample {
            origin: self.centre + self.frame.to_world((place * self.radius_m).extend(0.0)),
            direction: self.frame.to_world(self.sample_direction(u)),
            from: None,
            flux_w: self.power_w,
            spd: EmittedSpd::Own,
        }
    }

    pub(super) fn sample_li(&self, from: DVec3, u: [f64; 3]) -> Option<LiSample> {
        let local = self.frame.to_local(from - self.centre);
        if local.z <= 0.0 {
            return None;
        }
        if self.is_parallel() {
            let inside = DVec2::new(local.x, local.y).length() <= self.radius_m;
            let irradiance = self.power_w / self.area();
            return inside.then(|| self.incident(-self.axis, local.z, irradiance));
        }
        // A sample carries light only on the disk and in the cone. The one with the smaller solid
        // angle is sampled.
        let disk_solid_angle = self.area() / (local.z * local.z);
        let cone_solid_angle = 2.0 * PI * self.one_minus_cos_divergence;
        if disk_solid_angle < cone_solid_angle {
            let source = (warp::disk([u[0], u[1]]) * self.radius_m).extend(0.0);
            let offset = local - source;
            let distance = offset.length();
            let cos = offset.z / distance;
            let inside = 1.0 - cos <= self.one_minus_cos_divergence;
            let irradiance = self.radiance() * self.area() * cos / (distance * distance);
            inside.then(|| self.incident(self.frame.to_world(-offset / distance), distance, irradiance))
        } else {
            let towards = warp::cone(self.one_minus_cos_divergence, [u[0], u[1]]);
            let distance = local.z / towards.z;
            let source = local - towards * distance;
            let inside = DVec2::new(source.x, source.y).length() <= self.radius_m;
            inside.then(|| self.incident(self.frame.to_world(-towards), distance, self.radiance() * cone_solid_angle))
        }
    }

    pub(super) fn lit_interval(&self, ray: &Ray, interval: (f64, f64)) -> Option<LitInterval> {
        let (from, to) = match self.cone() {
            None => inside_cylinder(ray, interval, self.centre, self.axis, self.radius_m)?,
            Some((apex, one_minus_cos)) => inside_cone(ray, interval, apex, self.axis, one_minus_cos)?,
        };
        Some(LitInterval { from, to, pivot: None })
    }

    /// Outside the disk, the light is at most the light of a point at the apex of the cone.
    pub(super) fn intensity_bounds(&self) -> Option<IntensityBounds> {
        let (apex, one_minus_cos) = self.cone()?;
        let intensity = self.power_w / (PI * self.sin_divergence * self.sin_divergence);
        Some(IntensityBounds::into_cone(apex, intensity, self.axis, warp::half_angle(one_minus_cos)))
    }

    /// A virtual light of parallel rays; divergent light comes from many directions.
    pub(super) fn virtual_light(&self, u: [f64; 3]) -> Option<VirtualLight> {
        self.is_parallel().then(|| VirtualLight::parallel(-self.axis, Some(self.centre), u))
    }

    fn incident(&self, direction: DVec3, distance: f64, irradiance: f64) -> LiSample {
        LiSample { direction, distance, target: None, irradiance, pdf_solid_angle: None, spd: EmittedSpd::Own }
    }
}

/// The contract tests use these lights.
#[cfg(test)]
pub(super) fn test_lights(at: DVec3, axis: DVec3) -> Vec<TestLight> {
    let light = |name, disk_m: f64, cone_rad, irradiance_at_2_m| TestLight {
        name,
        emitter: Emitter::Beam(BeamLight::new(at, axis, disk_m, cone_rad, 7.0)),
        cone_rad,
        disk_m,
        irradiance_at_2_m,
    };
    // The first divergent beam samples its disk, and the second samples its cone.
    vec![
        light("parallel beam", 0.3, 0.0, Some(7.0 / (PI * 0.09))),
        light("divergent beam", 0.1, 0.3, None),
        light("nearly parallel beam", 0.3, 0.05, None),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;

    /// A sphere of the cross-section S in front of a large disk, whose light fills a cone of
    /// directions with constant radiance, receives the flux L Ω S.
    #[test]
    fn a_sphere_in_a_wide_beam_receives_all_directions() {
        let (divergence, radius_m) = (1.0_f64, 4.0);
        let beam = BeamLight::new(DVec3::ZERO, DVec3::Z, radius_m, divergence, 10.0);
        let sphere = BoundingSphere { centre: DVec3::new(0.1, -0.2, 0.5), radius_m: 0.05 };
        let (sobol, count) = (Sobol::new(0), 4096);
        let flux = |i: u32| {
            let u = sobol.point(i);
            beam.sample_le_through(&sphere, LeRandoms { aim: [u[0], u[1]], rest: [u[2], u[3], u[4]] }).flux_w
        };
        let mean = (0..count).map(flux).sum::<f64>() / f64::from(count);
        let radiance = 10.0 / (PI * radius_m * radius_m * PI * divergence.sin().powi(2));
        let known = radiance * 2.0 * PI * (1.0 - divergence.cos()) * PI * 0.05 * 0.05;
        assert!((mean / known - 1.0).abs() < 2e-3, "{mean} for {known}");
    }
}
