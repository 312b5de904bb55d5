//! STL files, binary or text. Corners at the same position become one vertex.

use super::part::MeshPart;
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use glam::DVec3;
use std::io::{Cursor, ErrorKind};

/// Number of bytes before the triangles of a binary file.
const HEADER: usize = 84;

/// Number of bytes of each triangle in a binary file.
const TRIANGLE: usize = 50;

/// Reads an STL file. The result has exactly one part.
pub(super) fn load(mut bytes: Vec<u8>) -> Result<Vec<MeshPart>> {
    if is_binary(&bytes) {
        // The header of some binary files begins with `solid`, the word that marks text files.
        // Without this word, the crate reads the file as binary.
        bytes[0] = 0;
    }
    let read = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|error| {
        if error.kind() == ErrorKind::UnexpectedEof {
            return Error::input("the STL file is truncated");
        }
        Error::input(format!("not a valid STL file: {error}"))
    })?;
    let index = |vertex: usize| u32::try_from(vertex).map_err(|_| Error::input("the mesh has more than 2³² vertices"));
    let positions = read.vertices.iter().map(|vertex| DVec3::from_array(vertex.0.map(f64::from))).collect();
    let mut triangles = Vec::with_capacity(read.faces.len());
    for face in &read.faces {
        let [a, b, c] = face.vertices;
        triangles.push([index(a)?, index(b)?, index(c)?]);
    }
    let mesh = TriangleMesh::new(positions, None, None, triangles)?;
    Ok(vec![MeshPart { mesh, material: None, material_number: None, name: String::new() }])
}

/// Returns whether the file is binary. The header of a binary file states the number of triangles,
/// and the length of the file must match this number.
fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(80..HEADER).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| bytes.len() == HEADER + TRIANGLE * count as usize)
}
