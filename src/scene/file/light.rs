//! Lights and the emission of objects, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::path::JsonPath;
use super::quantity::{QuantityFile, one_quantity, validate_quantity};
use super::spectrum::{ImageFile, SpectrumFile, Use};
use super::transform::{KeyframeFile, TransformFile, validate_motion};
use crate::error::Result;

/// A light.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LightFile {
    /// A point that shines equally into all directions.
    Point(PointFile),
    /// A point that shines into a cone.
    Spot(SpotFile),
    /// A uniform disk of parallel light, such as a laser or a slit of sunlight.
    Beam(BeamFile),
    /// Light from infinitely far away, such as the sun.
    Directional(DirectionalFile),
    /// Light from everywhere around, constant or from a picture.
    Environment(EnvironmentFile),
    /// A lamp measured by a goniophotometer (IES LM-63 file).
    Ies(IesFile),
}

/// A point light.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointFile {
    /// Where it stands.
    pub at: [f64; 3],
    /// The shape of its spectrum.
    pub spectrum: SpectrumFile,
    /// Power in W over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub power: Option<f64>,
    /// Luminous flux in lm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminous_flux: Option<f64>,
    /// Intensity in W/sr.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub intensity: Option<f64>,
    /// Luminous intensity in cd.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminous_intensity: Option<f64>,
    /// Where it stands in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// A spotlight.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpotFile {
    /// Where it stands.
    pub at: [f64; 3],
    /// A point on its axis.
    pub to: [f64; 3],
    /// Half-angle of the cone in degrees.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    pub half_angle: f64,
    /// The last degrees inside `half_angle`, over which it falls off (smoothstep in cos θ; default 0).
    #[serde(default, skip_serializing_if = "super::forms::is_default")]
    #[schemars(range(min = 0))]
    pub penumbra: f64,
    /// The shape of its spectrum.
    pub spectrum: SpectrumFile,
    /// Power in W over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub power: Option<f64>,
    /// Luminous flux in lm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminous_flux: Option<f64>,
    /// Intensity on the axis in W/sr.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub intensity: Option<f64>,
    /// Luminous intensity on the axis in cd.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminous_intensity: Option<f64>,
    /// Where it stands in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// A beam.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BeamFile {
    /// Centre of the disk that it leaves.
    pub from: [f64; 3],
    /// A point on its axis.
    pub to: [f64; 3],
    /// Radius of the disk.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Half-angle in degrees of a cone of constant radiance (default 0: parallel light).
    #[serde(default, skip_serializing_if = "super::forms::is_default")]
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 90))]
    pub divergence: f64,
    /// The shape of its spectrum.
    pub spectrum: SpectrumFile,
    /// Power in W over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub power: Option<f64>,
    /// Luminous flux in lm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminous_flux: Option<f64>,
    /// Where it stands in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// A directional light. It has no power of its own: that depends on how much of the scene stands in its way.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionalFile {
    /// The direction its light travels.
    pub toward: [f64; 3],
    /// Angular diameter of the source in degrees (default 0; the sun has 0.53).
    #[serde(default, skip_serializing_if = "super::forms::is_default")]
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 180))]
    pub angular_diameter: f64,
    /// The shape of its spectrum.
    pub spectrum: SpectrumFile,
    /// Irradiance in W/m² over 360–830 nm on a surface that faces it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub irradiance: Option<f64>,
    /// Illuminance in lx on a surface that faces it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub illuminance: Option<f64>,
    /// Turns it.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// An environment: exactly one of `spectrum` and `image`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentFile {
    /// The shape of its spectrum, the same from all directions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<SpectrumFile>,
    /// A picture of all directions, latitude by longitude, +y up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<ImageFile>,
    /// π × its mean radiance, in W/m² over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub irradiance: Option<f64>,
    /// π × its mean luminance, in lx.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub illuminance: Option<f64>,
    /// Turns it.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// A measured lamp.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IesFile {
    /// Where it stands.
    pub at: [f64; 3],
    /// The direction of its photometric axis (nadir).
    pub toward: [f64; 3],
    /// Path of the IES LM-63 file, relative to the scene's folder.
    pub path: String,
    /// The shape of its spectrum.
    pub spectrum: SpectrumFile,
    /// Power in W over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub power: Option<f64>,
    /// Luminous flux in lm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminous_flux: Option<f64>,
    /// Where it stands in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// The emission of an object, which makes it an area light.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EmissionFile {
    /// The shape of its spectrum.
    pub spectrum: SpectrumFile,
    /// Power in W over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub power: Option<f64>,
    /// Luminous flux in lm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminous_flux: Option<f64>,
    /// Radiance in W/m²/sr over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub radiance: Option<f64>,
    /// Luminance in cd/m².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminance: Option<f64>,
}

impl PointFile {
    /// Its one quantity.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[
            (self.power, QuantityFile::Power),
            (self.luminous_flux, QuantityFile::LuminousFlux),
            (self.intensity, QuantityFile::Intensity),
            (self.luminous_intensity, QuantityFile::LuminousIntensity),
        ])
    }
}

impl SpotFile {
    /// Its one quantity.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[
            (self.power, QuantityFile::Power),
            (self.luminous_flux, QuantityFile::LuminousFlux),
            (self.intensity, QuantityFile::Intensity),
            (self.luminous_intensity, QuantityFile::LuminousIntensity),
        ])
    }
}

