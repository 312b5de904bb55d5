//! The lens shape: two spherical or plane surfaces and a cylindrical edge. Faces: 0 front, 1 back,
//! 2 edge.
//!
//! The lens is built from convex sets: the cylinder of the edge, and one ball or half-space per
//! surface, inside of which it lies if the surface is convex or plane, and outside if it is
//! concave. A line intersects each set in one span, and the lens combines these spans on the line,
//! so entries and exits alternate, and faces meet at their rims without gaps.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::local::{
    Crossing, LocalLine, LocalSurfacePoint, Span, azimuth_fraction, ball_roots, chord_t, ordered_roots,
};
use abbe_spectra::math::elementary::{hypot, sin_cos};

const FRONT: u32 = 0;
const BACK: u32 = 1;
const EDGE: u32 = 2;

/// One of the two surfaces and its convex set: the half-space of a plane, or the ball of a sphere,
/// extended beyond its centre to a half-space, so that its far side does not cut a thick lens.
#[derive(Debug, Clone, Copy)]
struct Cap {
    face: u32,
    /// z of the vertex, where the surface crosses the axis.
    vertex_z: f64,
    /// `None` for a plane.
    radius: Option<f64>,
    /// The z direction (+1 or −1) that points out of the set at the vertex.
    outward: f64,
    /// True if the lens lies inside the set (convex or plane surface), not outside (concave).
    kept: bool,
}

/// A lens about the z axis, with the front vertex at the origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LensSolid {
    front: Cap,
    back: Cap,
    edge_radius: f64,
}

impl LensSolid {
    pub(crate) const FACES: u32 = 3;
    pub(crate) const ROUND_FACE: u32 = EDGE;

    /// Creates a lens from radii: positive towards a centre at +z, and 0 for a plane.
    pub(crate) fn new(radius1: f64, radius2: f64, thickness: f64, diameter: f64) -> Self {
        let front = Cap {
            face: FRONT,
            vertex_z: 0.0,
            radius: (radius1 != 0.0).then_some(radius1.abs()),
            outward: if radius1 < 0.0 { 1.0 } else { -1.0 },
            kept: radius1 >= 0.0,
        };
        let back = Cap {
            face: BACK,
            vertex_z: thickness,
            radius: (radius2 != 0.0).then_some(radius2.abs()),
            outward: if radius2 > 0.0 { -1.0 } else { 1.0 },
            kept: radius2 <= 0.0,
        };
        Self { front, back, edge_radius: 0.5 * diameter }
    }

    /// Returns the z coordinates of the rims of the front and the back surface.
    pub(crate) fn rims(&self) -> (f64, f64) {
        (self.front.rim_z(self.edge_radius), self.back.rim_z(self.edge_radius))
    }

    /// Returns the support function: the largest dot product of `direction` with a point of it.
    pub(crate) fn support(&self, direction: DVec3) -> f64 {
        let across = self.edge_radius * hypot(direction.x, direction.y);
        let (front, back) = self.rims();
        let rims = across + (front * direction.z).max(back * direction.z);
        let caps = [&self.front, &self.back].into_iter().filter(|cap| cap.kept);
        caps.filter_map(|cap| cap.support(direction, self.edge_radius)).fold(rims, f64::max)
    }

    pub(crate) fn next_crossing(&self, line: &LocalLine, start_face: Option<u32>, after: f64) -> Option<Crossing> {
        match start_face {
            Some(face) => self.next_from(line, face),
            None => self.crossing_after(line, after),
        }
    }

    fn kept(&self, line: &LocalLine) -> Option<Span> {
        let mut span = Span::of_face(ball_roots(&project_xy(line), self.edge_radius)?, EDGE);
        for cap in [&self.front, &self.back] {
            if cap.kept {
                span = span.intersection(cap.span(line)?)?;
            }
        }
        Some(span)
    }

