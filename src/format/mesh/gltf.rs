//! Reads glTF 2.0 files in text form (`.gltf`) or in binary form (`.glb`). The result contains the
//! triangles of the default scene after all node transforms.

use std::path::Path;

use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::Source;
use ::gltf::mesh::Mode;
use ::gltf::scene::Transform;
use ::gltf::{Accessor, Document, Gltf, Node, Primitive, Semantic};
use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::gltf_material::{ignored, read_material};
use super::gltf_texture::GltfPictures;
use super::{MeshPart, PartsAndNotes, TriangleMesh};
use crate::error::{Error, Result};
use crate::format::FileAccess;

/// Reads the parts of a glTF file.
pub(super) fn load(bytes: &[u8], folder: Option<&Path>, file_access: FileAccess) -> Result<PartsAndNotes> {
    let (document, blob) = parse(bytes)?;
    check_uris(&document, file_access)?;
    let buffers = ::gltf::import_buffers(&document, folder, blob).map_err(|error| invalid(&error))?;
    let pictures = GltfPictures::new(&buffers, folder, file_access, document.images().len());
    let mut reader = SceneReader { buffers: &buffers, pictures, parts: Vec::new() };
    for_each_node(&document, |node, to_world| reader.node(node, to_world))?;
    let has_lights = document.lights().is_some_and(|mut lights| lights.next().is_some());
    let SceneReader { parts, pictures, .. } = reader;
    let ignored = [ignored(&document), pictures.unusable].concat();
    Ok(PartsAndNotes { parts, ignored, has_lights })
}

/// Parses a glTF file. Returns the document, and the binary chunk of a `.glb` file.
pub(super) fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>)> {
    if bytes.starts_with(b"glTF") {
        check_length(bytes)?;
    }
    let unchecked = Gltf::from_slice_without_validation(bytes).map_err(|error| invalid(&error))?;
    let mut root = unchecked.document.into_json();
    // The crate refuses a file that requires an extension unknown to the crate. The module
    // `gltf_material` reads the extension below.
    root.extensions_required.retain(|name| name != "KHR_materials_dispersion");
    check_attributes(&root)?;
    let document = Document::from_json(root).map_err(|error| invalid(&error))?;
    Ok((document, unchecked.blob))
}

/// Calls `visit` for each node of the default scene. The second argument is the transform from the
/// node to the scene. If the file has no scene, all nodes without a parent belong to the scene.
pub(super) fn for_each_node(
    document: &Document,
    mut visit: impl FnMut(&Node<'_>, &DAffine3) -> Result<()>,
) -> Result<()> {
    let mut open: Vec<(Node<'_>, DAffine3)> = match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => scene.nodes().map(|node| (node, DAffine3::IDENTITY)).collect(),
        None => {
            let children: Vec<usize> = document
                .nodes()
                .flat_map(|node| node.children().map(|child| child.index()).collect::<Vec<_>>())
                .collect();
            let roots = document.nodes().filter(|node| !children.contains(&node.index()));
            roots.map(|node| (node, DAffine3::IDENTITY)).collect()
        }
    };
    open.reverse();
    // It is an error to read a node twice, so a cycle of nodes cannot cause an endless loop.
    let mut visited = vec![false; document.nodes().len()];
    while let Some((node, parent)) = open.pop() {
        if std::mem::replace(&mut visited[node.index()], true) {
            return Err(Error::input(format!("node {} of the glTF file has two parents", node.index())));
        }
        let to_world = parent * affine(&node.transform());
        visit(&node, &to_world)?;
        open.extend(node.children().map(|child| (child, to_world)));
    }
    Ok(())
}

/// Checks the length in the header of a binary file. A wrong length would cause an integer
/// underflow in the crate `gltf`.
fn check_length(bytes: &[u8]) -> Result<()> {
    let stated = bytes.get(8..12).and_then(|length| length.try_into().ok()).map(u32::from_le_bytes);
    match stated {
        Some(stated) if stated as usize > bytes.len() => Err(Error::input("the glTF file is truncated")),
        Some(stated) if stated >= 20 => Ok(()),
        Some(_) | None => Err(Error::input("not a valid glTF file: its header is incomplete")),
    }
}

/// Checks that no attribute refers to a missing accessor. A missing accessor would cause a panic in
/// the crate `gltf`.
fn check_attributes(root: &::gltf::json::Root) -> Result<()> {
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let largest = primitives.flat_map(|primitive| primitive.attributes.values()).map(|index| index.value()).max();
    if largest.is_some_and(|index| index >= root.accessors.len()) {
        return Err(Error::input("not a valid glTF file: an attribute names an accessor that does not exist"));
    }
    Ok(())
}

/// Checks the addresses of buffers: the percent-decoded text must be UTF-8, and the file access
/// must allow the path. The crate `gltf` makes neither of these checks.
fn check_uris(document: &Document, file_access: FileAccess) -> Result<()> {
    for buffer in document.buffers() {
        if let Source::Uri(uri) = buffer.source()
            && !uri.starts_with("data:")
        {
            let invalid = || Error::input(format!("the glTF buffer's address \"{uri}\" is not valid"));
            let decoded = decoded_address(uri).ok_or_else(invalid)?;
            let path = decoded.strip_prefix("file://").or(decoded.strip_prefix("file:")).unwrap_or(&decoded);
            file_access.file(Path::new(""), Path::new(path))?;
        }
    }
    Ok(())
}

/// Decodes the percent escapes of an address. Returns `None` if the result is not UTF-8.
pub(super) fn decoded_address(uri: &str) -> Option<String> {
    let mut decoded = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let escaped = (*first == b'%').then(|| tail.get(..2)).flatten();
        let value =
            escaped.and_then(|hex| std::str::from_utf8(hex).ok()).and_then(|hex| u8::from_str_radix(hex, 16).ok());
        decoded.push(value.unwrap_or(*first));
        rest = if value.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(decoded).ok()
}

fn invalid(error: &::gltf::Error) -> Error {
    if let ::gltf::Error::BufferLength { buffer, expected, actual } = error {
        return Error::input(format!("buffer {buffer} of the glTF file is truncated: {actual} of {expected} bytes"));
    }
    if let ::gltf::Error::Io(cause) = error {
        return Error::input(format!("the glTF file or its data cannot be read: {cause}"));
    }
    Error::input(format!("not a valid glTF file: {error}"))
}

struct SceneReader<'b> {
    buffers: &'b [::gltf::buffer::Data],
    pictures: GltfPictures<'b>,
    parts: Vec<MeshPart>,
}

