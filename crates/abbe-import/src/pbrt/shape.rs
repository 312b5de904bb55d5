//! Shapes of pbrt files.

use super::parameters::{Parameter, Parameters};
use crate::facing::{NormalSide, normal_side};
use abbe_format::without_nulls;
use abbe_format::{FileAccess, mesh};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::sin_cos;
use glam::{DMat3, DMat4, DVec2, DVec3};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// A shape with its material, before an instance places it.
#[derive(Debug, Clone)]
pub(super) struct PbrtShape {
    pub(super) shape: Value,
    pub(super) to_world: DMat4,
    pub(super) material: String,
    pub(super) emission: Option<Value>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct ReadShape {
    pub(super) shape: Value,
    /// The transform from the shape of the scene file to the local coordinates of pbrt.
    pub(super) local: DMat4,
    /// The area in local coordinates, if it is known.
    pub(super) area: Option<f64>,
}

/// The number of segments of a circle that is replaced by straight lines.
const SEGMENTS: usize = 64;

/// The number of segments of a disk that is replaced by triangles.
const DISK_SEGMENTS: u32 = 192;

/// The number of segments along each side of a curved bilinear patch.
const PATCH_SEGMENTS: usize = 8;

pub(super) struct ShapeReader<'a> {
    /// The path from the folder of the scene file to the folder of the main file.
    pub(super) folder: &'a str,
    /// The folder of the main file.
    pub(super) base: &'a Path,
    pub(super) file_access: FileAccess,
    /// True if the front and the back of the shape are exchanged.
    pub(super) reverse: bool,
    /// True if the material has a texture.
    pub(super) textured: bool,
    /// True if the shape emits light.
    pub(super) emits: bool,
    pub(super) left_out: Vec<String>,
}

