//! Reads triangle meshes from OBJ, PLY, STL, glTF and Mitsuba's serialized files, and gem designs of
//! GemCad and of Gem Cut Studio.
//!
//! Readers check their input and never panic. Errors of missing or malformed files have their name.

#[cfg(feature = "gems")]
mod gem;
#[cfg(feature = "meshes")]
mod gltf;
mod material;
#[cfg(feature = "meshes")]
mod mtl;
#[cfg(feature = "meshes")]
mod obj;
#[cfg(feature = "meshes")]
mod packed;
mod part;
#[cfg(feature = "meshes")]
mod ply;
#[cfg(feature = "meshes")]
mod polygon;
#[cfg(feature = "meshes")]
mod serialized;
#[cfg(feature = "meshes")]
mod stl;
mod vertex_colours;

use std::path::Path;

use crate::FileAccess;
use abbe_spectra::error::{Error, Result};
#[cfg(feature = "meshes")]
use flate2::read::GzDecoder;

#[cfg(feature = "meshes")]
pub use self::gltf::{
    GltfAccessors, GltfFile, RestPose, affine, decoded_address, first_parts, for_each_node, has_triangles, ignored,
};
pub use material::{
    MeshAttenuation, MeshCoat, MeshDiffuseTransmission, MeshFilm, MeshMaterial, MeshOpacity, MeshTexture,
};
#[cfg(feature = "meshes")]
use packed::{read, unpacked};
use part::PartsAndNotes;
pub use part::{MeshPart, UnplacedParts, open_panes};
pub(crate) use vertex_colours::painted;

/// The contents of a mesh file.
#[derive(Debug, Clone)]
pub struct MeshFile {
    /// The parts of the file. There is at least one part.
    pub parts: Vec<MeshPart>,
    /// What the file states about materials and this reader ignores, such as textures.
    pub ignored: Option<String>,
    /// Sentences about what the file names and the reader cannot use, such as missing pictures.
    pub warnings: Vec<String>,
    /// Sentences about the geometry, such as faces that were dropped.
    pub remarks: Vec<String>,
    /// True if the file also contains lights, which are not part of the mesh.
    pub has_lights: bool,
}

/// Reads a mesh file by its extension: `.obj` (with its `.mtl`), `.ply`, `.stl`, `.serialized`,
/// `.gltf`, `.glb`, or a gem design `.asc`, `.gem` or `.gcs`. `file_access` states which other files
/// the file may name.
///
/// # Errors
/// Returns an error with the name of the file if it is missing, has an unknown format, is truncated
/// or malformed, or if no triangle has an area above 0.
pub fn load(path: &Path, file_access: FileAccess) -> Result<MeshFile> {
    let read = read_parts(path, file_access).map_err(|error| error.in_file(path));
    let PartsAndNotes { parts, mut ignored, warnings, remarks, has_lights } = read?;
    if parts.is_empty() {
        return Err(Error::input("the mesh has no triangles").in_file(path));
    }
    ignored.extend(open_panes(&parts));
    let ignored = (!ignored.is_empty()).then(|| ignored.join("; "));
    Ok(MeshFile { parts, ignored, warnings, remarks, has_lights })
}

/// Reads the parts of a mesh file like [`load`], for scenes that name them one by one.
pub fn load_unplaced(path: &Path, file_access: FileAccess) -> Result<UnplacedParts> {
    #[cfg(feature = "meshes")]
    if matches!(extension_of(path).as_str(), "gltf" | "glb") {
        return gltf::load_unplaced(path, file_access).map_err(|error| error.in_file(path));
    }
    let MeshFile { parts, ignored, warnings, remarks, has_lights: _ } = load(path, file_access)?;
    Ok(UnplacedParts { parts: (0..).zip(parts).collect(), ignored: ignored.into_iter().collect(), warnings, remarks })
}

#[cfg(feature = "meshes")]
fn read_parts(path: &Path, file_access: FileAccess) -> Result<PartsAndNotes> {
    let extension = extension_of(path);
    match extension.as_str() {
        "obj" => obj::load(path, file_access),
        "ply" => read(path).and_then(|bytes| ply::load(&bytes)),
        "ply.gz" => {
            let unpacked = read(path).and_then(|bytes| unpacked(GzDecoder::new(&bytes[..]), "gzip file"));
            unpacked.and_then(|bytes| ply::load(&bytes))
        }
        "stl" => read(path).and_then(|bytes| stl::load(&bytes)),
        "serialized" => read(path).and_then(|bytes| serialized::load(&bytes)).map(PartsAndNotes::of),
        "gltf" | "glb" => gltf::load(path, file_access),
        #[cfg(feature = "gems")]
        "asc" | "gem" | "gcs" => gem::load(path, &extension),
        #[cfg(not(feature = "gems"))]
        "asc" | "gem" | "gcs" => {
            Err(Error::input("this build cannot read gem designs").expected("the cargo feature `gems`"))
        }
        _ => Err(Error::input(format!("unknown kind of mesh file \"{extension}\""))
            .expected("one of .obj, .ply, .ply.gz, .stl, .serialized, .gltf, .glb, .asc, .gem, .gcs")),
    }
}

/// Returns the extension of a file name in lower case. That of a packed file is like "ply.gz".
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

#[cfg(test)]
#[cfg(feature = "meshes")]
mod obj_tests;
#[cfg(test)]
#[cfg(feature = "meshes")]
mod tests;
