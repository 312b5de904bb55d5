//! Reads triangle meshes from OBJ, PLY, STL, glTF and Mitsuba's serialized files.
//!
//! Every reader checks its input. If a file is missing, truncated or malformed, the error names the
//! file. The reader never panics.

#[cfg(feature = "meshes")]
mod gltf;
#[cfg(feature = "meshes")]
mod gltf_accessor;
#[cfg(feature = "meshes")]
mod gltf_extensions;
#[cfg(feature = "meshes")]
mod gltf_material;
#[cfg(feature = "meshes")]
mod gltf_pose;
#[cfg(feature = "meshes")]
mod gltf_specular_glossiness;
#[cfg(feature = "meshes")]
mod gltf_texture;
mod material;
#[cfg(feature = "meshes")]
mod obj;
#[cfg(feature = "meshes")]
mod ply;
#[cfg(feature = "meshes")]
mod serialized;
#[cfg(feature = "meshes")]
mod stl;
#[cfg(feature = "meshes")]
mod vertex_colours;

use std::collections::BTreeMap;
#[cfg(feature = "meshes")]
use std::io::Read as _;
use std::path::Path;

#[cfg(feature = "meshes")]
use flate2::read::GzDecoder;

use crate::FileAccess;
use abbe_spectra::error::{Error, Result};

#[cfg(feature = "meshes")]
pub use self::gltf::{GltfFile, affine, decoded_address, first_parts, for_each_node, has_triangles};
use abbe_scene::geometry::mesh::TriangleMesh;
#[cfg(feature = "meshes")]
pub use gltf_accessor::GltfAccessors;
#[cfg(feature = "meshes")]
pub use gltf_material::ignored;
#[cfg(feature = "meshes")]
pub use gltf_pose::RestPose;
pub use material::{
    MeshAttenuation, MeshCoat, MeshDiffuseTransmission, MeshFilm, MeshMaterial, MeshOpacity, MeshTexture,
};

/// One part of a mesh file: triangles with one material.
#[derive(Debug, Clone)]
pub struct MeshPart {
    /// The triangles in the unit of the file, after all node transforms.
    pub mesh: TriangleMesh,
    /// The material in the file, if there is one.
    pub material: Option<MeshMaterial>,
    /// The number of the material in a glTF file. Parts with the same number have equal materials.
    pub material_number: Option<usize>,
    /// Name of the part in the file. The string is empty if the part has no name.
    pub name: String,
}

/// The contents of a mesh file.
#[derive(Debug, Clone)]
pub struct MeshFile {
    /// The parts of the file. There is at least one part.
    pub parts: Vec<MeshPart>,
    /// What the file states about materials and this reader ignores, such as textures. `None` if
    /// nothing is ignored.
    pub ignored: Option<String>,
    /// True if the file also contains lights, which are not part of the mesh.
    pub has_lights: bool,
}

/// Reads a mesh file. The file extension determines the format: `.obj` (with its `.mtl`), `.ply`,
/// `.stl`, `.serialized`, `.gltf` or `.glb`. `file_access` states which other files the file may
/// name.
///
/// # Errors
/// Returns an error if the file is missing, has an unknown format, or is truncated or malformed.
/// Also returns an error if no triangle has an area above 0. The error contains the name of the
/// file.
pub fn load(path: &Path, file_access: FileAccess) -> Result<MeshFile> {
    let PartsAndNotes { parts, ignored, has_lights } =
        read_parts(path, file_access).map_err(|error| error.in_file(path))?;
    if parts.is_empty() {
        return Err(Error::input("the mesh has no triangles").in_file(path));
    }
    let ignored = (!ignored.is_empty()).then(|| ignored.join("; "));
    Ok(MeshFile { parts, ignored, has_lights })
}

/// The parts of a mesh file by their number.
#[derive(Debug, Clone)]
pub struct UnplacedParts {
    /// The parts. In a glTF file, the parts are the primitives of all meshes, in the order of the
    /// file and without the transforms of the nodes. Primitives without triangles, and primitives
    /// outside the default scene, are absent.
    pub parts: BTreeMap<u32, MeshPart>,
    /// Sentences about what the reader ignores.
    pub ignored: Vec<String>,
}