impl ShapeReader<'_> {
    pub(super) fn read(&mut self, class: &str, parameters: &Parameters) -> Result<Option<ReadShape>> {
        match class {
            "sphere" => self.sphere(parameters).map(Some),
            "disk" => self.disk(parameters).map(Some),
            "cylinder" => self.cylinder(parameters).map(Some),
            "trianglemesh" | "loopsubdiv" => self.triangle_mesh(class, parameters),
            "bilinearmesh" => self.bilinear_mesh(parameters),
            "plymesh" => self.ply_mesh(parameters),
            _ => {
                self.left_out.push(format!("shape \"{class}\" is left out"));
                parameters.ignore_all();
                Ok(None)
            }
        }
    }

    /// Notes a part of a quadric that is not the whole quadric.
    fn note_partial(&mut self, class: &str, parameters: &Parameters, keys: &[&str]) {
        if keys.iter().filter(|key| parameters.get(key).is_some()).count() > 0 {
            self.left_out.push(format!("a partial {class} is replaced by the whole {class}"));
        }
    }

    fn sphere(&mut self, parameters: &Parameters) -> Result<ReadShape> {
        let radius = parameters.number_or("radius", 1.0)?;
        self.note_partial("sphere", parameters, &["zmin", "zmax", "phimax"]);
        if self.reverse {
            self.left_out.push("a sphere that faces inwards is replaced by one that faces outwards".into());
        }
        let shape = json!({"sphere": {"radius": radius}});
        Ok(ReadShape { shape, local: y_to_z(), area: Some(4.0 * PI * radius * radius) })
    }

    fn disk(&mut self, parameters: &Parameters) -> Result<ReadShape> {
        let (radius, height) = (parameters.number_or("radius", 1.0)?, parameters.number_or("height", 0.0)?);
        let inner = parameters.number_or("innerradius", 0.0)?.clamp(0.0, radius);
        let sweep = parameters.number_or("phimax", 360.0)?.clamp(0.0, 360.0).to_radians();
        if self.textured || inner > 0.0 || sweep < TAU {
            return Ok(self.ring([inner, radius], height, sweep));
        }
        let turn = if self.reverse { DMat4::from_rotation_x(PI) } else { DMat4::IDENTITY };
        let local = DMat4::from_translation(DVec3::new(0.0, 0.0, height)) * y_to_z() * turn;
        Ok(ReadShape { shape: json!({"disk": {"radius": radius}}), local, area: Some(PI * radius * radius) })
    }

    /// A disk with a hole, a part of a disk, or a disk with pbrt's texture coordinates: u is the
    /// angle, and v is 0 at the rim and 1 at the inner edge.
    fn ring(&self, radii: [f64; 2], height: f64, sweep: f64) -> ReadShape {
        let mut mesh = Triangles::default();
        for i in 0..=DISK_SEGMENTS {
            let turn = f64::from(i) / f64::from(DISK_SEGMENTS);
            let (sin, cos) = sin_cos(sweep * turn);
            for (radius, v) in radii.into_iter().zip([1.0, 0.0]) {
                mesh.add_vertex(DVec3::new(radius * cos, radius * sin, height), None, Some([turn, v]));
            }
        }
        for i in (0..2 * DISK_SEGMENTS).step_by(2) {
            mesh.indices.push([i, i + 1, i + 3]);
            if radii[0] > 0.0 {
                mesh.indices.push([i, i + 3, i + 2]);
            }
        }
        self.finish(mesh)
    }

    /// A cylinder in pbrt has no caps.
    fn cylinder(&mut self, parameters: &Parameters) -> Result<ReadShape> {
        let radius = parameters.number_or("radius", 1.0)?;
        let z = [parameters.number_or("zmin", -1.0)?, parameters.number_or("zmax", 1.0)?];
        self.note_partial("cylinder", parameters, &["phimax"]);
        self.left_out.push(format!("a cylinder is replaced by {} triangles", 2 * SEGMENTS));
        let mut mesh = Triangles::default();
        for i in 0..=SEGMENTS {
            let turn = i as f64 / SEGMENTS as f64;
            let (sin, cos) = sin_cos(TAU * turn);
            for (end, z) in z.into_iter().enumerate() {
                let normal = DVec3::new(cos, sin, 0.0);
                mesh.add_vertex(radius * normal + z * DVec3::Z, Some(normal), Some([turn, end as f64]));
            }
        }
        for i in (0..2 * SEGMENTS as u32).step_by(2) {
            mesh.indices.extend([[i, i + 2, i + 3], [i, i + 3, i + 1]]);
        }
        let area = TAU * radius * (z[1] - z[0]);
        Ok(ReadShape { area: Some(area), ..self.finish(mesh) })
    }

    fn triangle_mesh(&mut self, class: &str, parameters: &Parameters) -> Result<Option<ReadShape>> {
        parameters.ignore(&["S", "faceIndices", "levels", "scheme"]);
        if class == "loopsubdiv" {
            self.left_out.push("a subdivision surface is replaced by its control mesh".into());
        }
        let Some(positions) = parameters.tuples::<3>("P")? else {
            self.left_out.push("a triangle mesh without positions is left out".into());
            return Ok(None);
        };
        let indices = match parameters.indices("indices")? {
            Some(indices) => indices,
            None if positions.len() == 3 => vec![0, 1, 2],
            None => {
                self.left_out.push("a triangle mesh without indices is left out".into());
                return Ok(None);
            }
        };
        let normals = parameters.tuples::<3>("N")?;
        let uv = parameters.tuples::<2>("uv")?.or(parameters.tuples::<2>("st")?);
        let mut mesh = Triangles::new(&positions, normals.as_deref(), uv.as_deref());
        mesh.indices = indices.as_chunks::<3>().0.to_vec();
        mesh.face_normals();
        Ok(Some(self.finish(mesh)))
    }

    /// A bilinear patch becomes two triangles if it is flat, and a grid of triangles otherwise.
    fn bilinear_mesh(&mut self, parameters: &Parameters) -> Result<Option<ReadShape>> {
        if parameters.get("emissionfilename").is_some() {
            self.left_out.push("a picture of the emission of a bilinear patch is left out".into());
        }
        let Some(positions) = parameters.tuples::<3>("P")? else {
            self.left_out.push("a bilinear patch without positions is left out".into());
            return Ok(None);
        };
        let normals = parameters.tuples::<3>("N")?;
        let uv = parameters.tuples::<2>("uv")?;
        let indices = parameters.indices("indices")?.unwrap_or_else(|| vec![0, 1, 2, 3]);
        let mut mesh = Triangles::default();
        for &patch in indices.as_chunks::<4>().0 {
            let Some(corners) = patch_corners(patch, &positions, normals.as_deref(), uv.as_deref()) else {
                let few = || Error::input("a bilinear patch needs four positions");
                let wrong = |indices: &Parameter| indices.fault("indices of existing positions");
                return Err(parameters.get("indices").map_or_else(few, wrong));
            };
            mesh.add_patch(&corners);
        }
        mesh.face_normals();
        Ok(Some(self.finish(mesh)))
    }

    fn ply_mesh(&mut self, parameters: &Parameters) -> Result<Option<ReadShape>> {
        if parameters.get("displacement").is_some() {
            self.left_out.push("the displacement of a mesh is left out".into());
        }
        parameters.ignore(&["edgelength", "displacement.edgelength", "displacement.uvscale"]);
        let Some(file) = parameters.file("filename", self.base, self.file_access)? else {
            self.left_out.push("a mesh without a file name is left out".into());
            return Ok(None);
        };
        // As in a triangle mesh, the vertex normals decide to which side a light shines.
        let side = if self.emits {
            let read = mesh::load(&self.base.join(file), self.file_access)?;
            normal_side(&read.parts)
        } else {
            NormalSide::Front
        };
        let turned = side == NormalSide::Back;
        if side == NormalSide::Both {
            self.left_out
                .push("the normals of a light point to both sides of its faces: it shines to their front".into());
        } else if turned {
            self.left_out
                .push("the faces of a light are turned to the side of its vertex normals, which are left out".into());
        }
        let (path, reverse) = (format!("{}{file}", self.folder), self.reverse != turned);
        let [reverse, flat] = [reverse, turned].map(|is_set| is_set.then_some(true));
        let mesh = without_nulls(json!({"path": path, "reverse": reverse, "flat": flat}));
        Ok(Some(ReadShape { shape: json!({"mesh": mesh}), local: DMat4::IDENTITY, area: None }))
    }

    fn finish(&self, mut mesh: Triangles) -> ReadShape {
        if self.reverse {
            mesh.reverse();
        }
        ReadShape { area: Some(mesh.area()), shape: mesh.shape(), local: DMat4::IDENTITY }
    }
}

