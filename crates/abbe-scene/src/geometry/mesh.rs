//! Triangle meshes with shared vertices, validated when they are created.

use glam::{DAffine3, DVec3};
use std::collections::HashMap;

use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::atan2;

/// Triangles over shared vertices, which are counter-clockwise seen from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    positions: Vec<DVec3>,
    normals: Option<Vec<DVec3>>,
    uvs: Option<Vec<[f64; 2]>>,
    triangles: Vec<[u32; 3]>,
    dropped: usize,
    open_edges: usize,
}

impl TriangleMesh {
    /// Creates a mesh without the triangles whose area is zero within rounding, which it counts.
    /// `normals` (of any length except zero) and `uvs` have one value per vertex. Returns an error
    /// if the mesh has no triangles or no area, an index does not refer to a vertex, a coordinate
    /// is not finite, or the number of normals or uvs differs from the number of vertices.
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
            return Err(Error::input(format!("a triangle refers to vertex {index} of {count} vertices"))
                .expected("indices below the number of vertices"));
        }
        if let Some(position) = positions.iter().find(|position| !position.is_finite()) {
            return Err(Error::input(format!("a vertex has the position {position}")).expected("finite coordinates"));
        }
        let one_a_vertex = |count: Option<usize>| count.is_none_or(|count| count == positions.len());
        if !one_a_vertex(normals.as_ref().map(Vec::len)) || !one_a_vertex(uvs.as_ref().map(Vec::len)) {
            return Err(Error::input("the mesh does not have one normal and one texture coordinate per vertex"));
        }
        let before = triangles.len();
        let triangles: Vec<_> = triangles.into_iter().filter(|&t| has_area(t.map(|i| positions[i as usize]))).collect();
        if triangles.is_empty() {
            return Err(Error::input("the mesh has no area").expected("triangles whose corners do not lie on one line"));
        }
        let open_edges = count_open_edges(&positions, &triangles);
        Ok(Self { dropped: before - triangles.len(), open_edges, positions, normals, uvs, triangles })
    }

    #[must_use]
    pub fn reversed(mut self) -> Self {
        self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        self.normals.iter_mut().flatten().for_each(|normal| *normal = -*normal);
        self
    }

    #[must_use]
    pub fn without_normals(self) -> Self {
        Self { normals: None, ..self }
    }

    /// Returns the mesh with vertex normals. Missing ones are the means of the normals of the
    /// triangles around the vertex, weighted by their angles there (Thürmer and Wüthrich 1998).
    #[must_use]
    pub fn with_normals(self) -> Self {
        if self.normals.is_some() {
            return self;
        }
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for &triangle in &self.triangles {
            let corners = self.corners(triangle);
            let normal = triangle_normal(corners).normalize_or_zero();
            for (i, &vertex) in triangle.iter().enumerate() {
                let edges = [corners[(i + 1) % 3], corners[(i + 2) % 3]].map(|corner| corner - corners[i]);
                let angle = atan2(edges[0].cross(edges[1]).length(), edges[0].dot(edges[1]));
                normals[vertex as usize] += angle * normal;
            }
        }
        // A vertex without triangles, or with triangles of opposite normals, has no mean normal.
        normals.iter_mut().for_each(|normal| *normal = normal.normalize_or(DVec3::Z));
        Self { normals: Some(normals), ..self }
    }

    #[must_use]
    pub fn with_flipped_v(mut self) -> Self {
        self.uvs.iter_mut().flatten().for_each(|uv| uv[1] = 1.0 - uv[1]);
        self
    }

    /// Returns the mesh of a closed part of the triangles, with the vertices that they use.
    pub(super) fn part(&self, triangles: &[[u32; 3]]) -> Self {
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let number = |index: u32| used.partition_point(|&other| other < index) as u32;
        Self {
            positions: used.iter().map(|&index| self.positions[index as usize]).collect(),
            normals: self.normals.as_ref().map(|all| used.iter().map(|&index| all[index as usize]).collect()),
            uvs: self.uvs.as_ref().map(|all| used.iter().map(|&index| all[index as usize]).collect()),
            triangles: triangles.iter().map(|triangle| triangle.map(number)).collect(),
            dropped: 0,
            open_edges: 0,
        }
    }

    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The normals (one per vertex, of any length), if the mesh has normals.
    pub fn normals(&self) -> Option<&[DVec3]> {
        self.normals.as_deref()
    }

    /// One texture coordinate per vertex, if the mesh has them.
    pub fn uvs(&self) -> Option<&[[f64; 2]]> {
        self.uvs.as_deref()
    }

    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.positions.as_slice())
            + self.normals.as_deref().map_or(0, size_of_val)
            + self.uvs.as_deref().map_or(0, size_of_val)
            + size_of_val(self.triangles.as_slice())
    }

    /// The number of dropped triangles without area.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|index| self.positions[index as usize])
    }

    /// The total area in the square of the unit of length of the mesh.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|&t| triangle_normal(self.corners(t)).length() / 2.0).sum()
    }

    /// Returns why paths may get lost in a transparent body with this mesh, which `to_world` places
    /// in the scene, or `None` if they do not.
    pub fn fault_as_body(&self, to_world: &DAffine3) -> Option<String> {
        /// The largest ratio of length to width of a triangle in which no path was lost in the
        /// tests. Distances along longer triangles have rounding errors as large as their width.
        const MAX_SLENDERNESS: f64 = 2e7;
        let slenderness = self.slenderness(to_world);
        if !self.is_closed() {
            let count = self.open_edges;
            let edges = if count == 1 { "1 open edge" } else { &format!("{count} open edges") };
            Some(format!("is not closed ({edges}): a ray may enter the body and never leave it"))
        } else if self.signed_volume() < 0.0 {
            Some("faces inwards: its inside counts as the outside".into())
        } else {
            (slenderness > MAX_SLENDERNESS).then(|| {
                format!("has triangles {slenderness:.0e} times as long as wide: a ray may miss them and never leave the body")
            })
        }
    }

    /// Returns the largest ratio of length (the longest edge) to width among the triangles.
    fn slenderness(&self, to_world: &DAffine3) -> f64 {
        let ratio = |&triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle).map(|corner| to_world.transform_vector3(corner));
            let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            longest / triangle_normal([a, b, c]).length()
        };
        self.triangles.iter().map(ratio).fold(0.0, f64::max)
    }

    /// Computes the volume of a closed mesh by the divergence theorem: negative if it faces
    /// inwards.
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

    /// Returns true if the triangles bound a volume: every edge belongs to exactly two triangles
    /// that traverse it in opposite directions. Vertices nearer to each other than 10⁻⁶ of the size
    /// of the mesh count as one vertex, because programs round the two sides of a seam.
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0
    }

    /// The number of edges that keep the mesh from being closed.
    pub fn open_edges(&self) -> usize {
        self.open_edges
    }

    /// Returns the mesh without copies of triangles, which have the same corners as another one in
    /// any order, and the number of copies. Returns `None` if there are none.
    ///
    /// Some programs double all faces with the other winding. A body with such faces has no inside,
    /// because a ray enters and leaves it at the same place. If the mesh is closed without the
    /// copies, those triangles stay that face outwards.
    pub fn without_copies(&self) -> Option<(Self, usize)> {
        // Two copies of one triangle are closed, but have no volume.
        if self.is_closed() && self.signed_volume() != 0.0 {
            return None;
        }
        let representatives = representatives(&self.positions);
        // A use: the corners in rising order, whether this is a turn of the triangle, the number.
        let use_of = |(number, triangle): (usize, &[u32; 3])| {
            let corners = triangle.map(|index| representatives[index as usize]);
            let mut sorted = corners;
            sorted.sort_unstable();
            let first = corners.iter().position(|&corner| corner == sorted[0]).unwrap_or_default();
            (sorted, corners[(first + 1) % 3] == sorted[1], number)
        };
        let mut uses: Vec<([u32; 3], bool, usize)> = self.triangles.iter().enumerate().map(use_of).collect();
        uses.sort_unstable();
        let groups = || uses.chunk_by(|a, b| a.0 == b.0);
        let copies = self.triangles.len() - groups().count();
        if copies == 0 {
            return None;
        }
        // The first triangles of the file, and those with the other winding where there are any.
        let first = |group: &[([u32; 3], bool, usize)]| group.iter().map(|it| it.2).min().unwrap_or_default();
        let other = |group: &[([u32; 3], bool, usize)]| {
            let first = first(group);
            let turn = group.iter().find(|it| it.2 == first).is_some_and(|it| it.1);
            group.iter().find(|it| it.1 != turn).map_or(first, |it| it.2)
        };
        let kept = |mut numbers: Vec<usize>| {
            numbers.sort_unstable();
            let triangles: Vec<[u32; 3]> = numbers.into_iter().map(|number| self.triangles[number]).collect();
            let open_edges = count_open_edges(&self.positions, &triangles);
            Self { triangles, open_edges, ..self.clone() }
        };
        let single = kept(groups().map(first).collect());
        let faces_inwards = single.is_closed() && single.signed_volume() < 0.0;
        Some((if faces_inwards { kept(groups().map(other).collect()) } else { single }, copies))
    }
}