    fn crossing_after(&self, line: &LocalLine, after: f64) -> Option<Crossing> {
        let mut pieces = [Some(self.kept(line)?), None, None];
        for cap in [&self.front, &self.back] {
            if let Some(hollow) = Some(cap).filter(|cap| !cap.kept).and_then(|cap| cap.span(line)) {
                pieces = subtract(pieces, hollow);
            }
        }
        pieces.iter().flatten().find_map(|piece| piece.next_crossing(after))
    }

    fn next_from(&self, line: &LocalLine, start: u32) -> Option<Crossing> {
        // The t at which the line leaves the set of its start face, negative if it points out.
        let (kept, set_exit_t) = match start {
            EDGE => (true, chord_t(&project_xy(line))),
            FRONT => (self.front.kept, self.front.set_exit_t(line)),
            _ => (self.back.kept, self.back.set_exit_t(line)),
        };
        match (kept, set_exit_t > 0.0) {
            (true, true) | (false, false) => self.exit_from(line, start, set_exit_t),
            // The line leaves a convex set that contains the lens, so it never re-enters the lens.
            (true, false) => None,
            (false, true) => self.entry_from(line, start, set_exit_t),
        }
    }

    /// Returns the first exit of a line that starts on a face and points into the lens. If rounding
    /// places the start beyond another face, the exit is at t = 0.
    fn exit_from(&self, line: &LocalLine, start: u32, set_exit_t: f64) -> Option<Crossing> {
        let edge = if start == EDGE {
            set_exit_t
        } else {
            ball_roots(&project_xy(line), self.edge_radius).map_or(0.0, |r| r.1)
        };
        let mut exit = Crossing { t: edge, face: EDGE };
        for cap in [&self.front, &self.back] {
            let leaves = match (cap.face == start, cap.kept) {
                (true, true) => Some(Crossing { t: set_exit_t, face: cap.face }),
                (true, false) => None,
                (false, true) => Some(cap.span(line).map_or(Crossing { t: 0.0, face: cap.face }, |span| span.exit)),
                (false, false) => cap.span(line).filter(|span| span.exit.t > 0.0).map(|span| span.enter),
            };
            if let Some(leaves) = leaves.filter(|leaves| leaves.t < exit.t) {
                exit = Crossing { face: cap.face, ..leaves };
            }
        }
        Some(Crossing { t: exit.t.max(0.0), ..exit }).filter(|exit| exit.t < f64::INFINITY)
    }

    /// Returns the re-entry of a line from a concave face through the hollow, or `None` if it
    /// misses.
    fn entry_from(&self, line: &LocalLine, start: u32, set_exit_t: f64) -> Option<Crossing> {
        let mut entry = Crossing { t: set_exit_t, face: start };
        let other = if start == FRONT { &self.back } else { &self.front };
        if !other.kept
            && let Some(hollow) = other.span(line)
            && hollow.enter.t <= entry.t
            && entry.t < hollow.exit.t
        {
            entry = Crossing { face: other.face, ..hollow.exit };
        }
        let kept = self.kept(line)?;
        (entry.t < f64::INFINITY && kept.enter.t <= entry.t && entry.t < kept.exit.t).then_some(entry)
    }

    pub(crate) fn surface(&self, point: DVec3, face: u32) -> LocalSurfacePoint {
        match face {
            FRONT => self.front.surface(point),
            BACK => self.back.surface(point),
            _ => {
                let normal = point.with_z(0.0).normalize_or(DVec3::X);
                LocalSurfacePoint { point: (self.edge_radius * normal).with_z(point.z), normal }
            }
        }
    }

    pub(crate) fn uv(&self, point: DVec3, face: u32) -> [f64; 2] {
        if matches!(face, FRONT | BACK) {
            return [0.5 + 0.5 * point.x / self.edge_radius, 0.5 - 0.5 * point.y / self.edge_radius];
        }
        let (z0, z1) = self.rims();
        [azimuth_fraction(point.x, point.y), (point.z - z0) / (z1 - z0).max(f64::MIN_POSITIVE)]
    }