impl SceneReader<'_> {
    fn node(&mut self, node: &Node<'_>, to_world: &DAffine3) -> Result<()> {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let name = node.name().or(mesh.name()).unwrap_or_default();
        mesh.primitives().try_for_each(|primitive| self.primitive(&primitive, name, *to_world))
    }

    fn primitive(&mut self, primitive: &Primitive<'_>, name: &str, placed: DAffine3) -> Result<()> {
        if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            return Ok(());
        }
        let of_part = |mut error: Error| {
            error.what = format!("mesh \"{name}\": {}", error.what);
            error
        };
        let mesh = self.mesh(primitive, placed).map_err(of_part)?;
        let material = primitive.material();
        let material =
            material.index().map(|_| read_material(&material, &mut self.pictures)).transpose().map_err(of_part)?;
        self.parts.push(MeshPart { mesh, material, name: name.to_string() });
        Ok(())
    }

    fn mesh(&self, primitive: &Primitive<'_>, placed: DAffine3) -> Result<TriangleMesh> {
        let accessor = primitive.get(&Semantic::Positions).ok_or_else(|| Error::input("it has no positions"))?;
        let positions: Vec<DVec3> = self.vectors(&accessor)?.map(|p| placed.transform_point3(p)).collect();
        // The cofactor matrix transforms the normals. Up to a factor, it equals the inverse
        // transpose, but it also exists for singular matrices.
        let [x, y, z] = [placed.matrix3.x_axis, placed.matrix3.y_axis, placed.matrix3.z_axis];
        let cofactors = glam::DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let mirrored = placed.matrix3.determinant() < 0.0;
        let outwards = if mirrored { -1.0 } else { 1.0 };
        let normals = match primitive.get(&Semantic::Normals) {
            Some(accessor) => Some(self.vectors(&accessor)?.map(|n| outwards * (cofactors * n)).collect()),
            None => None,
        };
        let uvs = match primitive.get(&Semantic::TexCoords(0)) {
            Some(accessor) => Some(self.pairs(&accessor)?),
            None => None,
        };
        let indices = match primitive.indices() {
            Some(accessor) => self.indices(&accessor)?,
            None => (0..positions.len() as u32).collect(),
        };
        let mut triangles = triangles(primitive.mode(), &indices);
        if mirrored {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        TriangleMesh::new(positions, normals, uvs, triangles)
    }

    /// Returns the items of an accessor after checking that all items are inside the buffer. Each
    /// item has `size` bytes.
    fn items<'a>(&'a self, accessor: &Accessor<'_>, size: usize) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>> {
        if accessor.sparse().is_some() {
            return Err(Error::input("sparse glTF accessors are not supported"));
        }
        let short = || Error::input(format!("accessor {} reaches beyond its buffer", accessor.index()));
        let view = accessor.view().ok_or_else(short)?;
        let (stride, count) = (view.stride().unwrap_or(size), accessor.count());
        if stride < size || count == 0 {
            return Err(Error::input(format!("accessor {} has no items or too small a stride", accessor.index())));
        }
        let data = self.buffers.get(view.buffer().index()).ok_or_else(short)?;
        let view_end = view.offset().checked_add(view.length()).ok_or_else(short)?;
        let in_view = data.get(view.offset()..view_end).ok_or_else(short)?;
        let length = (count - 1).checked_mul(stride).and_then(|length| length.checked_add(size)).ok_or_else(short)?;
        let end = accessor.offset().checked_add(length).ok_or_else(short)?;
        let items = in_view.get(accessor.offset()..end).ok_or_else(short)?;
        Ok(items.chunks(stride).map(move |item| &item[..size]))
    }

    fn vectors<'a>(&'a self, accessor: &Accessor<'_>) -> Result<impl Iterator<Item = DVec3> + use<'a>> {
        if accessor.data_type() != DataType::F32 || accessor.dimensions() != Dimensions::Vec3 {
            return Err(Error::input(format!("accessor {} does not hold vectors of three floats", accessor.index())));
        }
        Ok(self.items(accessor, 12)?.map(|item| DVec3::new(float(item, 0), float(item, 4), float(item, 8))))
    }

    fn pairs(&self, accessor: &Accessor<'_>) -> Result<Vec<[f64; 2]>> {
        let wrong = || Error::input(format!("accessor {} does not hold texture coordinates", accessor.index()));
        if accessor.dimensions() != Dimensions::Vec2 {
            return Err(wrong());
        }
        Ok(match accessor.data_type() {
            DataType::F32 => self.items(accessor, 8)?.map(|item| [float(item, 0), float(item, 4)]).collect(),
            DataType::U8 => {
                self.items(accessor, 2)?.map(|item| [item[0], item[1]].map(|x| f64::from(x) / 255.0)).collect()
            }
            DataType::U16 => {
                let word = |item: &[u8], at: usize| f64::from(u16::from_le_bytes([item[at], item[at + 1]])) / 65535.0;
                self.items(accessor, 4)?.map(|item| [word(item, 0), word(item, 2)]).collect()
            }
            DataType::I8 | DataType::I16 | DataType::U32 => return Err(wrong()),
        })
    }

    fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>> {
        let wrong = || Error::input(format!("accessor {} does not hold indices", accessor.index()));
        if accessor.dimensions() != Dimensions::Scalar {
            return Err(wrong());
        }
        Ok(match accessor.data_type() {
            DataType::U8 => self.items(accessor, 1)?.map(|item| u32::from(item[0])).collect(),
            DataType::U16 => {
                self.items(accessor, 2)?.map(|item| u32::from(u16::from_le_bytes([item[0], item[1]]))).collect()
            }
            DataType::U32 => {
                self.items(accessor, 4)?.map(|item| u32::from_le_bytes([item[0], item[1], item[2], item[3]])).collect()
            }
            DataType::I8 | DataType::I16 | DataType::F32 => return Err(wrong()),
        })
    }
}

fn float(item: &[u8], at: usize) -> f64 {
    f64::from(f32::from_le_bytes([item[at], item[at + 1], item[at + 2], item[at + 3]]))
}

/// Converts a list of indices to triangles.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
            .collect(),
        Mode::TriangleFan if indices.len() >= 3 => super::fan(indices).collect(),
        Mode::TriangleFan | Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}

/// Returns the transform of a node in double precision.
fn affine(transform: &Transform) -> DAffine3 {
    match transform {
        Transform::Matrix { matrix } => {
            DAffine3::from_mat4(DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))))
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
            let [scale, translation] = [scale, translation].map(|v| DVec3::from_array(v.map(f64::from)));
            DAffine3::from_scale_rotation_translation(scale, rotation, translation)
        }
    }
}
