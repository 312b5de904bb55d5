//! The lens: two spherical or plane surfaces and a cylindrical edge; faces 0 front, 1 back, 2 edge.
//!
//! It is built from convex sets: the edge's cylinder and the half-spaces or balls that the surfaces bound. A
//! surface that bulges outwards keeps what is inside its set, a hollow one takes it away. A line meets each
//! convex set in one span, and spans combine on the line, so that entering and leaving alternate and the faces
//! meet at their rims without a gap.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::line::{Crossing, Line, Span, ball_roots, chord, ordered_roots};
use super::solid::LocalSurface;

const FRONT: u32 = 0;
const BACK: u32 = 1;
const EDGE: u32 = 2;

/// One of the two surfaces, and the convex set behind it: its ball, continued beyond the ball's centre as the
/// half-space there (so that a thick lens is not cut by the far side of its own ball), or a plane's half-space.
#[derive(Debug, Clone, Copy)]
struct Cap {
    face: u32,
    /// Where the surface meets the axis.
    vertex_z: f64,
    /// Radius of the ball, or `None` for a plane.
    radius: Option<f64>,
    /// Direction along z from the set outwards at the vertex, ±1.
    outward: f64,
    /// Whether the lens is what is inside the set (bulging or plane) or outside it (hollow).
    kept: bool,
}

/// A lens about the z axis, the front vertex at the origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lens {
    front: Cap,
    back: Cap,
    edge_radius: f64,
}

impl Lens {
    pub(crate) const FACES: u32 = 3;

    /// Radii as in the scene file: positive where the centre lies towards +z, 0 for a plane.
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

    /// z of the rim of the front and of the back surface.
    pub(crate) fn rims(&self) -> (f64, f64) {
        (self.front.rim_z(self.edge_radius), self.back.rim_z(self.edge_radius))
    }

    /// How far the lens reaches along a direction of any length: the largest p·direction over its points p.
    pub(crate) fn reach(&self, direction: DVec3) -> f64 {
        let across = self.edge_radius * direction.x.hypot(direction.y);
        let (front, back) = self.rims();
        let rims = across + (front * direction.z).max(back * direction.z);
        let caps = [&self.front, &self.back].into_iter().filter(|cap| cap.kept);
        caps.filter_map(|cap| cap.reach(direction, self.edge_radius)).fold(rims, f64::max)
    }

    pub(crate) fn next(&self, line: &Line, on: Option<u32>, after: f64) -> Option<Crossing> {
        match on {
            Some(face) => self.next_from(line, face),
            None => self.next_crossing(line, after),
        }
    }

    /// What is inside the kept sets, on the line.
    fn kept(&self, line: &Line) -> Option<Span> {
        let mut span = Span::of_face(ball_roots(&across(line), self.edge_radius)?, EDGE);
        for cap in [&self.front, &self.back] {
            if cap.kept {
                span = span.intersection(cap.span(line)?)?;
            }
        }
        Some(span)
    }

    fn next_crossing(&self, line: &Line, after: f64) -> Option<Crossing> {
        let mut pieces = [Some(self.kept(line)?), None, None];
        for cap in [&self.front, &self.back] {
            if let Some(hollow) = Some(cap).filter(|cap| !cap.kept).and_then(|cap| cap.span(line)) {
                pieces = without(pieces, hollow);
            }
        }
        pieces.iter().flatten().find_map(|piece| piece.next(after))
    }

    fn next_from(&self, line: &Line, start: u32) -> Option<Crossing> {
        // How the line stands to the set it starts on: the t at which it leaves that set again if it goes into
        // it, negative if it goes out.
        let (kept, stays) = match start {
            EDGE => (true, chord(&across(line))),
            FRONT => (self.front.kept, self.front.stays(line)),
            _ => (self.back.kept, self.back.stays(line)),
        };
        let into_set = stays > 0.0;
        if kept == into_set {
            return self.exit_from(line, start, stays);
        }
        if kept {
            return None; // The lens lies inside each kept set, which is convex: no way back.
        }
        self.entry_from(line, start, stays)
    }

