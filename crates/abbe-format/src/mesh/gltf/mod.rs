//! Reads glTF 2.0 files in text form (`.gltf`) or in binary form (`.glb`). The result contains the
//! triangles of the default scene after all node transforms.

mod accessor;
mod address;
mod extensions;
mod file;
mod material;
mod node;
mod pose;
mod specular_glossiness;
mod texture;

use super::part::{MeshPart, PartsAndNotes, UnplacedParts, fan, open_panes};
use crate::FileAccess;
use ::gltf::mesh::Mode;
use ::gltf::{Document, Primitive, Semantic};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use glam::DAffine3;
use material::{read_material, uv_set};
use node::placed_normal;
use pose::{Deformation, VertexData};
use std::collections::BTreeMap;
use std::path::Path;
use texture::GltfPictures;

pub use accessor::GltfAccessors;
pub use address::decoded_address;
pub use file::GltfFile;
pub use material::ignored;
pub use node::{affine, for_each_node};
pub use pose::RestPose;

/// Reads the parts of a glTF file, each at its place in the default scene.
pub(super) fn load(path: &Path, file_access: FileAccess) -> Result<PartsAndNotes> {
    let mut file = GltfFile::open(path, file_access)?;
    let buffers = file.buffers()?;
    let mut reader = SceneReader::new(&file, &buffers);
    let pose = RestPose::of(&file.document)?;
    let mut parts = Vec::new();
    for_each_node(&file.document, |node, _, to_world| {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let name = node.name().or(mesh.name()).unwrap_or_default();
        let deformation = pose.deformation(node, &mesh, &reader.accessors)?;
        let placed = if deformation.has_skin() { DAffine3::IDENTITY } else { *to_world };
        for primitive in mesh.primitives() {
            parts.extend(reader.primitive(&primitive, name, placed, &deformation)?);
        }
        Ok(())
    })?;
    let has_lights = file.document.lights().is_some_and(|mut lights| lights.next().is_some());
    let animations = file.document.animations().next().map(|_| "ignored as well: animations".to_owned());
    let ignored = [ignored(&file.document), animations.into_iter().collect()].concat();
    let warnings = reader.pictures.unusable;
    Ok(PartsAndNotes { parts, ignored, warnings, remarks: Vec::new(), has_lights })
}

/// Reads the parts of a glTF file that the default scene uses, without the transforms of the nodes.
/// Parts with a skin are in the world. If several nodes deform a mesh, the first one counts. Each
/// part has the number of its primitive in the file, and an empty name.
pub(super) fn load_unplaced(path: &Path, file_access: FileAccess) -> Result<UnplacedParts> {
    let mut file = GltfFile::open(path, file_access)?;
    let buffers = file.buffers()?;
    let mut reader = SceneReader::new(&file, &buffers);
    let firsts = first_parts(&file.document);
    let pose = RestPose::of(&file.document)?;
    let mut parts = BTreeMap::new();
    for_each_node(&file.document, |node, _, _| {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let deformation = pose.deformation(node, &mesh, &reader.accessors)?;
        for (number, primitive) in (firsts[mesh.index()]..).zip(mesh.primitives()) {
            if !parts.contains_key(&number) {
                let name = mesh.name().unwrap_or_default();
                let read = reader.primitive(&primitive, name, DAffine3::IDENTITY, &deformation)?;
                parts.extend(read.map(|part| (number, MeshPart { name: String::new(), ..part })));
            }
        }
        Ok(())
    })?;
    let ignored = [ignored(&file.document), open_panes(parts.values())].concat();
    Ok(UnplacedParts { parts, ignored, warnings: reader.pictures.unusable, remarks: Vec::new() })
}

/// Returns the number of the first part of each mesh. Parts are primitives in the file's order.
pub fn first_parts(document: &Document) -> Vec<u32> {
    let mut next = 0;
    let first = |mesh: ::gltf::Mesh<'_>| {
        let first = next;
        next += mesh.primitives().len() as u32;
        first
    };
    document.meshes().map(first).collect()
}

