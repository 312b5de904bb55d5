//! An object's surface as a light: the same radiance everywhere, in all directions of its outer side.

use super::{Emission, EmissionNumbers, Incident, Tint};
use crate::math::frame::Frame;
use crate::math::warp;
use crate::scene::geometry::Geometry;
use glam::DVec3;
use std::f64::consts::PI;

/// The emission of an object.
#[derive(Debug, Clone, PartialEq)]
pub struct Area {
    /// The object.
    pub object: u32,
    /// Radiance in W/m²/sr over the band.
    pub radiance: f64,
    /// The object's area in m².
    pub area_m2: f64,
}

impl Area {
    pub(super) fn power_w(&self) -> f64 {
        PI * self.area_m2 * self.radiance
    }

    pub(super) fn emit(&self, geometry: &Geometry, u: EmissionNumbers) -> Emission {
        let place = geometry.sample_area(self.object, u.rest);
        let direction = Frame::new(place.normal).to_world(warp::cosine_hemisphere(u.aim));
        // L cos θ over the densities cos θ/π and pdf_area.
        let flux_w = self.radiance * PI / place.pdf_area;
        Emission { origin: place.position, direction, from: Some(place.surface), flux_w, tint: Tint::Own }
    }

    pub(super) fn towards(&self, geometry: &Geometry, from: DVec3, u: [f64; 3]) -> Option<Incident> {
        let (place, pdf) = geometry.sample_towards(self.object, from, u)?;
        let offset = place.position - from;
        let distance = offset.length();
        let direction = offset / distance;
        let lit = pdf > 0.0 && distance > 0.0 && direction.dot(place.normal) < 0.0;
        lit.then_some(Incident {
            direction,
            distance,
            target: Some(place.surface),
            irradiance: self.radiance / pdf,
            pdf_solid_angle: Some(pdf),
            tint: Tint::Own,
        })
    }

    pub(super) fn radiance(&self, direction: DVec3, normal: DVec3) -> f64 {
        if direction.dot(normal) < 0.0 { self.radiance } else { 0.0 }
    }
}
