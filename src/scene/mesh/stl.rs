//! STL files, binary or text. Corners at the same place become one vertex.

use std::io::{Cursor, ErrorKind};

use glam::DVec3;

use super::{MeshPart, TriangleMesh};
use crate::error::{Error, Result};

/// Bytes before the triangles of a binary file, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

pub(super) fn load(mut bytes: Vec<u8>) -> Result<Vec<MeshPart>> {
    if is_binary(&bytes) {
        // Some programs begin a binary file's free header with the word that marks text files.
        bytes[0] = 0;
    }
    let read = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|error| {
        if error.kind() == ErrorKind::UnexpectedEof {
            return Error::input("the STL file is cut short");
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
    Ok(vec![MeshPart { mesh, material: None, name: String::new(), note: None }])
}

/// Whether the length is exactly that of a binary file with the number of triangles it states.
fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(80..HEADER).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| bytes.len() == HEADER + TRIANGLE * count as usize)
}
