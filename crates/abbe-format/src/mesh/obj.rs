//! Wavefront OBJ files with MTL materials.

use super::material::MeshMaterial;
use super::packed::read;
use super::part::{MeshPart, PartsAndNotes, listed};
use super::polygon::PolygonSplitter;
use super::{mtl, mtl::MtlMaterial};
use crate::FileAccess;
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::colour::decode_srgb;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::without_byte_order_mark;
use glam::DVec3;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

/// Reads the parts of an OBJ file. Also returns sentences about the materials that are ignored.
pub(super) fn load(path: &Path, file_access: FileAccess) -> Result<PartsAndNotes> {
    let bytes = read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let text = joined_lines(without_byte_order_mark(&text));
    let mut warnings = Vec::new();
    // A library counts for the whole file, wherever the file names it.
    let libraries = text.lines().filter_map(|line| value_of(line, "mtllib"));
    let libraries: Vec<MtlMaterial> =
        libraries.flat_map(|names| read_libraries(names, path, file_access, &mut warnings)).collect();
    let used = text.lines().filter_map(|line| value_of(line, "usemtl"));
    let unknown = used.filter(|name| !libraries.iter().any(|known| known.name == *name));
    let unknown = listed(unknown).map(|names| format!("unknown materials became matt grey: {names}"));
    let ignored = mtl::ignored_keys(&libraries);
    warnings.extend(unknown);
    let materials = mtl::converted(&libraries, path, file_access, &mut warnings);
    let mut reader = ObjReader::new(materials);
    for (number, line) in text.lines().enumerate() {
        reader.line(line).map_err(|error| error.at(number + 1, 1))?;
    }
    reader.finish_part()?;
    let ObjReader { parts, notes: remarks, .. } = reader;
    Ok(PartsAndNotes { parts, ignored, warnings, remarks, has_lights: false })
}

/// Joins each line that ends with a backslash to the next line. The other lines keep their numbers.
fn joined_lines(text: &str) -> Cow<'_, str> {
    if !text.lines().any(|line| line.trim_end().ends_with('\\')) {
        return Cow::Borrowed(text);
    }
    let (mut joined, mut ends) = (String::with_capacity(text.len()), String::new());
    for line in text.lines() {
        ends.push('\n');
        match line.trim_end().strip_suffix('\\') {
            Some(begin) => joined += &format!("{begin} "),
            None => joined += &format!("{line}{}", std::mem::take(&mut ends)),
        }
    }
    Cow::Owned(joined)
}

/// Returns the rest of a line after a keyword, or `None` if the line has another keyword.
fn value_of<'l>(line: &'l str, keyword: &str) -> Option<&'l str> {
    let (word, rest) = line.trim().split_once(char::is_whitespace)?;
    (word == keyword).then(|| rest.trim())
}

/// Reads the libraries of a line. The line names one file, whose name may contain blanks, or
/// several files.
fn read_libraries(names: &str, obj: &Path, file_access: FileAccess, warnings: &mut Vec<String>) -> Vec<MtlMaterial> {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let open = |name: &str| -> Result<Vec<u8>> {
        let file = file_access.file(folder, Path::new(&name.replace('\\', "/")))?;
        std::fs::read(file).map_err(|error| Error::input(error.to_string()))
    };
    let mut several = names.split_whitespace().map(|name| (name, open(name)));
    let found = match open(names) {
        Err(_) if several.clone().count() > 1 && several.clone().any(|(_, library)| library.is_ok()) => {
            several.by_ref().collect()
        }
        whole => vec![(names, whole)],
    };
    let mut materials = Vec::new();
    for (name, library) in found {
        match library {
            Ok(bytes) => materials.extend(mtl::parse(&bytes)),
            Err(error) => warnings.push(format!("the material library \"{name}\" cannot be used ({error})")),
        }
    }
    materials
}

/// A corner of a face: the numbers of its position, its texture coordinates and its normal.
type Corner = [Option<u32>; 3];

