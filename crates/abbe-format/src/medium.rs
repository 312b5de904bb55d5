//! Participating media in the scene file.

use crate::prelude::*;
use crate::{
    FieldFile, JsonPath, KeyframeFile, PhaseFile, SpectrumFile, TransformFile, check, forms, spectrum::SpectrumUse,
    transform::validate_motion,
};
use abbe_spectra::error::Result;

/// A participating medium: fog, smoke, milk or a flame.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Medium")]
pub enum MediumFile {
    /// A medium that is the same everywhere.
    #[schemars(example = json!({"homogeneous": {"absorption": 0, "scattering": 0.05,
        "phase": {"henyey_greenstein": {"g": 0.3}}}}))]
    #[schemars(example = json!({"homogeneous": {"absorption": 1, "scattering": 0, "phase": "isotropic",
        "emission": {"spectrum": "neon-glow", "power": 5}, "priority": 2, "transform": [], "motion": []}}))]
    #[schemars(example = json!({"homogeneous": {"absorption": 0, "scattering": 0, "phase": "isotropic",
        "dye": {"absorption": 20, "emission": "blue glow", "quantum_yield": 0.55}}}))]
    Homogeneous(Box<HomogeneousFile>),
    /// A medium whose density varies over a box.
    #[schemars(example = json!({"grid": {"bounds": [[-1, 0, -1], [1, 2, 1]], "density": {"noise": {"value": 2,
        "scale": 0.5}}, "absorption": 0, "scattering": 0.5, "phase": "isotropic", "transmittance": "exact",
        "transform": [{"translate": [0, 1, 0]}]}}))]
    #[schemars(example = json!({"grid": {"bounds": [[-1, 0, -1], [1, 2, 1]], "density": {"path": "soot.npy"},
        "absorption": 1, "scattering": 0, "phase": "isotropic", "emission": {"blackbody": {}},
        "temperature": {"constant": 1800}, "priority": 1, "motion": []}}))]
    #[schemars(example = json!({"grid": {"bounds": [[-1, 0, -1], [1, 2, 1]], "density": {"constant": 2},
        "absorption": 0, "scattering": 0, "phase": "isotropic", "dye": {"absorption": 3, "emission": "green glow",
        "quantum_yield": 0.9}}}))]
    Grid(Box<GridFile>),
}

/// A homogeneous medium.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HomogeneousFile {
    /// Absorption coefficient.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit"))]
    pub absorption: SpectrumFile,
    /// Scattering coefficient.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit"))]
    pub scattering: SpectrumFile,
    /// The phase function.
    pub phase: PhaseFile,
    /// Light that the medium emits.
    #[schemars(extend("x-default" = "no emission"))]
    pub emission: Option<MediumEmissionFile>,
    /// A fluorescent dye in the medium. Its absorption is added to `absorption`.
    #[schemars(extend("x-default" = "no dye"))]
    pub dye: Option<DyeFile>,
    /// Priority where dielectrics or media overlap: the highest one fills the space. Of equal
    /// priorities, the innermost one fills it.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub priority: i32,
    /// Placement of the medium in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
}

/// A medium whose density varies over a box. The coefficients hold at density 1.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GridFile {
    /// The lowest and the highest corner of the box.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub bounds: [[f64; 3]; 2],
    /// Density, which multiplies both coefficients.
    pub density: FieldFile,
    /// Absorption coefficient at density 1.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit"))]
    pub absorption: SpectrumFile,
    /// Scattering coefficient at density 1.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit"))]
    pub scattering: SpectrumFile,
    /// The phase function.
    pub phase: PhaseFile,
    /// Light that the medium emits.
    #[schemars(extend("x-default" = "no emission"))]
    pub emission: Option<MediumEmissionFile>,
    /// Temperature, for emission as a black body.
    #[schemars(extend("x-unit" = "K"))]
    pub temperature: Option<FieldFile>,
    /// The estimator of transmittance.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transmittance: TransmittanceFile,
    /// A fluorescent dye in the medium. Its absorption is added to `absorption`.
    #[schemars(extend("x-default" = "no dye"))]
    pub dye: Option<DyeFile>,
    /// Priority where dielectrics or media overlap: the highest one fills the space. Of equal
    /// priorities, the innermost one fills it.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub priority: i32,
    /// Placement of the medium in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
}

