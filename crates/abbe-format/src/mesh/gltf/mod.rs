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
mod vertex_colours;

use super::material::{MeshMaterial, MeshTexture};
use super::part::{MeshPart, PartsAndNotes, UnplacedParts, fan};
use crate::FileAccess;
use ::gltf::mesh::Mode;
use ::gltf::{Document, Primitive, Semantic};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use glam::{DAffine3, DVec3};
use material::{has_textures, read_material, uv_set};
use node::placed_normal;
use pose::{Deformation, VertexData};
use std::collections::BTreeMap;
use std::path::Path;
use texture::GltfPictures;
use vertex_colours::ColourPicture;

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
    let ignored = [ignored(&file.document), animations.into_iter().collect(), reader.pictures.unusable].concat();
    Ok(PartsAndNotes { parts, ignored, has_lights })
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
    let ignored = [ignored(&file.document), reader.pictures.unusable].concat();
    Ok(UnplacedParts { parts, ignored })
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
        let Some(colours) = colours else {
            let (mesh, _) = self.mesh(primitive, placed, deformation, None).map_err(of_part)?;
            return Ok(Some(MeshPart { mesh, material, material_number: file.index(), name: name.to_string() }));
        };
        let white = || MeshMaterial { base_colour: [1.0; 3], ..MeshMaterial::default() };
        let mut material = material.unwrap_or_else(white);
        let varies = colours.iter().any(|colour| *colour != colours[0]);
        let drawn = (varies && !has_textures(&file)).then_some(colours.as_slice());
        let (mesh, texture) = self.mesh(primitive, placed, deformation, drawn).map_err(of_part)?;
        if texture.is_some() {
            material.base_colour_texture = texture;
        } else {
            let mean = |i: usize| colours.iter().map(|colour| f64::from(colour[i])).sum::<f64>() / colours.len() as f64;
            material.base_colour = std::array::from_fn(|i| material.base_colour[i] * mean(i));
        }
        // The colours belong to this part, so no other part shares the material.
        Ok(Some(MeshPart { mesh, material: Some(material), material_number: None, name: name.to_string() }))
    }

    /// Returns the vertex colours in linear sRGB, or `None` if the primitive has none.
    fn vertex_colours(&self, primitive: &Primitive) -> Result<Option<Vec<[f32; 3]>>> {
        let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(None) };
        let colours = self.accessors.floats(&accessor)?;
        // A colour that is not a number becomes 0.
        let in_range = |[r, g, b, _]: [f64; 4]| [r, g, b].map(|c| if c > 0.0 { c.min(1.0) as f32 } else { 0.0 });
        Ok((!colours.is_empty()).then(|| colours.into_iter().map(in_range).collect()))
    }

    /// Reads the geometry. If there are vertex colours, returns a picture of them, and texture
    /// coordinates into this picture replace those of the file.
    fn mesh(
        &self,
        primitive: &Primitive,
        placed: DAffine3,
        deformation: &Deformation,
        colours: Option<&[[f32; 3]]>,
    ) -> Result<(TriangleMesh, Option<MeshTexture>)> {
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
        let Some(colours) = colours else {
            return TriangleMesh::new(positions, normals, uvs, triangles).map(|mesh| (mesh, None));
        };
        if colours.len() != positions.len() || triangles.iter().flatten().any(|&i| i as usize >= positions.len()) {
            return Err(Error::input("the mesh does not have one colour per vertex"));
        }
        let ColourPicture { texture, corners } = ColourPicture::new(colours, &triangles);
        let vertices: Vec<(u32, [f64; 2])> = corners.into_iter().flatten().collect();
        let of_vertices = |values: &[DVec3]| vertices.iter().map(|&(vertex, _)| values[vertex as usize]).collect();
        if normals.as_ref().is_some_and(|normals: &Vec<DVec3>| normals.len() != positions.len()) {
            return Err(Error::input("the mesh does not have one normal per vertex"));
        }
        let triangles = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let uvs = vertices.iter().map(|&(_, uv)| uv).collect();
        let normals = normals.map(|normals| of_vertices(&normals));
        Ok((TriangleMesh::new(of_vertices(&positions), normals, Some(uvs), triangles)?, Some(texture)))
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
