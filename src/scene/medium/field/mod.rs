//! Fields: a quantity (density, temperature) as a function of place, 0 outside a box.
//!
//! Along a straight line every field falls into pieces on which a quadrature rule is exact, or as good as exact (relative error
//! below 10⁻¹²): cells of a grid, shells of an atmosphere. From the pieces come the integral along the line and, by Newton's
//! method within the piece that holds it, the place where the integral reaches a given value.

mod atmosphere;
mod ball;
mod grid;
mod noise;
#[cfg(test)]
mod tests;

pub use atmosphere::{Atmosphere, Ground, Planet};
pub use ball::Ball;
pub use grid::Grid;
pub use noise::Noise;

use crate::scene::geometry::Ray;
use glam::{DAffine3, DVec3};
use std::ops::ControlFlow;

/// A field, placed in the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    shape: Shape,
    /// From the scene's coordinates to the field's own, in which its box stands along the axes.
    to_local: DAffine3,
    /// The box's lowest and highest corner.
    bounds: (DVec3, DVec3),
}

/// How a field varies within its box.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Not at all.
    Constant(f64),
    /// Between values at the centres of cells.
    Grid(Grid),
    /// Exponentially with height.
    Atmosphere(Atmosphere),
    /// As a ball that fades towards its surface.
    Ball(Ball),
}

/// A straight line in a field's own coordinates. The parameter is the ray's distance in m, so that the direction is no unit vector
/// where the field is scaled.
#[derive(Debug, Clone, Copy)]
struct Line {
    origin: DVec3,
    direction: DVec3,
}

impl Line {
    fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// Where the line comes nearest to a point.
    fn nearest_to(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.direction) / self.direction.length_squared()
    }

    /// Where the line crosses a sphere of this radius, given where it comes nearest to the centre.
    fn crossings(&self, centre: DVec3, radius: f64, nearest: f64) -> Option<(f64, f64)> {
        let closest = (self.at(nearest) - centre).length();
        (closest < radius).then(|| {
            let half = ((radius - closest) * (radius + closest)).sqrt() / self.direction.length();
            (nearest - half, nearest + half)
        })
    }
}

/// Steps of Newton's method after which a place is as exact as it gets; bisection alone would need as many.
const MAX_NEWTON_STEPS: u32 = 100;

impl Field {
    /// A field of this shape within a box, whose corners' coordinates rise; `to_local` leads from the scene (m, relative to its
    /// centre) to the box's coordinates.
    pub fn new(shape: Shape, bounds: (DVec3, DVec3), to_local: DAffine3) -> Self {
        Self { shape, to_local, bounds }
    }

    /// Whether a grid of so many cells along the longest side of the field's box is fine enough to interpolate what light goes through in it: not
    /// air that thins out within less than a cell, as that of a planet does, all of which lies beside a few of the nodes.
    pub fn is_smooth_in_cells(&self, cells: u32) -> bool {
        let longest = (self.bounds.1 - self.bounds.0).max_element();
        match &self.shape {
            Shape::Atmosphere(air) => air.scale_height >= longest / f64::from(cells),
            Shape::Constant(_) | Shape::Grid(_) | Shape::Ball(_) => true,
        }
    }

    /// The map from the unit cube onto the box, as it stands in the scene.
    pub fn from_unit(&self) -> DAffine3 {
        let (low, high) = self.bounds;
        self.to_local.inverse() * DAffine3::from_translation(low) * DAffine3::from_scale(high - low)
    }

