//! The scene file of the renderer Abbe: strict JSON, its JSON Schema, and its resolution into a
//! scene.
//!
//! [`read`] reads a file into a [`SceneFile`]. The module [`json`] parses the text and deserialises
//! it into the types of this crate, which check the ranges of single values. Then the module
//! [`resolve`] looks up names, reads the other files that the scene names, and converts everything
//! to SI units. Every error states its line, its column and its JSON path, and suggests a similar
//! name if one exists.
//!
//! ```
//! use abbe_format::{parse, resolve::resolve};
//!
//! let text = r#"{
//!   "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
//!   "film": {"width": 8, "height": 8},
//!   "materials": {"glass": {"dielectric": {"ior": "N-BK8"}}},
//!   "objects": [{"name": "ball", "shape": {"sphere": {"radius": 1}}, "material": "glass"}],
//!   "lights": [{"environment": {"spectrum": "D65", "illuminance": 1000}}]
//! }"#;
//! let (file, source) = parse(text, "scene.json".as_ref(), &[])?;
//! let error = resolve(&file, &source).expect_err("no glass has this name").to_string();
//! assert!(error.starts_with("scene.json:4:"), "{error}");
//! assert!(error.contains("did you mean \"N-BK7\"?"), "{error}");
//! # Ok::<(), abbe_spectra::Error>(())
//! ```
//!
//! `examples/find_a_mistake.rs` prints the errors of a scene.
//!
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`json`] | strict JSON with the position of every value, patches, the folder that a scene may read |
//! | [`light`] | the forms of lights |
//! | [`luminaire`] | IES LM-63 and EULUMDAT files |
//! | [`mesh`] | OBJ, PLY, STL, glTF and Mitsuba's serialized meshes (feature `meshes`) |
//! | [`volume_file`] | volumes in `.npz` files |
//! | [`resolve`] | the resolution of a scene file into a scene |
//!
//! The other forms are at the root: each type whose name ends with `File` mirrors a key of the
//! file.
//!
//! # Units and conventions
//!
//! Lengths in a file are in the file's `unit`, which is the metre by default, and angles are in
//! degrees. A resolved scene is in m, W and rad. Keys are in snake case, and unknown keys are
//! errors.
//!
//! # Dependencies
//!
//! [`abbe_scene`] is the result, [`abbe_optics`] finds glasses and lenses, and [`abbe_spectra`]
//! spectra.

mod camera;
mod check;
mod coating;
mod date_time;
mod emission;
mod field;
mod film;
mod foreign;
mod forms;
mod grating;
mod index;
pub mod json;
mod lens;
pub mod light;
pub mod luminaire;
mod material;
mod medium;
pub mod mesh;
mod meter;
mod normal_map;
mod object;
mod phase;
mod picture;
mod picture_file;
mod quantity;
mod reference;
#[cfg(test)]
mod reference_tests;
mod render;
pub mod resolve;
#[cfg(test)]
mod schema_tests;
mod shape;
mod spectrum;
mod srgb;
#[cfg(test)]
mod tests;
mod texture;
mod transform;
pub mod volume_file;

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