/// Computes [`TriangleMesh::open_edges`].
fn count_open_edges(positions: &[DVec3], triangles: &[[u32; 3]]) -> usize {
    weld(positions, triangles).1
}

/// Maps each vertex to the representative of all vertices that count as one with it, and counts the
/// edges that are open nevertheless.
pub(super) fn weld(positions: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let representatives = representatives(positions);
    let open = open_edges(&representatives, triangles);
    if open.is_empty() {
        return (representatives, 0);
    }
    let welded = welded(positions, representatives, &open);
    let count = open_edges(&welded, triangles).len();
    (welded, count)
}

/// The largest distance of vertices that count as one, as a fraction of the diagonal of the mesh.
const WELDED_FRACTION: f64 = 1e-6;

/// Unites the ends of open edges that are near to each other.
fn welded(positions: &[DVec3], mut representatives: Vec<u32>, open: &[(u32, u32)]) -> Vec<u32> {
    let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let distance = WELDED_FRACTION * (high - low).length();
    // A point lies in one cell, and seldom near others, because cells are much larger.
    let size = 16.0 * distance;
    let cell = |point: DVec3| ((point - low) / size).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut ends: Vec<u32> = open.iter().flat_map(|&(from, to)| [from, to]).collect();
    ends.sort_unstable();
    ends.dedup();
    let mut united: HashMap<u32, u32> = HashMap::new();
    for end in ends {
        let point = positions[end as usize];
        let [from, to] = [-distance, distance].map(|d| cell(point + DVec3::splat(d)));
        let near = (from[0]..=to[0])
            .flat_map(|x| (from[1]..=to[1]).flat_map(move |y| (from[2]..=to[2]).map(move |z| [x, y, z])));
        let is_near = |&known: &u32| positions[known as usize].distance(point) <= distance;
        let known = near.filter_map(|cell| cells.get(&cell)).flatten().copied().find(is_near);
        match known {
            Some(known) => drop(united.insert(end, known)),
            None => cells.entry(cell(point)).or_default().push(end),
        }
    }
    representatives.iter_mut().for_each(|index| *index = united.get(index).copied().unwrap_or(*index));
    representatives
}

