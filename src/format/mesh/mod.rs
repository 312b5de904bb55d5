//! Reads triangle meshes from OBJ, PLY, STL and glTF files.
//!
//! Every reader checks its input. If a file is missing, truncated or malformed, the error names the
//! file. The reader never panics.

#[cfg(feature = "meshes")]
mod gltf;
#[cfg(feature = "meshes")]
mod gltf_material;
mod material;
#[cfg(feature = "meshes")]
mod obj;
#[cfg(feature = "meshes")]
mod ply;
#[cfg(feature = "meshes")]
mod stl;

use std::path::Path;

use crate::error::{Error, Result};
use crate::format::FileAccess;

use crate::geometry::mesh::TriangleMesh;
pub use material::{MeshAttenuation, MeshMaterial};

/// One part of a mesh file: triangles with one material.
#[derive(Debug, Clone)]
pub struct MeshPart {
    /// The triangles in the unit of the file, after all node transforms.
    pub mesh: TriangleMesh,
    /// The material in the file, if there is one.
    pub material: Option<MeshMaterial>,
    /// Name of the part in the file. The string is empty if the part has no name.
    pub name: String,
    /// A note for the user. For example, the note says that textures are not read, or that a
    /// material library is missing.
    pub note: Option<String>,
}

/// Reads a mesh file. The file extension determines the format: `.obj` (with its `.mtl`), `.ply`,
/// `.stl`, `.gltf` or `.glb`. `file_access` states which other files the file may name.
///
/// # Errors
/// Returns an error if the file is missing, has an unknown format, or is truncated or malformed.
/// Also returns an error if no triangle has an area above 0. The error contains the name of the
/// file.
pub fn load(path: &Path, file_access: FileAccess) -> Result<Vec<MeshPart>> {
    let parts = read_parts(path, file_access).map_err(|error| error.in_file(path))?;
    if parts.is_empty() {
        return Err(Error::input("the mesh has no triangles").in_file(path));
    }
    Ok(parts)
}

#[cfg(feature = "meshes")]
fn read_parts(path: &Path, file_access: FileAccess) -> Result<Vec<MeshPart>> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_lowercase();
    match extension.as_str() {
        "obj" => obj::load(path, file_access),
        "ply" => read(path).and_then(|bytes| ply::load(&bytes)),
        "stl" => read(path).and_then(stl::load),
        "gltf" | "glb" => read(path).and_then(|bytes| gltf::load(&bytes, path.parent(), file_access)),
        _ => Err(Error::input(format!("unknown kind of mesh file \"{extension}\""))
            .expected("one of .obj, .ply, .stl, .gltf, .glb")),
    }
}

#[cfg(not(feature = "meshes"))]
fn read_parts(_: &Path, _: FileAccess) -> Result<Vec<MeshPart>> {
    Err(Error::input("this build cannot read mesh files").expected("the cargo feature `meshes`"))
}

#[cfg(feature = "meshes")]
fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::input(format!("cannot read the mesh: {error}")))
}

/// Splits a polygon into triangles that share its first corner.
#[cfg(feature = "meshes")]
fn fan(polygon: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]])
}

#[cfg(test)]
#[cfg(feature = "meshes")]
mod tests;
