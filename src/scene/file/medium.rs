//! Participating media as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::forms;
use super::index::IndexFile;
use super::path::JsonPath;
use super::spectrum::{SpectrumFile, Use};
use super::transform::{KeyframeFile, TransformFile, validate_motion};
use crate::error::Result;

/// What fills a space: fog, smoke, milk, flames.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MediumFile {
    /// The same everywhere.
    Homogeneous(Box<HomogeneousFile>),
    /// Varies over a box.
    Grid(Box<GridFile>),
}

/// A homogeneous medium.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HomogeneousFile {
    /// Absorption coefficient in 1/unit.
    pub absorption: SpectrumFile,
    /// Scattering coefficient in 1/unit.
    pub scattering: SpectrumFile,
    /// How it scatters.
    pub phase: PhaseFile,
    /// Light that it emits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<MediumEmissionFile>,
    /// Where dielectrics or media overlap, the higher wins; ties go to the innermost (default 0).
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub priority: i32,
    /// Where it stands in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// A medium whose density varies over a box; the coefficients are per unit density.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GridFile {
    /// The box: its lowest and its highest corner.
    pub bounds: [[f64; 3]; 2],
    /// Density.
    pub density: FieldFile,
    /// Absorption coefficient in 1/unit at density 1.
    pub absorption: SpectrumFile,
    /// Scattering coefficient in 1/unit at density 1.
    pub scattering: SpectrumFile,
    /// How it scatters.
    pub phase: PhaseFile,
    /// Light that it emits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<MediumEmissionFile>,
    /// Temperature in K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<FieldFile>,
    /// How the light that passes is estimated.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub transmittance: TransmittanceFile,
    /// Where dielectrics or media overlap, the higher wins; ties go to the innermost (default 0).
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub priority: i32,
    /// Where it stands in the scene.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    pub transform: TransformFile,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<KeyframeFile>,
}

/// An estimator of transmittance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TransmittanceFile {
    /// From the exact integral of the density: without bias and without noise (default).
    #[default]
    Exact,
    /// Ratio tracking: unbiased, noisy.
    Ratio,
    /// Ray marching with `render.march_steps` steps: biased, without noise.
    March,
}

/// A field over a grid's box: exactly one of `values` with `resolution`, `path`, or a procedural field.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FieldFile {
    /// Values at the cells' centres, x fastest, then y, then z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<f64>>,
    /// Number of cells along x, y and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<[u32; 3]>,
    /// Path of a volume file, relative to the scene's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// The same value everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub constant: Option<f64>,
    /// Falls off exponentially with height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exponential: Option<ExponentialFieldFile>,
    /// A ball that fades towards its surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereFieldFile>,
    /// Fractal noise: clouds and smoke.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseFieldFile>,
}

/// value · exp(−height/scale_height) over the box, the height being that above the bottom of the box or above a planet.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExponentialFieldFile {
    /// Value at the bottom of the box, or on the planet.
    #[schemars(range(min = 0))]
    pub value: f64,
    /// Height over which it falls to 1/e, in the scene's unit.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale_height: f64,
    /// The planet that it surrounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planet: Option<PlanetFile>,
}

/// A sphere from which height is counted; inside it the value is that on its surface.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanetFile {
    /// Centre, in the scene's unit.
    pub center: [f64; 3],
    /// Radius, in the scene's unit.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// A ball of a value, smooth over its outer `falloff`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereFieldFile {
    /// Value inside.
    #[schemars(range(min = 0))]
    pub value: f64,
    /// Centre, in the scene's unit.
    pub center: [f64; 3],
    /// Radius, in the scene's unit.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Share of the radius, from 0 to 1, over which it fades (default 0).
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub falloff: f64,
}

/// Fractal noise, computed once on a grid with two cells to the smallest lump, but at most 128 along the longest side.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoiseFieldFile {
    /// Largest value.
    #[schemars(range(min = 0))]
    pub value: f64,
    /// Size of the largest lumps, in the scene's unit.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// Number of octaves (default 4).
    #[serde(default = "default_octaves")]
    #[schemars(range(min = 1, max = 16))]
    pub octaves: u32,
    /// Share of the noise that is cut to 0, from 0 to 1 (default 0).
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub threshold: f64,
    /// Share of the box's half-axes, from 0 to 1, over which it fades towards the ellipsoid in the box (default 0: it fills the box).
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub falloff: f64,
    /// Seed (default 0).
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub seed: u32,
}

