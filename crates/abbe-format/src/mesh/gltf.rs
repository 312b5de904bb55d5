//! Reads glTF 2.0 files in text form (`.gltf`) or in binary form (`.glb`). The result contains the
//! triangles of the default scene after all node transforms.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ::gltf::buffer::{Data, Source};
use ::gltf::json::Root;
use ::gltf::mesh::Mode;
use ::gltf::scene::Transform;
use ::gltf::{Document, Glb, Node, Primitive, Semantic};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde_json::Value;

use super::gltf_accessor::GltfAccessors;
use super::gltf_extensions;
use super::gltf_material::{has_textures, ignored, read_material, uv_set};
use super::gltf_pose::{Deformation, RestPose, VertexData};
use super::gltf_texture::GltfPictures;
use super::vertex_colours::ColourPicture;
use super::{MeshMaterial, MeshPart, MeshTexture, PartsAndNotes, TriangleMesh, UnplacedParts};
use crate::FileAccess;
use abbe_spectra::error::{Error, Result};

/// A glTF file whose geometry and pictures are not read yet.
pub struct GltfFile {
    /// The document.
    pub document: Document,
    /// True if the file animates other properties than those of nodes (KHR_animation_pointer).
    pub has_property_animations: bool,
    blob: Option<Vec<u8>>,
    folder: PathBuf,
    file_access: FileAccess,
}

impl GltfFile {
    /// Reads a glTF file, and checks the addresses of its buffers.
    pub fn open(path: &Path, file_access: FileAccess) -> Result<Self> {
        let (mut value, blob) = parse(&super::read(path)?)?;
        let has_property_animations = add_optional_keys(&mut value);
        let mut root: Root = serde_json::from_value(value).map_err(malformed)?;
        check_extensions(&mut root)?;
        check_attributes(&root)?;
        let document = Document::from_json(root).map_err(|error| invalid(&error))?;
        check_uris(&document, file_access)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { document, has_property_animations, blob, folder, file_access })
    }

    /// Reads the buffers. This function is called once, because it moves the data of a binary file.
    pub fn buffers(&mut self) -> Result<Vec<Data>> {
        ::gltf::import_buffers(&self.document, Some(&self.folder), self.blob.take()).map_err(|error| invalid(&error))
    }
}

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
            parts.extend(reader.primitive(&primitive, name, (placed, &deformation))?);
        }
        Ok(())
    })?;
    let has_lights = file.document.lights().is_some_and(|mut lights| lights.next().is_some());
    let animations = file.document.animations().next().map(|_| "ignored as well: animations".to_owned());
    let ignored = [ignored(&file.document), animations.into_iter().collect(), reader.pictures.unusable].concat();
    Ok(PartsAndNotes { parts, ignored, has_lights })
}

/// Reads the parts of a glTF file that the default scene uses, without the transforms of the nodes.
/// Parts with a skin are in the world. If several nodes deform a mesh, the first one counts.
/// The number of a part is the position of its primitive in the file. The names of the parts are
/// empty.
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
                let place = (DAffine3::IDENTITY, &deformation);
                let read = reader.primitive(&primitive, mesh.name().unwrap_or_default(), place)?;
                parts.extend(read.map(|part| (number, MeshPart { name: String::new(), ..part })));
            }
        }
        Ok(())
    })?;
    let ignored = [ignored(&file.document), reader.pictures.unusable].concat();
    Ok(UnplacedParts { parts, ignored })
}

/// Returns the number of the first part of each mesh. The parts are the primitives of all meshes,
/// in the order of the file.
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
pub fn has_triangles(primitive: &Primitive<'_>) -> bool {
    match primitive.mode() {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => false,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan => true,
    }
}

