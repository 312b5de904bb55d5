//! Lights in the scene file.

mod distant;
mod ies;
mod rays;
mod sky;

pub use distant::{DirectionalFile, EnvironmentFile, ProjectionFile};
pub use ies::IesFile;
pub use rays::RaysFile;
pub use sky::{PlaceFile, SkyFile, SunFile};

use crate::prelude::*;
use crate::quantity::{one_quantity, validate_quantity};
use crate::{
    JsonPath, KeyframeFile, QuantityFile, SpectrumFile, TransformFile, check, forms, spectrum::SpectrumUse,
    transform::validate_motion,
};
use abbe_spectra::error::Result;

/// A light that is not an object. Area lights are objects with `emission`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Light")]
pub enum LightFile {
    /// A point light with equal intensity in all directions.
    #[schemars(example = json!({"point": {"at": [0, 2, 0], "spectrum": "D65", "power": 60, "group": "lamps",
        "transform": [{"translate": [0, 1, 0]}], "motion": []}}))]
    #[schemars(example = json!({"point": {"at": [0, 2, 0], "spectrum": "A", "luminous_flux": 800}}))]
    #[schemars(example = json!({"point": {"at": [0, 2, 0], "spectrum": 1, "intensity": 5}}))]
    #[schemars(example = json!({"point": {"at": [0, 2, 0], "spectrum": 1, "luminous_intensity": 100}}))]
    Point(PointFile),
    /// A point light that shines into a cone.
    #[schemars(example = json!({"spot": {"at": [0, 3, 0], "to": [0, 0, 0], "half_angle": 20, "penumbra": 5,
        "falloff": "linear", "spectrum": "D65", "power": 10, "group": "lamps", "transform": [], "motion": []}}))]
    #[schemars(example = json!({"spot": {"at": [0, 3, 0], "to": [0, 0, 0], "half_angle": 20, "spectrum": "A", "luminous_flux": 800}}))]
    #[schemars(example = json!({"spot": {"at": [0, 3, 0], "to": [0, 0, 0], "half_angle": 20, "spectrum": 1, "intensity": 5}}))]
    #[schemars(example = json!({"spot": {"at": [0, 3, 0], "to": [0, 0, 0], "half_angle": 20, "spectrum": 1, "luminous_intensity": 100}}))]
    Spot(SpotFile),
    /// A uniform disk of parallel or slightly divergent light, such as a laser beam.
    #[schemars(example = json!({"beam": {"from": [-2, 0.5, 0], "to": [0, 0.5, 0], "radius": 0.02, "divergence": 0.25,
        "spectrum": "D65", "power": 10, "group": "lamps", "transform": [], "motion": []}}))]
    #[schemars(example = json!({"beam": {"from": [-2, 0.5, 0], "to": [0, 0.5, 0], "radius": 0.02, "spectrum": 1, "luminous_flux": 100}}))]
    Beam(BeamFile),
    /// Light from infinitely far away, such as sunlight.
    #[schemars(example = json!({"directional": {"toward": [1, -2, 0], "angular_diameter": 0.53, "spectrum": "D65",
        "irradiance": 1000, "group": "daylight", "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 30}}],
        "motion": []}}))]
    #[schemars(example = json!({"directional": {"toward": [1, -2, 0], "spectrum": 1, "illuminance": 100_000}}))]
    Directional(DirectionalFile),
    /// Light from all directions, constant or from a picture.
    #[schemars(example = json!({"environment": {"spectrum": "D65", "illuminance": 1000}}))]
    #[schemars(example = json!({"environment": {"image": "sky.exr", "irradiance": 100, "group": "daylight",
        "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 90}}], "motion": []}}))]
    #[schemars(example = json!({"environment": {"image": "sky.exr", "projection": "equal_area", "luminance": 1}}))]
    #[schemars(example = json!({"environment": {"image": "spectral.exr"}}))]
    Environment(EnvironmentFile),
    /// A CIE standard sky (ISO 15469, CIE S 011) above a uniform ground. The zenith is +y.
    #[schemars(example = json!({"sky": {"type": 12, "sun_elevation": 60, "sun_azimuth": 180, "illuminance": 10_000,
        "ground_reflectance": 0.2, "spectrum": "D65", "group": "daylight"}}))]
    #[schemars(example = json!({"sky": {"type": 1, "illuminance": 10_000, "spectrum": 1}}))]
    #[schemars(example = json!({"sky": {"type": 12, "place": {"latitude": 52.52, "longitude": 13.405},
        "time": "2026-06-21T12:00:00+02:00", "illuminance": 20_000, "sun": {"illuminance": 90_000}}}))]
    Sky(SkyFile),
    /// A luminaire with a measured distribution of intensity, from an IES LM-63, EULUMDAT or IES
    /// TM-33 file.
    #[schemars(example = json!({"ies": {"at": [0, 3, 0], "toward": [0, -1, 0], "path": "lamp.ies", "spectrum": "LED-B3"}}))]
    #[schemars(example = json!({"ies": {"at": [0, 3, 0], "toward": [0, -1, 0], "c0": [0, 0, 1], "path": "lamp.ldt",
        "area": true, "spectrum": "D65", "luminous_flux": 800, "group": "lamps", "transform": [], "motion": []}}))]
    #[schemars(example = json!({"ies": {"at": [0, 3, 0], "toward": [0, -1, 0], "path": "lamp.ies", "spectrum": 1, "power": 60}}))]
    #[schemars(example = json!({"ies": {"at": [0, 3, 0], "toward": [0, -1, 0], "path": "lamp.tm33"}}))]
    Ies(IesFile),
    /// The rays of a file, as makers of LEDs publish them: IES TM-25, or a source file of Zemax.
    #[schemars(example = json!({"rays": {"at": [0, 1, 0], "toward": [0, -1, 0], "path": "led.TM25RAY"}}))]
    #[schemars(example = json!({"rays": {"at": [0, 1, 0], "path": "led.dat", "spectrum": "LED-B3", "luminous_flux": 800,
        "group": "lamps", "transform": [], "motion": []}}))]
    #[schemars(example = json!({"rays": {"at": [0, 1, 0], "path": "led.dat", "spectrum": 1, "power": 3}}))]
    Rays(RaysFile),
}