/// A fluorescent dye. State either `absorption`, or `molar_absorption` and `concentration`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Dye", example = json!({"absorption": {"table": {"nm": [360, 380, 420], "values": [20, 20, 0]}},
    "emission": {"gaussian": {"peak_nm": 450, "fwhm_nm": 80}}, "quantum_yield": 0.55}))]
#[schemars(example = json!({"molar_absorption": {"gaussian": {"peak_nm": 490, "fwhm_nm": 40}}, "concentration": 1e-5,
    "emission": {"gaussian": {"peak_nm": 515, "fwhm_nm": 40}}, "quantum_yield": 0.9}))]
pub struct DyeFile {
    /// Absorption coefficient of the dye. Outside a table, it is 0.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit"))]
    pub absorption: Option<SpectrumFile>,
    /// Decadic molar absorption coefficient of the dye. Outside a table, it is 0.
    #[schemars(extend("minimum" = 0, "x-unit" = "L/mol/cm"))]
    pub molar_absorption: Option<SpectrumFile>,
    /// Concentration of the dye.
    #[schemars(range(min = 0), extend("x-unit" = "mol/L"))]
    pub concentration: Option<f64>,
    /// Relative number of emitted photons per nm, at any scale. Outside a table, it is 0.
    #[schemars(extend("minimum" = 0))]
    pub emission: SpectrumFile,
    /// Number of emitted photons, divided by the number of absorbed photons.
    #[schemars(range(min = 0, max = 1))]
    pub quantum_yield: f64,
}

/// The estimator of transmittance through a grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Transmittance estimator")]
pub enum TransmittanceFile {
    /// The exact integral of the density, without bias and noise.
    #[default]
    Exact,
    /// Ratio tracking: unbiased, but noisy.
    Ratio,
    /// Ray marching with `render.march_steps` steps: without noise, but biased.
    March,
}

/// The emission of a medium. State either `blackbody`, or `spectrum` and exactly one of `radiance`
/// and `power`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Medium emission", example = json!({"blackbody": {"temperature": 1800}}))]
#[schemars(example = json!({"spectrum": "neon-glow", "power": 5}), example = json!({"spectrum": 1, "radiance": 1}))]
pub struct MediumEmissionFile {
    /// Emission as a black body.
    pub blackbody: Option<MediumBlackbodyFile>,
    /// Relative distribution of the emission over wavelength.
    #[schemars(extend("minimum" = 0))]
    pub spectrum: Option<SpectrumFile>,
    /// Source radiance over 360–830 nm: the emission coefficient divided by the absorption
    /// coefficient.
    #[schemars(range(min = 0), extend("x-unit" = "W/m²/sr"))]
    pub radiance: Option<f64>,
    /// Power over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W"))]
    pub power: Option<f64>,
}

/// The temperature of a medium that emits as a black body.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Medium black body", example = json!({"temperature": 1800}))]
pub struct MediumBlackbodyFile {
    /// Temperature.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "K", "x-default" = "`temperature` of the grid"))]
    pub temperature: Option<f64>,
}

impl MediumFile {
    pub fn transform_and_motion(&self) -> (&TransformFile, &[KeyframeFile]) {
        match self {
            Self::Homogeneous(medium) => (&medium.transform, &medium.motion),
            Self::Grid(medium) => (&medium.transform, &medium.motion),
        }
    }

    pub fn priority(&self) -> i32 {
        match self {
            Self::Homogeneous(medium) => medium.priority,
            Self::Grid(medium) => medium.priority,
        }
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Homogeneous(medium) => medium.validate(&at.key("homogeneous")),
            Self::Grid(medium) => medium.validate(&at.key("grid")),
        }
    }
}