/// The rotation that maps +y to +z and keeps x.
fn y_to_z() -> DMat4 {
    DMat4::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y))
}

#[derive(Clone, Copy)]
struct Corner {
    position: DVec3,
    normal: Option<DVec3>,
    uv: DVec2,
}

/// Returns the corners of a patch at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
fn patch_corners(
    patch: [u32; 4],
    positions: &[[f64; 3]],
    normals: Option<&[[f64; 3]]>,
    uv: Option<&[[f64; 2]]>,
) -> Option<[Corner; 4]> {
    let unit = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let corner = |number: usize| {
        let index = patch[number] as usize;
        Some(Corner {
            position: (*positions.get(index)?).into(),
            normal: if let Some(normals) = normals { Some((*normals.get(index)?).into()) } else { None },
            uv: uv.map_or(Some(unit[number]), |uv| uv.get(index).copied())?.into(),
        })
    };
    Some([corner(0)?, corner(1)?, corner(2)?, corner(3)?])
}

/// A triangle mesh with pbrt's texture coordinates.
#[derive(Default)]
struct Triangles {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    uv: Vec<[f64; 2]>,
    indices: Vec<[u32; 3]>,
}

impl Triangles {
    fn new(positions: &[[f64; 3]], normals: Option<&[[f64; 3]]>, uv: Option<&[[f64; 2]]>) -> Self {
        let vectors = |list: &[[f64; 3]]| list.iter().copied().map(DVec3::from).collect::<Vec<_>>();
        Self {
            positions: vectors(positions),
            normals: normals.map(vectors).unwrap_or_default(),
            uv: uv.unwrap_or_default().to_vec(),
            indices: Vec::new(),
        }
    }

