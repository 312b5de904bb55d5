//! Requirements on the readings of meters.

use crate::prelude::*;
use crate::{JsonPath, MeterFile, check};
use abbe_scene::meter::Quantity;
use abbe_spectra::error::{Error, Result};

/// A requirement on the readings of a meter. State at least one limit. `abbe measure` judges each
/// limit by the 95 % intervals of the readings.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Requirement", example = json!({"meter": "desk", "mean_at_least": 500, "uniformity_at_least": 0.6,
    "source": "EN 12464-1"}))]
#[schemars(example = json!({"meter": "glare", "at_most": 19}))]
#[schemars(example = json!({"meter": "eye", "at_least": 250, "mean_at_most": 2000}))]
pub struct RequirementFile {
    /// Name of the meter.
    pub meter: String,
    /// Least mean of the readings, in the unit of the meter.
    pub mean_at_least: Option<f64>,
    /// Largest mean of the readings, in the unit of the meter.
    pub mean_at_most: Option<f64>,
    /// Least uniformity U0: the least reading divided by the mean.
    #[schemars(range(min = 0, max = 1))]
    pub uniformity_at_least: Option<f64>,
    /// Least value of each reading, in the unit of the meter.
    pub at_least: Option<f64>,
    /// Largest value of each reading, in the unit of the meter.
    pub at_most: Option<f64>,
    /// Where the requirement stands, such as the clause of a standard. Reports contain it.
    #[schemars(extend("x-default" = "no source"))]
    pub source: Option<String>,
}

impl RequirementFile {
    pub(super) fn validate(&self, at: &JsonPath, meters: &[MeterFile]) -> Result<()> {
        let Self { meter, mean_at_least, mean_at_most, uniformity_at_least, at_least, at_most, source: _ } = self;
        let Some(of_meter) = meters.iter().find(|known| known.name == *meter) else {
            let known = meters.iter().map(|known| known.name.as_str());
            return Err(Error::unknown_name("meter", meter, known).on_path(at.key("meter").to_string()));
        };
        if of_meter.quantity() == Quantity::SpectralIrradiance {
            let found = format!("found \"{meter}\", whose readings are spectra");
            return Err(check::fault(&at.key("meter"), found, "a meter whose readings are numbers"));
        }
        let limits = [mean_at_least, mean_at_most, uniformity_at_least, at_least, at_most];
        if limits.iter().all(|limit| limit.is_none()) {
            return Err(check::fault(
                at,
                "found no limit",
                "at least one of mean_at_least, mean_at_most, uniformity_at_least, at_least and at_most",
            ));
        }
        let in_range = uniformity_at_least.is_none_or(|limit| (0.0..=1.0).contains(&limit));
        let found = || format!("found {}", uniformity_at_least.unwrap_or_default());
        let wrong = || check::fault(&at.key("uniformity_at_least"), found(), "a number from 0 to 1");
        if in_range { Ok(()) } else { Err(wrong()) }
    }
}
