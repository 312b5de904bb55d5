//! A luminaire with a measured distribution of intensity I, the same at all points: a point, or a
//! flat invisible opening of area A, whose radiance at the angle θ to its normal is I/(A cos θ).

use super::intensity_bounds::IntensityBounds;
use super::intensity_table::IntensityTable;
use super::lit_interval::{LitInterval, inside_cone};
use super::point::sample_li_from_point;
use super::sample::{EmittedSpd, LeRandoms, LeSample, LiSample};
use super::virtual_light::VirtualLight;
#[cfg(test)]
use super::{Emitter, contract_tests::TestLight, intensity_table::PhotometricType};
use crate::geometry::Ray;
use abbe_spectra::math::elementary::acos;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OpeningShape {
    Point,
    Rectangle,
    Ellipse,
}

/// The luminous opening of a luminaire: a flat figure around the position of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuminousOpening {
    pub shape: OpeningShape,
    /// From the centre to the middle of two adjacent sides, or half the axes of the ellipse, in m.
    pub half_sides: [DVec3; 2],
}

impl LuminousOpening {
    /// An opening without extent.
    pub const POINT: Self = Self { shape: OpeningShape::Point, half_sides: [DVec3::ZERO; 2] };

    /// Samples the offset of a point from the centre in m, uniformly.
    fn sample(&self, u: [f64; 2]) -> DVec3 {
        let [along, across] = self.half_sides;
        match self.shape {
            OpeningShape::Point => DVec3::ZERO,
            OpeningShape::Rectangle => (2.0 * u[0] - 1.0) * along + (2.0 * u[1] - 1.0) * across,
            OpeningShape::Ellipse => {
                let place = warp::disk(u);
                place.x * along + place.y * across
            }
        }
    }

    /// The normal of the opening times its area, in m².
    fn area_vector(&self) -> DVec3 {
        let of_box = self.half_sides[0].cross(self.half_sides[1]);
        match self.shape {
            OpeningShape::Point => DVec3::ZERO,
            OpeningShape::Rectangle => 4.0 * of_box,
            OpeningShape::Ellipse => PI * of_box,
        }
    }

    /// Half the size in m of a box around the opening.
    fn half_size(&self) -> DVec3 {
        self.half_sides[0].abs() + self.half_sides[1].abs()
    }
}

/// A luminaire with a measured distribution of intensity.
#[derive(Debug, Clone)]
pub struct GoniometricLight {
    /// In m, relative to the scene's centre.
    position: DVec3,
    /// The axes of the luminaire as columns: C0, C90, and the photometric axis.
    axes: DMat3,
    /// The intensity in W/sr over the band for a value of 1 in the table.
    scale: f64,
    table: Arc<IntensityTable>,
    opening: LuminousOpening,
}

impl GoniometricLight {
    /// Creates a luminaire at `position` (m, relative to the scene's centre). `toward`, the
    /// photometric axis, and `c0`, the direction of the half-plane C0, are perpendicular unit
    /// vectors. Seen against the photometric axis, which is from below for a ceiling luminaire, the
    /// C angles increase clockwise. `scale` is the intensity in W/sr over the band for a value of 1
    /// in the table.
    pub fn new(position: DVec3, [toward, c0]: [DVec3; 2], scale: f64, table: Arc<IntensityTable>) -> Self {
        let axes = DMat3::from_cols(c0, c0.cross(toward), toward);
        Self { position, axes, scale, table, opening: LuminousOpening::POINT }
    }

    #[must_use]
    pub fn with_opening(self, opening: LuminousOpening) -> Self {
        Self { opening, ..self }
    }

