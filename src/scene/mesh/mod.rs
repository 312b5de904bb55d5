//! Triangle meshes and the files they come from.

mod material;
mod triangles;

pub use material::{MeshAttenuation, MeshMaterial};
pub use triangles::TriangleMesh;
pub(crate) use triangles::triangle_normal;
