//! A line in a shape's frame, where it crosses a surface, and the roots that say so.

use glam::DVec3;

/// The line `origin + t·direction`. The direction has any length, so that t is the same in every frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl Line {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// A line crosses a face of a shape at `t`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) t: f64,
    pub(crate) face: u32,
}

/// The part of a line inside a convex set: it enters, then it leaves; either end may be infinite.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) enter: Crossing,
    pub(crate) exit: Crossing,
}

impl Span {
    /// Between two roots of the same face.
    pub(crate) fn of_face(roots: (f64, f64), face: u32) -> Self {
        Self { enter: Crossing { t: roots.0, face }, exit: Crossing { t: roots.1, face } }
    }

    /// What lies in both, or nothing.
    pub(crate) fn intersection(self, other: Self) -> Option<Self> {
        let enter = if other.enter.t > self.enter.t { other.enter } else { self.enter };
        let exit = if other.exit.t < self.exit.t { other.exit } else { self.exit };
        (enter.t <= exit.t).then_some(Self { enter, exit })
    }

    /// The first end beyond `after`.
    pub(crate) fn next(&self, after: f64) -> Option<Crossing> {
        [self.enter, self.exit].into_iter().find(|end| end.t > after && end.t < f64::INFINITY)
    }
}

/// The t between which a line is within `radius` of the origin of its frame.
///
/// For a cylinder, pass origin and direction with the axial component set to 0. The discriminant comes from the
/// point of closest approach and the roots from the sum that does not cancel, so that small, distant and nearly
/// grazed balls keep their digits.
#[inline]
pub(crate) fn ball_roots(line: &Line, radius: f64) -> Option<(f64, f64)> {
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

/// The other root of a line that starts on the surface of a ball about the origin of its frame: with c = 0
/// exactly, one root is 0 and the other −2b/a. Negative where the line leaves the ball.
pub(crate) fn chord(line: &Line) -> f64 {
    let a = line.direction.length_squared();
    if a == 0.0 { f64::INFINITY } else { -2.0 * line.origin.dot(line.direction) / a }
}

/// The roots of a t² + 2b t + c in order, from its discriminant b² − ac ≥ 0, without cancellation.
#[inline]
pub(crate) fn ordered_roots(a: f64, b: f64, c: f64, discriminant: f64) -> (f64, f64) {
    let q = -b - discriminant.sqrt().copysign(b);
    if q == 0.0 {
        return (0.0, 0.0);
    }
    let (first, second) = (q / a, c / q);
    if first <= second { (first, second) } else { (second, first) }
}
