//! The local frame of a shape: lines, their crossings with faces, and surface points.

use std::f64::consts::TAU;

use glam::DVec3;

use abbe_spectra::math::elementary::atan2;
use abbe_spectra::math::random::ONE_MINUS_ULP;

/// The line `origin + t·direction`. The direction is not normalised, so transforms do not change t.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalLine {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl LocalLine {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) t: f64,
    pub(crate) face: u32,
}

/// The part of a line inside a convex set. Either end may be infinite.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) enter: Crossing,
    pub(crate) exit: Crossing,
}

impl Span {
    /// Creates a span whose entry and exit, at the t of `roots`, lie on the same face.
    pub(crate) fn of_face(roots: (f64, f64), face: u32) -> Self {
        Self { enter: Crossing { t: roots.0, face }, exit: Crossing { t: roots.1, face } }
    }

    pub(crate) fn intersection(self, other: Self) -> Option<Self> {
        let enter = if other.enter.t > self.enter.t { other.enter } else { self.enter };
        let exit = if other.exit.t < self.exit.t { other.exit } else { self.exit };
        (enter.t <= exit.t).then_some(Self { enter, exit })
    }

    /// Returns the first end of the span with a finite t above `after`.
    pub(crate) fn next_crossing(&self, after: f64) -> Option<Crossing> {
        [self.enter, self.exit].into_iter().find(|end| end.t > after && end.t < f64::INFINITY)
    }
}

/// A point of a surface, projected onto it, and the outward unit normal there, in the local frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalSurfacePoint {
    pub(crate) point: DVec3,
    pub(crate) normal: DVec3,
}

/// Returns the azimuth from x towards y as a fraction of a full turn, in [0, 1).
pub(crate) fn azimuth_fraction(x: f64, y: f64) -> f64 {
    // A tiny negative angle would round to 1.
    (atan2(y, x) / TAU).rem_euclid(1.0).min(ONE_MINUS_ULP)
}

/// Returns the range of t in which a line lies inside a ball about the origin, or in a cylinder if
/// the axial components of the line are 0. The discriminant is computed from the point of closest
/// approach, and the roots without cancellation, so they are accurate also for small and distant
/// balls, and for lines that almost graze the ball.
#[inline]
pub(crate) fn ball_roots(line: &LocalLine, radius: f64) -> Option<(f64, f64)> {
    let a = line.direction.length_squared();
    let c = line.origin.length_squared() - radius * radius;
    if a == 0.0 {
        return (c <= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let b = line.origin.dot(line.direction);
    let closest = line.origin - b / a * line.direction;
    let discriminant = radius * radius - closest.length_squared();
    if discriminant < 0.0 {
        return None;
    }
    Some(ordered_roots(a, b, c, discriminant * a))
}

/// Returns the t at which a line that starts on the surface of a ball about the origin crosses it a
/// second time. The constant term of the quadratic equation is exactly 0, so the other root is
/// −2b/a. It is negative if the line points out of the ball.
pub(crate) fn chord_t(line: &LocalLine) -> f64 {
    let a = line.direction.length_squared();
    if a == 0.0 { f64::INFINITY } else { -2.0 * line.origin.dot(line.direction) / a }
}

/// Returns the roots of a t² + 2b t + c in ascending order without cancellation, by b² − ac ≥ 0.
#[inline]
pub(crate) fn ordered_roots(a: f64, b: f64, c: f64, discriminant: f64) -> (f64, f64) {
    let q = -b - discriminant.sqrt().copysign(b);
    if q == 0.0 {
        return (0.0, 0.0);
    }
    let (first, second) = (q / a, c / q);
    if first <= second { (first, second) } else { (second, first) }
}