    /// Returns the direction of the half-plane C0 if the scene gives none: the x axis, turned by
    /// the smallest rotation from −y to the unit vector `toward`.
    pub fn default_c0(toward: DVec3) -> DVec3 {
        let rest = 1.0 - toward.y;
        if rest < 1e-12 { DVec3::X } else { (DVec3::X - toward.x / rest * (toward - DVec3::Y)).normalize() }
    }

    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        let toward = map.transform_vector3(self.axes.z_axis).normalize();
        let c0 = map.transform_vector3(self.axes.x_axis);
        let c0 = (c0 - c0.dot(toward) * toward).normalize();
        // A mirrored luminaire keeps the image of the direction C90.
        let c90 = toward.cross(c0);
        let c90 = if c90.dot(map.transform_vector3(self.axes.y_axis)) < 0.0 { -c90 } else { c90 };
        let half_sides = self.opening.half_sides.map(|side| map.transform_vector3(side));
        Self {
            position: map.transform_point3(self.position),
            axes: DMat3::from_cols(c0, c90, toward),
            scale: self.scale,
            table: Arc::clone(&self.table),
            opening: LuminousOpening { half_sides, ..self.opening },
        }
    }

    /// In m, relative to the scene's centre.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    pub(super) fn is_point(&self) -> bool {
        self.opening.shape == OpeningShape::Point
    }

    /// The solid angle of the opening if all its points were at the sampled point.
    pub(super) fn apparent_solid_angle(&self, sample: &LiSample) -> f64 {
        self.opening.area_vector().dot(sample.direction).abs() / sample.distance.powi(2)
    }

    /// The lowest and the highest corner of a box around the opening.
    pub(super) fn corners(&self) -> (DVec3, DVec3) {
        let half = self.opening.half_size();
        (self.position - half, self.position + half)
    }

    pub(super) fn power_w(&self) -> f64 {
        self.scale * self.table.flux()
    }

    /// The intensity along a unit vector, in W/sr over the band.
    fn intensity_along(&self, outward: DVec3) -> f64 {
        self.scale * self.table.at(self.axes.transpose() * outward)
    }

    /// The axis of the cone around all light, and 1 − cos of its half-angle. The axis is the
    /// photometric axis or its opposite, whichever gives the narrower cone.
    fn cone(&self) -> (DVec3, f64) {
        let [least, most] = self.table.cosines();
        let toward = self.axes.z_axis;
        if least >= -most { (toward, 1.0 - least) } else { (-toward, 1.0 + most) }
    }

    pub(super) fn intensity_bounds(&self) -> IntensityBounds {
        let (low, high) = self.corners();
        let (axis, one_minus_cos) = self.cone();
        let intensity = self.scale * self.table.largest();
        IntensityBounds { low, high, intensity, axis, normals_rad: acos(1.0 - one_minus_cos), emission_rad: 0.0 }
    }

    pub(super) fn lit_interval(&self, ray: &Ray, interval: (f64, f64), u: [f64; 3]) -> Option<LitInterval> {
        let pivot = Some(self.position + self.opening.sample([u[0], u[1]]));
        let (axis, one_minus_cos) = self.cone();
        let (from, to) =
            if self.is_point() { inside_cone(ray, interval, self.position, axis, one_minus_cos)? } else { interval };
        Some(LitInterval { from, to, pivot })
    }

    pub(super) fn virtual_light(&self, u: [f64; 3]) -> Option<VirtualLight> {
        self.is_point().then(|| VirtualLight::at_point(self.position, u))
    }

    pub(super) fn sample_le(&self, u: LeRandoms) -> LeSample {
        LeSample {
            origin: self.position + self.opening.sample([u.rest[0], u.rest[1]]),
            direction: (self.axes * self.table.sample(u.aim)).normalize(),
            from: None,
            flux_w: self.power_w(),
            spd: EmittedSpd::Own,
        }
    }

    pub(super) fn sample_le_through(&self, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let origin = self.position + self.opening.sample([u.rest[0], u.rest[1]]);
        let (direction, solid_angle) = sphere.sample_direction(origin, u.aim);
        let flux_w = self.intensity_along(direction) * solid_angle;
        LeSample { origin, direction, from: None, flux_w, spd: EmittedSpd::Own }
    }

    pub(super) fn sample_li(&self, from: DVec3, u: [f64; 3]) -> Option<LiSample> {
        let position = self.position + self.opening.sample([u[0], u[1]]);
        sample_li_from_point(position, from, |outward| self.intensity_along(outward))
    }
}

