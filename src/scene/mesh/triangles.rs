//! A mesh of triangles with shared vertices, checked once when it is made.

use glam::DVec3;

use crate::error::{Error, Result};

/// Triangles over shared vertices. Counter-clockwise seen from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    positions: Vec<DVec3>,
    normals: Option<Vec<DVec3>>,
    uvs: Option<Vec<[f64; 2]>>,
    triangles: Vec<[u32; 3]>,
    dropped: usize,
    closed: bool,
}

impl TriangleMesh {
    /// Makes a mesh. Triangles without area (to rounding) are dropped and counted.
    ///
    /// `normals` (any length but zero) and `uvs` have one value a vertex.
    ///
    /// # Errors
    /// No triangles, no area, an index beyond the vertices, a coordinate that is not finite, or normals or uvs
    /// that are not one a vertex.
    pub fn new(
        positions: Vec<DVec3>,
        normals: Option<Vec<DVec3>>,
        uvs: Option<Vec<[f64; 2]>>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self> {
        if triangles.is_empty() {
            return Err(Error::input("the mesh has no triangles"));
        }
        if let Some(&index) = triangles.iter().flatten().find(|&&index| index as usize >= positions.len()) {
            let count = positions.len();
            return Err(Error::input(format!("a triangle names vertex {index} of {count}"))
                .expected("indices below the number of vertices"));
        }
        if let Some(position) = positions.iter().find(|position| !position.is_finite()) {
            return Err(Error::input(format!("a vertex stands at {position}")).expected("finite coordinates"));
        }
        let one_a_vertex = |count: Option<usize>| count.is_none_or(|count| count == positions.len());
        if !one_a_vertex(normals.as_ref().map(Vec::len)) || !one_a_vertex(uvs.as_ref().map(Vec::len)) {
            return Err(Error::input("the mesh's normals or texture coordinates are not one a vertex"));
        }
        let before = triangles.len();
        let triangles: Vec<_> = triangles.into_iter().filter(|&t| has_area(t.map(|i| positions[i as usize]))).collect();
        if triangles.is_empty() {
            return Err(Error::input("the mesh has no area").expected("triangles whose corners are not in one line"));
        }
        let closed = bounds_a_volume(&positions, &triangles);
        Ok(Self { dropped: before - triangles.len(), closed, positions, normals, uvs, triangles })
    }

    /// Positions of the vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// One normal a vertex, of any length, if the mesh has them.
    pub fn normals(&self) -> Option<&[DVec3]> {
        self.normals.as_deref()
    }

    /// One texture coordinate a vertex, if the mesh has them.
    pub fn uvs(&self) -> Option<&[[f64; 2]]> {
        self.uvs.as_deref()
    }

    /// The vertices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// How many triangles without area were left out.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Corners of a triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|index| self.positions[index as usize])
    }

    /// Total area, in the square of the mesh's unit.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|&t| triangle_normal(self.corners(t)).length() / 2.0).sum()
    }

    /// Enclosed volume of a closed mesh, by the divergence theorem; negative where it is inside out.
    pub fn signed_volume(&self) -> f64 {
        let origin = self.positions[self.triangles[0][0] as usize];
        self.triangles
            .iter()
            .map(|&triangle| {
                let [a, b, c] = self.corners(triangle).map(|corner| corner - origin);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    /// Whether the triangles bound a volume: every edge belongs to exactly two of them, in opposite directions.
    /// Vertices count as one where they stand at the same place.
    pub fn is_closed(&self) -> bool {
        self.closed
    }
}

/// See [`TriangleMesh::is_closed`].
fn bounds_a_volume(positions: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    let places = places(positions);
    // Each use of an edge as (smaller end, larger end, whether it runs from the smaller to the larger).
    let mut uses: Vec<(u32, u32, bool)> = triangles
        .iter()
        .flat_map(|triangle| {
            let [a, b, c] = triangle.map(|index| places[index as usize]);
            [(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from < to))
        })
        .collect();
    uses.sort_unstable();
    let same_edge = |a: &(u32, u32, bool), b: &(u32, u32, bool)| (a.0, a.1) == (b.0, b.1);
    uses.chunk_by(same_edge).all(|edge| edge.len() == 2 && edge[0].2 != edge[1].2)
}

/// For each vertex one of those that stand at the same place, the same for all of them.
fn places(positions: &[DVec3]) -> Vec<u32> {
    // Adding 0 makes −0 and 0 the same place.
    let place = |index: u32| (positions[index as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&index| place(index));
    let mut places = vec![0; positions.len()];
    for same in order.chunk_by(|&a, &b| place(a) == place(b)) {
        for &index in same {
            places[index as usize] = same[0];
        }
    }
    places
}

/// (b − a) × (c − a): normal to the triangle, twice its area long.
pub(crate) fn triangle_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Whether a triangle has an area that is more than the rounding of its own coordinates.
fn has_area(corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners;
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    triangle_normal(corners).length() > 4.0 * f64::EPSILON * longest
}
