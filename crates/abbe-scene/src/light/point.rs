//! Lights without extent: a point light, and a spot light that shines into a cone.

use super::intensity_bounds::IntensityBounds;
use super::lit_interval::{LitInterval, inside_cone};
use super::sample::{EmittedSpd, LeRandoms, LeSample, LiSample};
#[cfg(test)]
use super::{Emitter, contract_tests::TestLight};
use crate::geometry::Ray;
use abbe_spectra::math::elementary::sin;
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use glam::{DAffine3, DVec3};
use std::f64::consts::{PI, TAU};

/// A point light: the same intensity in all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct PointLight {
    /// In m, relative to the scene's centre.
    pub position: DVec3,
    /// In W/sr over the band.
    pub intensity: f64,
}

impl PointLight {
    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        Self { position: map.transform_point3(self.position), ..*self }
    }

    pub(super) fn power_w(&self) -> f64 {
        4.0 * PI * self.intensity
    }

    pub(super) fn sample_le(&self, u: LeRandoms) -> LeSample {
        let direction = warp::sphere(u.aim);
        LeSample { origin: self.position, direction, from: None, flux_w: self.power_w(), spd: EmittedSpd::Own }
    }

    pub(super) fn sample_le_through(&self, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let (direction, solid_angle) = sphere.sample_direction(self.position, u.aim);
        let flux_w = self.intensity * solid_angle;
        LeSample { origin: self.position, direction, from: None, flux_w, spd: EmittedSpd::Own }
    }

    pub(super) fn sample_li(&self, from: DVec3) -> Option<LiSample> {
        sample_li_from_point(self.position, from, |_| self.intensity)
    }
}

/// How the intensity of a spot light falls between its two cones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpotFalloff {
    /// A smoothstep function of cos θ, where θ is the angle to the axis (pbrt).
    Smooth,
    /// Linear in θ (Mitsuba).
    Linear,
    /// The square of a linear function of cos θ (glTF).
    Square,
}

/// A spot light: a point that shines into a cone with a soft edge. The intensity is constant inside
/// the inner cone and 0 outside the outer cone.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotLight {
    position: DVec3,
    axis: DVec3,
    intensity: f64,
    /// 1 − cos of the half-angles of the two cones, accurate for narrow ones.
    inner: f64,
    outer: f64,
    falloff: SpotFalloff,
}

impl SpotLight {
    /// Creates a spot light at `position` (m, relative to the scene's centre) that shines along the
    /// unit vector `axis` into a cone of `half_angle` radians. `intensity` is that on the axis in
    /// W/sr over the band; it falls to 0 over the last `penumbra` radians of the cone.
    pub fn new(position: DVec3, axis: DVec3, half_angle: f64, penumbra: f64, intensity: f64) -> Self {
        let inner = warp::one_minus_cos((half_angle - penumbra).max(0.0));
        Self { position, axis, intensity, inner, outer: warp::one_minus_cos(half_angle), falloff: SpotFalloff::Smooth }
    }

    #[must_use]
    pub fn with_falloff(self, falloff: SpotFalloff) -> Self {
        Self { falloff, ..self }
    }

