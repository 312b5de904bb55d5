//! The scene file as written: text → [`SceneFile`], with the place of every value kept.
//!
//! The way of a scene file: `set` patches the text (`--set`), `scan` checks that it is strict JSON and notes where each
//! value stands (`positions`), `de` hands those values to serde, which fills the types of this folder, and `validate`
//! checks the rules that a single value can break. What names mean, and everything that needs two places of the scene
//! at once, is left to resolving; its errors come back through [`Source::error_at`] to gain their place.

mod camera;
mod check;
mod de;
mod fault;
mod film;
mod forms;
mod index;
mod light;
mod material;
mod medium;
mod object;
mod path;
mod positions;
mod quantity;
mod reach;
mod render;
mod scan;
mod set;
mod shape;
mod source;
mod spectrum;
#[cfg(test)]
mod tests;
mod transform;

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

pub use camera::{
    CameraFile, CameraKeyframeFile, LensFile, LensSurfaceFile, PrescriptionFile, ShutterFile, SystemLensFile,
    ThinLensFile, ThinLensForm,
};
pub use film::{ExposureFile, FilmFile, GamutFile, ObserverFile, OutputSpaceFile, WhiteBalanceFile};
pub use index::{FormulaFile, IndexFile};
pub use light::{BeamFile, DirectionalFile, EmissionFile, EnvironmentFile, IesFile, LightFile, PointFile, SpotFile};
pub use material::{ConductorFile, DielectricFile, MaterialFile, WeightedMaterialFile};
pub use medium::{
    ExponentialFieldFile, FieldFile, GridFile, HomogeneousFile, MediumBlackbodyFile, MediumEmissionFile, MediumFile,
    NoiseFieldFile, PhaseFile, PlanetFile, SphereFieldFile, TransmittanceFile,
};
pub use object::ObjectFile;
pub use path::JsonPath;
pub use quantity::QuantityFile;
pub use reach::Reach;
pub use render::{LightMapFile, RenderFile};
pub use shape::ShapeFile;
pub use source::{MAX_BYTES, Source, read_text};
pub use spectrum::{ImageFile, LineFile, ReflectanceFile, SpectrumFile, WeightedSpectrumFile};
pub use transform::{KeyframeFile, ScaleFile, TransformFile, TransformStepFile};

use crate::error::Result;
use spectrum::Use;

/// A scene as it is written.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Abbe scene")]
pub struct SceneFile {
    /// The JSON Schema, for editors.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// What the scene shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The unit of all lengths (default "m").
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub unit: UnitFile,
    /// The camera.
    pub camera: CameraFile,
    /// The film.
    pub film: FilmFile,
    /// Named spectra.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub spectra: BTreeMap<String, SpectrumFile>,
    /// Named media.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub media: BTreeMap<String, MediumFile>,
    /// Named materials.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub materials: BTreeMap<String, MaterialFile>,
    /// The objects.
    pub objects: Vec<ObjectFile>,
    /// The lights that are not objects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightFile>,
    /// Name of the medium that fills everything outside the objects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub atmosphere: Option<String>,
    /// How the picture is computed.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub render: RenderFile,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
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
    /// How many metres one unit is.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 1e-2,
            Self::Millimetre => 1e-3,
            Self::Micrometre => 1e-6,
        }
    }
}

/// Reads a scene file; `sets` are `PATH=JSON` patches in the order they apply.
///
/// Errors name file, line, column and JSON path: a file that cannot be read or is above [`MAX_BYTES`], malformed JSON,
/// wrong types, unknown keys, numbers out of range.
pub fn read(path: &Path, sets: &[String]) -> Result<(SceneFile, Source)> {
    parse(&source::read_text(path)?, path, sets)
}

/// Reads a scene from its text; `path` is the name that errors give the text.
pub fn parse(text: &str, path: &Path, sets: &[String]) -> Result<(SceneFile, Source)> {
    let source = set::patched(text, path, sets)?;
    let scene: SceneFile = from_source(&source)?;
    scene.validate(&source)?;
    Ok((scene, source))
}

/// Reads a spectrum from its text: any form that a scene may hold; `name` is the name that errors give the text. Who writes a spectrum by
/// itself may name any file in it.
pub fn parse_spectrum(text: &str, name: &Path) -> Result<(SpectrumFile, Source)> {
    let source = set::patched(text, name, &[])?.reaching(Reach::Anywhere);
    let spectrum: SpectrumFile = from_source(&source)?;
    spectrum.validate(&JsonPath::Root, Use::Any).map_err(|error| source.placed(error))?;
    Ok((spectrum, source))
}

/// Reads a lens prescription from its text, any form that a scene may hold; `name` is the name that errors give the text.
pub fn parse_prescription(text: &str, name: &Path) -> Result<(PrescriptionFile, Source)> {
    let source = set::patched(text, name, &[])?;
    let prescription: PrescriptionFile = from_source(&source)?;
    prescription.validate(&JsonPath::Root).map_err(|error| source.placed(error))?;
    Ok((prescription, source))
}

/// Fills a type from a source.
fn from_source<T: DeserializeOwned>(source: &Source) -> Result<T> {
    let root = source.positions().root(&source.text);
    T::deserialize(de::ValueDeserializer::new(root)).map_err(|fault| fault.explain(source))
}

/// The JSON Schema of the scene file, draft 2020-12.
pub fn schema() -> serde_json::Value {
    schemars::generate::SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<SceneFile>().into()
}

impl SceneFile {
    /// Checks every rule that a single value or object can break, in the order of the file format.
    pub fn validate(&self, source: &Source) -> Result<()> {
        self.check().map_err(|error| source.placed(error))
    }

    /// The same without file, line and column.
    fn check(&self) -> Result<()> {
        let Self { schema: _, title: _, unit: _, camera, film, spectra, media, materials, .. } = self;
        let root = JsonPath::Root;
        camera.validate(&root.key("camera"))?;
        film.validate(&root.key("film"))?;
        let at = root.key("spectra");
        spectra.iter().try_for_each(|(name, spectrum)| spectrum.validate(&at.key(name), Use::Any))?;
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
