//! STL files, binary or text. Corners at the same position become one vertex.

use super::part::{MeshPart, PartsAndNotes};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::bytes_without_byte_order_mark;
use glam::DVec3;
use std::collections::HashMap;
use std::io::{Cursor, ErrorKind};

/// Number of bytes before the triangles of a binary file.
const HEADER: usize = 84;

/// Number of bytes of each triangle in a binary file.
const TRIANGLE: usize = 50;

/// Reads an STL file. The result has exactly one part, also if a text file has several solids.
pub(super) fn load(bytes: &[u8]) -> Result<PartsAndNotes> {
    let text = bytes_without_byte_order_mark(bytes).trim_ascii_start();
    let is_solid = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let (corners, remarks) = if !is_binary(bytes) && is_solid && !text.contains(&0) {
        of_text(&String::from_utf8_lossy(text))?
    } else {
        (of_binary(bytes.to_vec())?, Vec::new())
    };
    let index = |vertex: usize| u32::try_from(vertex).map_err(|_| Error::input("the mesh has more than 2³² vertices"));
    let (mut positions, mut known) = (Vec::new(), HashMap::new());
    let mut triangles = Vec::with_capacity(corners.len());
    for triangle in corners {
        let mut vertices = [0; 3];
        for (vertex, corner) in vertices.iter_mut().zip(triangle) {
            let next = index(positions.len())?;
            *vertex = *known.entry(corner.map(f32::to_bits)).or_insert(next);
            if *vertex == next {
                positions.push(DVec3::from_array(corner.map(f64::from)));
            }
        }
        triangles.push(vertices);
    }
    let mesh = TriangleMesh::new(positions, None, None, triangles)?;
    let part = MeshPart { mesh, material: None, material_number: None, name: String::new(), colours: None };
    Ok(PartsAndNotes { parts: vec![part], remarks, ..PartsAndNotes::default() })
}

/// Returns whether the file is binary. The header of a binary file states the number of triangles,
/// and the length of the file must match this number.
fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(80..HEADER).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| bytes.len() == HEADER + TRIANGLE * count as usize)
}

type Corners = [[f32; 3]; 3];

fn of_binary(mut bytes: Vec<u8>) -> Result<Vec<Corners>> {
    // The header of some binary files begins with `solid`, the word that marks text files. Without
    // this word, the crate reads the file as binary.
    if let Some(first) = bytes.first_mut() {
        *first = 0;
    }
    let mut bytes = Cursor::new(bytes);
    let read = stl_io::create_stl_reader(&mut bytes).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let read = read.map_err(|error| {
        if error.kind() == ErrorKind::UnexpectedEof {
            return Error::input("the STL file is truncated");
        }
        Error::input(format!("not a valid STL file: {error}"))
    })?;
    Ok(read.into_iter().map(|triangle| triangle.vertices.map(|vertex| vertex.0)).collect())
}

/// Reads the triangles of all solids of a text, and returns sentences about the text. Keywords may
/// be in capitals, and blanks and line ends may separate words.
fn of_text(text: &str) -> Result<(Vec<Corners>, Vec<String>)> {
    let mut triangles = Vec::new();
    let mut facet: Option<Vec<[f32; 3]>> = None;
    let mut is_open = false;
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let wrong = |what: String| Error::input(format!("not a valid STL file: {what}")).at(number + 1, 1);
        while let Some(word) = words.next() {
            match (word.to_ascii_lowercase().as_str(), &mut facet) {
                // The name of the solid may consist of any words.
                ("solid", None) => is_open = true,
                ("endsolid", None) => is_open = false,
                ("facet", None) => {
                    facet = Some(Vec::new());
                    // The normal is that of the corners.
                    words.by_ref().take(4).for_each(drop);
                    continue;
                }
                ("outer" | "loop" | "endloop", Some(_)) => continue,
                ("vertex", Some(corners)) => {
                    let mut corner = [0.0; 3];
                    for component in &mut corner {
                        let value = words.next().unwrap_or_default();
                        let found = || wrong(format!("found \"{value}\" instead of a coordinate"));
                        let parsed = value.parse().ok().filter(|number: &f32| number.is_finite());
                        *component = parsed.ok_or_else(found)?;
                    }
                    corners.push(corner);
                    continue;
                }
                ("endfacet", Some(corners)) => {
                    let count = corners.len();
                    let few = |_| wrong(format!("a facet has {count} corners")).expected("three");
                    triangles.push(Corners::try_from(std::mem::take(corners)).map_err(few)?);
                    facet = None;
                    continue;
                }
                _ => return Err(wrong(format!("found \"{word}\""))),
            }
            break;
        }
    }
    if facet.is_some() || triangles.is_empty() {
        return Err(Error::input("the STL file is truncated"));
    }
    let unfinished = "the STL file ends without `endsolid`; if the mesh has a gap, export it again";
    Ok((triangles, is_open.then(|| unfinished.to_owned()).into_iter().collect()))
}
