//! Compares the faces of a mesh with its vertex normals.

use abbe_format::mesh::MeshPart;
use glam::DVec3;

/// The side of the faces to which the vertex normals of a mesh point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NormalSide {
    /// The side from which the corners are counter-clockwise, or the mesh has no normals.
    Front,
    Back,
    /// The front of some faces, and the back of others.
    Both,
}

/// Returns the side to which the vertex normals of a mesh point. Abbe's lights emit to the front of
/// their faces, whereas the normals decide in Mitsuba and pbrt.
pub(crate) fn normal_side<'p>(parts: impl IntoIterator<Item = &'p MeshPart>) -> NormalSide {
    /// Faces with a smaller part of the area are ignored.
    const LEAST_FRACTION: f64 = 1e-3;
    let (mut front, mut back) = (0.0, 0.0);
    for part in parts {
        for &triangle in part.mesh.triangles() {
            let [a, b, c] = part.mesh.corners(triangle);
            let face = (b - a).cross(c - a);
            let mean = part.mesh.normals().map(|normals| {
                let of_corners = triangle.map(|index| normals[index as usize].normalize_or_zero());
                of_corners.into_iter().sum::<DVec3>()
            });
            let side = if mean.is_some_and(|mean| face.dot(mean) < 0.0) { &mut back } else { &mut front };
            *side += face.length();
        }
    }
    match back / (front + back) {
        fraction if fraction < LEAST_FRACTION => NormalSide::Front,
        fraction if fraction > 1.0 - LEAST_FRACTION => NormalSide::Back,
        _ => NormalSide::Both,
    }
}
