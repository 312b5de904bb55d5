//! Flat shapes: rectangle and disk in the xz plane, facing +y. They have one face, number 0.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::local::{Crossing, LocalLine, LocalSurfacePoint};
use abbe_spectra::math::elementary::sin_cos;

#[derive(Debug, Clone, Copy)]
pub(crate) enum FlatShape {
    /// |x| ≤ half_width, |z| ≤ half_height.
    Rectangle { half_width: f64, half_height: f64 },
    /// x² + z² ≤ radius².
    Disk { radius: f64 },
}

impl FlatShape {
    /// Returns where the line crosses the shape, which a line that starts on it never does.
    pub(crate) fn next_crossing(&self, line: &LocalLine, start_face: Option<u32>, after: f64) -> Option<Crossing> {
        if start_face.is_some() || line.direction.y == 0.0 {
            return None;
        }
        let t = -line.origin.y / line.direction.y;
        let point = line.at(t);
        (t > after && t < f64::INFINITY && self.contains(point)).then_some(Crossing { t, face: 0 })
    }

    fn contains(&self, point: DVec3) -> bool {
        match *self {
            Self::Rectangle { half_width, half_height } => point.x.abs() <= half_width && point.z.abs() <= half_height,
            Self::Disk { radius } => point.x * point.x + point.z * point.z <= radius * radius,
        }
    }

    pub(crate) fn surface(&self, point: DVec3) -> LocalSurfacePoint {
        LocalSurfacePoint { point: DVec3::new(point.x, 0.0, point.z), normal: DVec3::Y }
    }

    pub(crate) fn uv(&self, point: DVec3) -> [f64; 2] {
        match *self {
            Self::Rectangle { half_width, half_height } => {
                [0.5 + 0.5 * point.x / half_width, 0.5 + 0.5 * point.z / half_height]
            }
            Self::Disk { radius } => [0.5 + 0.5 * point.x / radius, 0.5 + 0.5 * point.z / radius],
        }
    }

    pub(crate) fn area(&self) -> f64 {
        match *self {
            Self::Rectangle { half_width, half_height } => 4.0 * half_width * half_height,
            Self::Disk { radius } => PI * radius * radius,
        }
    }

    pub(crate) fn sample(&self, u: [f64; 2]) -> DVec3 {
        match *self {
            Self::Rectangle { half_width, half_height } => {
                DVec3::new((2.0 * u[0] - 1.0) * half_width, 0.0, (2.0 * u[1] - 1.0) * half_height)
            }
            Self::Disk { radius } => {
                let (sin, cos) = sin_cos(TAU * u[1]);
                radius * u[0].sqrt() * DVec3::new(cos, 0.0, sin)
            }
        }
    }
}