    pub(crate) fn area(&self, face: u32) -> f64 {
        match face {
            FRONT => self.front.area(self.edge_radius),
            BACK => self.back.area(self.edge_radius),
            _ => {
                let (z0, z1) = self.rims();
                TAU * self.edge_radius * (z1 - z0).max(0.0)
            }
        }
    }

    pub(crate) fn sample(&self, face: u32, u: [f64; 2]) -> DVec3 {
        let (sin, cos) = sin_cos(TAU * u[1]);
        match face {
            FRONT => self.front.sample(self.edge_radius, u[0], sin, cos),
            BACK => self.back.sample(self.edge_radius, u[0], sin, cos),
            _ => {
                let (z0, z1) = self.rims();
                DVec3::new(self.edge_radius * cos, self.edge_radius * sin, z0 + u[0] * (z1 - z0))
            }
        }
    }
}

impl Cap {
    /// The z coordinate of the ball's centre, or of the plane.
    fn centre_z(&self) -> f64 {
        self.vertex_z - self.outward * self.radius.unwrap_or(0.0)
    }

    /// Returns the sagitta of the cap over a disk, accurate also for nearly flat caps.
    fn sagitta(&self, disk_radius: f64) -> f64 {
        self.radius.map_or(0.0, |radius| {
            let root = ((radius - disk_radius) * (radius + disk_radius)).max(0.0).sqrt();
            disk_radius * disk_radius / (radius + root)
        })
    }

    fn rim_z(&self, edge_radius: f64) -> f64 {
        self.vertex_z - self.outward * self.sagitta(edge_radius)
    }

    /// Returns the ball's support function, or `None` for a plane or an extreme point off the cap.
    fn support(&self, direction: DVec3, edge_radius: f64) -> Option<f64> {
        let radius = self.radius?;
        let sin = edge_radius / radius;
        let in_cap = self.outward * direction.z >= direction.length() * ((1.0 - sin) * (1.0 + sin)).max(0.0).sqrt();
        // Relative to the vertex, the support is accurate for nearly flat caps: if d⊥ is the
        // component of d perpendicular to the axis, r(|d| − d·axis) equals r|d⊥|²/(|d| + d·axis).
        let along = self.outward * direction.z;
        let bulge = radius * direction.with_z(0.0).length_squared() / (direction.length() + along);
        in_cap.then_some(self.vertex_z * direction.z + bulge)
    }

    fn span(&self, line: &LocalLine) -> Option<Span> {
        let Some((first, second)) = self.radius.and_then(|radius| self.roots(line, radius)) else {
            return self.half_space(line);
        };
        // A root is valid on the half of the ball that belongs to the surface.
        let on_cap = |t: f64| self.outward * (line.at(t).z - self.centre_z()) >= 0.0;
        match (on_cap(first), on_cap(second)) {
            (true, true) => Some(Span::of_face((first, second), self.face)),
            (true, false) => Some(Span::of_face((first, f64::INFINITY), self.face)),
            (false, true) => Some(Span::of_face((f64::NEG_INFINITY, second), self.face)),
            (false, false) => self.half_space(line),
        }
    }

    /// Returns the two t at which the line crosses the surface of the ball. Positions are relative
    /// to the vertex, and t is relative to the point of the line nearest to it, so that the
    /// constant term of the quadratic equation does not contain the square of the radius of
    /// curvature, and the roots are accurate for nearly flat surfaces.
    fn roots(&self, line: &LocalLine, radius: f64) -> Option<(f64, f64)> {
        let direction = line.direction;
        let a = direction.length_squared();
        let from_vertex = line.origin - DVec3::new(0.0, 0.0, self.vertex_z);
        let shift = -from_vertex.dot(direction) / a;
        let near = from_vertex + shift * direction;
        let b = near.dot(direction) + self.outward * radius * direction.z;
        let c = near.length_squared() + 2.0 * self.outward * radius * near.z;
        let discriminant = b * b - a * c;
        if discriminant < 0.0 {
            return None;
        }
        let (first, second) = ordered_roots(a, b, c, discriminant);
        Some((first + shift, second + shift))
    }