    /// The line starts on a face and goes into the glass: the first way out. A start that rounding put beyond
    /// another face leaves at once.
    fn exit_from(&self, line: &Line, start: u32, stays: f64) -> Option<Crossing> {
        let edge = if start == EDGE { stays } else { ball_roots(&across(line), self.edge_radius).map_or(0.0, |r| r.1) };
        let mut exit = Crossing { t: edge, face: EDGE };
        for cap in [&self.front, &self.back] {
            let leaves = match (cap.face == start, cap.kept) {
                (true, true) => Some(Crossing { t: stays, face: cap.face }),
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

    /// The line starts on a hollow face and goes into the hollow: where it meets the glass again, if it does.
    fn entry_from(&self, line: &Line, start: u32, stays: f64) -> Option<Crossing> {
        let mut entry = Crossing { t: stays, face: start };
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

    pub(crate) fn surface(&self, point: DVec3, face: u32) -> LocalSurface {
        let planar = [0.5 + 0.5 * point.x / self.edge_radius, 0.5 + 0.5 * point.y / self.edge_radius];
        match face {
            FRONT => self.front.surface(point, planar),
            BACK => self.back.surface(point, planar),
            _ => {
                let normal = point.with_z(0.0).normalize_or(DVec3::X);
                let u = (normal.y.atan2(normal.x) / TAU).rem_euclid(1.0);
                let (z0, z1) = self.rims();
                let v = (point.z - z0) / (z1 - z0).max(f64::MIN_POSITIVE);
                LocalSurface { point: (self.edge_radius * normal).with_z(point.z), normal, uv: [u, v] }
            }
        }
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
        let (sin, cos) = (TAU * u[1]).sin_cos();
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
    /// z of the ball's centre, or of the plane.
    fn centre_z(&self) -> f64 {
        self.vertex_z - self.outward * self.radius.unwrap_or(0.0)
    }

    /// Height of the cap over a disk of the given radius, written so that flat caps keep their digits.
    fn sagitta(&self, disk_radius: f64) -> f64 {
        self.radius.map_or(0.0, |radius| {
            let root = ((radius - disk_radius) * (radius + disk_radius)).max(0.0).sqrt();
            disk_radius * disk_radius / (radius + root)
        })
    }

    fn rim_z(&self, edge_radius: f64) -> f64 {
        self.vertex_z - self.outward * self.sagitta(edge_radius)
    }

    /// How far the ball reaches along a direction, if it does so in the cap and not at its rim.
    fn reach(&self, direction: DVec3, edge_radius: f64) -> Option<f64> {
        let radius = self.radius?;
        let sin = edge_radius / radius;
        let in_cap = self.outward * direction.z >= direction.length() * ((1.0 - sin) * (1.0 + sin)).max(0.0).sqrt();
        // From the vertex, so that a flat cap keeps its digits: r(|d| − d·axis) = r|d across|²/(|d| + d·axis).
        let along = self.outward * direction.z;
        let bulge = radius * direction.with_z(0.0).length_squared() / (direction.length() + along);
        in_cap.then_some(self.vertex_z * direction.z + bulge)
    }

    /// The span of the line inside the set.
    fn span(&self, line: &Line) -> Option<Span> {
        let Some((first, second)) = self.radius.and_then(|radius| self.roots(line, radius)) else {
            return self.half_space(line);
        };
        // A root counts where it lies on the half of the ball that is the surface.
        let on_cap = |t: f64| self.outward * (line.at(t).z - self.centre_z()) >= 0.0;
        match (on_cap(first), on_cap(second)) {
            (true, true) => Some(Span::of_face((first, second), self.face)),
            (true, false) => Some(Span::of_face((first, f64::INFINITY), self.face)),
            (false, true) => Some(Span::of_face((f64::NEG_INFINITY, second), self.face)),
            (false, false) => self.half_space(line),
        }
    }

    /// Roots on the ball, relative to the vertex and to the line's point nearest to it: nothing then is as large
    /// as the radius of curvature, and nearly flat surfaces keep their digits.
    fn roots(&self, line: &Line, radius: f64) -> Option<(f64, f64)> {
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

    /// The span inside the half-space behind the plane, or behind the ball's centre.
    fn half_space(&self, line: &Line) -> Option<Span> {
        let height = self.outward * (line.origin.z - self.centre_z());
        let speed = self.outward * line.direction.z;
        if speed == 0.0 {
            return (height <= 0.0).then(|| Span::of_face((f64::NEG_INFINITY, f64::INFINITY), self.face));
        }
        let t = -height / speed;
        let roots = if speed > 0.0 { (f64::NEG_INFINITY, t) } else { (t, f64::INFINITY) };
        Some(Span::of_face(roots, self.face))
    }

    /// For a line that starts on this surface: the t at which it leaves the set again if it goes into it (∞ if
    /// it never does), negative if it goes out of it.
    fn stays(&self, line: &Line) -> f64 {
        let Some(radius) = self.radius else {
            return if self.outward * line.direction.z < 0.0 { f64::INFINITY } else { -1.0 };
        };
        let centre = DVec3::new(0.0, 0.0, self.centre_z());
        let t = chord(&Line { origin: line.origin - centre, ..*line });
        let on_cap = self.outward * (line.at(t).z - centre.z) >= 0.0 && radius > 0.0;
        if t > 0.0 && !on_cap { f64::INFINITY } else { t }
    }

    fn surface(&self, point: DVec3, planar: [f64; 2]) -> LocalSurface {
        let outwards = if self.kept { 1.0 } else { -1.0 };
        let Some(radius) = self.radius else {
            let normal = DVec3::new(0.0, 0.0, self.outward * outwards);
            return LocalSurface { point: point.with_z(self.vertex_z), normal, uv: planar };
        };
        let centre = DVec3::new(0.0, 0.0, self.centre_z());
        let radial = (point - centre).normalize_or(DVec3::new(0.0, 0.0, self.outward));
        let across = point.with_z(0.0).length();
        // z from the sagitta, since adding the radius to the centre's z would lose the digits of a flat surface;
        // along the radius where the surface is steep.
        let snapped = if across < 0.7 * radius {
            point.with_z(self.vertex_z - self.outward * self.sagitta(across))
        } else {
            centre + radius * radial
        };
        LocalSurface { point: snapped, normal: outwards * radial, uv: planar }
    }

    fn area(&self, edge_radius: f64) -> f64 {
        self.radius.map_or(PI * edge_radius * edge_radius, |radius| TAU * radius * self.sagitta(edge_radius))
    }

    /// Uniform on the cap: Archimedes' equal areas for equal heights.
    fn sample(&self, edge_radius: f64, u: f64, sin: f64, cos: f64) -> DVec3 {
        let height = u * self.sagitta(edge_radius);
        let ring =
            self.radius.map_or(edge_radius * u.sqrt(), |radius| (height * (2.0 * radius - height)).max(0.0).sqrt());
        DVec3::new(ring * cos, ring * sin, self.vertex_z - self.outward * height)
    }
}

/// The pieces, less what is inside a convex hollow.
fn without(pieces: [Option<Span>; 3], hollow: Span) -> [Option<Span>; 3] {
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

/// The line seen along the axis.
fn across(line: &Line) -> Line {
    Line { origin: line.origin.with_z(0.0), direction: line.direction.with_z(0.0) }
}
