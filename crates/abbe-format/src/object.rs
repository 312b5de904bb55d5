//! Objects in the scene file.

use crate::prelude::*;
use crate::{EmissionFile, JsonPath, KeyframeFile, ShapeFile, TransformFile, check, transform::validate_motion};
use abbe_spectra::error::Result;

/// An object: a shape with a material. An object with `emission` is an area light.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Object", example = json!({"name": "prism", "shape": {"prism": {"side": 0.5, "length": 0.6}},
    "material": "flint", "transform": [{"translate": [0, 0.5, 0]}]}))]
#[schemars(example = json!({"shape": {"disk": {"radius": 0.1}}, "material": "white", "emission": {"spectrum": "D65",
    "power": 20}, "motion": [{"time": 0, "transform": []}, {"time": 0.02, "transform": [{"translate": [0, 1, 0]}]}]}))]
pub struct ObjectFile {
    /// Name for reports and for paths such as `objects[name=prism]`.
    pub name: Option<String>,
    /// The shape of the object.
    pub shape: ShapeFile,
    /// Name of the material, from the scene's `materials`. All shapes except meshes need a
    /// material. If the material is absent, a mesh has the materials of its file.
    #[schemars(extend("x-default" = "materials of the mesh file"))]
    pub material: Option<String>,
    /// Placement of the shape in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
    /// Light that the surface emits.
    #[schemars(extend("x-default" = "no emission"))]
    pub emission: Option<EmissionFile>,
}

/// An entry of `objects`.
#[cfg(feature = "schema")]
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used, because the text of a scene is read without groups")]
pub(super) enum ObjectOrGroupFile {
    Object(Box<ObjectFile>),
    Group(GroupFile),
}

/// A group of objects and groups, which its transform and its motion move together. Errors count
/// the objects of a scene without groups.
#[cfg(feature = "schema")]
#[derive(JsonSchema)]
#[schemars(title = "Group", deny_unknown_fields)]
#[schemars(example = json!({"name": "table", "transform": [{"translate": [0, 0, 2]}],
    "motion": [{"time": 0, "transform": []}],
    "group": [{"shape": {"box": {"size": [1, 0.1, 1]}}, "material": "wood"}]}))]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) struct GroupFile {
    /// Name for paths such as `objects.table.transform`.
    name: Option<String>,
    /// The objects and groups.
    #[schemars(length(min = 1))]
    group: Vec<ObjectOrGroupFile>,
    /// Placement of the group, applied after the transforms of its objects.
    #[schemars(default)]
    transform: TransformFile,
    /// Keyframes of the motion of the group. Its objects and groups then have no motion.
    #[schemars(default)]
    motion: Vec<KeyframeFile>,
}

impl ObjectFile {
    /// Checks that all values are in range and that the object has a material.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { name: _, shape, material, transform, motion, emission } = self;
        let has_material = if material.is_some() || matches!(shape, ShapeFile::Mesh(_) | ShapeFile::Shared(_)) {
            Ok(())
        } else {
            let allowed = "the name of a material (only a mesh may leave it out)";
            Err(check::fault(at, "missing key \"material\"", allowed))
        };
        check::all([
            shape.validate(&at.key("shape")),
            has_material,
            transform.validate(&at.key("transform")),
            validate_motion(&at.key("motion"), motion),
            emission.as_ref().map_or(Ok(()), |emission| emission.validate(&at.key("emission"))),
        ])
    }
}
