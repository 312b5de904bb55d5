//! The shells of a mesh: the parts of its surface that share no vertex.
//!
//! Programs often join several closed bodies into one mesh. Where two of them overlap, a path is
//! inside the mesh twice, and it must leave both before it is outside. If each shell is placed on
//! its own, the rules for coincident surfaces also tell shells apart that touch.

use super::mesh::{TriangleMesh, weld};
use super::shape::bounds_of;
use glam::DVec3;
use std::collections::HashMap;

/// The lowest and the highest corner of a bounding box.
type Corners = (DVec3, DVec3);

impl TriangleMesh {
    /// Divides a closed mesh into its shells, in the order of their first triangles. Returns `None`
    /// if the mesh is open, or if the bounding boxes of its shells are apart, so that no path can
    /// be inside two of them. A shell that faces inwards is a cavity and counts for no overlap.
    pub(crate) fn overlapping_shells(&self) -> Option<Vec<TriangleMesh>> {
        if !self.is_closed() {
            return None;
        }
        let shells: Vec<_> = self.triangles_by_shell().iter().map(|triangles| self.part(triangles)).collect();
        let bodies = shells.iter().filter(|shell| shells.len() > 1 && shell.signed_volume() > 0.0);
        touch(bodies.map(|shell| bounds_of(shell.positions().iter().copied())).collect()).then_some(shells)
    }

    fn triangles_by_shell(&self) -> Vec<Vec<[u32; 3]>> {
        let (representatives, _) = weld(self.positions(), self.triangles());
        let mut parents: Vec<u32> = (0..representatives.len() as u32).collect();
        for triangle in self.triangles() {
            let [a, b, c] = triangle.map(|index| root(&mut parents, representatives[index as usize]));
            parents[b.max(a) as usize] = a.min(b);
            let (a, c) = (root(&mut parents, a), root(&mut parents, c));
            parents[a.max(c) as usize] = a.min(c);
        }
        let mut numbers = HashMap::new();
        let mut shells: Vec<Vec<[u32; 3]>> = Vec::new();
        for &triangle in self.triangles() {
            let shell = root(&mut parents, representatives[triangle[0] as usize]);
            let number = *numbers.entry(shell).or_insert(shells.len());
            if number == shells.len() {
                shells.push(Vec::new());
            }
            shells[number].push(triangle);
        }
        shells
    }
}

/// Returns the smallest vertex that is connected with `vertex`, and shortens the way to it.
fn root(parents: &mut [u32], mut vertex: u32) -> u32 {
    while parents[vertex as usize] != vertex {
        let next = parents[parents[vertex as usize] as usize];
        parents[vertex as usize] = next;
        vertex = next;
    }
    vertex
}

/// Returns true if two boxes have a common point.
fn touch(mut boxes: Vec<Corners>) -> bool {
    boxes.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
    let mut active: Vec<Corners> = Vec::new();
    boxes.into_iter().any(|(low, high)| {
        active.retain(|other| other.1.x >= low.x);
        let touches = active.iter().any(|other| low.cmple(other.1).all() && high.cmpge(other.0).all());
        active.push((low, high));
        touches
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns one mesh of tetrahedra with an edge of 1 at these positions.
    fn tetrahedra(positions: &[DVec3]) -> TriangleMesh {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let vertices = positions.iter().flat_map(|&position| corners.map(|corner| position + corner)).collect();
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let triangles = (0..positions.len() as u32).flat_map(|i| faces.map(|face| face.map(|index| index + 4 * i)));
        TriangleMesh::new(vertices, None, None, triangles.collect()).expect("tetrahedra are a mesh")
    }

    #[test]
    fn only_shells_whose_boxes_touch_are_divided() {
        assert_eq!(tetrahedra(&[DVec3::ZERO]).overlapping_shells(), None);
        assert_eq!(tetrahedra(&[DVec3::ZERO, 3.0 * DVec3::X, 3.0 * DVec3::Y]).overlapping_shells(), None);
        let three = tetrahedra(&[DVec3::ZERO, 3.0 * DVec3::X, 0.5 * DVec3::X]);
        let shells = three.overlapping_shells().expect("the first and the last overlap");
        assert_eq!(shells.len(), 3);
        for shell in &shells {
            assert!(shell.is_closed() && shell.positions().len() == 4);
            assert!((shell.signed_volume() - 1.0 / 6.0).abs() < 1e-12);
        }
        assert_eq!(shells[1].positions()[0], 3.0 * DVec3::X);
    }

    #[test]
    fn a_cavity_is_no_overlap() {
        let around = |scale: f64| tetrahedra(&[DVec3::ZERO]).positions().iter().map(|p| scale * (p - 0.2)).collect();
        let (outer, inner): (Vec<DVec3>, Vec<DVec3>) = (around(2.0), around(1.0));
        let faces = tetrahedra(&[DVec3::ZERO]).triangles().to_vec();
        let cavity = faces.iter().map(|[a, b, c]| [a + 4, c + 4, b + 4]);
        let triangles = faces.iter().copied().chain(cavity).collect();
        let hollow = TriangleMesh::new([outer, inner].concat(), None, None, triangles).expect("a mesh");
        assert_eq!(hollow.overlapping_shells(), None);
    }

    #[test]
    fn vertices_at_one_position_join_a_shell() {
        let mesh = tetrahedra(&[DVec3::ZERO, 0.5 * DVec3::ONE]);
        let vertices: Vec<DVec3> = mesh.triangles().iter().flat_map(|&triangle| mesh.corners(triangle)).collect();
        let triangles = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let soup = TriangleMesh::new(vertices, None, None, triangles).expect("a mesh");
        assert_eq!(soup.overlapping_shells().map(|shells| shells.len()), Some(2));
    }
}