/// The contract tests use these lights.
#[cfg(test)]
pub(super) fn test_lights(at: DVec3, axis: DVec3) -> Vec<TestLight> {
    let c0 = axis.any_orthonormal_vector();
    let luminaire = |kind, polar: &[f64], azimuth: &[f64], values: &[f64]| {
        let [polar, azimuth] = [polar, azimuth].map(|angles| angles.iter().map(|a| a.to_radians()).collect::<Vec<_>>());
        let table = IntensityTable::new(kind, &polar, &azimuth, values).unwrap();
        GoniometricLight::new(at, [axis, c0], 0.5, Arc::new(table))
    };
    let light = |name, light: GoniometricLight, cone_rad, disk_m, irradiance_at_2_m| TestLight {
        name,
        emitter: Emitter::Goniometric(light),
        cone_rad,
        disk_m,
        irradiance_at_2_m,
    };
    let c90 = c0.cross(axis);
    let even = || luminaire(PhotometricType::C, &[0.0, 180.0], &[0.0, 360.0], &[6.0; 4]);
    let disk = LuminousOpening { shape: OpeningShape::Ellipse, half_sides: [0.3 * c0, 0.3 * c90] };
    let rectangle = LuminousOpening { shape: OpeningShape::Rectangle, half_sides: [0.3 * c0, 0.02 * c90] };
    let downlight = || {
        // The intensity falls from 5 W/sr on the axis to 0 at 60°, and differs between the planes.
        let planes = [[10.0, 8.0, 0.0], [10.0, 2.0, 0.0], [10.0, 5.0, 0.0], [10.0, 1.0, 0.0], [10.0, 8.0, 0.0]];
        luminaire(PhotometricType::C, &[0.0, 30.0, 60.0], &[0.0, 90.0, 200.0, 300.0, 360.0], planes.as_flattened())
    };
    // The intensity falls from 1.5 W/sr on the axis to 0.5 W/sr at the edges of the table.
    let beam = [[1.0; 3], [1.0, 3.0, 1.0], [1.0; 3]];
    vec![
        light("goniometric, even", even(), PI, 0.0, Some(0.75)),
        light("goniometric, uneven", downlight(), PI / 3.0, 0.0, Some(1.25)),
        light(
            "goniometric, type B",
            luminaire(PhotometricType::B, &[50.0, 90.0, 130.0], &[-30.0, 0.0, 40.0], beam.as_flattened()),
            0.943_67,
            0.0,
            Some(0.375),
        ),
        light(
            "goniometric, type A",
            luminaire(PhotometricType::A, &[50.0, 90.0, 130.0], &[-30.0, 0.0, 40.0], beam.as_flattened()),
            0.943_67,
            0.0,
            Some(0.375),
        ),
        // The axial irradiance of a disk of points is 2 I/R² · (1 − h/√(h² + R²)).
        light(
            "goniometric, disk",
            even().with_opening(disk),
            PI,
            0.3,
            Some(2.0 * 3.0 / 0.09 * (1.0 - 2.0 / (4.0_f64 + 0.09).sqrt())),
        ),
        light(
            "goniometric, rectangle",
            downlight().with_opening(rectangle),
            PI / 3.0,
            (0.09_f64 + 0.0004).sqrt(),
            None,
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The axes are x to the right and y up, so the C angles of a ceiling luminaire increase from
    /// +x to −z: counter-clockwise as seen from above.
    #[test]
    fn c0_is_x_for_light_from_above_and_from_below() {
        assert_eq!(GoniometricLight::default_c0(-DVec3::Y), DVec3::X);
        assert_eq!(GoniometricLight::default_c0(DVec3::Y), DVec3::X);
        for toward in [DVec3::Z, DVec3::new(0.6, -0.8, 0.0), DVec3::new(-0.3, 0.9, 0.2).normalize()] {
            let c0 = GoniometricLight::default_c0(toward);
            assert!(c0.dot(toward).abs() < 1e-12 && (c0.length() - 1.0).abs() < 1e-12, "{toward}: {c0}");
        }
        assert!(
            (GoniometricLight::default_c0(DVec3::new(0.6, -0.8, 0.0)) - DVec3::new(0.8, 0.6, 0.0)).length() < 1e-12
        );
        let table = IntensityTable::new(PhotometricType::C, &[0.0, 1.0], &[0.0, PI], &[1.0; 4]).unwrap();
        let light = GoniometricLight::new(DVec3::ZERO, [-DVec3::Y, DVec3::X], 1.0, Arc::new(table));
        assert_eq!(light.axes.y_axis, -DVec3::Z);
    }

    #[test]
    fn a_mirrored_luminaire_shines_on_mirrored_points() {
        let at = DVec3::new(0.3, 2.0, -0.4);
        let map = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        for test in test_lights(at, DVec3::new(0.2, -1.0, 0.3).normalize()) {
            let (Emitter::Goniometric(light), Emitter::Goniometric(moved)) = (&test.emitter, test.emitter.moved(&map))
            else {
                panic!("{} is no luminaire", test.name);
            };
            for i in 0..50 {
                let from = DVec3::new(0.05 * f64::from(i) - 1.0, 0.01 * f64::from(i), 0.4);
                let irradiance = |light: &GoniometricLight, from| {
                    light.sample_li(from, [0.5, 0.5, 0.0]).map_or(0.0, |sample| sample.irradiance)
                };
                let (before, after) = (irradiance(light, from), irradiance(&moved, map.transform_point3(from)));
                assert!((before - after).abs() < 1e-12, "{}: {before} {after}", test.name);
            }
        }
    }
}
