//! Spheres that bound a part of the scene, and the rays that pass through them.

use super::frame::Frame;
use super::warp;
use glam::DVec3;
use std::f64::consts::PI;

/// A sphere around a part of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingSphere {
    /// The centre.
    pub centre: DVec3,
    /// The radius in m.
    pub radius_m: f64,
}

impl BoundingSphere {
    /// Returns the smallest sphere around a box from its lowest to its highest corner.
    pub fn around_box(low: DVec3, high: DVec3) -> Self {
        Self { centre: 0.5 * (low + high), radius_m: 0.5 * low.distance(high) }
    }

    /// Returns a sphere with the same centre and a multiple of the radius.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self { radius_m: factor * self.radius_m, ..*self }
    }

    /// Returns true if another sphere lies in this sphere.
    pub fn contains(&self, other: &Self) -> bool {
        self.centre.distance(other.centre) + other.radius_m <= self.radius_m
    }

    /// Returns true if a ray of unit direction passes through the sphere, or starts in it. The
    /// sphere is wider by a relative 10⁻⁹, so that rounding excludes no ray of
    /// [`Self::sample_direction`] or [`Self::sample_offset`].
    pub fn contains_part_of(&self, origin: DVec3, direction: DVec3) -> bool {
        let radius2 = self.radius_m * self.radius_m * (1.0 + 2e-9);
        let to_centre = self.centre - origin;
        let along = to_centre.dot(direction);
        let inside = to_centre.length_squared() <= radius2;
        inside || (along > 0.0 && (to_centre - along * direction).length_squared() <= radius2)
    }

    /// Samples a direction from `origin` through the sphere, uniformly over the solid angle, and
    /// returns the unit direction and the solid angle in steradians, which is 4π from inside.
    pub fn sample_direction(&self, origin: DVec3, u: [f64; 2]) -> (DVec3, f64) {
        let (axis, distance) = (self.centre - origin).normalize_and_length();
        match self.one_minus_cos(distance) {
            None => (warp::sphere(u), 4.0 * PI),
            Some(one_minus_cos) => (Frame::new(axis).to_world(warp::cone(one_minus_cos, u)), 2.0 * PI * one_minus_cos),
        }
    }

    /// Returns 1 − cos α, where α is half the angle that the sphere subtends at this distance (m)
    /// from its centre, or `None` inside the sphere.
    fn one_minus_cos(&self, distance: f64) -> Option<f64> {
        // 1 − cos α = sin² α / (1 + cos α) is accurate even for small angles.
        let sin = self.radius_m / distance;
        (distance > self.radius_m).then(|| sin * sin / (1.0 + (1.0 - sin * sin).max(0.0).sqrt()))
    }

    /// Returns the pdf of [`Self::sample_direction`] per steradian.
    pub fn pdf_direction(&self, origin: DVec3, direction: DVec3) -> f64 {
        match self.one_minus_cos(self.centre.distance(origin)) {
            None => 0.25 / PI,
            Some(one_minus_cos) if self.contains_part_of(origin, direction) => 1.0 / (2.0 * PI * one_minus_cos),
            Some(_) => 0.0,
        }
    }

    /// Samples uniformly a point of the disk that a beam along `direction` sees of the sphere,
    /// which contains the centre and has the area π r².
    pub fn sample_offset(&self, direction: DVec3, u: [f64; 2]) -> DVec3 {
        self.centre + Frame::new(direction).to_world((warp::disk(u) * self.radius_m).extend(0.0))
    }

    /// Returns the area of the disk of [`Self::sample_offset`], in m².
    pub fn cross_section_m2(&self) -> f64 {
        PI * self.radius_m * self.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{Purpose, Seed, Stream};

    /// Every sampled ray passes through the sphere, even a small and far one, and the fraction of
    /// uniform directions through a sphere equals its solid angle.
    #[test]
    fn sampled_rays_pass_through_the_sphere() {
        let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
        for scale in [1.0, 1e-3, 1e-6] {
            let sphere = BoundingSphere { centre: DVec3::new(3e3, -2e3, 5e3), radius_m: 2e3 * scale };
            for _ in 0..1000 {
                let (direction, solid_angle) = sphere.sample_direction(DVec3::ONE, stream.pair());
                assert!(solid_angle > 0.0 && sphere.contains_part_of(DVec3::ONE, direction));
                let point = sphere.sample_offset(direction, stream.pair());
                assert!(sphere.contains_part_of(point - 1e4 * direction, direction));
                assert!(!sphere.contains_part_of(point + 1e4 * direction, direction));
            }
        }
        let sphere = BoundingSphere { centre: DVec3::Z, radius_m: 0.8 };
        let n = 100_000;
        let inside = (0..n).filter(|_| sphere.contains_part_of(DVec3::ZERO, warp::sphere(stream.pair()))).count();
        let (_, solid_angle) = sphere.sample_direction(DVec3::ZERO, [0.3, 0.4]);
        assert!((inside as f64 / f64::from(n) - solid_angle / (4.0 * PI)).abs() < 5e-3);
        assert_eq!(sphere.sample_direction(DVec3::Z, [0.3, 0.4]).1, 4.0 * PI);
    }
}