pub use camera::{CameraFile, CameraKeyframeFile, ShutterFile};
pub use coating::{CoatingFile, CoatingIndexFile, CoatingLayerFile, ComplexIndexFile};
pub use emission::EmissionFile;
pub use field::{ExponentialFieldFile, FieldFile, NoiseFieldFile, PlanetFile, SphereFieldFile};
pub use film::{
    ExposureFile, FilmFile, GamutFile, LayerFile, ObserverFile, OutputSpaceFile, ToneFile, WhiteBalanceFile,
};
pub use grating::{GratingFile, GratingProfileFile, GroovesFile, OrderEfficiencyFile};
pub use index::{FormulaFile, IndexFile};
pub use lens::{
    LensFile, LensSurfaceFile, LensTransmissionFile, PrescriptionFile, SystemLensFile, ThinLensFile, ThinLensForm,
};
pub use light::LightFile;
pub use material::{
    ConductorFile, DielectricFile, MaterialFile, PaneTransmittanceFile, ThinDielectricFile, WeightedMaterialFile,
};
pub use medium::{
    DyeFile, GridFile, HomogeneousFile, MediumBlackbodyFile, MediumEmissionFile, MediumFile, TransmittanceFile,
};
pub use meter::{
    MeterCylinderFile, MeterFile, MeterGridFile, MeterSphereFile, MeterSpotFile, QuantityKindFile, SideFile,
};
pub use normal_map::{GreenFile, NormalMapFile};
pub use object::ObjectFile;
pub use phase::PhaseFile;
pub use picture::{BandImageFile, ChannelFile, ColourImageFile, EncodingFile, FilterFile, ScalarImageFile, WrapFile};
pub use picture_file::PictureFile;
pub use quantity::QuantityFile;
pub use reference::scene_reference;
pub use render::{LightMapFile, RenderFile};
pub use shape::{MeshShapeFile, ShapeFile, TrianglesFile};
pub use spectrum::{ImageFile, LineFile, SpectrumFile, WeightedSpectrumFile};
pub use srgb::{SrgbFile, is_hex_colour, linear_of_hex};
pub use texture::{GradientFile, NoisePatternFile, PatternFile, ReflectanceFile, ScalarFile, UvFile};
pub use transform::{KeyframeFile, ScaleFile, TransformFile, TransformStepFile};

pub use crate::json::{FileAccess, JsonPath, JsonSource, MAX_BYTES, PATCH_LABEL, read_text};
use abbe_spectra::error::{Error, Result};
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
    "shapes": {"plate": {"box": {"size": [1, 0.1, 1]}}},
    "objects": [{"shape": {"sphere": {"center": [0, 0.5, 0], "radius": 0.5}}, "material": "crown"}],
    "lights": [{"point": {"at": [0, 3, 0], "spectrum": "warm", "luminous_flux": 800}}],
    "meters": [{"name": "table", "points": [[0, 0, 1]]}],
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
    /// The camera. Only a scene with `meters` may leave it out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-default" = "no camera, if the scene has `meters`"))]
    pub camera: Option<CameraFile>,
    /// The film: size and colours of the picture. Only a scene with `meters` may leave it out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-default" = "no film, if the scene has `meters`"))]
    pub film: Option<FilmFile>,
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
    /// Shapes by name, for objects with the shape `shared`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub shapes: BTreeMap<String, ShapeFile>,
    /// The objects.
    pub objects: Vec<ObjectFile>,
    /// The lights that are not objects. Area lights are objects with `emission`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub lights: Vec<LightFile>,
    /// The meters, which `abbe measure` reads. A picture does not show them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "forms::never")]
    pub meters: Vec<MeterFile>,
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
/// column and the JSON path. If the file has several faults, the error contains all of them, up to
/// [`MAX_FAULTS`](abbe_spectra::error::MAX_FAULTS).
pub fn read(path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
    parse(read_scene_text(path)?, path, sets)
}

/// Reads the text of a scene file.
///
/// # Errors
/// Returns an error if the file cannot be read, is too large, is not UTF-8, or is a file of another
/// program. In the last case, the error says how to bring the file into a scene.
pub fn read_scene_text(path: &Path) -> Result<String> {
    foreign::refuse_foreign(path)?;
    read_text(path)
}

/// Reads a scene from its text. Errors use `path` as the name of the text. `sets` are patches as in
/// [`read`].
///
/// # Errors
/// Returns the same errors as [`read`].
pub fn parse(text: impl Into<String>, path: &Path, sets: &[String]) -> Result<(SceneFile, JsonSource)> {
    let source = JsonSource::patched(text, path, sets)?;
    parse_source(source, |_, _| None)
}

/// Reads a scene from its text like [`parse`]. `access` says which files the scene may name. If the
/// text has faults, the error also contains the faults that [`resolve::resolve`] finds, such as
/// unknown names.
///
/// # Errors
/// Returns the errors of [`parse`] and of [`resolve::resolve`].
pub fn parse_with_access(
    text: impl Into<String>,
    path: &Path,
    sets: &[String],
    access: FileAccess,
) -> Result<(SceneFile, JsonSource)> {
    let source = JsonSource::patched(text, path, sets)?.with_file_access(access);
    parse_source(source, |scene, source| resolve::resolve_any(scene, source).err())
}

