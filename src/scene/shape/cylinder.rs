//! The closed cylinder: faces 0 the side, 1 the top (+y), 2 the bottom.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::line::{Crossing, Line, Span, ball_roots, chord};
use super::solid::{LocalSurface, turn};

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

    pub(crate) fn next(&self, line: &Line, on: Option<u32>, after: f64) -> Option<Crossing> {
        match on {
            Some(face) => self.exit_from(line, face),
            None => {
                let side = Span::of_face(ball_roots(&across(line), self.radius)?, SIDE);
                side.intersection(self.slab(line)?)?.next(after)
            }
        }
    }

    /// Between the planes of top and bottom.
    fn slab(&self, line: &Line) -> Option<Span> {
        let (y, speed) = (line.origin.y, line.direction.y);
        if speed == 0.0 {
            return (y.abs() <= self.half_height).then(|| Span::of_face((f64::NEG_INFINITY, f64::INFINITY), TOP));
        }
        let top = Crossing { t: (self.half_height - y) / speed, face: TOP };
        let bottom = Crossing { t: (-self.half_height - y) / speed, face: BOTTOM };
        Some(if speed > 0.0 { Span { enter: bottom, exit: top } } else { Span { enter: top, exit: bottom } })
    }

    /// Convex: from a face the line leaves for good, or goes in and leaves by the nearest exit.
    fn exit_from(&self, line: &Line, start: u32) -> Option<Crossing> {
        let speed = line.direction.y;
        let side = match start {
            SIDE => chord(&across(line)),
            _ => ball_roots(&across(line), self.radius).map_or(0.0, |roots| roots.1),
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

    pub(crate) fn surface(&self, point: DVec3, face: u32) -> LocalSurface {
        let radial = DVec3::new(point.x, 0.0, point.z);
        match face {
            SIDE => {
                let normal = radial.normalize_or(DVec3::X);
                LocalSurface { point: (self.radius * normal).with_y(point.y), normal }
            }
            TOP => LocalSurface { point: radial.with_y(self.half_height), normal: DVec3::Y },
            _ => LocalSurface { point: radial.with_y(-self.half_height), normal: DVec3::NEG_Y },
        }
    }

    pub(crate) fn uv(&self, point: DVec3, face: u32) -> [f64; 2] {
        if face == SIDE {
            return [turn(point.x, point.z), 0.5 + 0.5 * point.y / self.half_height];
        }
        [0.5 + 0.5 * point.x / self.radius, 0.5 + 0.5 * point.z / self.radius]
    }

    pub(crate) fn area(&self, face: u32) -> f64 {
        if face == SIDE { TAU * self.radius * 2.0 * self.half_height } else { PI * self.radius * self.radius }
    }

    pub(crate) fn sample(&self, face: u32, u: [f64; 2]) -> DVec3 {
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let ring = DVec3::new(cos, 0.0, sin);
        match face {
            SIDE => (self.radius * ring).with_y((2.0 * u[0] - 1.0) * self.half_height),
            TOP => (self.radius * u[0].sqrt() * ring).with_y(self.half_height),
            _ => (self.radius * u[0].sqrt() * ring).with_y(-self.half_height),
        }
    }
}

/// The line seen along the axis.
fn across(line: &Line) -> Line {
    Line { origin: line.origin.with_y(0.0), direction: line.direction.with_y(0.0) }
}