    /// Returns the span inside the half-space behind the plane or the ball's centre.
    fn half_space(&self, line: &LocalLine) -> Option<Span> {
        let height = self.outward * (line.origin.z - self.centre_z());
        let speed = self.outward * line.direction.z;
        if speed == 0.0 {
            return (height <= 0.0).then(|| Span::of_face((f64::NEG_INFINITY, f64::INFINITY), self.face));
        }
        let t = -height / speed;
        let roots = if speed > 0.0 { (f64::NEG_INFINITY, t) } else { (t, f64::INFINITY) };
        Some(Span::of_face(roots, self.face))
    }

    /// Returns the t at which a line from this surface leaves the set: ∞ if it never does, and
    /// negative if it points out.
    fn set_exit_t(&self, line: &LocalLine) -> f64 {
        let Some(radius) = self.radius else {
            return if self.outward * line.direction.z < 0.0 { f64::INFINITY } else { -1.0 };
        };
        let centre = DVec3::new(0.0, 0.0, self.centre_z());
        let t = chord_t(&LocalLine { origin: line.origin - centre, ..*line });
        let on_cap = self.outward * (line.at(t).z - centre.z) >= 0.0 && radius > 0.0;
        if t > 0.0 && !on_cap { f64::INFINITY } else { t }
    }

    fn surface(&self, point: DVec3) -> LocalSurfacePoint {
        let outwards = if self.kept { 1.0 } else { -1.0 };
        let Some(radius) = self.radius else {
            let normal = DVec3::new(0.0, 0.0, self.outward * outwards);
            return LocalSurfacePoint { point: point.with_z(self.vertex_z), normal };
        };
        let centre = DVec3::new(0.0, 0.0, self.centre_z());
        let radial = (point - centre).normalize_or(DVec3::new(0.0, 0.0, self.outward));
        let across = point.with_z(0.0).length();
        // Near the axis, z is computed from the sagitta, because the sum of the centre's z and the
        // radius would be inaccurate on a nearly flat surface. Far from the axis, where the surface
        // is steep, the point is computed from the centre and the radius.
        let snapped = if across < 0.7 * radius {
            point.with_z(self.vertex_z - self.outward * self.sagitta(across))
        } else {
            centre + radius * radial
        };
        LocalSurfacePoint { point: snapped, normal: outwards * radial }
    }

    fn area(&self, edge_radius: f64) -> f64 {
        self.radius.map_or(PI * edge_radius * edge_radius, |radius| TAU * radius * self.sagitta(edge_radius))
    }

    /// Samples a point uniformly on the cap. By Archimedes, zones of equal height have equal areas.
    fn sample(&self, edge_radius: f64, u: f64, sin: f64, cos: f64) -> DVec3 {
        let height = u * self.sagitta(edge_radius);
        let ring =
            self.radius.map_or(edge_radius * u.sqrt(), |radius| (height * (2.0 * radius - height)).max(0.0).sqrt());
        DVec3::new(ring * cos, ring * sin, self.vertex_z - self.outward * height)
    }
}

/// Removes the parts of the spans that lie inside a convex hollow.
fn subtract(pieces: [Option<Span>; 3], hollow: Span) -> [Option<Span>; 3] {
    let mut left = [None; 3];
    let mut count = 0;
    for piece in pieces.into_iter().flatten() {
        if hollow.exit.t <= piece.enter.t || hollow.enter.t >= piece.exit.t {
            left[count] = Some(piece);
            count += 1;
            continue;
        }
        for (enter, exit) in [(piece.enter, hollow.enter), (hollow.exit, piece.exit)] {
            if enter.t < exit.t && count < left.len() {
                left[count] = Some(Span { enter, exit });
                count += 1;
            }
        }
    }
    left
}

fn project_xy(line: &LocalLine) -> LocalLine {
    LocalLine { origin: line.origin.with_z(0.0), direction: line.direction.with_z(0.0) }
}
