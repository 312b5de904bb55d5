//! The convex polyhedron behind all of a set of planes.
//!
//! A large cube is cut by one plane after the other. Faces share their vertices, so the surface
//! stays closed. At the end, short edges shrink to points, so that planes which meet in one point up
//! to rounding have one vertex there.

use glam::{DMat3, DVec3};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// A plane with the unit normal `normal`, at a signed distance from the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) distance: f64,
}

impl Plane {
    /// Returns the distance of a point in front of the plane.
    pub(super) fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.distance
    }
}

/// A face of a polyhedron.
#[derive(Debug)]
pub(super) struct Face {
    /// The number of the plane.
    pub(super) plane: usize,
    /// The vertices, counter-clockwise seen from outside.
    pub(super) corners: Vec<u32>,
}

#[derive(Debug)]
pub(super) struct Polyhedron {
    pub(super) vertices: Vec<DVec3>,
    pub(super) faces: Vec<Face>,
}

/// Why planes do not enclose a body.
#[derive(Debug)]
pub(super) enum Fault {
    /// Nothing remains behind the plane with this number.
    Empty(usize),
    /// The face of the plane with this number is no polygon: the body is about as thin as the
    /// tolerance.
    Tangled(usize),
    /// The planes are open in this direction.
    Open(DVec3),
}

/// Intersects the half-spaces behind the planes. Edges shorter than `shortest` become points.
pub(super) fn intersection(planes: &[Plane], shortest: f64) -> Result<Polyhedron, Fault> {
    // A vertex this near to a plane counts as a vertex on it.
    let tolerance = 1e-3 * shortest;
    let farthest = planes.iter().map(|plane| plane.distance.abs()).fold(0.0, f64::max);
    let mut solid = Polyhedron::cube(1e3 * farthest, planes.len());
    for (number, plane) in planes.iter().enumerate() {
        solid.cut(number, plane, tolerance)?;
    }
    if let Some(face) = solid.faces.iter().find(|face| face.plane >= planes.len()) {
        return Err(Fault::Open(cube_normal(face.plane - planes.len())));
    }
    solid.contract(shortest);
    solid.adjust(planes, shortest);
    Ok(solid)
}

/// Returns the outward normal of a face of the cube, from 0 to 5.
fn cube_normal(face: usize) -> DVec3 {
    let sign = if face.is_multiple_of(2) { -1.0 } else { 1.0 };
    sign * DVec3::AXES[face / 2]
}

