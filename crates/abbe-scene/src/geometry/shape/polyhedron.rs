//! Box and prism: intersections of half-spaces, one per face. A line enters the body at the last of
//! its entries into half-spaces, and leaves it at the first of its exits, so entries and exits
//! alternate by construction, also at edges and corners.

use glam::DVec3;

use super::local::{Crossing, LocalLine, LocalSurfacePoint};
use abbe_spectra::math::elementary::sin_cos;

/// The half-space of all points x with normal·x ≤ offset.
#[derive(Debug, Clone, Copy)]
struct HalfSpace {
    normal: DVec3,
    offset: f64,
}

/// The face in its plane: the parallelogram of two edges at a corner, or half of it.
#[derive(Debug, Clone, Copy)]
struct FaceOutline {
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    triangle: bool,
}

#[derive(Debug, Clone)]
pub(crate) struct Polyhedron {
    half_spaces: Vec<HalfSpace>,
    facets: Vec<FaceOutline>,
}

impl Polyhedron {
    pub(crate) fn contains(&self, point: DVec3) -> bool {
        self.half_spaces.iter().all(|half_space| half_space.normal.dot(point) < half_space.offset)
    }

    /// Creates a box centred on the origin. Faces: −x, +x, −y, +y, −z, +z. Seen from outside, the
    /// texture coordinate u points to the right. On the upright faces, v points down.
    pub(crate) fn cuboid(size: DVec3) -> Self {
        let half = 0.5 * size;
        let mut body = Self { half_spaces: Vec::with_capacity(6), facets: Vec::with_capacity(6) };
        for (normal, u, v) in [
            (DVec3::NEG_X, DVec3::Z, DVec3::NEG_Y),
            (DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y),
            (DVec3::NEG_Y, DVec3::X, DVec3::NEG_Z),
            (DVec3::Y, DVec3::X, DVec3::Z),
            (DVec3::NEG_Z, DVec3::NEG_X, DVec3::NEG_Y),
            (DVec3::Z, DVec3::X, DVec3::NEG_Y),
        ] {
            let (edge_u, edge_v) = (size * u, size * v);
            let corner = half * (normal - u - v);
            body.push(normal, half.dot(normal.abs()), FaceOutline { corner, edge_u, edge_v, triangle: false });
        }
        body
    }

    /// Creates a triangular prism. Faces: right leg (+x), left leg (−x), base, −z, +z.
    pub(crate) fn prism(side: f64, length: f64, apex_deg: f64) -> Self {
        let (sin, cos) = sin_cos(0.5 * apex_deg.to_radians());
        let (half_base, height) = (side * sin, side * cos);
        let z = -0.5 * length;
        let top = DVec3::new(0.0, height * (2.0 / 3.0), z);
        let right = DVec3::new(half_base, -height / 3.0, z);
        let left = DVec3::new(-half_base, -height / 3.0, z);
        let along = DVec3::new(0.0, 0.0, length);
        let mut body = Self { half_spaces: Vec::with_capacity(5), facets: Vec::with_capacity(5) };
        // The apex angle determines the normals of the legs, and the apex their common offset, so
        // that both planes contain the same line at the apex.
        let (leg_right, leg_left) = (DVec3::new(cos, sin, 0.0), DVec3::new(-cos, sin, 0.0));
        let parallelogram = |corner, edge_u, edge_v| FaceOutline { corner, edge_u, edge_v, triangle: false };
        body.push(leg_right, leg_right.dot(top), parallelogram(top + along, -along, right - top));
        body.push(leg_left, leg_left.dot(top), parallelogram(top, along, left - top));
        body.push(DVec3::NEG_Y, height / 3.0, parallelogram(left + along, right - left, -along));
        let end = |corner: DVec3| FaceOutline { corner, edge_u: right - left, edge_v: top - left, triangle: true };
        body.push(DVec3::NEG_Z, 0.5 * length, end(left));
        body.push(DVec3::Z, 0.5 * length, end(left + along));
        body
    }

