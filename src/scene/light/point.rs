//! Lights without extent: a point, and a point that shines into a cone.

use super::{Emission, EmissionNumbers, Incident, Tint};
use crate::math::frame::Frame;
use crate::math::warp;
use glam::{DAffine3, DVec3};
use std::f64::consts::{PI, TAU};

/// A point that shines equally in all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Where it is.
    pub at: DVec3,
    /// Intensity in W/sr over the band.
    pub intensity: f64,
}

impl Point {
    pub(super) fn power_w(&self) -> f64 {
        4.0 * PI * self.intensity
    }

    pub(super) fn emit(&self, u: EmissionNumbers) -> Emission {
        let direction = warp::sphere(u.aim);
        Emission { origin: self.at, direction, from: None, flux_w: self.power_w(), tint: Tint::Own }
    }

    pub(super) fn towards(&self, from: DVec3) -> Option<Incident> {
        towards_point(self.at, from, |_| self.intensity)
    }
}

/// A point that shines into a cone, with a smooth edge: the intensity is `intensity` up to the cosine `cos_inner` from the
/// axis, 0 beyond `cos_outer`, and a smoothstep in the cosine between.
#[derive(Debug, Clone, PartialEq)]
pub struct Spot {
    at: DVec3,
    axis: DVec3,
    intensity: f64,
    /// 1 − cos at the inner and outer edge: cosines of narrow cones would lose their digits.
    inner: f64,
    outer: f64,
}

impl Spot {
    /// A spot on `at` that shines along the unit vector `axis` within `half_angle` (radians); over the last `penumbra` radians
    /// inside that it fades out. `intensity` is that on the axis.
    pub fn new(at: DVec3, axis: DVec3, half_angle: f64, penumbra: f64, intensity: f64) -> Self {
        let inner = warp::one_minus_cos((half_angle - penumbra).max(0.0));
        Self { at, axis, intensity, inner, outer: warp::one_minus_cos(half_angle) }
    }

    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        let (at, axis) = (map.transform_point3(self.at), map.transform_vector3(self.axis).normalize());
        Self { at, axis, ..*self }
    }

    /// The power of a spot of unit intensity: 2π ∫ falloff d(cos θ), the smoothstep's mean being one half.
    pub fn power_per_intensity(half_angle: f64, penumbra: f64) -> f64 {
        let spot = Self::new(DVec3::ZERO, DVec3::Z, half_angle, penumbra, 1.0);
        spot.power_w()
    }

    /// Where it is.
    pub fn at(&self) -> DVec3 {
        self.at
    }

    /// The unit vector along which it shines.
    pub(super) fn axis(&self) -> DVec3 {
        self.axis
    }

    /// 1 − cos of the cone's half-angle.
    pub(super) fn one_minus_cos(&self) -> f64 {
        self.outer
    }

    pub(super) fn power_w(&self) -> f64 {
        self.intensity * TAU * 0.5 * (self.inner + self.outer)
    }

    /// The intensity along a direction given by 1 − its cosine with the axis.
    fn intensity_at(&self, one_minus_cos: f64) -> f64 {
        if one_minus_cos <= self.inner {
            self.intensity
        } else if one_minus_cos >= self.outer {
            0.0
        } else {
            let t = (self.outer - one_minus_cos) / (self.outer - self.inner);
            self.intensity * t * t * (3.0 - 2.0 * t)
        }
    }

    /// Draws uniformly within the cone.
    pub(super) fn emit(&self, u: EmissionNumbers) -> Emission {
        let local = warp::cone(self.outer, u.aim);
        let solid_angle = TAU * self.outer;
        let flux_w = self.intensity_at(u.aim[0] * self.outer) * solid_angle;
        Emission {
            origin: self.at,
            direction: Frame::new(self.axis).to_world(local),
            from: None,
            flux_w,
            tint: Tint::Own,
        }
    }

    pub(super) fn towards(&self, from: DVec3) -> Option<Incident> {
        // 1 − cos of the angle between unit vectors a, b is |a − b|²/2, exact for narrow cones.
        towards_point(self.at, from, |outward| self.intensity_at(0.5 * (outward - self.axis).length_squared()))
    }
}

fn towards_point(at: DVec3, from: DVec3, intensity: impl Fn(DVec3) -> f64) -> Option<Incident> {
    let offset = at - from;
    let distance = offset.length();
    if distance == 0.0 {
        return None;
    }
    let direction = offset / distance;
    let irradiance = intensity(-direction) / (distance * distance);
    (irradiance > 0.0).then_some(Incident {
        direction,
        distance,
        target: None,
        irradiance,
        pdf_solid_angle: None,
        tint: Tint::Own,
    })
}
