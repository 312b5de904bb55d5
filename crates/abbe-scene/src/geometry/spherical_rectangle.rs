//! Uniform sampling of the solid angle that a rectangle subtends (Ureña, Fajardo & King, "An
//! area-preserving parametrization for spherical rectangles", EGSR 2013).

use std::f64::consts::TAU;

use glam::DVec3;

use super::object::WorldRectangle;
use abbe_spectra::math::elementary::{acos, hypot, sin_cos};

/// Smallest solid angle in sr for this method. Below it, the solid angle, which is a difference of
/// angles, has fewer than ten correct digits, and the caller samples by area.
const SMALLEST_SOLID_ANGLE: f64 = 1e-6;

/// Largest distance from the rectangle's plane, relative to the coordinates, that counts as a
/// rounding error. Without this limit, a point of the rectangle would see it in half of all
/// directions.
const IN_PLANE: f64 = 1e-12;

/// A rectangle seen from a point, which is the origin. The axes x and y are parallel to the
/// rectangle's sides, and its plane is z = z0 < 0.
pub(super) struct SphericalRectangle {
    from: DVec3,
    axes: [DVec3; 3],
    x: [f64; 2],
    y: [f64; 2],
    z0: f64,
    /// z of the unit normals of the planes through the point and the sides at y0 and y1.
    side_normals_z: [f64; 2],
    /// 2π minus the inner angles of the spherical rectangle at both ends of the side x = x0. The
    /// sampled angle starts at this value and increases with x.
    first_angle: f64,
    solid_angle: f64,
}

impl WorldRectangle {
    /// Returns the rectangle seen from a point, or `None` if the solid angle is too small for the
    /// method, or if the point lies in the rectangle's plane.
    pub(super) fn seen_from(&self, from: DVec3) -> Option<SphericalRectangle> {
        let offset = self.corner - from;
        let mut normal = self.x.cross(self.y);
        let mut z0 = offset.dot(normal);
        if z0 > 0.0 {
            (z0, normal) = (-z0, -normal);
        }
        let (x0, y0) = (offset.dot(self.x), offset.dot(self.y));
        let (x, y) = ([x0, x0 + self.width], [y0, y0 + self.height]);
        // The unit normals of the four side planes lie in the yz plane or the zx plane.
        let along_x = |y: f64| DVec3::new(0.0, z0, -y).normalize_or_zero();
        let along_y = |x: f64| DVec3::new(-z0, 0.0, x).normalize_or_zero();
        let normals = [along_x(y[0]), along_y(x[1]), -along_x(y[1]), -along_y(x[0])];
        let angle = |i: usize| acos((-normals[i].dot(normals[(i + 1) % 4])).clamp(-1.0, 1.0));
        let first_angle = TAU - angle(2) - angle(3);
        let solid_angle = angle(0) + angle(1) - first_angle;
        let largest = self.corner.abs().max_element() + self.width + self.height;
        let outside = z0 < -IN_PLANE * largest.max(from.abs().max_element());
        (outside && solid_angle > SMALLEST_SOLID_ANGLE).then_some(SphericalRectangle {
            from,
            axes: [self.x, self.y, normal],
            x,
            y,
            z0,
            side_normals_z: [normals[0].z, normals[2].z],
            first_angle,
            solid_angle,
        })
    }
}

impl SphericalRectangle {
    /// The uniform density per solid angle.
    pub(super) fn pdf(&self) -> f64 {
        1.0 / self.solid_angle
    }

    /// Samples a point of the rectangle in world coordinates.
    pub(super) fn sample(&self, u: f64, v: f64) -> DVec3 {
        let [b0, b1] = self.side_normals_z;
        let (sin, cos) = sin_cos(u * self.solid_angle + self.first_angle);
        let f = (cos * b0 - b1) / sin;
        let cos_u = (1.0_f64.copysign(f) / hypot(f, b0)).clamp(-1.0, 1.0);
        let sin_u = ((1.0 - cos_u) * (1.0 + cos_u)).sqrt();
        let x = (-cos_u * self.z0 / sin_u).clamp(self.x[0], self.x[1]);
        let distance = hypot(x, self.z0);
        let [h0, h1] = self.y.map(|y| y / hypot(distance, y));
        let h = h0 + v * (h1 - h0);
        let y = (h * distance / ((1.0 - h) * (1.0 + h)).sqrt()).clamp(self.y[0], self.y[1]);
        self.from + x * self.axes[0] + y * self.axes[1] + self.z0 * self.axes[2]
    }
}