/// Reads the parts of a mesh file, for scenes that name them one by one. `file_access` states which
/// other files the file may name.
///
/// # Errors
/// Returns the same errors as [`load`].
pub fn load_unplaced(path: &Path, file_access: FileAccess) -> Result<UnplacedParts> {
    #[cfg(feature = "meshes")]
    if matches!(extension_of(path).as_str(), "gltf" | "glb") {
        return gltf::load_unplaced(path, file_access).map_err(|error| error.in_file(path));
    }
    let MeshFile { parts, ignored, has_lights: _ } = load(path, file_access)?;
    Ok(UnplacedParts { parts: (0..).zip(parts).collect(), ignored: ignored.into_iter().collect() })
}

/// What the reader of a format returns.
#[derive(Debug, Default)]
struct PartsAndNotes {
    parts: Vec<MeshPart>,
    /// Sentences about what the reader ignores.
    ignored: Vec<String>,
    has_lights: bool,
}

#[cfg(feature = "meshes")]
impl PartsAndNotes {
    /// Returns parts without notes.
    fn of(parts: Vec<MeshPart>) -> Self {
        Self { parts, ..Self::default() }
    }
}

#[cfg(feature = "meshes")]
fn read_parts(path: &Path, file_access: FileAccess) -> Result<PartsAndNotes> {
    let extension = extension_of(path);
    match extension.as_str() {
        "obj" => obj::load(path, file_access),
        "ply" => read(path).and_then(|bytes| ply::load(&bytes)).map(PartsAndNotes::of),
        "ply.gz" => {
            let unpacked = read(path).and_then(|bytes| unpacked(GzDecoder::new(&bytes[..]), "gzip file"));
            unpacked.and_then(|bytes| ply::load(&bytes)).map(PartsAndNotes::of)
        }
        "stl" => read(path).and_then(stl::load).map(PartsAndNotes::of),
        "serialized" => read(path).and_then(|bytes| serialized::load(&bytes)).map(PartsAndNotes::of),
        "gltf" | "glb" => gltf::load(path, file_access),
        _ => Err(Error::input(format!("unknown kind of mesh file \"{extension}\""))
            .expected("one of .obj, .ply, .ply.gz, .stl, .serialized, .gltf, .glb")),
    }
}

/// Returns the extension of a file name in lower case. The extension of a packed file has two
/// parts, such as "ply.gz".
#[cfg(feature = "meshes")]
fn extension_of(path: &Path) -> String {
    let extension = |path: &Path| path.extension().and_then(|name| name.to_str()).unwrap_or("").to_lowercase();
    match extension(path).as_str() {
        "gz" => format!("{}.gz", extension(&path.with_extension(""))),
        plain => plain.to_string(),
    }
}

#[cfg(not(feature = "meshes"))]
fn read_parts(_: &Path, _: FileAccess) -> Result<PartsAndNotes> {
    Err(Error::input("this build cannot read mesh files").expected("the cargo feature `meshes`"))
}

#[cfg(feature = "meshes")]
fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::input(format!("cannot read the mesh: {error}")))
}

/// The largest size in bytes of an unpacked mesh file (4 GiB).
#[cfg(feature = "meshes")]
const MAX_UNPACKED_BYTES: u64 = 4 << 30;

/// Reads the unpacked data of a decoder. `kind` is the kind of the packed data, such as "gzip
/// file".
#[cfg(feature = "meshes")]
fn unpacked(decoder: impl std::io::Read, kind: &str) -> Result<Vec<u8>> {
    let mut unpacked = Vec::new();
    let mut reader = decoder.take(MAX_UNPACKED_BYTES + 1);
    reader.read_to_end(&mut unpacked).map_err(|error| Error::input(format!("not a valid {kind}: {error}")))?;
    if unpacked.len() as u64 > MAX_UNPACKED_BYTES {
        return Err(Error::input("the unpacked mesh is above 4 GiB").expected("a smaller mesh"));
    }
    Ok(unpacked)
}

/// Lists names in the order of their first occurrence, each once. Of many names, the list states
/// the first five and the number of the others.
#[cfg(feature = "meshes")]
fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    const MOST: usize = 5;
    let mut unique: Vec<&str> = Vec::new();
    for name in names {
        if !unique.contains(&name) {
            unique.push(name);
        }
    }
    let others = unique.len().saturating_sub(MOST);
    unique.truncate(MOST);
    let list = unique.join(", ");
    (!list.is_empty()).then(|| if others == 0 { list } else { format!("{list} and {others} others") })
}

/// Splits a polygon into triangles that share its first corner.
#[cfg(feature = "meshes")]
fn fan(polygon: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]])
}

#[cfg(test)]
#[cfg(feature = "meshes")]
mod obj_tests;
#[cfg(test)]
#[cfg(feature = "meshes")]
mod tests;