/// Octaves of fractal noise where none are stated.
fn default_octaves() -> u32 {
    4
}

/// Into which directions light is scattered.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum PhaseFile {
    /// Equally into all.
    Isotropic,
    /// By particles much smaller than the wavelength.
    Rayleigh,
    /// Henyey & Greenstein's function.
    HenyeyGreenstein {
        /// Mean cosine, above −1 (backward) and below 1 (forward).
        g: SpectrumFile,
    },
    /// Measured: scattering angle × wavelength.
    Table {
        /// Path of the file, relative to the scene's folder.
        path: String,
    },
    /// By spheres (Mie's theory).
    Mie {
        /// Median radius in µm.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius_um: f64,
        /// Geometric standard deviation of the radii, lognormal about the median; 1 or none: all the same.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 1))]
        spread: Option<f64>,
        /// Index of the spheres (default: water).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        ior: Option<IndexFile>,
    },
    /// By drops of water large enough for a rainbow.
    Rainbow,
}

/// Light that a medium emits: either `blackbody`, or `spectrum` with exactly one of `radiance` and `power`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MediumEmissionFile {
    /// Glows as a black body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blackbody: Option<MediumBlackbodyFile>,
    /// The shape of its spectrum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<SpectrumFile>,
    /// Radiance per unit of absorption, in W/m²/sr over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub radiance: Option<f64>,
    /// Power in W over 360–830 nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub power: Option<f64>,
}

/// A glowing medium's temperature.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MediumBlackbodyFile {
    /// Temperature in K (default: the medium's temperature field).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub temperature: Option<f64>,
}

impl MediumFile {
    /// Where it stands in the scene, and its keyframes.
    pub fn way(&self) -> (&TransformFile, &[KeyframeFile]) {
        match self {
            Self::Homogeneous(medium) => (&medium.transform, &medium.motion),
            Self::Grid(medium) => (&medium.transform, &medium.motion),
        }
    }

    /// Which body rules where several overlap: the higher.
    pub fn priority(&self) -> i32 {
        match self {
            Self::Homogeneous(medium) => medium.priority,
            Self::Grid(medium) => medium.priority,
        }
    }

    /// Checks ranges and lengths.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Homogeneous(medium) => medium.validate(&at.key("homogeneous")),
            Self::Grid(medium) => medium.validate(&at.key("grid")),
        }
    }
}

impl HomogeneousFile {
    /// Checks ranges.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { absorption, scattering, phase, emission, priority: _, transform, motion } = self;
        absorption.validate(&at.key("absorption"), Use::NotNegative)?;
        scattering.validate(&at.key("scattering"), Use::NotNegative)?;
        phase.validate(&at.key("phase"))?;
        if let Some(emission) = emission {
            emission.validate(&at.key("emission"), false)?;
        }
        transform.validate(&at.key("transform"))?;
        validate_motion(&at.key("motion"), motion)
    }
}

impl GridFile {
    /// Checks ranges and lengths.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { bounds: [min, max], density, absorption, scattering, phase, emission, temperature, .. } = self;
        for axis in 0..3 {
            let (bounds, allowed) = (at.key("bounds"), format!("a number above {}", check::number(min[axis])));
            check::rule(&bounds.index(1).index(axis), max[axis], max[axis] > min[axis], &allowed)?;
        }
        density.validate(&at.key("density"))?;
        absorption.validate(&at.key("absorption"), Use::NotNegative)?;
        scattering.validate(&at.key("scattering"), Use::NotNegative)?;
        phase.validate(&at.key("phase"))?;
        if let Some(emission) = emission {
            emission.validate(&at.key("emission"), temperature.is_some())?;
        }
        temperature.as_ref().map_or(Ok(()), |field| field.validate(&at.key("temperature")))?;
        self.transform.validate(&at.key("transform"))?;
        validate_motion(&at.key("motion"), &self.motion)
    }
}

