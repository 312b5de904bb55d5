//! Reads `vertex` and `face` of PLY files, as text or binary. Polygons are split into triangles.

use super::part::{MeshPart, PartsAndNotes};
use super::polygon::PolygonSplitter;
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::colour::decode_srgb;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::bytes_without_byte_order_mark;
use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::Property::{
    self, Char, Double, Float, Int, ListChar, ListDouble, ListFloat, ListInt, ListShort, ListUChar, ListUInt,
    ListUShort, Short, UChar, UInt, UShort,
};
use ply_rs_bw::ply::{ElementDef, Header, PropertyAccess, PropertyAccessResult};
use std::io::{Cursor, ErrorKind};

/// The property names for the corners of a face. Different programs use different names.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The names of the properties for the colour of a vertex, in sRGB.
const COLOURS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];

#[derive(Debug, Default)]
struct PlyVertex {
    position: DVec3,
    normal: DVec3,
    uv: [f64; 2],
    /// The components as the file encodes them, from 0 to 1.
    colour: [f64; 3],
}

#[derive(Debug, Default)]
struct PlyFace {
    /// The corners, or `None` if an index is negative.
    corners: Option<Vec<u32>>,
}

struct SkippedElement;

impl PropertyAccess for PlyVertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let (target, largest) = match name {
            "red" | "r" | "diffuse_red" => (Some(&mut self.colour[0]), largest(&property)),
            "green" | "g" | "diffuse_green" => (Some(&mut self.colour[1]), largest(&property)),
            "blue" | "b" | "diffuse_blue" => (Some(&mut self.colour[2]), largest(&property)),
            _ => (self.coordinate(name), 1.0),
        };
        let Some(target) = target else { return PropertyAccessResult::Ignored };
        let Some(value) = number(&property) else { return PropertyAccessResult::UnsupportedType };
        *target = value / largest;
        PropertyAccessResult::Set
    }
}

impl PlyVertex {
    /// Returns the number of a property of the geometry.
    fn coordinate(&mut self, name: &str) -> Option<&mut f64> {
        Some(match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "u" | "s" | "texture_u" => &mut self.uv[0],
            "v" | "t" | "texture_v" => &mut self.uv[1],
            _ => return None,
        })
    }
}