/// Reads the lines of an OBJ file.
struct ObjReader {
    materials: Vec<MeshMaterial>,
    positions: Vec<DVec3>,
    /// One colour for each position as the file encodes it. Positions without a colour are white.
    /// The list is empty until the first colour.
    colours: Vec<[f32; 3]>,
    uvs: Vec<[f64; 2]>,
    normals: Vec<DVec3>,
    /// The corners of the faces of the part, and the number of corners of each face.
    corners: Vec<Corner>,
    faces: Vec<usize>,
    name: String,
    material: Option<usize>,
    parts: Vec<MeshPart>,
    notes: Vec<String>,
}

impl ObjReader {
    fn new(materials: Vec<MeshMaterial>) -> Self {
        Self {
            materials,
            positions: Vec::new(),
            colours: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            corners: Vec::new(),
            faces: Vec::new(),
            name: UNNAMED.to_owned(),
            material: None,
            parts: Vec::new(),
            notes: Vec::new(),
        }
    }

    fn line(&mut self, line: &str) -> Result<()> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let data = rest.split('#').next().unwrap_or_default();
        match keyword {
            "v" => self.vertex(data),
            "vt" => {
                let [u, v] = numbers(data, "texture coordinates", "u v")?;
                // In OBJ files, v increases upwards.
                self.uvs.push([u, 1.0 - v]);
                Ok(())
            }
            "vn" => {
                self.normals.push(numbers(data, "a normal", "x y z")?.into());
                Ok(())
            }
            "f" => self.face(data),
            "o" | "g" => {
                self.finish_part()?;
                self.name = if rest.is_empty() { UNNAMED } else { rest }.to_owned();
                Ok(())
            }
            "usemtl" => {
                // Of several materials with a name, the last one counts.
                let material = self.materials.iter().rposition(|known| known.name == rest);
                if material != self.material {
                    self.finish_part()?;
                }
                self.material = material;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Reads a position, and a weight or a colour after it.
    fn vertex(&mut self, data: &str) -> Result<()> {
        let expected = "x y z, and then a weight, or a colour r g b";
        let values = data.split_whitespace().map(|word| number(word, "a vertex", expected));
        let values: Vec<f64> = values.collect::<Result<_>>()?;
        let (position, colour) = match values[..] {
            [x, y, z] => (DVec3::new(x, y, z), None),
            [x, y, z, weight] => (DVec3::new(x, y, z) / weight, None),
            [x, y, z, r, g, b] | [x, y, z, r, g, b, _] => (DVec3::new(x, y, z), Some([r, g, b])),
            _ => return Err(Error::input(format!("a vertex has {} numbers", values.len())).expected(expected)),
        };
        let white = [1.0; 3];
        if let Some(colour) = colour {
            self.colours.resize(self.positions.len(), white);
            self.colours.push(colour.map(|component| component as f32));
        } else if !self.colours.is_empty() {
            self.colours.push(white);
        }
        self.positions.push(position);
        Ok(())
    }

    fn face(&mut self, data: &str) -> Result<()> {
        let before = self.corners.len();
        for corner in data.split_whitespace() {
            let corner = self.corner(corner)?;
            self.corners.push(corner);
        }
        let count = self.corners.len() - before;
        if count < 3 {
            return Err(Error::input(format!("a face has {count} corners")).expected("at least three"));
        }
        self.faces.push(count);
        Ok(())
    }

    /// Reads a corner, which refers to vertices before it.
    fn corner(&self, text: &str) -> Result<Corner> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let wrong = || {
            Error::input(format!("a face has the corner \"{text}\"")).expected(format!(
                "indices of {} positions, {} texture coordinates, {} normals",
                counts[0], counts[1], counts[2]
            ))
        };
        let mut parts = text.split('/');
        let mut corner = [None; 3];
        for (place, count) in counts.into_iter().enumerate() {
            match parts.next() {
                None | Some("") if place > 0 => {}
                None => return Err(wrong()),
                Some(part) => {
                    let (index, count): (i64, i64) = (part.parse().map_err(|_| wrong())?, count as i64);
                    let from_start = if index < 0 { count.checked_add(index) } else { index.checked_sub(1) };
                    let from_start = from_start.filter(|index| (0..count).contains(index)).ok_or_else(wrong)?;
                    corner[place] = Some(u32::try_from(from_start).map_err(|_| wrong())?);
                }
            }
        }
        if parts.next().is_some() { Err(wrong()) } else { Ok(corner) }
    }

    /// Makes a part of the faces since the last one.
    fn finish_part(&mut self) -> Result<()> {
        if self.faces.is_empty() {
            return Ok(());
        }
        let (corners, faces) = (std::mem::take(&mut self.corners), std::mem::take(&mut self.faces));
        let (mut vertices, mut indices) = (Vec::new(), Vec::with_capacity(corners.len()));
        let mut known: HashMap<Corner, u32> = HashMap::new();
        for corner in corners {
            let index = *known.entry(corner).or_insert_with(|| {
                vertices.push(corner);
                vertices.len() as u32 - 1
            });
            indices.push(index);
        }
        let place = |corner: &Corner| corner[0].map(|index| index as usize);
        let position = |corner: &Corner| place(corner).map_or(DVec3::ZERO, |index| self.positions[index]);
        let positions: Vec<DVec3> = vertices.iter().map(position).collect();
        // If only some faces have normals or texture coordinates, the whole part has none.
        let uvs = vertices.iter().map(|corner| corner[1].map(|index| self.uvs[index as usize])).collect();
        let normals = vertices.iter().map(|corner| corner[2].map(|index| self.normals[index as usize])).collect();
        let encoded: Option<Vec<[f32; 3]>> =
            vertices.iter().map(|corner| self.colours.get(place(corner)?).copied()).collect();
        let mut splitter = PolygonSplitter::new(&positions);
        let mut rest = indices.as_slice();
        for count in faces {
            let (face, others) = rest.split_at(count);
            splitter.add(face);
            rest = others;
        }
        let of_part = |note: String| format!("part \"{}\": {note}", self.name);
        self.notes.extend(splitter.note().map(of_part));
        let triangles = splitter.triangles;
        let mesh = TriangleMesh::new(positions, normals, uvs, triangles)?;
        let material = self.material.and_then(|index| self.materials.get(index)).cloned();
        let colours = encoded.filter(|_| !self.colours.is_empty()).map(|colours| linear(&colours));
        let name = self.name.clone();
        self.parts.push(MeshPart { mesh, material, material_number: None, name, colours });
        Ok(())
    }
}

/// The name of a part without `o` and `g`.
const UNNAMED: &str = "unnamed_object";

/// Decodes colours in sRGB. Some programs write components from 0 to 255.
fn linear(colours: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let most = colours.iter().flatten().copied().fold(0.0, f32::max);
    let scale = if most > 1.0 { 255.0 } else { 1.0 };
    colours.iter().map(|colour| colour.map(|c| decode_srgb(f64::from((c / scale).clamp(0.0, 1.0))) as f32)).collect()
}

/// Returns the first `N` numbers of a line. `what` and `expected` describe them in errors.
fn numbers<const N: usize>(data: &str, what: &str, expected: &str) -> Result<[f64; N]> {
    let mut words = data.split_whitespace();
    let mut values = [0.0; N];
    for value in &mut values {
        let word =
            words.next().ok_or_else(|| Error::input(format!("{what}: found too few numbers")).expected(expected))?;
        *value = number(word, what, expected)?;
    }
    Ok(values)
}

fn number(word: &str, what: &str, expected: &str) -> Result<f64> {
    word.parse().map_err(|_| Error::input(format!("{what}: found \"{word}\"")).expected(expected))
}