/// Returns true if a primitive consists of triangles.
pub fn has_triangles(primitive: &Primitive) -> bool {
    match primitive.mode() {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => false,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan => true,
    }
}

struct SceneReader<'b> {
    accessors: GltfAccessors<'b>,
    pictures: GltfPictures<'b>,
}

impl<'b> SceneReader<'b> {
    fn new(file: &'b GltfFile, buffers: &'b [Vec<u8>]) -> Self {
        let pictures = GltfPictures::new(&file.document, buffers, &file.folder, file.file_access);
        Self { accessors: GltfAccessors::new(buffers), pictures }
    }

    /// Reads a primitive of triangles. `placed` is the transform after the deformation.
    fn primitive(
        &mut self,
        primitive: &Primitive,
        name: &str,
        placed: DAffine3,
        deformation: &Deformation,
    ) -> Result<Option<MeshPart>> {
        if !has_triangles(primitive) {
            return Ok(None);
        }
        let of_part = |mut error: Error| {
            error.what = format!("mesh \"{name}\": {}", error.what);
            error
        };
        let file = primitive.material();
        let material = file.index().map(|_| read_material(&file, &mut self.pictures)).transpose().map_err(of_part)?;
        let colours = self.vertex_colours(primitive).map_err(of_part)?;
        let mesh = self.mesh(primitive, placed, deformation).map_err(of_part)?;
        if colours.as_ref().is_some_and(|colours| colours.len() != mesh.positions().len()) {
            return Err(of_part(Error::input("the mesh does not have one colour per vertex")));
        }
        // The colours belong to this part, so no other part shares the material.
        let material_number = file.index().filter(|_| colours.is_none());
        Ok(Some(MeshPart { mesh, material, material_number, name: name.to_string(), colours }))
    }

    /// Returns the vertex colours in linear sRGB, or `None` if the primitive has none.
    fn vertex_colours(&self, primitive: &Primitive) -> Result<Option<Vec<[f32; 3]>>> {
        let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(None) };
        let colours = self.accessors.floats(&accessor)?;
        // A colour that is not a number becomes 0.
        let in_range = |[r, g, b, _]: [f64; 4]| [r, g, b].map(|c| if c > 0.0 { c.min(1.0) as f32 } else { 0.0 });
        Ok((!colours.is_empty()).then(|| colours.into_iter().map(in_range).collect()))
    }

    fn mesh(&self, primitive: &Primitive, placed: DAffine3, deformation: &Deformation) -> Result<TriangleMesh> {
        let accessor = primitive.get(&Semantic::Positions).ok_or_else(|| Error::input("it has no positions"))?;
        let normals = primitive.get(&Semantic::Normals).map(|accessor| self.accessors.vectors(&accessor));
        let normals = normals.transpose()?.map(Iterator::collect);
        let mut vertices = VertexData { positions: self.accessors.vectors(&accessor)?.collect(), normals };
        deformation.apply(primitive, &self.accessors, &mut vertices)?;
        let VertexData { mut positions, mut normals } = vertices;
        positions.iter_mut().for_each(|position| *position = placed.transform_point3(*position));
        normals.iter_mut().flatten().for_each(|normal| *normal = placed_normal(&placed, *normal));
        let mirrored = placed.matrix3.determinant() < 0.0;
        let uvs = primitive.get(&Semantic::TexCoords(uv_set(&primitive.material())));
        let uvs = uvs.map(|accessor| self.accessors.pairs(&accessor)).transpose()?;
        let all = || Ok((0..positions.len() as u32).collect());
        let indices = primitive.indices().map_or_else(all, |accessor| self.accessors.indices(&accessor))?;
        let mut triangles = triangles(primitive.mode(), &indices);
        if mirrored {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        TriangleMesh::new(positions, normals, uvs, triangles)
    }
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let turned = |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
    match mode {
        Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        Mode::TriangleStrip => indices.windows(3).enumerate().map(turned).collect(),
        Mode::TriangleFan if indices.len() >= 3 => fan(indices).collect(),
        Mode::TriangleFan | Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}
