//! The outermost object of a scene file.

use crate::prelude::*;
use crate::{
    CameraFile, FilmFile, JsonPath, JsonSource, LightFile, MaterialFile, MediumFile, MeterFile, ObjectFile, RenderFile,
    RequirementFile, ShapeFile, SpectrumFile, check, forms, spectrum::SpectrumUse,
};
use abbe_spectra::error::{Error, Result};
use serde::ser::Error as _;
use serde_json::Value;
use std::collections::BTreeMap;

/// A scene.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", deny_unknown_fields)]
#[schemars(rename = "SceneFile", title = "Scene", example = json!({
    "$schema": "scene.schema.json", "title": "A glass ball in mist", "unit": "m", "include": [],
    "variables": {"lamp_height": 3},
    "camera": {"from": [0, 1, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 35}}},
    "film": {"width": 640, "height": 360},
    "spectra": {"warm": {"blackbody": {"temperature": 2856}}},
    "media": {"mist": {"homogeneous": {"absorption": 0, "scattering": 0.05, "phase": "isotropic"}}},
    "materials": {"crown": {"dielectric": {"ior": "N-BK7"}}},
    "shapes": {"plate": {"box": {"size": [1, 0.1, 1]}}},
    "objects": [{"shape": {"sphere": {"center": [0, 0.5, 0], "radius": 0.5}}, "material": "crown"}],
    "lights": [{"point": {"at": [0, 3, 0], "spectrum": "warm", "luminous_flux": 800}}],
    "meters": [{"name": "table", "points": [[0, 0, 1]]}],
    "requirements": [{"meter": "table", "at_least": 100}],
    "atmosphere": "mist", "render": {"passes": 64}
}))]
pub struct SceneFile {
    /// Path or URL of the JSON Schema of the scene file, for editors. Abbe ignores it.
    #[serde(rename = "$schema")]
    pub schema: Option<String>,
    /// Title of the scene.
    pub title: Option<String>,
    /// Names of files with parts of the scene: objects with the sections `variables`, `spectra`,
    /// `media`, `materials`, `shapes`, `objects`, `lights` and `meters`, which are added to those
    /// of the scene. Paths in a part are relative to the folder of the scene. A part includes no
    /// files.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub include: Vec<String>,
    /// Values by name. A string `"$name"` anywhere in the scene stands for the value of this name.
    /// The values contain no variables.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub variables: BTreeMap<String, Value>,
    /// Unit of all lengths whose key does not name another unit.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub unit: UnitFile,
    /// The camera. Only a scene with `meters` may leave it out.
    #[schemars(extend("x-default" = "no camera, if the scene has `meters`"))]
    pub camera: Option<CameraFile>,
    /// The film: size and colours of the picture. Only a scene with `meters` may leave it out.
    #[schemars(extend("x-default" = "no film, if the scene has `meters`"))]
    pub film: Option<FilmFile>,
    /// Spectra by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub spectra: BTreeMap<String, SpectrumFile>,
    /// Media by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub media: BTreeMap<String, MediumFile>,
    /// Materials by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub materials: BTreeMap<String, MaterialFile>,
    /// Shapes by name, for objects with the shape `shared`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub shapes: BTreeMap<String, ShapeFile>,
    /// The objects, and groups of objects.
    #[schemars(with = "Vec<crate::object::ObjectOrGroupFile>")]
    pub objects: Vec<ObjectFile>,
    /// The lights that are not objects. Area lights are objects with `emission`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub lights: Vec<LightFile>,
    /// The meters, which `abbe measure` reads. A picture does not show them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub meters: Vec<MeterFile>,
    /// What the readings of the meters must reach.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub requirements: Vec<RequirementFile>,
    /// Name of the medium outside all objects, from `media`.
    #[schemars(extend("x-default" = "no medium"))]
    pub atmosphere: Option<String>,
    /// The render settings. Options of the command line override them.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub render: RenderFile,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[schemars(title = "Unit of length")]
pub enum UnitFile {
    /// Metre.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Centimetre.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetre.
    #[serde(rename = "mm")]
    Millimetre,
    /// Micrometre.
    #[serde(rename = "um")]
    Micrometre,
}

impl<'de> Deserialize<'de> for SceneFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        Self::deserialize(deserializer)
    }
}

