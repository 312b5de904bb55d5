//! Triangle meshes and the files they come from.

mod material;
mod triangles;

pub use material::{MeshAttenuation, MeshMaterial};
pub use triangles::TriangleMesh;
pub(crate) use triangles::triangle_normal;
#[derive(Debug)]
pub struct MeshPart { pub mesh: TriangleMesh, pub material: Option<MeshMaterial>, pub name: String }
pub fn load(p: &std::path::Path) -> crate::error::Result<Vec<MeshPart>> { Err(crate::error::Error::input("x").in_file(p)) }
