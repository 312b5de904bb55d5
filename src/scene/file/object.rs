//! Objects as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::light::EmissionFile;
use super::path::JsonPath;
use super::shape::ShapeFile;
use super::transform::{KeyframeFile, TransformFile, validate_motion};
use crate::error::Result;

/// A thing in the scene.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectFile {
    /// Its name, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Its shape.
    pub shape: ShapeFile,
    /// Name of its material; only a mesh, which may bring its own, can do without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Where it stands, as steps applied first to last.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
    /// Light that its surface emits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<EmissionFile>,
}

impl ObjectFile {
    /// Checks ranges, and that there is a material.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { name: _, shape, material, transform, motion, emission } = self;
        shape.validate(&at.key("shape"))?;
        if material.is_none() && !matches!(shape, ShapeFile::Mesh { .. }) {
            let allowed = "the name of a material (only a mesh may leave it out)";
            return Err(check::fault(at, "missing key \"material\"", allowed));
        }
        transform.validate(&at.key("transform"))?;
        validate_motion(&at.key("motion"), motion)?;
        emission.as_ref().map_or(Ok(()), |emission| emission.validate(&at.key("emission")))
    }
}