impl HomogeneousFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { absorption, scattering, phase, emission, dye, priority: _, transform, motion } = self;
        check::all([
            absorption.validate(&at.key("absorption"), SpectrumUse::NotNegative),
            scattering.validate(&at.key("scattering"), SpectrumUse::NotNegative),
            phase.validate(&at.key("phase")),
            emission.as_ref().map_or(Ok(()), |emission| emission.validate(&at.key("emission"), false)),
            dye.as_ref().map_or(Ok(()), |dye| dye.validate(&at.key("dye"))),
            transform.validate(&at.key("transform")),
            validate_motion(&at.key("motion"), motion),
        ])
    }
}

impl GridFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { bounds: [min, max], density, absorption, scattering, phase, emission, temperature, .. } = self;
        let bounds = check::all((0..3).map(|axis| {
            let (bounds, allowed) = (at.key("bounds"), format!("a number above {}", check::number(min[axis])));
            check::rule(&bounds.index(1).index(axis), max[axis], max[axis] > min[axis], &allowed)
        }));
        let has_temperature = temperature.is_some();
        check::all([
            bounds,
            density.validate(&at.key("density")),
            absorption.validate(&at.key("absorption"), SpectrumUse::NotNegative),
            scattering.validate(&at.key("scattering"), SpectrumUse::NotNegative),
            phase.validate(&at.key("phase")),
            emission.as_ref().map_or(Ok(()), |emission| emission.validate(&at.key("emission"), has_temperature)),
            self.dye.as_ref().map_or(Ok(()), |dye| dye.validate(&at.key("dye"))),
            temperature.as_ref().map_or(Ok(()), |field| field.validate(&at.key("temperature"))),
            self.transform.validate(&at.key("transform")),
            validate_motion(&at.key("motion"), &self.motion),
        ])
    }
}

impl DyeFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { absorption, molar_absorption, concentration, emission, quantum_yield } = self;
        let given = [("absorption", absorption.is_some()), ("molar_absorption", molar_absorption.is_some())];
        check::exactly_one(at, &given)?;
        if concentration.is_some() != molar_absorption.is_some() {
            let found =
                if concentration.is_some() { "found `concentration` alone" } else { "found no `concentration`" };
            return Err(check::fault(at, found, "`molar_absorption` together with `concentration`"));
        }
        let spectrum = |key: &str, file: &Option<SpectrumFile>| {
            file.as_ref().map_or(Ok(()), |file| file.validate(&at.key(key), SpectrumUse::NotNegative))
        };
        check::all([
            spectrum("absorption", absorption),
            spectrum("molar_absorption", molar_absorption),
            concentration.map_or(Ok(()), |value| check::not_negative(&at.key("concentration"), value)),
            emission.validate(&at.key("emission"), SpectrumUse::NotNegative),
            check::fraction(&at.key("quantum_yield"), *quantum_yield),
        ])
    }
}

impl MediumEmissionFile {
    fn validate(&self, at: &JsonPath, has_temperature: bool) -> Result<()> {
        let Self { blackbody, spectrum, radiance, power } = self;
        check::exactly_one(at, &[("blackbody", blackbody.is_some()), ("spectrum", spectrum.is_some())])?;
        if let Some(MediumBlackbodyFile { temperature }) = blackbody {
            let place = at.key("blackbody");
            match temperature {
                Some(temperature) => check::positive(&place.key("temperature"), *temperature)?,
                None if has_temperature => {}
                None => {
                    return Err(check::fault(&place, "found no temperature", "`temperature`, or a grid that has one"));
                }
            }
            for (key, value) in [("radiance", radiance), ("power", power)] {
                if value.is_some() {
                    let allowed = "no quantity, because the temperature determines the radiance";
                    return Err(check::fault(&at.key(key), "found together with `blackbody`", allowed));
                }
            }
        }
        if let Some(spectrum) = spectrum {
            spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative)?;
            check::exactly_one(at, &[("radiance", radiance.is_some()), ("power", power.is_some())])?;
        }
        radiance.map_or(Ok(()), |value| check::not_negative(&at.key("radiance"), value))?;
        power.map_or(Ok(()), |value| check::not_negative(&at.key("power"), value))
    }
}