    /// The field after a map of the scene's places.
    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        Self { to_local: self.to_local * map.inverse(), ..self.clone() }
    }

    /// The box's corners in the scene.
    pub fn corners(&self) -> [DVec3; 8] {
        let from_unit = self.from_unit();
        let corner = |i: usize| DVec3::from_array(std::array::from_fn(|axis| (i >> axis & 1) as f64));
        std::array::from_fn(|i| from_unit.transform_point3(corner(i)))
    }

    /// The least of the integrals along the three lines through the box's middle that join opposite faces' middles, in m.
    pub fn least_column_m(&self) -> f64 {
        let corners = self.corners();
        let middle = 0.5 * (corners[0] + corners[7]);
        let across = [1, 2, 4].map(|corner| {
            let side = corners[corner] - corners[0];
            let ray = Ray::new(middle - 0.5 * side, side.normalize_or_zero());
            self.column_m(&ray, side.length())
        });
        across.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// The distance of the box's farthest corner from the scene's centre, in m.
    pub fn reach_m(&self) -> f64 {
        self.corners().map(DVec3::length).into_iter().fold(0.0, f64::max)
    }

    /// The value at a point of the scene.
    pub fn at(&self, point: DVec3) -> f64 {
        let local = self.to_local.transform_point3(point);
        let inside = local.cmpge(self.bounds.0).all() && local.cmple(self.bounds.1).all();
        if inside { self.local_at(local) } else { 0.0 }
    }

    /// The part of the ray's first `length_m` that lies in the box.
    pub fn window(&self, ray: &Ray, length_m: f64) -> Option<(f64, f64)> {
        self.clipped(&self.line(ray), length_m)
    }

    /// The largest value along the ray's first `length_m`, or somewhat more.
    pub fn majorant(&self, ray: &Ray, length_m: f64) -> f64 {
        let line = self.line(ray);
        let Some(window) = self.clipped(&line, length_m) else { return 0.0 };
        match &self.shape {
            Shape::Constant(value) => *value,
            Shape::Grid(grid) => grid.majorant(&line, window, self.bounds),
            Shape::Atmosphere(atmosphere) => atmosphere.majorant(&line, window),
            Shape::Ball(ball) => ball.majorant(&line, window),
        }
    }

    /// The largest value anywhere, or somewhat more.
    pub fn max(&self) -> f64 {
        match &self.shape {
            Shape::Constant(value) => *value,
            Shape::Grid(grid) => grid.max(),
            Shape::Atmosphere(atmosphere) => atmosphere.max(self.bounds),
            Shape::Ball(ball) => ball.value,
        }
    }

    /// The integral in m (times the field's unit) along the ray's first `length_m`, which may be infinite.
    pub fn column_m(&self, ray: &Ray, length_m: f64) -> f64 {
        let line = self.line(ray);
        let mut sum = 0.0;
        self.for_each_piece(&line, length_m, |piece| {
            sum += self.integral(&line, piece);
            ControlFlow::Continue(())
        });
        sum
    }

    /// Where along the ray the integral reaches `column_m`; `None` where the ray's first `length_m` hold less.
    pub fn distance_at(&self, ray: &Ray, length_m: f64, column_m: f64) -> Option<f64> {
        let line = self.line(ray);
        let mut left = column_m;
        let mut found = None;
        self.for_each_piece(&line, length_m, |piece| {
            let whole = self.integral(&line, piece);
            if whole > left {
                found = Some(self.invert(&line, piece, whole, left));
                return ControlFlow::Break(());
            }
            left -= whole;
            ControlFlow::Continue(())
        });
        found
    }

    /// The integral by as many midpoint steps along the ray's way through the box: biased, with an error that falls with the square
    /// of the step.
    pub fn column_by_steps(&self, ray: &Ray, length_m: f64, steps: u32) -> f64 {
        let line = self.line(ray);
        let Some((from, to)) = self.clipped(&line, length_m) else { return 0.0 };
        let step = (to - from) / f64::from(steps);
        let middle = |i: u32| from + (f64::from(i) + 0.5) * step;
        (0..steps).map(|i| self.local_at(line.at(middle(i)))).sum::<f64>() * step
    }

    fn line(&self, ray: &Ray) -> Line {
        let origin = self.to_local.transform_point3(ray.origin);
        Line { origin, direction: self.to_local.transform_vector3(ray.direction) }
    }

    /// The part of 0…`length_m` within the box.
    fn clipped(&self, line: &Line, length_m: f64) -> Option<(f64, f64)> {
        let (mut from, mut to) = (0.0_f64, length_m);
        for axis in 0..3 {
            let (origin, along) = (line.origin[axis], line.direction[axis]);
            let (low, high) = (self.bounds.0[axis], self.bounds.1[axis]);
            if along == 0.0 {
                // In a face of the box a ray counts as inside.
                if origin < low || origin > high {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - origin) / along, (high - origin) / along);
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
        (from < to).then_some((from, to))
    }

    /// The value at a point of the box.
    fn local_at(&self, local: DVec3) -> f64 {
        match &self.shape {
            Shape::Constant(value) => *value,
            Shape::Grid(grid) => grid.at(local, self.bounds),
            Shape::Atmosphere(atmosphere) => atmosphere.at(local),
            Shape::Ball(ball) => ball.at(local),
        }
    }

    /// Calls `visit` with the pieces of the line's first `length_m` in order; stretches left out hold nothing.
    fn for_each_piece(&self, line: &Line, length_m: f64, mut visit: impl FnMut((f64, f64)) -> ControlFlow<()>) {
        let Some(window) = self.clipped(line, length_m) else { return };
        let _ = match &self.shape {
            Shape::Constant(_) => visit(window),
            Shape::Grid(grid) => grid.for_each_piece(line, window, self.bounds, visit),
            Shape::Atmosphere(atmosphere) => atmosphere.for_each_piece(line, window, visit),
            Shape::Ball(ball) => ball.for_each_piece(line, window, visit),
        };
    }

    /// The integral over a piece, or over a part of one.
    fn integral(&self, line: &Line, piece: (f64, f64)) -> f64 {
        match &self.shape {
            Shape::Constant(value) => value * (piece.1 - piece.0),
            Shape::Grid(grid) => grid.integral(line, piece, self.bounds),
            Shape::Atmosphere(atmosphere) => atmosphere.integral(line, piece),
            Shape::Ball(ball) => ball.integral(line, piece),
        }
    }

    /// Where in a piece, which holds `whole`, its integral reaches `wanted`: Newton's method, kept within what bisection knows.
    fn invert(&self, line: &Line, piece: (f64, f64), whole: f64, wanted: f64) -> f64 {
        let (mut low, mut high) = piece;
        let mut t = low + (high - low) * (wanted / whole);
        for _ in 0..MAX_NEWTON_STEPS {
            let error = self.integral(line, (piece.0, t)) - wanted;
            if error < 0.0 {
                low = t;
            } else {
                high = t;
            }
            let newton = t - error / self.local_at(line.at(t));
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if error == 0.0 || (next - t).abs() <= f64::EPSILON * t.abs() {
                return t;
            }
            t = next;
        }
        t
    }
}