impl Serialize for SceneFile {
    /// Writes the scene without the keys that have no value.
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let scene = Self::serialize(self, serde_json::value::Serializer).map_err(S::Error::custom)?;
        without_nulls(scene).serialize(serializer)
    }
}

/// Removes the entries of all objects in a value that are null: keys without a value.
pub fn without_nulls(mut value: Value) -> Value {
    match &mut value {
        Value::Object(entries) => {
            entries.retain(|_, entry| !entry.is_null());
            entries.values_mut().for_each(|entry| *entry = without_nulls(entry.take()));
        }
        Value::Array(elements) => elements.iter_mut().for_each(|element| *element = without_nulls(element.take())),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
    value
}

impl UnitFile {
    /// Returns the length of one unit in metres.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 1e-2,
            Self::Millimetre => 1e-3,
            Self::Micrometre => 1e-6,
        }
    }
}

impl SceneFile {
    /// Keeps only the meters with these names. An empty list keeps all meters.
    ///
    /// # Errors
    /// Returns an error if the scene has no meter of a name.
    pub fn select_meters(&mut self, names: &[String]) -> Result<()> {
        for name in names {
            if !self.meters.iter().any(|meter| meter.name == *name) {
                let known = self.meters.iter().map(|meter| meter.name.as_str());
                return Err(Error::unknown_name("meter", name, known));
            }
        }
        if !names.is_empty() {
            self.meters.retain(|meter| names.contains(&meter.name));
            self.requirements.retain(|requirement| names.contains(&requirement.meter));
        }
        Ok(())
    }

    /// Checks all rules that concern a single value or object.
    ///
    /// # Errors
    /// Returns an error with all wrong values. Each fault contains its position in `source`.
    pub fn validate(&self, source: &JsonSource) -> Result<()> {
        self.check().map_err(|error| source.with_position(error))
    }

    /// Checks the rules of [`Self::validate`]. The error has a path, but no line and column.
    fn check(&self) -> Result<()> {
        let Self { schema: _, title: _, unit: _, camera, film, spectra, media, materials, shapes, .. } = self;
        let root = JsonPath::Root;
        let absent = |key: &str| {
            let expected = format!("`{key}`, or `meters` for `abbe measure`");
            let missing = check::fault(&root, format!("missing key \"{key}\""), expected);
            if self.meters.is_empty() { Err(missing) } else { Ok(()) }
        };
        let mut results = vec![
            camera.as_ref().map_or_else(|| absent("camera"), |camera| camera.validate(&root.key("camera"))),
            film.as_ref().map_or_else(|| absent("film"), |film| film.validate(&root.key("film"))),
        ];
        let at = root.key("meters");
        results.extend(self.meters.iter().enumerate().map(|(i, meter)| meter.validate(&at.index(i))));
        let at = root.key("requirements");
        let requirements = self.requirements.iter().enumerate();
        results.extend(requirements.map(|(i, requirement)| requirement.validate(&at.index(i), &self.meters)));
        let at = root.key("spectra");
        results.extend(spectra.iter().map(|(name, spectrum)| spectrum.validate(&at.key(name), SpectrumUse::Any)));
        let at = root.key("media");
        results.extend(media.iter().map(|(name, medium)| medium.validate(&at.key(name))));
        let at = root.key("materials");
        results.extend(materials.iter().map(|(name, material)| material.validate(&at.key(name))));
        let at = root.key("shapes");
        results.extend(shapes.iter().map(|(name, shape)| shape.validate(&at.key(name))));
        let at = root.key("objects");
        results.extend(self.objects.iter().enumerate().map(|(i, object)| object.validate(&at.index(i))));
        let at = root.key("lights");
        results.extend(self.lights.iter().enumerate().map(|(i, light)| light.validate(&at.index(i))));
        results.push(self.render.validate(&root.key("render")));
        check::all(results)
    }
}