/// Reads a scene and checks single values. If the text has faults, `look_further` returns further
/// faults of the scene, in which stand-ins replace the wrong parts.
fn parse_source(
    source: JsonSource,
    look_further: impl FnOnce(&SceneFile, &JsonSource) -> Option<Error>,
) -> Result<(SceneFile, JsonSource)> {
    let repaired = source.deserialize_repaired::<SceneFile>();
    let mut faults = repaired.faults.clone();
    if let Some(scene) = &repaired.value {
        let mut later = scene.validate(&source).err();
        if (later.is_some() || !faults.is_empty()) && !repaired.lacks_definitions(&source) {
            // A fault of the whole scene, such as a scene without light, may follow from the
            // others.
            let further = look_further(scene, &source).map_or_else(Vec::new, Error::into_faults);
            let in_a_part = |fault: &Error| fault.location.path.as_deref().is_some_and(|path| !path.is_empty());
            // The resolver repeats some checks of `validate`. It may find the same fault in a value
            // that contains the wrong value, such as a table.
            let known = later.clone().map_or_else(Vec::new, Error::into_faults);
            let contains = |fault: &Error, known: &Error| match (&fault.location.path, &known.location.path) {
                (Some(whole), Some(part)) => part
                    .strip_prefix(whole.as_str())
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '['])),
                (None, _) | (_, None) => false,
            };
            let is_new = |fault: &Error| {
                !known.iter().any(|known| {
                    (&known.what, &known.expected) == (&fault.what, &fault.expected) || contains(fault, known)
                })
            };
            let further = further.into_iter().filter(|fault| in_a_part(fault) && is_new(fault));
            later = Error::all(later.into_iter().chain(further));
        }
        let later = later.map_or_else(Vec::new, Error::into_faults);
        faults.extend(later.into_iter().filter(|fault| !repaired.explains(&source, fault)));
    }
    match (repaired.value, Error::all(faults)) {
        (Some(scene), None) => Ok((scene, source)),
        (_, Some(error)) => Err(error),
        (None, None) => Err(Error::input("the scene cannot be read").in_file(&source.path)),
    }
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

/// Reads a stack of thin films from its text, in the form of a coating in a scene. Errors use
/// `name` as the name of the text. Paths in the stack may name any file.
///
/// # Errors
/// If the text is not a stack, returns an error with its position in the text.
pub fn parse_coating(text: &str, name: &Path) -> Result<(CoatingFile, JsonSource)> {
    let source = JsonSource::patched(text, name, &[])?.with_file_access(FileAccess::Anywhere);
    let coating: CoatingFile = source.deserialize()?;
    coating.validate(&JsonPath::Root).map_err(|error| source.with_position(error))?;
    Ok((coating, source))
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
///
pub fn schema() -> serde_json::Value {
    serde_json::from_str(include_str!("../data/scene.schema.json")).expect("a test generates the file")
}

/// Generates the JSON Schema of the scene file from the types of this module. Only tests call this
/// function: they compare it with the file `scenes/scene.schema.json`, which [`schema`] returns.
pub fn generated_schema() -> serde_json::Value {
    schemars::generate::SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<SceneFile>().into()
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

    /// Checks the same rules as [`Self::validate`]. The error has a JSON path, but no line and
    /// column.
    fn check(&self) -> Result<()> {
        let Self { schema: _, title: _, unit: _, camera, film, spectra, media, materials, shapes, .. } = self;
        let root = JsonPath::Root;
        let absent = |key: &str, present: bool| {
            let missing = !present && self.meters.is_empty();
            let error = || {
                check::fault(
                    &root,
                    format!("missing key \"{key}\""),
                    format!("`{key}`, or `meters` for `abbe measure`"),
                )
            };
            if missing { Err(error()) } else { Ok(()) }
        };
        let mut results = vec![
            camera.as_ref().map_or_else(|| absent("camera", false), |camera| camera.validate(&root.key("camera"))),
            film.as_ref().map_or_else(|| absent("film", false), |film| film.validate(&root.key("film"))),
        ];
        let at = root.key("meters");
        results.extend(self.meters.iter().enumerate().map(|(i, meter)| meter.validate(&at.index(i))));
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
