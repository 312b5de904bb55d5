//! The types of the scene file, its JSON Schema, and the functions that read the scene file.
//!
//! [`read`] reads a file into a [`SceneFile`]. The module `json` parses the text and deserialises
//! it into the types of this module. Then `validate` checks the ranges of single values. Finally,
//! the module [`resolve`] looks up names, reads the other files that the scene names, and converts
//! everything to SI units. [`JsonSource::error_at`] adds the position in the scene file to the
//! errors of [`resolve`].

mod camera;
mod check;
mod emission;
mod field;
mod film;
mod forms;
mod index;
mod lens;
pub mod light;
mod material;
mod medium;
pub mod mesh;
mod object;
mod phase;
mod quantity;
mod reference;
#[cfg(test)]
mod reference_tests;
mod render;
pub mod resolve;
mod shape;
mod spectrum;
#[cfg(test)]
mod tests;
mod transform;
pub mod volume_file;

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

pub use camera::{CameraFile, CameraKeyframeFile, ShutterFile};
pub use emission::EmissionFile;
pub use field::{ExponentialFieldFile, FieldFile, NoiseFieldFile, PlanetFile, SphereFieldFile};
pub use film::{ExposureFile, FilmFile, GamutFile, ObserverFile, OutputSpaceFile, ToneFile, WhiteBalanceFile};
pub use index::{FormulaFile, IndexFile};
pub use lens::{LensFile, LensSurfaceFile, PrescriptionFile, SystemLensFile, ThinLensFile, ThinLensForm};
pub use light::LightFile;
pub use material::{ConductorFile, DielectricFile, MaterialFile, ThinDielectricFile, WeightedMaterialFile};
pub use medium::{GridFile, HomogeneousFile, MediumBlackbodyFile, MediumEmissionFile, MediumFile, TransmittanceFile};
pub use object::ObjectFile;
pub use phase::PhaseFile;
pub use quantity::QuantityFile;
pub use reference::scene_reference;
pub use render::{LightMapFile, RenderFile};
pub use shape::ShapeFile;
pub use spectrum::{ImageFile, LineFile, ReflectanceFile, SpectrumFile, WeightedSpectrumFile};
pub use transform::{KeyframeFile, ScaleFile, TransformFile, TransformStepFile};

use crate::error::Result;
pub use crate::json::{FileAccess, JsonPath, JsonSource, MAX_BYTES, PATCH_LABEL, read_text};
use spectrum::SpectrumUse;

