//! Normal maps in the scene file.

use crate::picture::{is_one, one};
use crate::prelude::*;
use crate::{FilterFile, UvFile, WrapFile, forms};

/// A material with shading normals from a picture. The red, green and blue components of the
/// picture, from 0 to 1, encode the components x, y and z of the normals from −1 to 1. x points
/// along u, and z along the surface normal.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NormalMapFile {
    /// Name of the material, from the scene's `materials`.
    pub material: String,
    /// Path of the picture, relative to the scene's folder.
    pub path: String,
    /// Factor of the components x and y.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0))]
    pub strength: f64,
    /// Direction in the picture in which the normals with a large green component lean.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub green: GreenFile,
    /// What the picture looks like outside the unit square of uv.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub wrap: WrapFile,
    /// How texels are interpolated.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub filter: FilterFile,
    /// The map of texture coordinates.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(extend("x-default" = "no change"))]
    pub uv: UvFile,
}

/// The direction of the green component of a normal map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Green of a normal map")]
pub enum GreenFile {
    /// Upwards, as in glTF, Blender and OpenGL.
    #[default]
    Up,
    /// Downwards, as in DirectX.
    Down,
}
