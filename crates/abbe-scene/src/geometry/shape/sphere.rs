//! The sphere, which has one face, number 0.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::local::{Crossing, LocalLine, LocalSurfacePoint, azimuth_fraction, ball_roots, chord_t};
use abbe_spectra::math::elementary::{acos, sin_cos};

#[derive(Debug, Clone, Copy)]
pub(crate) struct Sphere {
    pub(crate) radius: f64,
}

impl Sphere {
    pub(crate) fn next_crossing(&self, line: &LocalLine, start_face: Option<u32>, after: f64) -> Option<Crossing> {
        let t = match start_face {
            Some(_) => Some(chord_t(line)).filter(|&t| t > after.max(0.0)),
            None => {
                let (enter, exit) = ball_roots(line, self.radius)?;
                if enter > after { Some(enter) } else { Some(exit).filter(|&t| t > after) }
            }
        };
        t.map(|t| Crossing { t, face: 0 })
    }

    pub(crate) fn surface(&self, point: DVec3) -> LocalSurfacePoint {
        let normal = point.normalize_or(DVec3::Y);
        LocalSurfacePoint { point: self.radius * normal, normal }
    }

    pub(crate) fn uv(&self, point: DVec3) -> [f64; 2] {
        let normal = point.normalize_or(DVec3::Y);
        [azimuth_fraction(normal.x, -normal.z), acos(normal.y.clamp(-1.0, 1.0)) / PI]
    }

    pub(crate) fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    pub(crate) fn sample(&self, u: [f64; 2]) -> DVec3 {
        self.radius * on_unit_sphere(1.0 - 2.0 * u[0], u[1])
    }
}

/// Returns the unit vector at height `y` and azimuth `turn` (0 to 1) about the y axis.
fn on_unit_sphere(y: f64, turn: f64) -> DVec3 {
    let ring = ((1.0 - y) * (1.0 + y)).max(0.0).sqrt();
    let (sin, cos) = sin_cos(TAU * turn);
    DVec3::new(ring * cos, y, ring * sin)
}