impl BeamFile {
    /// Its one quantity.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[(self.power, QuantityFile::Power), (self.luminous_flux, QuantityFile::LuminousFlux)])
    }
}

impl DirectionalFile {
    /// Its one quantity.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[(self.irradiance, QuantityFile::Irradiance), (self.illuminance, QuantityFile::Illuminance)])
    }
}

impl EnvironmentFile {
    /// Its one quantity.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[(self.irradiance, QuantityFile::Irradiance), (self.illuminance, QuantityFile::Illuminance)])
    }
}

impl IesFile {
    /// Its one quantity.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[(self.power, QuantityFile::Power), (self.luminous_flux, QuantityFile::LuminousFlux)])
    }
}

impl EmissionFile {
    /// Its one quantity.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[
            (self.power, QuantityFile::Power),
            (self.luminous_flux, QuantityFile::LuminousFlux),
            (self.radiance, QuantityFile::Radiance),
            (self.luminance, QuantityFile::Luminance),
        ])
    }

    /// Checks ranges and the quantity.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        self.spectrum.validate(&at.key("spectrum"), Use::NotNegative)?;
        validate_quantity(at, self.quantity())
    }
}

impl LightFile {
    /// Its transform, and how it moves.
    pub fn way(&self) -> (&TransformFile, &[KeyframeFile]) {
        match self {
            Self::Point(light) => (&light.transform, &light.motion),
            Self::Spot(light) => (&light.transform, &light.motion),
            Self::Beam(light) => (&light.transform, &light.motion),
            Self::Directional(light) => (&light.transform, &light.motion),
            Self::Environment(light) => (&light.transform, &light.motion),
            Self::Ies(light) => (&light.transform, &light.motion),
        }
    }

    /// Checks ranges, directions and the quantity.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Point(light) => light.validate(&at.key("point")),
            Self::Spot(light) => light.validate(&at.key("spot")),
            Self::Beam(light) => light.validate(&at.key("beam")),
            Self::Directional(light) => light.validate(&at.key("directional")),
            Self::Environment(light) => light.validate(&at.key("environment")),
            Self::Ies(light) => light.validate(&at.key("ies")),
        }
    }
}

/// Checks what all lights have.
fn validate_pose(at: &JsonPath, transform: &TransformFile, motion: &[KeyframeFile]) -> Result<()> {
    transform.validate(&at.key("transform"))?;
    validate_motion(&at.key("motion"), motion)
}

impl PointFile {
    /// Checks ranges and the quantity.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        self.spectrum.validate(&at.key("spectrum"), Use::NotNegative)?;
        validate_quantity(at, self.quantity())?;
        validate_pose(at, &self.transform, &self.motion)
    }
}

impl SpotFile {
    /// Checks ranges, the axis and the quantity.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        check::apart(&at.key("to"), self.to, "at", self.at)?;
        check::between(&at.key("half_angle"), self.half_angle, 0.0, 180.0)?;
        let allowed = format!("a number from 0 to the half_angle, {}", check::number(self.half_angle));
        let inside = (0.0..=self.half_angle).contains(&self.penumbra);
        check::rule(&at.key("penumbra"), self.penumbra, inside, &allowed)?;
        self.spectrum.validate(&at.key("spectrum"), Use::NotNegative)?;
        validate_quantity(at, self.quantity())?;
        validate_pose(at, &self.transform, &self.motion)
    }
}

impl BeamFile {
    /// Checks ranges, the axis and the quantity.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        check::apart(&at.key("to"), self.to, "from", self.from)?;
        check::positive(&at.key("radius"), self.radius)?;
        let inside = (0.0..90.0).contains(&self.divergence);
        check::rule(&at.key("divergence"), self.divergence, inside, "a number of at least 0 and below 90")?;
        self.spectrum.validate(&at.key("spectrum"), Use::NotNegative)?;
        validate_quantity(at, self.quantity())?;
        validate_pose(at, &self.transform, &self.motion)
    }
}

impl DirectionalFile {
    /// Checks ranges, the direction and the quantity.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        check::direction(&at.key("toward"), self.toward)?;
        let inside = (0.0..180.0).contains(&self.angular_diameter);
        let allowed = "a number of at least 0 and below 180";
        check::rule(&at.key("angular_diameter"), self.angular_diameter, inside, allowed)?;
        self.spectrum.validate(&at.key("spectrum"), Use::NotNegative)?;
        validate_quantity(at, self.quantity())?;
        validate_pose(at, &self.transform, &self.motion)
    }
}

impl EnvironmentFile {
    /// Checks ranges, and that there is one source and one quantity.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        check::exactly_one(at, &[("spectrum", self.spectrum.is_some()), ("image", self.image.is_some())])?;
        self.spectrum.as_ref().map_or(Ok(()), |it| it.validate(&at.key("spectrum"), Use::NotNegative))?;
        validate_quantity(at, self.quantity())?;
        validate_pose(at, &self.transform, &self.motion)
    }
}

impl IesFile {
    /// Checks ranges, the direction and the quantity.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        check::direction(&at.key("toward"), self.toward)?;
        self.spectrum.validate(&at.key("spectrum"), Use::NotNegative)?;
        validate_quantity(at, self.quantity())?;
        validate_pose(at, &self.transform, &self.motion)
    }
}