/// Returns the edges that do not belong to exactly two triangles that traverse them in opposite
/// directions. Triangles whose corners are not three different vertices do not count.
fn open_edges(representatives: &[u32], triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    // A use: the smaller vertex, the larger, and whether it runs from smaller to larger.
    let mut uses: Vec<(u32, u32, bool)> = triangles
        .iter()
        .map(|triangle| triangle.map(|index| representatives[index as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from < to)))
        .collect();
    uses.sort_unstable();
    let same_edge = |a: &(u32, u32, bool), b: &(u32, u32, bool)| (a.0, a.1) == (b.0, b.1);
    let edges = uses.chunk_by(same_edge).filter(|edge| edge.len() != 2 || edge[0].2 == edge[1].2);
    edges.map(|edge| (edge[0].0, edge[0].1)).collect()
}

/// Maps each vertex to the representative of all vertices at its position.
fn representatives(positions: &[DVec3]) -> Vec<u32> {
    // The addition of 0 changes −0 to 0.
    let place = |index: u32| (positions[index as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&index| place(index));
    let mut representatives = vec![0; positions.len()];
    for same in order.chunk_by(|&a, &b| place(a) == place(b)) {
        for &index in same {
            representatives[index as usize] = same[0];
        }
    }
    representatives
}

/// Returns (b − a) × (c − a), a normal of the triangle whose length is twice the triangle's area.
pub(crate) fn triangle_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Returns true if the area of a triangle exceeds the error caused by rounding of its coordinates.
fn has_area(corners: [DVec3; 3]) -> bool {
    let [a, b, c] = corners;
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    triangle_normal(corners).length() > 4.0 * f64::EPSILON * longest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two long three-sided pyramids on a common base.
    fn needle(width: f64) -> TriangleMesh {
        let around = |i: f64| DVec3::new(width * (i * 2.1).cos(), 0.0, width * (i * 2.1).sin());
        let corners = vec![DVec3::Y, DVec3::NEG_Y, around(0.0), around(1.0), around(2.0)];
        let triangles = vec![[0, 3, 2], [0, 4, 3], [0, 2, 4], [1, 2, 3], [1, 3, 4], [1, 4, 2]];
        TriangleMesh::new(corners, None, None, triangles).expect("a needle is a mesh")
    }

    #[test]
    fn a_transparent_needle_of_1e9_to_1_is_reported() {
        assert_eq!(needle(1e-7).fault_as_body(&DAffine3::IDENTITY), None);
        let fault = needle(1e-9).fault_as_body(&DAffine3::IDENTITY).expect("the needle is too long");
        assert!(fault.contains("times as long as wide"), "{fault}");
        let stretched = needle(1e-3).fault_as_body(&DAffine3::from_scale(DVec3::new(1.0, 1e6, 1.0)));
        assert!(stretched.is_some(), "the transform counts");
    }

    fn tetrahedron(corners: [DVec3; 4], own: impl Fn(usize) -> DVec3) -> TriangleMesh {
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3_usize]];
        let positions = faces.iter().flatten().enumerate().map(|(i, &corner)| corners[corner] + own(i)).collect();
        TriangleMesh::new(positions, None, None, (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
    }

    /// Programs round the vertices on the two sides of a seam.
    #[test]
    fn rounded_seams_are_closed() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|corner| 3.0 * corner + DVec3::splat(7.0));
        for (gap, closed) in [(0.0, true), (2e-16, true), (1e-7, true), (1e-6, true), (1e-4, false)] {
            let mesh = tetrahedron(corners, |i| DVec3::splat(gap * (i % 4) as f64));
            assert_eq!(mesh.is_closed(), closed, "{gap}: {} open edges", mesh.open_edges());
        }
        let mesh = TriangleMesh::new(corners.to_vec(), None, None, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2]]).unwrap();
        assert_eq!(mesh.open_edges(), 3);
        assert!(mesh.fault_as_body(&DAffine3::IDENTITY).unwrap().contains("3 open edges"));
    }

    /// Doubled faces are dropped. The rest faces outwards, whichever copy comes first.
    #[test]
    fn copies_of_faces_are_dropped() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3_u32]];
        let inwards = faces.map(|[a, b, c]| [b, a, c]);
        let new = |triangles: Vec<[u32; 3]>| TriangleMesh::new(corners.to_vec(), None, None, triangles).unwrap();
        for (first, second) in [(faces, inwards), (inwards, faces), (faces, faces)] {
            let doubled = new([first, second].concat());
            assert!(!doubled.is_closed());
            let (single, copies) = doubled.without_copies().unwrap();
            assert_eq!((copies, single.triangles().len(), single.is_closed()), (4, 4, true));
            assert!((single.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
        }
        assert_eq!(new(faces.to_vec()).without_copies(), None);
        let (pane, copies) = new(vec![[0, 1, 2], [0, 2, 1]]).without_copies().unwrap();
        assert_eq!((pane.triangles(), copies, pane.open_edges()), (&[[0, 1, 2]][..], 1, 3));
    }

    /// At the first vertex, the triangle on the wall counts as much as the two on the floor.
    #[test]
    fn computed_normals_are_weighted_by_angles() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 1.0, 0.0)];
        let triangles = vec![[0, 3, 1], [0, 1, 4], [0, 4, 2]];
        let mesh = TriangleMesh::new(positions.to_vec(), None, None, triangles).unwrap().with_normals();
        let normals = mesh.normals().unwrap();
        assert!((normals[0] - DVec3::new(0.0, 1.0, 1.0).normalize()).length() < 1e-12, "{}", normals[0]);
        assert!((normals[2] - DVec3::Z).length() < 1e-12, "{}", normals[2]);
        let own = vec![DVec3::X; 5];
        let with_own = TriangleMesh::new(positions.to_vec(), Some(own.clone()), None, vec![[0, 3, 1]]).unwrap();
        assert_eq!(with_own.with_normals().normals(), Some(own.as_slice()));
    }
}
