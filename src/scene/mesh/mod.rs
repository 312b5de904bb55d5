//! Triangle meshes and the files they come from.
//!
//! Every reader checks what it reads before it uses it: a file that is missing, cut short or wrong gives an error
//! that names the file, never a panic.

mod gltf;
mod gltf_material;
mod material;
mod obj;
mod ply;
mod stl;
mod triangles;

use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::file::Reach;

pub use material::{MeshAttenuation, MeshMaterial};
pub use triangles::TriangleMesh;
pub(crate) use triangles::triangle_normal;

/// One part of a mesh file: triangles of one material.
#[derive(Debug, Clone)]
pub struct MeshPart {
    /// The triangles, in the file's unit, all node transforms applied.
    pub mesh: TriangleMesh,
    /// What the file says of its look, if anything.
    pub material: Option<MeshMaterial>,
    /// Name of the part in the file, or empty.
    pub name: String,
    /// What of the file could not be honoured, for the user to know: a material library that is missing,
    /// textures that are not read.
    pub note: Option<String>,
}

/// Reads a mesh file; the format goes by the extension: `.obj` (with its `.mtl`), `.ply`, `.stl`, `.gltf`, `.glb`. `reach` says which files it
/// may name in its turn.
///
/// # Errors
/// A file that is missing, of an unknown kind, cut short or malformed, or that has no triangles with an area. The
/// error names the file.
pub fn load(path: &Path, reach: Reach) -> Result<Vec<MeshPart>> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_lowercase();
    let parts = match extension.as_str() {
        "obj" => obj::load(path, reach),
        "ply" => read(path).and_then(|bytes| ply::load(&bytes)),
        "stl" => read(path).and_then(stl::load),
        "gltf" | "glb" => read(path).and_then(|bytes| gltf::load(&bytes, path.parent(), reach)),
        _ => Err(Error::input(format!("unknown kind of mesh file \"{extension}\""))
            .expected("one of .obj, .ply, .stl, .gltf, .glb")),
    };
    let parts = parts.map_err(|error| error.in_file(path))?;
    if parts.is_empty() {
        return Err(Error::input("the mesh has no triangles").in_file(path));
    }
    Ok(parts)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::input(format!("cannot read the mesh: {error}")))
}

/// Cuts a polygon into triangles around its first corner.
fn fan(polygon: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]])
}

#[cfg(test)]
mod tests;
