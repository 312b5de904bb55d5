//! Phase functions of media in the scene file.

use crate::prelude::*;
use crate::{IndexFile, JsonPath, SpectrumFile, check, picture, spectrum::SpectrumUse};

#[cfg(feature = "schema")]
use abbe_optics::phase::MAX_MEAN_COSINE;
use abbe_spectra::error::Result;

const MIN_LENGTH_TO_WIDTH: f64 = 0.01;
const MAX_LENGTH_TO_WIDTH: f64 = 100.0;

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
    /// Scattering by populations of ice crystals, some of which prefer an orientation: sundogs,
    /// arcs, pillars. The vertical is the y axis of the scene.
    #[schemars(example = json!({"ice_crystals": [{"orientation": "plates", "tilt": 1.5, "weight": 2},
        {"orientation": "random"}]}))]
    IceCrystals(#[schemars(length(min = 1))] Vec<IcePopulationFile>),
}

/// Ice crystals with the same shape and the same law of orientation.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Population of ice crystals")]
#[schemars(example = json!({"orientation": "columns", "length_to_width": 3, "tilt": 0.5, "weight": 1}))]
pub struct IcePopulationFile {
    /// How the crystals fall.
    pub orientation: IceOrientationFile,
    /// Length of the hexagonal prism, divided by its width from corner to corner. Crystals in all
    /// orientations are 0.5 to 2 times as long as wide and do not have this key.
    #[schemars(extend("minimum" = MIN_LENGTH_TO_WIDTH, "maximum" = MAX_LENGTH_TO_WIDTH))]
    #[schemars(extend("x-default" = "0.3 for plates, 2 for columns and Parry columns"))]
    pub length_to_width: Option<f64>,
    /// Standard deviation of the tilt about each axis. Crystals in all orientations do not have
    /// this key.
    #[schemars(range(min = 0, max = 30), extend("x-unit" = "°", "x-default" = "1"))]
    pub tilt: Option<f64>,
    /// Fraction of the scattered light relative to the other populations. At least one weight must
    /// be above 0.
    #[serde(default = "picture::one", skip_serializing_if = "picture::is_one")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0))]
    pub weight: f64,
}

/// How ice crystals fall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Orientation of ice crystals")]
pub enum IceOrientationFile {
    /// With a vertical axis, like plates.
    Plates,
    /// With a horizontal axis, in all rotations about it, like columns.
    Columns,
    /// With a horizontal axis and two horizontal side faces.
    Parry,
    /// In all orientations, as with the phase function `"ice"`.
    Random,
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
            Self::IceCrystals(populations) => {
                let at = at.key("ice_crystals");
                check::entries(&at, populations.len(), 1, "at least one population of crystals")?;
                check::weights(&at, populations.iter().map(|population| population.weight))?;
                check::all(populations.iter().enumerate().map(|(i, population)| population.validate(&at.index(i))))
            }
        }
    }
}

impl IcePopulationFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { orientation, length_to_width, tilt, weight: _ } = self;
        let keys = [("length_to_width", *length_to_width), ("tilt", *tilt)];
        if *orientation == IceOrientationFile::Random
            && let Some((key, _)) = keys.into_iter().find(|(_, value)| value.is_some())
        {
            let expected = "no `length_to_width` and no `tilt` for crystals in all orientations";
            return Err(check::fault(&at.key(key), format!("found `{key}`"), expected));
        }
        let within = |key: &str, value: Option<f64>, low, high| {
            value.map_or(Ok(()), |value| check::from_to(&at.key(key), value, low, high))
        };
        check::all([
            within("length_to_width", *length_to_width, MIN_LENGTH_TO_WIDTH, MAX_LENGTH_TO_WIDTH),
            within("tilt", *tilt, 0.0, 30.0),
        ])
    }
}
