//! Splits polygons into triangles.

use super::part::fan;
use earcut::Earcut;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Splits polygons over shared vertices into triangles.
pub(super) struct PolygonSplitter<'p> {
    positions: &'p [DVec3],
    ears: Earcut<f64>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The number of polygons whose triangles do not fill them: they cross themselves.
    crossing: usize,
}

impl<'p> PolygonSplitter<'p> {
    pub(super) fn new(positions: &'p [DVec3]) -> Self {
        Self { positions, ears: Earcut::new(), triangles: Vec::new(), crossing: 0 }
    }

    /// Adds the triangles of a polygon, which may be concave. Its corners may lie on one line, and
    /// each corner remains a corner of a triangle, so that no gap opens to the next polygon.
    ///
    /// A polygon that all diagonals from its first corner divide becomes this fan. Other polygons
    /// are projected along the axis that is nearest to their normal, and their ears are cut off.
    pub(super) fn add(&mut self, polygon: &[u32]) {
        if let &[a, b, c] = polygon {
            self.triangles.push([a, b, c]);
            return;
        }
        let corner = |&index: &u32| self.positions.get(index as usize).copied();
        // An index without a vertex is an error of the mesh, which names it.
        let corners: Option<Vec<DVec3>> = polygon.iter().map(corner).collect();
        let Some(corners) = corners.filter(|corners| !is_star(corners)) else {
            self.triangles.extend(fan(polygon));
            return;
        };
        let plane = projected(&corners);
        let mut cut: Vec<u32> = Vec::new();
        self.ears.earcut(plane.iter().map(|corner| corner.to_array()), &[], &mut cut);
        let mut triangles: Vec<[u32; 3]> = cut.as_chunks::<3>().0.to_vec();
        for triangle in &mut triangles {
            if twice_area(&plane, *triangle) < 0.0 {
                triangle.swap(1, 2);
            }
        }
        insert_unused(&plane, &mut triangles);
        let filled: f64 = triangles.iter().map(|&triangle| twice_area(&plane, triangle)).sum();
        let whole: f64 = fan(&numbers(plane.len())).map(|triangle| twice_area(&plane, triangle)).sum();
        if (filled - whole).abs() > 1e-6 * whole.abs() || triangles.is_empty() {
            self.crossing += 1;
        }
        if triangles.is_empty() {
            self.triangles.extend(fan(polygon));
        }
        self.triangles.extend(triangles.iter().map(|triangle| triangle.map(|index| polygon[index as usize])));
    }

    /// Returns a sentence about the polygons whose shape is ambiguous.
    pub(super) fn note(&self) -> Option<String> {
        let count = self.crossing;
        let kind = if count == 1 { "polygon crosses itself" } else { "polygons cross themselves" };
        (count > 0).then(|| format!("{count} {kind}, so its shape is ambiguous; export the mesh as triangles"))
    }
}

fn numbers(count: usize) -> Vec<u32> {
    (0..count as u32).collect()
}

/// Returns the area vector of a polygon, whose length is twice the area (Newell's formula).
fn area_vector(corners: &[DVec3]) -> DVec3 {
    let first = corners[0];
    corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum()
}

/// Returns whether the triangles between the first corner and each edge fill the polygon: all of
/// them have an area, and face the same way.
fn is_star(corners: &[DVec3]) -> bool {
    if corners.len() < 3 {
        return true;
    }
    let normal = area_vector(corners).normalize_or_zero();
    corners[1..].windows(2).all(|pair| {
        let edges = [pair[0] - corners[0], pair[1] - corners[0]];
        let longest = edges[0].length_squared().max(edges[1].length_squared());
        edges[0].cross(edges[1]).dot(normal) > 1e-12 * longest
    })
}

/// Projects a polygon along an axis, so that its corners are counter-clockwise.
fn projected(corners: &[DVec3]) -> Vec<DVec2> {
    let normal = area_vector(corners);
    let size = normal.abs();
    let plane = |corner: &DVec3| match (size.x >= size.y && size.x >= size.z, size.y >= size.z) {
        (true, _) => DVec2::new(corner.y, corner.z) * DVec2::new(normal.x.signum(), 1.0),
        (false, true) => DVec2::new(corner.z, corner.x) * DVec2::new(normal.y.signum(), 1.0),
        (false, false) => DVec2::new(corner.x, corner.y) * DVec2::new(normal.z.signum(), 1.0),
    };
    // Numbers near 0 keep the precision of the shape.
    let first = plane(&corners[0]);
    corners.iter().map(|corner| plane(corner) - first).collect()
}

fn twice_area(plane: &[DVec2], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|index| plane[index as usize]);
    (b - a).perp_dot(c - a)
}

