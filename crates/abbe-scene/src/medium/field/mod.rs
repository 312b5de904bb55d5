//! Scalar fields: a density or temperature as a function of position in a box, and 0 outside.
//!
//! A line through a field is split into pieces, such as cells of a grid or shells of an atmosphere,
//! which a quadrature rule integrates with a relative error below 10⁻¹². Newton's method finds the
//! position at which the integral along the line reaches a given value.

mod atmosphere;
mod ball;
mod grid;
mod noise;
#[cfg(test)]
mod tests;

pub use atmosphere::{Atmosphere, Ground, Planet};
pub use ball::BallField;
pub use grid::FieldGrid;
pub use noise::Noise;

use crate::geometry::Ray;
use glam::{DAffine3, DVec3};
use std::ops::ControlFlow;

#[derive(Debug, Clone, PartialEq)]
pub struct ScalarField {
    shape: FieldShape,
    /// From scene coordinates to local coordinates, in which the box is axis-aligned.
    to_local: DAffine3,
    /// The lowest and highest corner of the box.
    bounds: (DVec3, DVec3),
}

#[derive(Debug, Clone, PartialEq)]
pub enum FieldShape {
    Constant(f64),
    Grid(FieldGrid),
    Atmosphere(Atmosphere),
    Ball(BallField),
}

/// A line in a field's own coordinates. The parameter is the distance along the ray in m, so the
/// direction is not a unit vector if the coordinates are scaled.
#[derive(Debug, Clone, Copy)]
struct FieldLine {
    origin: DVec3,
    direction: DVec3,
}

impl FieldLine {
    fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    fn nearest_to(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.direction) / self.direction.length_squared()
    }

    /// The parameters at which the line enters and leaves a sphere, if it does. `nearest` is the
    /// parameter of the point nearest to the sphere's centre.
    fn crossings(&self, centre: DVec3, radius: f64, nearest: f64) -> Option<(f64, f64)> {
        let closest = (self.at(nearest) - centre).length();
        (closest < radius).then(|| {
            let half = ((radius - closest) * (radius + closest)).sqrt() / self.direction.length();
            (nearest - half, nearest + half)
        })
    }
}

/// The number of steps in which bisection alone reaches full precision.
const MAX_NEWTON_STEPS: u32 = 100;

impl ScalarField {
    /// Creates a field in a box with these corners. `to_local` maps positions of the scene (m,
    /// relative to its centre) to the coordinates of the box.
    pub fn new(shape: FieldShape, bounds: (DVec3, DVec3), to_local: DAffine3) -> Self {
        Self { shape, to_local, bounds }
    }

    /// Returns true if a grid with this number of cells along the longest side of the box can
    /// interpolate column densities: an atmosphere's scale height must be at least one cell.
    pub fn is_smooth_in_cells(&self, cells: u32) -> bool {
        let longest = (self.bounds.1 - self.bounds.0).max_element();
        match &self.shape {
            FieldShape::Atmosphere(air) => air.scale_height >= longest / f64::from(cells),
            FieldShape::Constant(_) | FieldShape::Grid(_) | FieldShape::Ball(_) => true,
        }
    }