    fn push(&mut self, normal: DVec3, offset: f64, facet: FaceOutline) {
        self.half_spaces.push(HalfSpace { normal, offset });
        self.facets.push(facet);
    }

    pub(crate) fn next_crossing(&self, line: &LocalLine, start_face: Option<u32>, after: f64) -> Option<Crossing> {
        match start_face {
            Some(face) => self.exit_from(line, face),
            None => self.crossing_after(line, after),
        }
    }

    fn crossing_after(&self, line: &LocalLine, after: f64) -> Option<Crossing> {
        let mut enter = Crossing { t: f64::NEG_INFINITY, face: 0 };
        let mut exit = Crossing { t: f64::INFINITY, face: 0 };
        for (face, half_space) in (0..).zip(&self.half_spaces) {
            let depth = half_space.offset - half_space.normal.dot(line.origin);
            let speed = half_space.normal.dot(line.direction);
            if speed < 0.0 {
                let t = depth / speed;
                if t > enter.t {
                    enter = Crossing { t, face };
                }
            } else if speed > 0.0 {
                let t = depth / speed;
                if t < exit.t {
                    exit = Crossing { t, face };
                }
            } else if depth < 0.0 {
                return None;
            }
        }
        if enter.t > exit.t {
            return None;
        }
        if enter.t > after { Some(enter) } else { Some(exit).filter(|exit| exit.t > after) }
    }

    /// Returns the exit of a line that starts on a face, or `None` if the line points out of the
    /// body. If rounding places the start beyond another face, the exit is at t = 0.
    fn exit_from(&self, line: &LocalLine, start: u32) -> Option<Crossing> {
        if self.half_spaces[start as usize].normal.dot(line.direction) >= 0.0 {
            return None;
        }
        let mut exit = Crossing { t: f64::INFINITY, face: start };
        for (face, half_space) in (0..).zip(&self.half_spaces) {
            let speed = half_space.normal.dot(line.direction);
            if face == start || speed <= 0.0 {
                continue;
            }
            let t = (half_space.offset - half_space.normal.dot(line.origin)) / speed;
            if t < exit.t {
                exit = Crossing { t: t.max(0.0), face };
            }
        }
        (exit.t < f64::INFINITY).then_some(exit)
    }

    pub(crate) fn surface(&self, point: DVec3, face: u32) -> LocalSurfacePoint {
        let HalfSpace { normal, offset } = self.half_spaces[face as usize];
        LocalSurfacePoint { point: point + (offset - normal.dot(point)) * normal, normal }
    }

    pub(crate) fn uv(&self, point: DVec3, face: u32) -> [f64; 2] {
        let facet = &self.facets[face as usize];
        let along = |edge: DVec3| (point - facet.corner).dot(edge) / edge.length_squared();
        [along(facet.edge_u), along(facet.edge_v)]
    }

    pub(crate) fn faces(&self) -> u32 {
        self.facets.len() as u32
    }

    pub(crate) fn area(&self, face: u32) -> f64 {
        let facet = &self.facets[face as usize];
        let parallelogram = facet.edge_u.cross(facet.edge_v).length();
        if facet.triangle { 0.5 * parallelogram } else { parallelogram }
    }

    pub(crate) fn sample(&self, face: u32, u: [f64; 2]) -> DVec3 {
        let facet = &self.facets[face as usize];
        let [mut s, mut t] = u;
        if facet.triangle && s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        facet.corner + s * facet.edge_u + t * facet.edge_v
    }

    /// Iterates over the corners, each at least once.
    pub(crate) fn corners(&self) -> impl Iterator<Item = DVec3> {
        self.facets.iter().flat_map(|facet| {
            let far = if facet.triangle { facet.corner } else { facet.corner + facet.edge_u + facet.edge_v };
            [facet.corner, facet.corner + facet.edge_u, facet.corner + facet.edge_v, far]
        })
    }
}