/// Divides triangles at the corners that cutting left out because they lie on an edge.
fn insert_unused(plane: &[DVec2], triangles: &mut Vec<[u32; 3]>) {
    let count = plane.len();
    let mut is_used = vec![false; count];
    triangles.iter().flatten().for_each(|&index| is_used[index as usize] = true);
    if is_used.iter().all(|used| *used) {
        return;
    }
    let edges = |&[a, b, c]: &[u32; 3]| [(a, b, c), (b, c, a), (c, a, b)];
    let mut opposite: HashMap<(u32, u32), (usize, u32)> = HashMap::new();
    for (number, triangle) in triangles.iter().enumerate() {
        opposite.extend(edges(triangle).map(|(a, b, c)| ((a, b), (number, c))));
    }
    for corner in 0..count {
        if is_used[corner] {
            continue;
        }
        let next = |from: usize, step: usize| {
            let mut others = (1..count).map(|i| (from + i * step) % count);
            others.find(|&other| is_used[other]).map(|other| other as u32)
        };
        let (Some(before), Some(after)) = (next(corner, count - 1), next(corner, 1)) else { return };
        let Some(&(number, third)) = opposite.get(&(before, after)) else { continue };
        let middle = corner as u32;
        let parts = [[before, middle, third], [middle, after, third]];
        if parts.iter().any(|part| twice_area(plane, *part) < 0.0) {
            continue;
        }
        is_used[corner] = true;
        triangles[number] = parts[0];
        triangles.push(parts[1]);
        for (place, part) in [(number, parts[0]), (triangles.len() - 1, parts[1])] {
            opposite.extend(edges(&part).map(|(a, b, c)| ((a, b), (place, c))));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the triangles of one polygon, their total area, and the note.
    fn split(corners: &[[f64; 3]]) -> (Vec<[u32; 3]>, f64, Option<String>) {
        let positions: Vec<DVec3> = corners.iter().copied().map(DVec3::from).collect();
        let mut splitter = PolygonSplitter::new(&positions);
        splitter.add(&numbers(corners.len()));
        let areas = splitter.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|index| positions[index as usize]);
            (b - a).cross(c - a).y / 2.0
        });
        (splitter.triangles.clone(), areas.sum(), splitter.note())
    }

    #[test]
    fn concave_polygons_are_filled() {
        let arrow = [[-1.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
        let (_, area, note) = split(&arrow);
        assert!((area - 1.0).abs() < 1e-12 && note.is_none(), "{area}");
        let c = [[-1.0, 1.0], [1.0, 1.0], [1.0, 0.5], [0.0, 0.5], [0.0, -0.5], [1.0, -0.5], [1.0, -1.0], [-1.0, -1.0]];
        // The plane of the polygon does not matter, nor does its first corner.
        for first in 0..8 {
            let turned: Vec<[f64; 3]> = (0..8).map(|i| c[(first + i) % 8]).map(|[x, z]| [x, 0.5 * x, z]).collect();
            let (triangles, area, note) = split(&turned);
            assert!((area - 3.0).abs() < 1e-12 && note.is_none(), "{first}: {area}");
            assert_eq!(triangles.len(), 6);
        }
        let mut reversed = c.map(|[x, z]| [x, 0.0, z]);
        reversed.reverse();
        assert!((split(&reversed).1 + 3.0).abs() < 1e-12);
    }

    /// A convex polygon stays the fan of its first corner.
    #[test]
    fn convex_polygons_are_fans() {
        let corner = |i: u32| {
            let (sine, cosine) = (f64::from(i) * -1.2).sin_cos();
            [cosine, 0.0, sine]
        };
        let pentagon: Vec<[f64; 3]> = (0..5).map(corner).collect();
        assert_eq!(split(&pentagon).0, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    /// Corners in the middle of edges stay corners: the neighbours of the polygon use them.
    #[test]
    fn corners_on_edges_are_kept() {
        let points = [[0, 0], [0, 1], [0, 2], [0, 3], [1, 3], [3, 3], [2, 2], [1, 1]];
        let corners = points.map(|[x, z]| [f64::from(x), 0.0, f64::from(z)]);
        let (triangles, area, note) = split(&corners);
        assert!((area - 4.5).abs() < 1e-12 && note.is_none(), "{area}");
        assert_eq!(triangles.len(), 6, "{triangles:?}");
        for edge in 0..8 {
            let (a, b) = (edge, (edge + 1) % 8);
            let has = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].contains(&(a, b));
            assert!(triangles.iter().any(has), "no triangle has the edge {a} {b}: {triangles:?}");
        }
    }

    #[test]
    fn polygons_that_cross_themselves_have_a_note() {
        let bow_tie = [[0.0, 0.0, 0.0], [3.0, 0.0, 1.0], [3.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
        assert!(split(&bow_tie).2.unwrap().contains("crosses itself"));
    }
}