    pub fn from_unit(&self) -> DAffine3 {
        let (low, high) = self.bounds;
        self.to_local.inverse() * DAffine3::from_translation(low) * DAffine3::from_scale(high - low)
    }

    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        Self { to_local: self.to_local * map.inverse(), ..self.clone() }
    }

    pub fn corners(&self) -> [DVec3; 8] {
        let from_unit = self.from_unit();
        let corner = |i: usize| DVec3::from_array(std::array::from_fn(|axis| (i >> axis & 1) as f64));
        std::array::from_fn(|i| from_unit.transform_point3(corner(i)))
    }

    /// The smallest integral of the field between the centres of two opposite faces of the box, in
    /// m times the unit of the field.
    pub fn min_column_m(&self) -> f64 {
        let corners = self.corners();
        let middle = 0.5 * (corners[0] + corners[7]);
        let across = [1, 2, 4].map(|corner| {
            let side = corners[corner] - corners[0];
            let ray = Ray::new(middle - 0.5 * side, side.normalize_or_zero());
            self.column_m(&ray, side.length())
        });
        across.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// The largest distance between a corner of the box and the scene's centre.
    pub fn radius_m(&self) -> f64 {
        self.corners().map(DVec3::length).into_iter().fold(0.0, f64::max)
    }

    /// The value at a point of the scene (m, relative to its centre).
    pub fn at(&self, point: DVec3) -> f64 {
        let local = self.to_local.transform_point3(point);
        let inside = local.cmpge(self.bounds.0).all() && local.cmple(self.bounds.1).all();
        if inside { self.local_at(local) } else { 0.0 }
    }

    /// The distances at which the first `length_m` of the ray enter and leave the box, if they do.
    pub fn interval(&self, ray: &Ray, length_m: f64) -> Option<(f64, f64)> {
        self.clipped(&self.line(ray), length_m)
    }

    /// An upper bound of the value along the first `length_m` of the ray.
    pub fn majorant(&self, ray: &Ray, length_m: f64) -> f64 {
        let line = self.line(ray);
        let Some(interval) = self.clipped(&line, length_m) else { return 0.0 };
        match &self.shape {
            FieldShape::Constant(value) => *value,
            FieldShape::Grid(grid) => grid.majorant(&line, interval, self.bounds),
            FieldShape::Atmosphere(atmosphere) => atmosphere.majorant(&line, interval),
            FieldShape::Ball(ball) => ball.majorant(&line, interval),
        }
    }

    /// An upper bound of the value at all points.
    pub fn max(&self) -> f64 {
        match &self.shape {
            FieldShape::Constant(value) => *value,
            FieldShape::Grid(grid) => grid.max(),
            FieldShape::Atmosphere(atmosphere) => atmosphere.max(self.bounds),
            FieldShape::Ball(ball) => ball.value,
        }
    }

    /// The integral of the field along the first `length_m` of the ray, in m times the unit of the
    /// field. The length may be infinite.
    pub fn column_m(&self, ray: &Ray, length_m: f64) -> f64 {
        let line = self.line(ray);
        let mut sum = 0.0;
        self.for_each_piece(&line, length_m, |piece| {
            sum += self.integral(&line, piece);
            ControlFlow::Continue(())
        });
        sum
    }

    /// The distance along the ray at which the integral of the field reaches `column_m`. `None` if
    /// the integral over the first `length_m` is smaller.
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

    /// Computes the integral of the field along a ray by the midpoint rule with `steps` steps
    /// inside the box. The error is proportional to the square of the step.
    pub fn column_by_steps(&self, ray: &Ray, length_m: f64, steps: u32) -> f64 {
        let line = self.line(ray);
        let Some((from, to)) = self.clipped(&line, length_m) else { return 0.0 };
        let step = (to - from) / f64::from(steps);
        let middle = |i: u32| from + (f64::from(i) + 0.5) * step;
        (0..steps).map(|i| self.local_at(line.at(middle(i)))).sum::<f64>() * step
    }

    fn line(&self, ray: &Ray) -> FieldLine {
        let origin = self.to_local.transform_point3(ray.origin);
        FieldLine { origin, direction: self.to_local.transform_vector3(ray.direction) }
    }

    /// The part of the line inside the box and between the parameters 0 and `length_m`.
    fn clipped(&self, line: &FieldLine, length_m: f64) -> Option<(f64, f64)> {
        let (mut from, mut to) = (0.0_f64, length_m);
        for axis in 0..3 {
            let (origin, along) = (line.origin[axis], line.direction[axis]);
            let (low, high) = (self.bounds.0[axis], self.bounds.1[axis]);
            if along == 0.0 {
                // A ray that lies in a face of the box counts as inside the box.
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

    fn local_at(&self, local: DVec3) -> f64 {
        match &self.shape {
            FieldShape::Constant(value) => *value,
            FieldShape::Grid(grid) => grid.at(local, self.bounds),
            FieldShape::Atmosphere(atmosphere) => atmosphere.at(local),
            FieldShape::Ball(ball) => ball.at(local),
        }
    }

    /// Divides the first `length_m` of the line into pieces, and calls `visit` with each in order.
    /// Parts where the field is 0 may be left out.
    fn for_each_piece(&self, line: &FieldLine, length_m: f64, mut visit: impl FnMut((f64, f64)) -> ControlFlow<()>) {
        let Some(interval) = self.clipped(line, length_m) else { return };
        let _ = match &self.shape {
            FieldShape::Constant(_) => visit(interval),
            FieldShape::Grid(grid) => grid.for_each_piece(line, interval, self.bounds, visit),
            FieldShape::Atmosphere(atmosphere) => atmosphere.for_each_piece(line, interval, visit),
            FieldShape::Ball(ball) => ball.for_each_piece(line, interval, visit),
        };
    }

    /// The integral over a piece or a part of one.
    fn integral(&self, line: &FieldLine, piece: (f64, f64)) -> f64 {
        match &self.shape {
            FieldShape::Constant(value) => value * (piece.1 - piece.0),
            FieldShape::Grid(grid) => grid.integral(line, piece, self.bounds),
            FieldShape::Atmosphere(atmosphere) => atmosphere.integral(line, piece),
            FieldShape::Ball(ball) => ball.integral(line, piece),
        }
    }

    /// The parameter at which the integral from the start of the piece, of `whole` in total,
    /// reaches `wanted`. Bisection replaces Newton steps that would leave the interval with the
    /// solution.
    fn invert(&self, line: &FieldLine, piece: (f64, f64), whole: f64, wanted: f64) -> f64 {
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
