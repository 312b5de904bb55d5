//! Watertight ray–triangle intersection: a line through the common edge of two adjacent triangles
//! intersects exactly one of them.
//!
//! As in Woop, Benthin & Wald, "Watertight ray/triangle intersection" (JCGT 2, 2013), vertices are
//! transformed to a frame whose third axis is the ray. Every triangle uses the same arithmetic for
//! a shared vertex, so the edge functions that two triangles compute for their common edge differ
//! only in sign. If a line passes exactly through an edge or a vertex, the test of every triangle
//! displaces it by the same infinitesimal step.

use glam::DVec3;

/// The data of a ray that all its triangle tests share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TriangleRay {
    origin: DVec3,
    direction: DVec3,
    across_x: DVec3,
    across_y: DVec3,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct TriangleHit {
    /// May be negative.
    pub(crate) t: f64,
    pub(crate) weights: [f64; 3],
}

impl TriangleRay {
    /// Creates the frame of a unit direction (Duff et al., JCGT 6, 2017).
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Self {
        let sign = 1.0_f64.copysign(direction.z);
        let a = -1.0 / (sign + direction.z);
        let b = direction.x * direction.y * a;
        let across_x = DVec3::new(1.0 + sign * direction.x * direction.x * a, sign * b, -sign * direction.x);
        let across_y = DVec3::new(b, sign + direction.y * direction.y * a, -direction.y);
        Self { origin, direction, across_x, across_y }
    }

    /// Two unit vectors perpendicular to the ray and to each other.
    pub(crate) fn across(&self) -> (DVec3, DVec3) {
        (self.across_x, self.across_y)
    }

    /// Returns the intersection of the line with the triangle, on either side of the ray's origin.
    #[inline(always)]
    pub(crate) fn intersect(&self, [a, b, c]: [DVec3; 3]) -> Option<TriangleHit> {
        let (a, b, c) = (a - self.origin, b - self.origin, c - self.origin);
        let x = [a.dot(self.across_x), b.dot(self.across_x), c.dot(self.across_x)];
        let y = [a.dot(self.across_y), b.dot(self.across_y), c.dot(self.across_y)];
        let edges = [x[1] * y[2] - y[1] * x[2], x[2] * y[0] - y[2] * x[0], x[0] * y[1] - y[0] * x[1]];
        let least = edges[0].min(edges[1]).min(edges[2]);
        let largest = edges[0].max(edges[1]).max(edges[2]);
        if least < 0.0 && largest > 0.0 {
            return None;
        }
        let has_zero = edges[0] == 0.0 || edges[1] == 0.0 || edges[2] == 0.0;
        if has_zero && !inside_by_tie_break(x, y, edges) {
            return None;
        }
        let determinant = edges[0] + edges[1] + edges[2];
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let weights = [edges[0] * inverse, edges[1] * inverse, edges[2] * inverse];
        let depth = [a.dot(self.direction), b.dot(self.direction), c.dot(self.direction)];
        let t = weights[0] * depth[0] + weights[1] * depth[1] + weights[2] * depth[2];
        Some(TriangleHit { t, weights })
    }
}

/// Decides whether a line that passes exactly through at least one edge counts as inside. Its edge
/// functions are evaluated for a line displaced by (ε, ε²) with ε → 0, which changes that of an
/// edge from p to q by ε (p.y − q.y) + ε² (q.x − p.x).
#[cold]
fn inside_by_tie_break(x: [f64; 3], y: [f64; 3], edges: [f64; 3]) -> bool {
    let sign = |edge: usize| {
        let (p, q) = ((edge + 1) % 3, (edge + 2) % 3);
        [edges[edge], y[p] - y[q], x[q] - x[p]].into_iter().find(|&value| value != 0.0)
    };
    match (sign(0), sign(1), sign(2)) {
        (Some(a), Some(b), Some(c)) => (a > 0.0) == (b > 0.0) && (b > 0.0) == (c > 0.0),
        _ => false,
    }
}