impl PropertyAccess for PlyFace {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.corners = match property {
            ListChar(list) => indices(list),
            ListUChar(list) => indices(list),
            ListShort(list) => indices(list),
            ListUShort(list) => indices(list),
            ListInt(list) => indices(list),
            ListUInt(list) => Some(list),
            Char(_) | UChar(_) | Short(_) | UShort(_) | Int(_) | UInt(_) | Float(_) | Double(_) | ListFloat(_)
            | ListDouble(_) => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for SkippedElement {
    fn new() -> Self {
        Self
    }
}

fn indices<T: TryInto<u32>>(list: Vec<T>) -> Option<Vec<u32>> {
    list.into_iter().map(|index| index.try_into().ok()).collect()
}

/// Returns the value of a colour's component that means 1.
fn largest(property: &Property) -> f64 {
    match property {
        UChar(_) => 255.0,
        UShort(_) => 65535.0,
        Char(_) | Short(_) | Int(_) | UInt(_) => 255.0,
        Float(_) | Double(_) | ListChar(_) | ListUChar(_) | ListShort(_) | ListUShort(_) | ListInt(_) | ListUInt(_)
        | ListFloat(_) | ListDouble(_) => 1.0,
    }
}

fn number(property: &Property) -> Option<f64> {
    match *property {
        Char(value) => Some(f64::from(value)),
        UChar(value) => Some(f64::from(value)),
        Short(value) => Some(f64::from(value)),
        UShort(value) => Some(f64::from(value)),
        Int(value) => Some(f64::from(value)),
        UInt(value) => Some(f64::from(value)),
        Float(value) => Some(f64::from(value)),
        Double(value) => Some(value),
        ListChar(_) | ListUChar(_) | ListShort(_) | ListUShort(_) | ListInt(_) | ListUInt(_) | ListFloat(_)
        | ListDouble(_) => None,
    }
}

/// Reads a PLY file. The result has exactly one part.
pub(super) fn load(bytes: &[u8]) -> Result<PartsAndNotes> {
    let mut reader = Reader::new(Cursor::new(bytes_without_byte_order_mark(bytes)));
    let header = Parser::<SkippedElement>::new().read_header(&mut reader).map_err(|error| explain(&error))?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (name, element) in &header.elements {
        if element.properties.is_empty() && element.count > 0 {
            return Err(Error::input(format!("the PLY element \"{name}\" has no properties")));
        }
        match name.as_str() {
            "vertex" => vertices = elements::<PlyVertex>(&mut reader, element, &header)?,
            "face" => faces = elements::<PlyFace>(&mut reader, element, &header)?,
            _ => drop(elements::<SkippedElement>(&mut reader, element, &header)?),
        }
    }
    let has = |names: &[&str]| {
        let properties = header.elements.get("vertex").map(|element| &element.properties);
        properties.is_some_and(|properties| names.iter().all(|&name| properties.contains_key(name)))
    };
    if !has(&["x", "y", "z"]) {
        return Err(Error::input("the PLY file has no vertices with x, y, z"));
    }
    let has_uv = has(&["u", "v"]) || has(&["s", "t"]) || has(&["texture_u", "texture_v"]);
    let positions: Vec<DVec3> = vertices.iter().map(|vertex| vertex.position).collect();
    let mut splitter = PolygonSplitter::new(&positions);
    for (number, face) in faces.iter().enumerate() {
        let corners = face.corners.as_deref().filter(|corners| corners.len() >= 3).ok_or_else(|| {
            Error::input(format!("face {number} of the PLY file is not a polygon"))
                .expected("a list vertex_indices of at least three indices of at least 0")
        })?;
        splitter.add(corners);
    }
    let remarks = splitter.note().into_iter().collect();
    let triangles = splitter.triangles;
    let normals = has(&["nx", "ny", "nz"]).then(|| vertices.iter().map(|vertex| vertex.normal).collect());
    // In PLY files, v increases upwards.
    let uvs = has_uv.then(|| vertices.iter().map(|vertex| [vertex.uv[0], 1.0 - vertex.uv[1]]).collect());
    let mesh = TriangleMesh::new(positions, normals, uvs, triangles)?;
    let has_colours = COLOURS.iter().any(|names| has(names));
    let linear = |c: f64| if c > 0.0 { decode_srgb(c.min(1.0)) as f32 } else { 0.0 };
    let colours = has_colours.then(|| vertices.iter().map(|vertex| vertex.colour.map(linear)).collect());
    let of_faces = header.elements.get("face").map(|element| &element.properties);
    let has_face_colours = of_faces.is_some_and(|known| COLOURS[0].iter().all(|&name| known.contains_key(name)));
    let ignored = has_face_colours.then(|| "colours of faces are ignored; store them at the vertices".to_owned());
    let part = MeshPart { mesh, material: None, material_number: None, name: String::new(), colours };
    Ok(PartsAndNotes { parts: vec![part], ignored: ignored.into_iter().collect(), remarks, ..PartsAndNotes::default() })
}

fn elements<E: PropertyAccess>(reader: &mut Reader<Cursor<&[u8]>>, kind: &ElementDef, all: &Header) -> Result<Vec<E>> {
    Parser::<E>::new().read_payload_for_element(reader, kind, all).map_err(|error| explain(&error))
}

fn explain(error: &ParseError) -> Error {
    if error.kind() == ErrorKind::UnexpectedEof {
        return Error::input("the PLY file is truncated");
    }
    // The first line names the problem, and the others repeat the contents of the file.
    let message = error.to_string();
    Error::input(format!("not a valid PLY file: {}", message.lines().next().unwrap_or_default()))
}