impl FieldFile {
    /// Checks that the field is stated in one way, with as many values as cells, none of them negative.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { values, resolution, path, constant, exponential, sphere, noise } = self;
        let forms = [
            ("values", values.is_some()),
            ("path", path.is_some()),
            ("constant", constant.is_some()),
            ("exponential", exponential.is_some()),
            ("sphere", sphere.is_some()),
            ("noise", noise.is_some()),
        ];
        check::exactly_one(at, &forms)?;
        match (values, resolution) {
            (Some(values), Some(resolution)) => validate_values(at, values, *resolution)?,
            (Some(_), None) => return Err(check::fault(at, "found `values` without `resolution`", "both")),
            (None, Some(_)) => return Err(check::fault(at, "found `resolution` without `values`", "both")),
            (None, None) => {}
        }
        constant.map_or(Ok(()), |value| check::not_negative(&at.key("constant"), value))?;
        if let Some(ExponentialFieldFile { value, scale_height, planet }) = exponential {
            let at = at.key("exponential");
            check::not_negative(&at.key("value"), *value)?;
            check::positive(&at.key("scale_height"), *scale_height)?;
            planet.map_or(Ok(()), |planet| check::positive(&at.key("planet").key("radius"), planet.radius))?;
        }
        if let Some(SphereFieldFile { value, center: _, radius, falloff }) = sphere {
            let at = at.key("sphere");
            check::not_negative(&at.key("value"), *value)?;
            check::positive(&at.key("radius"), *radius)?;
            check::share(&at.key("falloff"), *falloff)?;
        }
        if let Some(NoiseFieldFile { value, scale, octaves, threshold, falloff, seed: _ }) = noise {
            let at = at.key("noise");
            check::not_negative(&at.key("value"), *value)?;
            check::positive(&at.key("scale"), *scale)?;
            check::count(&at.key("octaves"), u64::from(*octaves), 1, 16)?;
            check::share(&at.key("threshold"), *threshold)?;
            check::share(&at.key("falloff"), *falloff)?;
        }
        Ok(())
    }
}

/// Checks a grid's values against its resolution.
fn validate_values(at: &JsonPath, values: &[f64], resolution: [u32; 3]) -> Result<()> {
    let (values_at, resolution_at) = (at.key("values"), at.key("resolution"));
    for (axis, cells) in resolution.into_iter().enumerate() {
        check::count(&resolution_at.index(axis), u64::from(cells), 1, 65_536)?;
    }
    let cells = resolution.into_iter().map(u64::from).product::<u64>();
    if values.len() as u64 != cells {
        let [x, y, z] = resolution;
        let allowed = format!("an array of {cells}, one value for each of {x} × {y} × {z} cells");
        return Err(check::fault(&values_at, format!("found an array of {}", values.len()), allowed));
    }
    values.iter().enumerate().try_for_each(|(i, &value)| check::not_negative(&values_at.index(i), value))
}

impl PhaseFile {
    /// Checks ranges.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Isotropic | Self::Rayleigh | Self::Table { path: _ } | Self::Rainbow => Ok(()),
            Self::HenyeyGreenstein { g } => g.validate(&at.key("henyey_greenstein").key("g"), Use::MeanCosine),
            Self::Mie { radius_um, spread, ior } => {
                let at = at.key("mie");
                check::positive(&at.key("radius_um"), *radius_um)?;
                let spread_at = at.key("spread");
                spread.map_or(Ok(()), |spread| {
                    check::rule(&spread_at, spread, spread >= 1.0, "a number of at least 1")
                })?;
                ior.as_ref().map_or(Ok(()), |ior| ior.validate(&at.key("ior")))
            }
        }
    }
}

impl MediumEmissionFile {
    /// Checks ranges, and that the emission is stated in one way.
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
                    let allowed = "no quantity, since the temperature gives the scale";
                    return Err(check::fault(&at.key(key), "found beside `blackbody`", allowed));
                }
            }
        }
        if let Some(spectrum) = spectrum {
            spectrum.validate(&at.key("spectrum"), Use::NotNegative)?;
            check::exactly_one(at, &[("radiance", radiance.is_some()), ("power", power.is_some())])?;
        }
        radiance.map_or(Ok(()), |value| check::not_negative(&at.key("radiance"), value))?;
        power.map_or(Ok(()), |value| check::not_negative(&at.key("power"), value))
    }
}
