//! Phase functions of media in the scene file.

use crate::prelude::*;
use crate::{IndexFile, JsonPath, SpectrumFile, check, spectrum::SpectrumUse};

#[cfg(feature = "schema")]
use abbe_optics::phase::MAX_MEAN_COSINE;
use abbe_spectra::error::Result;

/// The phase function: the distribution of directions into which a medium scatters light.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Phase function", example = &"isotropic", example = &"rayleigh", example = &"rainbow")]
pub enum PhaseFile {
    /// Isotropic scattering: equal in all directions.
    Isotropic,
    /// Rayleigh scattering by particles much smaller than the wavelength.
    Rayleigh,
    /// The function of Henyey and Greenstein.
    #[schemars(example = json!({"henyey_greenstein": {"g": 0.3}}))]
    HenyeyGreenstein {
        /// Mean cosine of the scattering angle: negative for backward scattering, positive for
        /// forward scattering.
        #[schemars(extend("minimum" = -MAX_MEAN_COSINE, "maximum" = MAX_MEAN_COSINE))]
        g: SpectrumFile,
    },
    /// A measured phase function: a table over scattering angle and wavelength.
    #[schemars(example = json!({"table": {"path": "phase.csv"}}))]
    Table {
        /// Path of the table, relative to the scene's folder.
        path: String,
    },
    /// Scattering by spheres (Mie theory).
    #[schemars(example = json!({"mie": {"radius_um": 0.5, "spread": 1.2, "ior": 1.46}}))]
    Mie {
        /// Median radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "µm"))]
        radius_um: f64,
        /// Geometric standard deviation of the lognormal distribution of radii. 1 means equal
        /// radii.
        #[schemars(range(min = 1), extend("x-default" = "equal radii"))]
        spread: Option<f64>,
        /// Index of refraction of the spheres.
        #[schemars(extend("minimum" = 1, "x-default" = "water at 20 °C"))]
        ior: Option<IndexFile>,
    },
    /// Scattering by water drops that are large enough for a rainbow.
    Rainbow,
    /// Scattering by ice crystals in all orientations, with the halos of 22° and 46°.
    Ice,
}

impl PhaseFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Isotropic | Self::Rayleigh | Self::Table { path: _ } | Self::Rainbow | Self::Ice => Ok(()),
            Self::HenyeyGreenstein { g } => g.validate(&at.key("henyey_greenstein").key("g"), SpectrumUse::MeanCosine),
            Self::Mie { radius_um, spread, ior } => {
                let at = at.key("mie");
                let spread_at = at.key("spread");
                check::all([
                    check::positive(&at.key("radius_um"), *radius_um),
                    spread.map_or(Ok(()), |spread| {
                        check::rule(&spread_at, spread, spread >= 1.0, "a number of at least 1")
                    }),
                    ior.as_ref().map_or(Ok(()), |ior| ior.validate(&at.key("ior"))),
                ])
            }
        }
    }
}