    #[must_use]
    pub fn with_intensity(self, intensity: f64) -> Self {
        Self { intensity, ..self }
    }

    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        let (position, axis) = (map.transform_point3(self.position), map.transform_vector3(self.axis).normalize());
        Self { position, axis, ..*self }
    }

    /// In m, relative to the scene's centre.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The power in W: 2π ∫ f d(cos θ), where f is the intensity at the angle θ to the axis. The
    /// mean of the smoothstep is one half, and that of the square is one third.
    pub fn power_w(&self) -> f64 {
        let solid_angle = match self.falloff {
            SpotFalloff::Smooth => 0.5 * (self.inner + self.outer),
            SpotFalloff::Square => (2.0 * self.inner + self.outer) / 3.0,
            SpotFalloff::Linear => {
                let [inner, outer] = [self.inner, self.outer].map(warp::half_angle);
                // The integral of sin θ · (outer − θ)/(outer − inner) over the edge.
                let edge = outer - inner;
                if edge > 0.0 { 1.0 - (sin(outer) - sin(inner)) / edge } else { self.outer }
            }
        };
        self.intensity * TAU * solid_angle
    }

    /// The intensity in W/sr at an angle, given as 1 − cos, to the axis.
    fn intensity_at(&self, one_minus_cos: f64) -> f64 {
        if one_minus_cos <= self.inner {
            self.intensity
        } else if one_minus_cos >= self.outer {
            0.0
        } else {
            let t = (self.outer - one_minus_cos) / (self.outer - self.inner);
            let part = match self.falloff {
                SpotFalloff::Smooth => t * t * (3.0 - 2.0 * t),
                SpotFalloff::Square => t * t,
                SpotFalloff::Linear => {
                    let [angle, inner, outer] = [one_minus_cos, self.inner, self.outer].map(warp::half_angle);
                    (outer - angle) / (outer - inner)
                }
            };
            self.intensity * part
        }
    }

    pub(super) fn intensity_bounds(&self) -> IntensityBounds {
        IntensityBounds::into_cone(self.position, self.intensity, self.axis, warp::half_angle(self.outer))
    }

    /// Samples an emitted ray uniformly over the solid angle of the outer cone.
    pub(super) fn sample_le(&self, u: LeRandoms) -> LeSample {
        let local = warp::cone(self.outer, u.aim);
        let solid_angle = TAU * self.outer;
        let flux_w = self.intensity_at(u.aim[0] * self.outer) * solid_angle;
        LeSample {
            origin: self.position,
            direction: Frame::new(self.axis).to_world(local),
            from: None,
            flux_w,
            spd: EmittedSpd::Own,
        }
    }

    pub(super) fn sample_le_through(&self, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let (direction, solid_angle) = sphere.sample_direction(self.position, u.aim);
        let flux_w = self.intensity_along(direction) * solid_angle;
        LeSample { origin: self.position, direction, from: None, flux_w, spd: EmittedSpd::Own }
    }

    pub(super) fn sample_li(&self, from: DVec3) -> Option<LiSample> {
        sample_li_from_point(self.position, from, |outward| self.intensity_along(outward))
    }

    /// The intensity along a unit vector. 1 − cos of the angle between unit vectors a and b is |a −
    /// b|²/2, which is accurate even for narrow cones.
    fn intensity_along(&self, outward: DVec3) -> f64 {
        self.intensity_at(0.5 * (outward - self.axis).length_squared())
    }

    pub(super) fn lit_interval(&self, ray: &Ray, interval: (f64, f64)) -> Option<LitInterval> {
        let (from, to) = inside_cone(ray, interval, self.position, self.axis, self.outer)?;
        Some(LitInterval { from, to, pivot: Some(self.position) })
    }
}

/// The light at `from` of a point source with an intensity (W/sr) by direction, if any.
pub(super) fn sample_li_from_point(position: DVec3, from: DVec3, intensity: impl Fn(DVec3) -> f64) -> Option<LiSample> {
    let offset = position - from;
    let distance = offset.length();
    if distance == 0.0 {
        return None;
    }
    let direction = offset / distance;
    let irradiance = intensity(-direction) / (distance * distance);
    (irradiance > 0.0).then_some(LiSample {
        direction,
        distance,
        target: None,
        irradiance,
        pdf_solid_angle: None,
        spd: EmittedSpd::Own,
    })
}

/// The contract tests use these lights.
#[cfg(test)]
pub(super) fn test_lights(at: DVec3, axis: DVec3) -> Vec<TestLight> {
    let spot = |half_angle, penumbra| Emitter::Spot(SpotLight::new(at, axis, half_angle, penumbra, 5.0));
    let edge = |half_angle, penumbra, falloff| {
        Emitter::Spot(SpotLight::new(at, axis, half_angle, penumbra, 5.0).with_falloff(falloff))
    };
    let light = |name, emitter, cone_rad, irradiance| TestLight {
        name,
        emitter,
        cone_rad,
        disk_m: 0.0,
        irradiance_at_2_m: Some(irradiance),
    };
    vec![
        light("point", Emitter::Point(PointLight { position: at, intensity: 2.0 }), PI, 0.5),
        light("spot", spot(0.35, 0.0), 0.35, 1.25),
        light("soft spot", spot(0.4, 0.25), 0.4, 1.25),
        light("wide spot", spot(2.0, 2.0), 2.0, 1.25),
        light("linear spot", edge(1.2, 0.7, SpotFalloff::Linear), 1.2, 1.25),
        light("square spot", edge(0.4, 0.25, SpotFalloff::Square), 0.4, 1.25),
    ]
}
