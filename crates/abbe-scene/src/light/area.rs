//! An area light: the surface of an object that emits the same radiance in all directions on its
//! outer side. A slide may filter the light, so that spectrum and radiance vary over the surface.

use super::lit_interval::LitInterval;
use super::sample::{EmittedSpd, LeRandoms, LeSample, LiSample, RepresentativePoint};
use super::virtual_light::VirtualLight;
use crate::geometry::{Geometry, SurfaceId};
use abbe_optics::texture::{LookupRandom, SurfaceSpectrum, Texel, TexturePoint};
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::random::hash64;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use glam::DVec3;
use std::f64::consts::PI;

#[derive(Debug, Clone, PartialEq)]
pub struct AreaLight {
    pub object: u32,
    /// In W/m²/sr over the band, without the slide.
    pub radiance: f64,
    pub area_m2: f64,
    /// The transmittance in front of the surface.
    pub slide: Option<SurfaceSpectrum>,
}

impl AreaLight {
    pub(super) fn spd(&self, geometry: &Geometry, surface: SurfaceId, position: DVec3) -> EmittedSpd {
        self.slide.as_ref().map_or(EmittedSpd::Own, |slide| {
            // All rays of a point see the same texel, and those of others an independent one.
            let bits = position.to_array().map(f64::to_bits);
            let mut random = LookupRandom::new(f64::from_bits(hash64(bits)));
            EmittedSpd::Filtered(slide.texel(&TexturePoint::new(geometry.uv_at(surface, position)), &mut random))
        })
    }

    pub(super) fn transmittance(&self, texel: Texel, nm: f64) -> f64 {
        self.slide.as_ref().map_or(1.0, |slide| slide.at(texel, nm))
    }

    pub(super) fn power_w(&self) -> f64 {
        PI * self.area_m2 * self.radiance
    }

    pub(super) fn sample_le(&self, geometry: &Geometry, u: LeRandoms) -> LeSample {
        let point = geometry.sample_area(self.object, u.rest);
        let direction = Frame::new(point.normal).to_world(warp::cosine_hemisphere(u.aim));
        // The flux is L cos θ divided by the two densities cos θ/π and pdf_area.
        let flux_w = self.radiance * PI / point.pdf_area;
        let spd = self.spd(geometry, point.surface, point.position);
        LeSample { origin: point.position, direction, from: Some(point.surface), flux_w, spd }
    }

    pub(super) fn sample_le_through(&self, geometry: &Geometry, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let point = geometry.sample_area(self.object, u.rest);
        let (direction, solid_angle) = sphere.sample_direction(point.position, u.aim);
        let cosine = direction.dot(point.normal).max(0.0);
        let flux_w = self.radiance * cosine * solid_angle / point.pdf_area;
        let spd = self.spd(geometry, point.surface, point.position);
        LeSample { origin: point.position, direction, from: Some(point.surface), flux_w, spd }
    }

    pub(super) fn sample_li(&self, geometry: &Geometry, from: DVec3, u: [f64; 3]) -> Option<LiSample> {
        let (point, pdf) = geometry.sample_solid_angle(self.object, from, u)?;
        let offset = point.position - from;
        let distance = offset.length();
        let direction = offset / distance;
        let lit = pdf > 0.0 && distance > 0.0 && direction.dot(point.normal) < 0.0;
        lit.then_some(LiSample {
            direction,
            distance,
            target: Some(point.surface),
            irradiance: self.radiance / pdf,
            pdf_solid_angle: Some(pdf),
            spd: self.spd(geometry, point.surface, point.position),
        })
    }

    /// The radiance that a ray along `direction` sees at a point of the surface with this normal.
    pub(super) fn le(&self, direction: DVec3, normal: DVec3) -> f64 {
        if direction.dot(normal) < 0.0 { self.radiance } else { 0.0 }
    }

    pub(super) fn lit_interval(&self, geometry: &Geometry, (from, to): (f64, f64), u: [f64; 3]) -> LitInterval {
        LitInterval { from, to, pivot: Some(geometry.sample_area(self.object, u).position) }
    }

    pub(super) fn virtual_light(&self, geometry: &Geometry, u: [f64; 3]) -> VirtualLight {
        VirtualLight::on_surface(&geometry.sample_area(self.object, u), self.radiance, u)
    }

    pub(super) fn representative_point(&self, geometry: &Geometry) -> RepresentativePoint {
        /// Any random numbers do, because all points of the surface are inside the same bodies.
        const U: [f64; 3] = [0.37, 0.61, 0.53];
        let point = geometry.sample_area(self.object, U);
        RepresentativePoint { position: point.position, surface: Some((point.surface, point.normal)) }
    }
}