/// A scene.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Scene", example = json!({
    "$schema": "scene.schema.json", "title": "A glass ball in mist", "unit": "m",
    "camera": {"from": [0, 1, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 35}}},
    "film": {"width": 640, "height": 360},
    "spectra": {"warm": {"blackbody": {"temperature": 2856}}},
    "media": {"mist": {"homogeneous": {"absorption": 0, "scattering": 0.05, "phase": "isotropic"}}},
    "materials": {"crown": {"dielectric": {"ior": "N-BK7"}}},
    "objects": [{"shape": {"sphere": {"center": [0, 0.5, 0], "radius": 0.5}}, "material": "crown"}],
    "lights": [{"point": {"at": [0, 3, 0], "spectrum": "warm", "luminous_flux": 800}}],
    "atmosphere": "mist", "render": {"passes": 64}
}))]
pub struct SceneFile {
    /// Path or URL of the JSON Schema of the scene file, for editors. Abbe ignores it.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// Title of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Unit of all lengths whose key does not name another unit.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub unit: UnitFile,
    /// The camera.
    pub camera: CameraFile,
    /// The film: size and colours of the picture.
    pub film: FilmFile,
    /// Spectra by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub spectra: BTreeMap<String, SpectrumFile>,
    /// Media by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub media: BTreeMap<String, MediumFile>,
    /// Materials by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub materials: BTreeMap<String, MaterialFile>,
    /// The objects.
    pub objects: Vec<ObjectFile>,
    /// The lights that are not objects. Area lights are objects with `emission`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub lights: Vec<LightFile>,
    /// Name of the medium outside all objects, from `media`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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

/// Reads a scene file. `sets` are patches of the form `PATH=JSON`. They are applied in the order of
/// the list.
///
/// # Errors
/// Returns an error if the file cannot be read, is larger than [`MAX_BYTES`] or is not JSON. Also
/// returns an error if a patch cannot be applied, if a key is unknown, or if a value has a wrong
/// type or is out of range. If the fault has a position in the file, the error states the line, the
/// column and the JSON path.
pub fn read(path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
    parse(&read_text(path)?, path, sets)
}

/// Reads a scene from its text. Errors use `path` as the name of the text. `sets` are patches as in
/// [`read`].
///
/// # Errors
/// Returns the same errors as [`read`].
pub fn parse(text: &str, path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
    let source = JsonSource::patched(text, path, sets)?;
    let scene: SceneFile = source.deserialize()?;
    scene.validate(&source)?;
    Ok((scene, source))
}

/// Reads a spectrum from its text, in any form that a scene may contain. Errors use `name` as the
/// name of the text. The spectrum may name any file, because the text comes from the user and not
/// from a scene file.
///
/// # Errors
/// If the text is not a spectrum, returns an error with its position in the text.
pub fn parse_spectrum(text: &str, name: &Path) -> Result<(SpectrumFile, JsonSource)> {
    let source = JsonSource::patched(text, name, &[])?.with_file_access(FileAccess::Anywhere);
    let spectrum: SpectrumFile = source.deserialize()?;
    spectrum.validate(&JsonPath::Root, SpectrumUse::Any).map_err(|error| source.with_position(error))?;
    Ok((spectrum, source))
}

/// Reads a lens prescription from its text, in any form that a scene may contain. Errors use `name`
/// as the name of the text.
///
/// # Errors
/// If the text is not a prescription, returns an error with its position in the text.
pub fn parse_prescription(text: &str, name: &Path) -> Result<(PrescriptionFile, JsonSource)> {
    let source = JsonSource::patched(text, name, &[])?;
    let prescription: PrescriptionFile = source.deserialize()?;
    prescription.validate(&JsonPath::Root).map_err(|error| source.with_position(error))?;
    Ok((prescription, source))
}

/// Returns the JSON Schema of the scene file. The schema follows draft 2020-12.
///
/// Three keys extend the schema: `x-unit` is the unit of a number, `x-default` describes a default
/// that is not a JSON value, and `x-range` describes a range that JSON Schema cannot express.
pub fn schema() -> serde_json::Value {
    schemars::generate::SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<SceneFile>().into()
}

impl SceneFile {
    /// Checks all rules that concern a single value or object.
    ///
    /// # Errors
    /// If several values are wrong, returns the error of the first wrong value in the order of the
    /// keys. The error contains its position in `source`.
    pub fn validate(&self, source: &JsonSource) -> Result<()> {
        self.check().map_err(|error| source.with_position(error))
    }

    /// Checks the same rules as [`Self::validate`]. The error has a JSON path, but no line and
    /// column.
    fn check(&self) -> Result<()> {
        let Self { schema: _, title: _, unit: _, camera, film, spectra, media, materials, .. } = self;
        let root = JsonPath::Root;
        camera.validate(&root.key("camera"))?;
        film.validate(&root.key("film"))?;
        let at = root.key("spectra");
        spectra.iter().try_for_each(|(name, spectrum)| spectrum.validate(&at.key(name), SpectrumUse::Any))?;
        let at = root.key("media");
        media.iter().try_for_each(|(name, medium)| medium.validate(&at.key(name)))?;
        let at = root.key("materials");
        materials.iter().try_for_each(|(name, material)| material.validate(&at.key(name)))?;
        let at = root.key("objects");
        self.objects.iter().enumerate().try_for_each(|(i, object)| object.validate(&at.index(i)))?;
        let at = root.key("lights");
        self.lights.iter().enumerate().try_for_each(|(i, light)| light.validate(&at.index(i)))?;
        self.render.validate(&root.key("render"))
    }
}
