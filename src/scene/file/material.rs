//! Materials as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::forms;
use super::index::IndexFile;
use super::path::JsonPath;
use super::spectrum::{ReflectanceFile, SpectrumFile, Use};
use crate::error::Result;

/// What a surface does to light.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MaterialFile {
    /// Reflects equally into all directions, on both sides (Lambert).
    Diffuse {
        /// Share of the light that is reflected.
        reflectance: ReflectanceFile,
    },
    /// Glass, water, gems: refracts and reflects by Fresnel's equations.
    Dielectric(DielectricFile),
    /// A pane without thickness: light passes straight through or is reflected.
    ThinDielectric {
        /// Index of refraction.
        ior: IndexFile,
    },
    /// A metal.
    Conductor(ConductorFile),
    /// A perfect mirror with a given reflectance.
    Mirror {
        /// Share of the light that is reflected.
        reflectance: ReflectanceFile,
    },
    /// A diffuse base under a clear coat.
    Glossy {
        /// Reflectance of the base.
        reflectance: ReflectanceFile,
        /// Index of refraction of the coat.
        ior: IndexFile,
        /// Roughness of the coat, from 0 to 1.
        #[schemars(range(min = 0, max = 1))]
        roughness: f64,
    },
    /// A thin sheet that reflects and transmits diffusely.
    Translucent {
        /// Share of the light that is reflected.
        reflectance: ReflectanceFile,
        /// Share of the light that passes.
        transmittance: ReflectanceFile,
    },
    /// At each point one of several materials, by chance.
    Mix(Vec<WeightedMaterialFile>),
    /// No surface: it only bounds a medium.
    Boundary {
        /// Name of the medium inside.
        medium: String,
    },
    /// Absorbs all light.
    Absorber,
}

/// A dielectric.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DielectricFile {
    /// Index of refraction.
    pub ior: IndexFile,
    /// Roughness, from 0 (polished, the default) to 1.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub roughness: f64,
    /// Absorption coefficient inside in 1/unit (Beer's law).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub absorption: Option<SpectrumFile>,
    /// Name of the medium inside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub medium: Option<String>,
    /// Where dielectrics or media overlap, the higher wins; ties go to the innermost (default 0).
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub priority: i32,
}

/// A conductor: either a metal's name or its complex index.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConductorFile {
    /// Name of the metal, such as "gold".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metal: Option<String>,
    /// Real part of the index of refraction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub eta: Option<SpectrumFile>,
    /// Extinction coefficient: imaginary part of the index of refraction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k: Option<SpectrumFile>,
    /// Roughness, from 0 (polished, the default) to 1.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub roughness: f64,
}

/// One part of a mix of materials.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightedMaterialFile {
    /// Name of the material.
    pub material: String,
    /// Its weight relative to the others.
    #[schemars(range(min = 0))]
    pub weight: f64,
}

impl MaterialFile {
    /// Checks ranges and lengths.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Diffuse { reflectance } => reflectance.validate(&at.key("diffuse").key("reflectance")),
            Self::Dielectric(dielectric) => dielectric.validate(&at.key("dielectric")),
            Self::ThinDielectric { ior } => ior.validate(&at.key("thin_dielectric").key("ior")),
            Self::Conductor(conductor) => conductor.validate(&at.key("conductor")),
            Self::Mirror { reflectance } => reflectance.validate(&at.key("mirror").key("reflectance")),
            Self::Glossy { reflectance, ior, roughness } => {
                let at = at.key("glossy");
                reflectance.validate(&at.key("reflectance"))?;
                ior.validate(&at.key("ior"))?;
                check::share(&at.key("roughness"), *roughness)
            }
            Self::Translucent { reflectance, transmittance } => {
                validate_translucent(&at.key("translucent"), reflectance, transmittance)
            }
            Self::Mix(parts) => {
                let at = at.key("mix");
                check::entries(&at, parts.len(), 1, "at least one material with its weight")?;
                check::weights(&at, parts.iter().map(|part| part.weight))
            }
            Self::Boundary { medium: _ } | Self::Absorber => Ok(()),
        }
    }
}

/// Checks that no more light leaves than arrives, where both shares are plain numbers.
fn validate_translucent(at: &JsonPath, reflectance: &ReflectanceFile, transmittance: &ReflectanceFile) -> Result<()> {
    reflectance.validate(&at.key("reflectance"))?;
    transmittance.validate(&at.key("transmittance"))?;
    if let (
        ReflectanceFile::Spectrum(SpectrumFile::Number(reflected)),
        ReflectanceFile::Spectrum(SpectrumFile::Number(transmitted)),
    ) = (reflectance, transmittance)
        && reflected + transmitted > 1.0
    {
        let allowed = format!("at most 1 together with the reflectance of {}", check::number(*reflected));
        return check::rule(&at.key("transmittance"), *transmitted, false, &allowed);
    }
    Ok(())
}

impl DielectricFile {
    /// Checks ranges and lengths.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { ior, roughness, absorption, medium: _, priority: _ } = self;
        ior.validate(&at.key("ior"))?;
        check::share(&at.key("roughness"), *roughness)?;
        absorption.as_ref().map_or(Ok(()), |it| it.validate(&at.key("absorption"), Use::NotNegative))
    }
}

impl ConductorFile {
    /// Checks ranges and that it is stated in exactly one way.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { metal, eta, k, roughness } = self;
        let allowed = "either `metal` or both `eta` and `k`";
        match (metal, eta, k) {
            (Some(_), None, None) | (None, Some(_), Some(_)) => {}
            (Some(_), Some(_), _) => return Err(check::fault(&at.key("eta"), "found beside `metal`", allowed)),
            (Some(_), None, Some(_)) => return Err(check::fault(&at.key("k"), "found beside `metal`", allowed)),
            (None, Some(_), None) => return Err(check::fault(at, "found `eta` without `k`", allowed)),
            (None, None, Some(_)) => return Err(check::fault(at, "found `k` without `eta`", allowed)),
            (None, None, None) => return Err(check::fault(at, "found none of the keys it needs", allowed)),
        }
        eta.as_ref().map_or(Ok(()), |it| it.validate(&at.key("eta"), Use::NotNegative))?;
        k.as_ref().map_or(Ok(()), |it| it.validate(&at.key("k"), Use::NotNegative))?;
        check::share(&at.key("roughness"), *roughness)
    }
}