/// The extensions other than those of materials that Abbe reads, and that the crate `gltf` does not
/// know.
const OWN_EXTENSIONS: [&str; 3] = ["EXT_lights_ies", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization"];

/// The extensions that pack geometry. Abbe does not read them.
const PACKED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// Parses a glTF file. Returns the JSON text, and the binary chunk of a `.glb` file.
fn parse(bytes: &[u8]) -> Result<(Value, Option<Vec<u8>>)> {
    if !bytes.starts_with(b"glTF") {
        return Ok((serde_json::from_slice(bytes).map_err(malformed)?, None));
    }
    check_length(bytes)?;
    let file = Glb::from_slice(bytes).map_err(|error| invalid(&error))?;
    Ok((serde_json::from_slice(&file.json).map_err(malformed)?, file.bin.map(Cow::into_owned)))
}

fn malformed(error: serde_json::Error) -> Error {
    Error::input(format!("not a valid glTF file: {error}"))
}

/// Adds keys that are optional in glTF, and that the crate `gltf` requires. Removes the channels of
/// animations that move no node. Returns true if there are such channels.
fn add_optional_keys(value: &mut Value) -> bool {
    let scenes = value.get_mut("scenes").and_then(Value::as_array_mut);
    for scene in scenes.into_iter().flatten().filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    let animations = value.get_mut("animations").and_then(Value::as_array_mut);
    let mut removed = false;
    for animation in animations.into_iter().flatten() {
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else { continue };
        let all = channels.len();
        channels.retain(|channel| channel.get("target").is_none_or(|target| target.get("node").is_some()));
        removed |= channels.len() < all;
    }
    removed
}

/// Checks the extensions that a file requires. The crate `gltf` refuses a file that requires an
/// extension unknown to the crate, so the known ones are removed from the list.
fn check_extensions(root: &mut Root) -> Result<()> {
    let packed = |name: &&String| PACKED.contains(&name.as_str());
    let is_packed = |primitive: &::gltf::json::mesh::Primitive| {
        let names = primitive.extensions.iter().flat_map(|extensions| extensions.others.keys());
        names.into_iter().any(|name| PACKED.contains(&name.as_str()))
    };
    let by_primitive = root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(is_packed);
    let name = root.extensions_required.iter().find(packed).map(String::as_str);
    if let Some(name) = name.or(by_primitive.then_some(PACKED[0])) {
        return Err(Error::input(format!("the geometry is compressed by {name}"))
            .expected("a file without compression of meshes; switch it off in the export"));
    }
    root.extensions_required
        .retain(|name| !OWN_EXTENSIONS.contains(&name.as_str()) && !gltf_extensions::is_accepted(name));
    Ok(())
}

/// Calls `visit` for each node of the default scene, parents first. The second argument is the
/// number of the parent. The third argument is the transform from the node to the scene. If the
/// file has no scene, all nodes without a parent belong to the scene.
pub fn for_each_node<'d>(
    document: &'d Document,
    mut visit: impl FnMut(&Node<'d>, Option<usize>, &DAffine3) -> Result<()>,
) -> Result<()> {
    let mut roots: Vec<Node<'d>> = match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => scene.nodes().collect(),
        None => {
            let children: Vec<usize> = document
                .nodes()
                .flat_map(|node| node.children().map(|child| child.index()).collect::<Vec<_>>())
                .collect();
            document.nodes().filter(|node| !children.contains(&node.index())).collect()
        }
    };
    roots.reverse();
    let mut open: Vec<(Node<'d>, Option<usize>, DAffine3)> =
        roots.into_iter().map(|node| (node, None, DAffine3::IDENTITY)).collect();
    // It is an error to read a node twice, so a cycle of nodes cannot cause an endless loop.
    let mut visited = vec![false; document.nodes().len()];
    while let Some((node, parent, parent_to_world)) = open.pop() {
        if std::mem::replace(&mut visited[node.index()], true) {
            return Err(Error::input(format!("node {} of the glTF file has two parents", node.index())));
        }
        let to_world = parent_to_world * affine(&node.transform());
        visit(&node, parent, &to_world)?;
        let first = open.len();
        open.extend(node.children().map(|child| (child, Some(node.index()), to_world)));
        open[first..].reverse();
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
pub fn decoded_address(uri: &str) -> Option<String> {
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
    accessors: GltfAccessors<'b>,
    pictures: GltfPictures<'b>,
}

impl<'b> SceneReader<'b> {
    fn new(file: &'b GltfFile, buffers: &'b [Data]) -> Self {
        let pictures = GltfPictures::new(&file.document, buffers, &file.folder, file.file_access);
        Self { accessors: GltfAccessors::new(buffers), pictures }
    }

    /// Reads a primitive. Returns `None` if it does not consist of triangles. `place` contains the
    /// transform after the deformation, and the deformation.
    fn primitive(
        &mut self,
        primitive: &Primitive<'_>,
        name: &str,
        place: (DAffine3, &Deformation),
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
            let (mesh, _) = self.mesh(primitive, place, None).map_err(of_part)?;
            return Ok(Some(MeshPart { mesh, material, material_number: file.index(), name: name.to_string() }));
        };
        let white = || MeshMaterial { base_colour: [1.0; 3], ..MeshMaterial::default() };
        let mut material = material.unwrap_or_else(white);
        let varies = colours.iter().any(|colour| *colour != colours[0]);
        let drawn = (varies && !has_textures(&file)).then_some(colours.as_slice());
        let (mesh, texture) = self.mesh(primitive, place, drawn).map_err(of_part)?;
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
    fn vertex_colours(&self, primitive: &Primitive<'_>) -> Result<Option<Vec<[f32; 3]>>> {
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
        primitive: &Primitive<'_>,
        (placed, deformation): (DAffine3, &Deformation),
        colours: Option<&[[f32; 3]]>,
    ) -> Result<(TriangleMesh, Option<MeshTexture>)> {
        let accessor = primitive.get(&Semantic::Positions).ok_or_else(|| Error::input("it has no positions"))?;
        let normals = match primitive.get(&Semantic::Normals) {
            Some(accessor) => Some(self.accessors.vectors(&accessor)?.collect()),
            None => None,
        };
        let mut vertices = VertexData { positions: self.accessors.vectors(&accessor)?.collect(), normals };
        deformation.apply(primitive, &self.accessors, &mut vertices)?;
        let VertexData { mut positions, mut normals } = vertices;
        positions.iter_mut().for_each(|position| *position = placed.transform_point3(*position));
        normals.iter_mut().flatten().for_each(|normal| *normal = placed_normal(&placed, *normal));
        let mirrored = placed.matrix3.determinant() < 0.0;
        let uvs = match primitive.get(&Semantic::TexCoords(uv_set(&primitive.material()))) {
            Some(accessor) => Some(self.accessors.pairs(&accessor)?),
            None => None,
        };
        let indices = match primitive.indices() {
            Some(accessor) => self.accessors.indices(&accessor)?,
            None => (0..positions.len() as u32).collect(),
        };
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

/// Transforms a normal. The result points to the same side of the transformed surface.
pub(super) fn placed_normal(placed: &DAffine3, normal: DVec3) -> DVec3 {
    // The cofactor matrix transforms the normals. Up to a factor, it equals the inverse transpose,
    // but it also exists for singular matrices.
    let [x, y, z] = [placed.matrix3.x_axis, placed.matrix3.y_axis, placed.matrix3.z_axis];
    let outwards = if placed.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
    outwards * (glam::DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * normal)
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
pub fn affine(transform: &Transform) -> DAffine3 {
    match transform {
        Transform::Matrix { matrix } => without_rounding(DAffine3::from_mat4(DMat4::from_cols_array_2d(
            &matrix.map(|column| column.map(f64::from)),
        ))),
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
            let [scale, translation] = [scale, translation].map(|v| DVec3::from_array(v.map(f64::from)));
            DAffine3::from_scale_rotation_translation(scale, rotation, translation)
        }
    }
}

/// Removes the rounding of a matrix in single precision, which looks like a shear or like unequal
/// scales. A matrix that differs by more than rounding stays unchanged.
fn without_rounding(whole: DAffine3) -> DAffine3 {
    const ROUNDING: f64 = 2e-6;
    let (mut scale, rotation, translation) = whole.to_scale_rotation_translation();
    let size = scale.abs().max_element();
    if (scale.abs() - DVec3::splat(size)).abs().max_element() < ROUNDING * size {
        scale = scale.signum() * size;
    }
    let again = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
    let deviation = [0, 1, 2].map(|i| (again.matrix3.col(i) - whole.matrix3.col(i)).abs().max_element());
    let deviation = deviation.into_iter().fold(0.0, f64::max);
    if deviation > 1e-12 * size && deviation < ROUNDING * size { again } else { whole }
}