impl Polyhedron {
    /// Makes a cube around the origin, whose faces count as planes from the number `first` on.
    fn cube(half: f64, first: usize) -> Self {
        let corner = |i: u32| DVec3::from_array([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -half } else { half }));
        let corners =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]].map(Vec::from);
        let faces = (first..).zip(corners).map(|(plane, corners)| Face { plane, corners });
        Self { vertices: (0..8).map(corner).collect(), faces: faces.collect() }
    }

    /// Cuts off what lies in front of a plane. If nothing does, the plane has no face.
    fn cut(&mut self, number: usize, plane: &Plane, tolerance: f64) -> Result<(), Fault> {
        let heights: Vec<f64> = self.vertices.iter().map(|&vertex| plane.height(vertex)).collect();
        let mut sides: Vec<Ordering> = heights
            .iter()
            .map(|&height| if height.abs() <= tolerance { Ordering::Equal } else { height.total_cmp(&0.0) })
            .collect();
        if !sides.contains(&Ordering::Greater) {
            return Ok(());
        }
        if !sides.contains(&Ordering::Less) {
            return Err(Fault::Empty(number));
        }
        let mut crossings: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let vertices = &mut self.vertices;
        for face in &mut self.faces {
            let corners = std::mem::take(&mut face.corners);
            if !corners.iter().any(|&corner| sides[corner as usize].is_lt()) {
                continue;
            }
            for (position, &corner) in corners.iter().enumerate() {
                let next = corners[(position + 1) % corners.len()];
                if sides[corner as usize].is_le() {
                    face.corners.push(corner);
                }
                if sides[corner as usize] as i8 * sides[next as usize] as i8 == -1 {
                    let ends = [corner.min(next), corner.max(next)];
                    let crossing = *crossings.entry(ends).or_insert_with(|| {
                        let [a, b] = ends.map(|end| end as usize);
                        let fraction = heights[a] / (heights[a] - heights[b]);
                        vertices.push(vertices[a].lerp(vertices[b], fraction));
                        (vertices.len() - 1) as u32
                    });
                    face.corners.push(crossing);
                }
            }
        }
        sides.resize(self.vertices.len(), Ordering::Equal);
        self.faces.retain(|face| !face.corners.is_empty());
        let corners = self.opening(&sides).ok_or(Fault::Tangled(number))?;
        self.faces.push(Face { plane: number, corners });
        self.drop_unused();
        Ok(())
    }

    /// Returns the polygon that closes the surface, or `None` if the opening is no single polygon.
    fn opening(&self, sides: &[Ordering]) -> Option<Vec<u32>> {
        let mut edges = BTreeSet::new();
        for face in &self.faces {
            let next = face.corners.iter().cycle().skip(1);
            let edge = face.corners.iter().zip(next).map(|(&from, &to)| (from, to));
            edges.extend(edge.filter(|&(from, to)| sides[from as usize].is_eq() && sides[to as usize].is_eq()));
        }
        let mut following = BTreeMap::new();
        for &(from, to) in edges.iter().filter(|&&(from, to)| !edges.contains(&(to, from))) {
            if following.insert(to, from).is_some() {
                return None;
            }
        }
        let (&first, _) = following.first_key_value()?;
        let mut corners = vec![first];
        while let Some(next) = following.remove(corners.last()?) {
            if next == first {
                break;
            }
            corners.push(next);
        }
        (following.is_empty() && corners.len() >= 3).then_some(corners)
    }

    /// Removes the vertices that no face has.
    fn drop_unused(&mut self) {
        let mut number: Vec<Option<u32>> = vec![None; self.vertices.len()];
        self.faces.iter().flat_map(|face| &face.corners).for_each(|&corner| number[corner as usize] = Some(0));
        let mut used = Vec::new();
        for (vertex, number) in self.vertices.iter().zip(&mut number) {
            if number.is_some() {
                *number = Some(used.len() as u32);
                used.push(*vertex);
            }
        }
        self.vertices = used;
        let corners = self.faces.iter_mut().flat_map(|face| &mut face.corners);
        corners.for_each(|corner| *corner = number[*corner as usize].unwrap_or_default());
    }

    /// Shrinks edges shorter than `shortest` to points. Faces without an area vanish.
    fn contract(&mut self, shortest: f64) {
        let mut target: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let root = |target: &[u32], mut vertex: u32| {
            while target[vertex as usize] != vertex {
                vertex = target[vertex as usize];
            }
            vertex
        };
        for face in &self.faces {
            for (&from, &to) in face.corners.iter().zip(face.corners.iter().cycle().skip(1)) {
                let [a, b] = [from, to].map(|end| self.vertices[end as usize]);
                if a.distance(b) < shortest {
                    let [a, b] = [from, to].map(|end| root(&target, end));
                    target[a.max(b) as usize] = a.min(b);
                }
            }
        }
        for face in &mut self.faces {
            face.corners.iter_mut().for_each(|corner| *corner = root(&target, *corner));
            face.corners.dedup();
            if face.corners.len() > 1 && face.corners.first() == face.corners.last() {
                face.corners.pop();
            }
        }
        self.faces.retain(|face| face.corners.len() >= 3);
        self.drop_unused();
    }

    /// Moves each vertex to the point with the least squared distances from its planes, so that it
    /// does not depend on the order of the cuts. A vertex moves by ten times `shortest` at most.
    fn adjust(&mut self, planes: &[Plane], shortest: f64) {
        let mut squares = vec![(DMat3::ZERO, DVec3::ZERO); self.vertices.len()];
        for face in &self.faces {
            let plane = &planes[face.plane];
            for &corner in &face.corners {
                let (matrix, gap) = &mut squares[corner as usize];
                let [x, y, z] = plane.normal.to_array().map(|component| plane.normal * component);
                *matrix += DMat3::from_cols(x, y, z);
                *gap -= plane.normal * plane.height(self.vertices[corner as usize]);
            }
        }
        for (vertex, (matrix, gap)) in self.vertices.iter_mut().zip(squares) {
            let shift = matrix.inverse() * gap;
            // Planes that are almost parallel leave the vertex undetermined.
            if matrix.determinant() > 1e-9 && shift.length() < 10.0 * shortest {
                *vertex += shift;
            }
        }
    }

    /// Returns the numbers of the planes that have no face and coincide with no plane that has one.
    pub(super) fn untouched(&self, planes: &[Plane], tolerance: f64) -> Vec<usize> {
        let mut has_face = vec![false; planes.len()];
        self.faces.iter().for_each(|face| has_face[face.plane] = true);
        let is_same = |a: &Plane, b: &Plane| {
            (a.normal - b.normal).length() <= 1e-6 && (a.distance - b.distance).abs() <= tolerance
        };
        let coincides = |plane: &Plane| self.faces.iter().any(|face| is_same(&planes[face.plane], plane));
        (0..planes.len()).filter(|&number| !has_face[number] && !coincides(&planes[number])).collect()
    }
}