/// A point light. State exactly one of `power`, `luminous_flux`, `intensity` and
/// `luminous_intensity`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointFile {
    /// Position of the light.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub at: [f64; 3],
    /// Relative distribution of the light over wavelength. The given quantity sets the scale.
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Power over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W"))]
    pub power: Option<f64>,
    /// Luminous flux.
    #[schemars(range(min = 0), extend("x-unit" = "lm"))]
    pub luminous_flux: Option<f64>,
    /// Intensity over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W/sr"))]
    pub intensity: Option<f64>,
    /// Luminous intensity.
    #[schemars(range(min = 0), extend("x-unit" = "cd"))]
    pub luminous_intensity: Option<f64>,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
    /// Placement of the light in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
}

/// How the intensity of a spot light falls from 1 to 0 over its penumbra. θ is the angle to the
/// axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Falloff of a spot light")]
pub enum SpotFalloffFile {
    /// As a smoothstep in cos θ, as in pbrt.
    #[default]
    Smooth,
    /// Linearly in θ, as in Mitsuba.
    Linear,
    /// As the square of a linear function of cos θ, as in glTF.
    Square,
}

/// A spotlight. State exactly one of `power`, `luminous_flux`, `intensity` and
/// `luminous_intensity`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpotFile {
    /// Position of the light.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub at: [f64; 3],
    /// A point on the axis of the light. It must differ from the position.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub to: [f64; 3],
    /// Half-angle of the cone.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180, "x-unit" = "°"))]
    pub half_angle: f64,
    /// Angle over which the intensity falls to 0 at the edge of the cone. It is at most
    /// `half_angle`.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0), extend("x-unit" = "°"))]
    pub penumbra: f64,
    /// How the intensity falls over the penumbra.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub falloff: SpotFalloffFile,
    /// Relative distribution of the light over wavelength. The given quantity sets the scale.
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Power over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W"))]
    pub power: Option<f64>,
    /// Luminous flux.
    #[schemars(range(min = 0), extend("x-unit" = "lm"))]
    pub luminous_flux: Option<f64>,
    /// Intensity on the axis over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W/sr"))]
    pub intensity: Option<f64>,
    /// Luminous intensity on the axis.
    #[schemars(range(min = 0), extend("x-unit" = "cd"))]
    pub luminous_intensity: Option<f64>,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
    /// Placement of the light in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
}