    fn add_vertex(&mut self, position: DVec3, normal: Option<DVec3>, uv: Option<[f64; 2]>) {
        self.positions.push(position);
        self.normals.extend(normal);
        self.uv.extend(uv);
    }

    fn add_patch(&mut self, corners: &[Corner; 4]) {
        let [a, b, c, d] = corners.map(|corner| corner.position);
        let normal = (b - a).cross(c - a);
        let is_flat = normal.dot(d - a).abs() <= 1e-6 * normal.length() * (d - a).length();
        let segments = if is_flat { 1 } else { PATCH_SEGMENTS };
        let first = self.positions.len() as u32;
        for i in 0..=segments * (segments + 2) {
            let [u, v] = [i % (segments + 1), i / (segments + 1)].map(|x| x as f64 / segments as f64);
            let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
            let mixed = |part: &dyn Fn(&Corner) -> Option<DVec3>| {
                let parts = corners.iter().zip(weights).map(|(corner, weight)| Some(weight * part(corner)?));
                parts.sum::<Option<DVec3>>()
            };
            let position = mixed(&|corner| Some(corner.position)).unwrap_or_default();
            let uv = mixed(&|corner| Some(corner.uv.extend(0.0))).unwrap_or_default();
            self.add_vertex(position, mixed(&|corner| corner.normal), Some(uv.truncate().into()));
        }
        let row = segments as u32 + 1;
        for i in (0..row * row - row).filter(|i| i % row < row - 1) {
            let corner = first + i;
            self.indices.extend([[corner, corner + 1, corner + row + 1], [corner, corner + row + 1, corner + row]]);
        }
    }

    /// Orders the corners of each triangle: its front is on the side of the vertex normals.
    fn face_normals(&mut self) {
        let Self { positions, normals, indices, .. } = self;
        for triangle in indices {
            let corners = triangle.map(|index| positions.get(index as usize).copied().unwrap_or_default());
            let own = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let mean: DVec3 = triangle.iter().filter_map(|&index| normals.get(index as usize)).sum();
            if own.dot(mean) < 0.0 {
                triangle.swap(1, 2);
            }
        }
    }

    fn reverse(&mut self) {
        self.indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        self.normals.iter_mut().for_each(|normal| *normal = -*normal);
    }

    fn area(&self) -> f64 {
        let at = |index: u32| self.positions.get(index as usize).copied().unwrap_or_default();
        let areas = self.indices.iter().map(|&[a, b, c]| 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).length());
        areas.sum()
    }

    /// Returns the shape of the scene file, in which v points down.
    fn shape(&self) -> Value {
        let list = |vectors: &[DVec3]| vectors.iter().map(|vector| vector.to_array()).collect::<Vec<_>>();
        let normals = (!self.normals.is_empty()).then(|| list(&self.normals));
        let uv = self.uv.iter().map(|uv| [uv[0], 1.0 - uv[1]]).collect::<Vec<_>>();
        let (positions, uv) = (list(&self.positions), (!uv.is_empty()).then_some(uv));
        let shape = json!({"positions": positions, "indices": self.indices, "normals": normals, "uv": uv});
        json!({"triangles": without_nulls(shape)})
    }
}
