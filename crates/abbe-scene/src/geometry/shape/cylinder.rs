//! The closed cylinder. Faces: 0 side, 1 top (+y), 2 bottom.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::local::{Crossing, LocalLine, LocalSurfacePoint, Span, azimuth_fraction, ball_roots, chord_t};
use abbe_spectra::math::elementary::sin_cos;

const SIDE: u32 = 0;
const TOP: u32 = 1;
const BOTTOM: u32 = 2;

/// A cylinder about the y axis, between −half_height and half_height.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cylinder {
    pub(crate) radius: f64,
    pub(crate) half_height: f64,
}

impl Cylinder {
    pub(crate) const FACES: u32 = 3;
    pub(crate) const ROUND_FACE: u32 = SIDE;

    pub(crate) fn next_crossing(&self, line: &LocalLine, start_face: Option<u32>, after: f64) -> Option<Crossing> {
        match start_face {
            Some(face) => self.exit_from(line, face),
            None => {
                let side = Span::of_face(ball_roots(&project_xz(line), self.radius)?, SIDE);
                side.intersection(self.slab(line)?)?.next_crossing(after)
            }
        }
    }

    /// Returns the part of the line between the planes of the top and the bottom face.
    fn slab(&self, line: &LocalLine) -> Option<Span> {
        let (y, speed) = (line.origin.y, line.direction.y);
        if speed == 0.0 {
            return (y.abs() <= self.half_height).then(|| Span::of_face((f64::NEG_INFINITY, f64::INFINITY), TOP));
        }
        let top = Crossing { t: (self.half_height - y) / speed, face: TOP };
        let bottom = Crossing { t: (-self.half_height - y) / speed, face: BOTTOM };
        Some(if speed > 0.0 { Span { enter: bottom, exit: top } } else { Span { enter: top, exit: bottom } })
    }

    /// Returns the exit of a line that starts on a face, or `None` if the line points out of the
    /// body, which is convex, so that the line never re-enters it.
    fn exit_from(&self, line: &LocalLine, start: u32) -> Option<Crossing> {
        let speed = line.direction.y;
        let side = match start {
            SIDE => chord_t(&project_xz(line)),
            _ => ball_roots(&project_xz(line), self.radius).map_or(0.0, |roots| roots.1),
        };
        let inward = match start {
            SIDE => side > 0.0,
            TOP => speed < 0.0,
            _ => speed > 0.0,
        };
        if !inward {
            return None;
        }
        let cap = if speed > 0.0 { TOP } else { BOTTOM };
        let cap_t =
            if speed == 0.0 { f64::INFINITY } else { (self.half_height.copysign(speed) - line.origin.y) / speed };
        let exit = if cap_t < side { Crossing { t: cap_t, face: cap } } else { Crossing { t: side, face: SIDE } };
        Some(Crossing { t: exit.t.max(0.0), ..exit }).filter(|exit| exit.t < f64::INFINITY)
    }

    pub(crate) fn surface(&self, point: DVec3, face: u32) -> LocalSurfacePoint {
        let radial = DVec3::new(point.x, 0.0, point.z);
        match face {
            SIDE => {
                let normal = radial.normalize_or(DVec3::X);
                LocalSurfacePoint { point: (self.radius * normal).with_y(point.y), normal }
            }
            TOP => LocalSurfacePoint { point: radial.with_y(self.half_height), normal: DVec3::Y },
            _ => LocalSurfacePoint { point: radial.with_y(-self.half_height), normal: DVec3::NEG_Y },
        }
    }

    pub(crate) fn uv(&self, point: DVec3, face: u32) -> [f64; 2] {
        match face {
            SIDE => [azimuth_fraction(point.x, -point.z), 0.5 - 0.5 * point.y / self.half_height],
            TOP => [0.5 + 0.5 * point.x / self.radius, 0.5 + 0.5 * point.z / self.radius],
            _ => [0.5 + 0.5 * point.x / self.radius, 0.5 - 0.5 * point.z / self.radius],
        }
    }

    pub(crate) fn area(&self, face: u32) -> f64 {
        if face == SIDE { TAU * self.radius * 2.0 * self.half_height } else { PI * self.radius * self.radius }
    }

    pub(crate) fn sample(&self, face: u32, u: [f64; 2]) -> DVec3 {
        let (sin, cos) = sin_cos(TAU * u[1]);
        let ring = DVec3::new(cos, 0.0, sin);
        match face {
            SIDE => (self.radius * ring).with_y((2.0 * u[0] - 1.0) * self.half_height),
            TOP => (self.radius * u[0].sqrt() * ring).with_y(self.half_height),
            _ => (self.radius * u[0].sqrt() * ring).with_y(-self.half_height),
        }
    }
}

/// Projects the line onto the xz plane.
fn project_xz(line: &LocalLine) -> LocalLine {
    LocalLine { origin: line.origin.with_y(0.0), direction: line.direction.with_y(0.0) }
}
