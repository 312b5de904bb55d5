//! The scene file of the renderer Abbe: strict JSON, its JSON Schema, and its resolution.
//!
//! [`read()`] reads a file into a [`SceneFile`]. The module [`json`] parses the text and
//! deserialises it into the types of this crate, which check the ranges of single values. Then the
//! module [`resolve`] looks up names, reads the other files that the scene names, and converts
//! everything to SI units. Every error states its line, its column and its JSON path, and suggests
//! a similar name if one exists.
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
//! | [`luminaire`] | IES LM-63, EULUMDAT and IES TM-33 files |
//! | [`mesh`] | OBJ, PLY, STL, glTF and Mitsuba's serialized meshes (feature `meshes`), gem designs (feature `gems`) |
//! | [`volume_file`] | volumes in `.npz` files |
//! | [`resolve`] | the resolution of a scene file into a scene |
//!
//! The other forms are at the root: each type named `…File` mirrors a key of the file.
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
mod file_kinds;
mod film;
mod filter;
mod forms;
#[cfg(all(test, feature = "schema"))]
mod forms_tests;
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
mod picture_exr;
mod picture_file;
mod picture_primaries;
mod quantity;
mod radiance_hdr;
pub mod ray_file;
mod read;
mod reference;
#[cfg(test)]
mod reference_tests;
mod render;
mod requirement;
pub mod resolve;
mod scene_file;
#[cfg(feature = "schema")]
mod schema;
#[cfg(test)]
mod schema_tests;
mod shape;
mod spectrum;
mod srgb;
#[cfg(test)]
mod tests;
mod texture;
mod transform;
mod uv;
pub mod volume_file;

pub use camera::{CameraFile, CameraKeyframeFile, ShutterFile};
pub use coating::{CoatingFile, CoatingIndexFile, CoatingLayerFile, ComplexIndexFile};
pub use emission::EmissionFile;
pub use field::{ExponentialFieldFile, FieldFile, NoiseFieldFile, PlanetFile, SphereFieldFile};
pub use file_kinds::is_json_schema;
pub use film::{
    BloomFile, ExposureFile, FilmFile, GamutFile, LayerFile, ObserverFile, OutputSpaceFile, ToneFile, WhiteBalanceFile,
};
pub use filter::{
    BeamFile, CircularPolariserFile, DiscFile, HandednessFile, LiquidCrystalFile, PolariserFile, PolarisingFilterFile,
    RetarderFile, StressFile,
};
pub use grating::{GratingFile, GratingProfileFile, GroovesFile, OrderEfficiencyFile};
pub use index::{FormulaFile, IndexFile};
pub use lens::{
    LensFile, LensSurfaceFile, LensTransmissionFile, PrescriptionFile, SystemLensFile, ThinLensFile, ThinLensForm,
};
pub use light::LightFile;
pub use material::{
    ConductorFile, CrystalFile, DielectricFile, MaterialFile, PaneTransmittanceFile, ThinDielectricFile,
    WeightedMaterialFile,
};
pub use medium::{
    DyeFile, GridFile, HomogeneousFile, MediumBlackbodyFile, MediumEmissionFile, MediumFile, TransmittanceFile,
};
pub use meter::{
    MeterCylinderFile, MeterFile, MeterGridFile, MeterSphereFile, MeterSpotFile, QuantityKindFile, SideFile,
};
pub use normal_map::{GreenFile, NormalMapFile};
pub use object::ObjectFile;
pub use phase::{IceOrientationFile, IcePopulationFile, PhaseFile};
pub use picture::{BandImageFile, ChannelFile, ColourImageFile, EncodingFile, FilterFile, ScalarImageFile, WrapFile};
pub use picture_file::PictureFile;
pub use quantity::QuantityFile;
pub use read::{parse, parse_coating, parse_prescription, parse_spectrum, read, read_scene_text};
pub use reference::scene_reference;
pub use render::{LightMapFile, RenderFile};
pub use requirement::RequirementFile;
pub use resolve::parse_with_access;
pub use scene_file::{SceneFile, UnitFile, without_nulls};
pub use shape::{MeshShapeFile, ShapeFile, TrianglesFile};
pub use spectrum::{ImageFile, LineFile, SpectrumFile, SpectrumPathFile, WeightedSpectrumFile};
pub use srgb::{SrgbFile, is_hex_colour, linear_of_hex};
pub use texture::{GradientFile, NoisePatternFile, PatternFile, ReflectanceFile, ScalarFile};
pub use transform::{KeyframeFile, ScaleFile, TransformFile, TransformStepFile};
pub use uv::UvFile;

pub use crate::json::{FileAccess, JsonPath, JsonSource, MAX_BYTES, NamedFile, PATCH_LABEL, read_text};

/// Returns the JSON Schema of the scene file. The schema follows draft 2020-12.
///
/// Three keys extend the schema: `x-unit` is the unit of a number, `x-default` describes a default
/// that is not a JSON value, and `x-range` describes a range that JSON Schema cannot express.
pub fn schema() -> serde_json::Value {
    serde_json::from_str(include_str!("../data/scene.schema.json")).expect("a test generates the file")
}

/// Generates the JSON Schema of the scene file from the types of this module. Only tests call this
/// function: they compare it with the file `scenes/scene.schema.json`, which [`schema()`] returns.
#[cfg(feature = "schema")]
pub fn generated_schema() -> serde_json::Value {
    let generator = schemars::generate::SchemaSettings::draft2020_12().into_generator();
    schema::with_notes(generator.into_root_schema_for::<SceneFile>().into())
}

/// The traits that the types of the scene file derive, and the macro in the attributes of their
/// schema.
mod prelude {
    #[cfg(not(feature = "schema"))]
    pub(crate) use abbe_no_schema::JsonSchema;
    #[cfg(feature = "schema")]
    pub(crate) use schemars::JsonSchema;
    pub(crate) use serde::{Deserialize, Deserializer, Serialize, Serializer};
    #[cfg(feature = "schema")]
    pub(crate) use serde_json::json;
}