/// A beam. State exactly one of `power` and `luminous_flux`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BeamFile {
    /// Centre of the disk from which the light starts.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub from: [f64; 3],
    /// A point on the axis of the light. It must differ from the position.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub to: [f64; 3],
    /// Radius of the disk.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
    pub radius: f64,
    /// Half-angle of the cone of constant radiance at each point of the disk. 0 is parallel light.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0))]
    #[schemars(extend("exclusiveMaximum" = 90, "x-unit" = "°"))]
    pub divergence: f64,
    /// Relative distribution of the light over wavelength. The given quantity sets the scale.
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Power over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W"))]
    pub power: Option<f64>,
    /// Luminous flux.
    #[schemars(range(min = 0), extend("x-unit" = "lm"))]
    pub luminous_flux: Option<f64>,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
    /// Placement of the light in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
}

impl PointFile {
    /// Returns the quantity, or an error if there is not exactly one, or if it is below 0.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[
            (self.power, QuantityFile::Power),
            (self.luminous_flux, QuantityFile::LuminousFlux),
            (self.intensity, QuantityFile::Intensity),
            (self.luminous_intensity, QuantityFile::LuminousIntensity),
        ])
    }

    fn validate(&self, at: &JsonPath) -> Result<()> {
        check::all([
            self.spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
            validate_quantity(at, self.quantity()),
            validate_pose(at, &self.transform, &self.motion),
        ])
    }
}

impl SpotFile {
    /// Returns the quantity, or an error if there is not exactly one, or if it is below 0.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[
            (self.power, QuantityFile::Power),
            (self.luminous_flux, QuantityFile::LuminousFlux),
            (self.intensity, QuantityFile::Intensity),
            (self.luminous_intensity, QuantityFile::LuminousIntensity),
        ])
    }

    fn validate(&self, at: &JsonPath) -> Result<()> {
        let allowed = format!("a number from 0 to the half_angle, {}", check::number(self.half_angle));
        let inside = (0.0..=self.half_angle.max(0.0)).contains(&self.penumbra);
        check::all([
            check::apart(&at.key("to"), self.to, "at", self.at),
            check::between(&at.key("half_angle"), self.half_angle, 0.0, 180.0),
            check::rule(&at.key("penumbra"), self.penumbra, inside, &allowed),
            self.spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
            validate_quantity(at, self.quantity()),
            validate_pose(at, &self.transform, &self.motion),
        ])
    }
}

impl BeamFile {
    /// Returns the quantity, or an error if there is not exactly one, or if it is below 0.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[(self.power, QuantityFile::Power), (self.luminous_flux, QuantityFile::LuminousFlux)])
    }

    fn validate(&self, at: &JsonPath) -> Result<()> {
        let inside = (0.0..90.0).contains(&self.divergence);
        check::all([
            check::apart(&at.key("to"), self.to, "from", self.from),
            check::positive(&at.key("radius"), self.radius),
            check::rule(&at.key("divergence"), self.divergence, inside, "a number of at least 0 and below 90"),
            self.spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
            validate_quantity(at, self.quantity()),
            validate_pose(at, &self.transform, &self.motion),
        ])
    }
}

impl LightFile {
    pub fn pose_and_group(&self) -> (&TransformFile, &[KeyframeFile], &Option<String>) {
        match self {
            Self::Point(light) => (&light.transform, &light.motion, &light.group),
            Self::Spot(light) => (&light.transform, &light.motion, &light.group),
            Self::Beam(light) => (&light.transform, &light.motion, &light.group),
            Self::Directional(light) => (&light.transform, &light.motion, &light.group),
            Self::Environment(light) => (&light.transform, &light.motion, &light.group),
            Self::Sky(light) => (SkyFile::TRANSFORM, &[], &light.group),
            Self::Ies(light) => (&light.transform, &light.motion, &light.group),
            Self::Rays(light) => (&light.transform, &light.motion, &light.group),
        }
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Point(light) => light.validate(&at.key("point")),
            Self::Spot(light) => light.validate(&at.key("spot")),
            Self::Beam(light) => light.validate(&at.key("beam")),
            Self::Directional(light) => light.validate(&at.key("directional")),
            Self::Environment(light) => light.validate(&at.key("environment")),
            Self::Sky(light) => light.validate(&at.key("sky")),
            Self::Ies(light) => light.validate(&at.key("ies")),
            Self::Rays(light) => light.validate(&at.key("rays")),
        }
    }
}

fn validate_pose(at: &JsonPath, transform: &TransformFile, motion: &[KeyframeFile]) -> Result<()> {
    check::all([transform.validate(&at.key("transform")), validate_motion(&at.key("motion"), motion)])
}
