//! The one quantity that gives an emitter its scale.

use super::check;
use super::path::JsonPath;
use crate::error::{Error, Result};

/// How strong an emitter is; its spectrum gives only the shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum QuantityFile {
    /// Power in W over the band.
    Power(f64),
    /// Luminous flux in lm.
    LuminousFlux(f64),
    /// Intensity in W/sr over the band; a spot's on its axis.
    Intensity(f64),
    /// Luminous intensity in cd; a spot's on its axis.
    LuminousIntensity(f64),
    /// Radiance in W/m²/sr over the band.
    Radiance(f64),
    /// Luminance in cd/m².
    Luminance(f64),
    /// Irradiance in W/m² over the band; an environment's is π × its mean radiance.
    Irradiance(f64),
    /// Illuminance in lx.
    Illuminance(f64),
}

impl QuantityFile {
    /// The key it is written under and its value.
    pub fn key_and_value(self) -> (&'static str, f64) {
        match self {
            Self::Power(value) => ("power", value),
            Self::LuminousFlux(value) => ("luminous_flux", value),
            Self::Intensity(value) => ("intensity", value),
            Self::LuminousIntensity(value) => ("luminous_intensity", value),
            Self::Radiance(value) => ("radiance", value),
            Self::Luminance(value) => ("luminance", value),
            Self::Irradiance(value) => ("irradiance", value),
            Self::Illuminance(value) => ("illuminance", value),
        }
    }
}

/// What a key of a quantity makes of its number.
pub(super) type Kind = fn(f64) -> QuantityFile;

/// The quantity among those that an emitter may state: exactly one, and not negative. The errors of this are found when
/// the scene is read; a scene that was changed afterwards can still break it.
pub(super) fn one_quantity(choices: &[(Option<f64>, Kind)]) -> Result<QuantityFile> {
    let given = choices.iter().map(|(value, kind)| (kind(0.0).key_and_value().0, value.is_some()));
    check::exactly_one(&JsonPath::Root, &given.collect::<Vec<_>>())?;
    let found = choices.iter().find_map(|(value, kind)| value.map(kind));
    let quantity = found.ok_or_else(|| Error::input("found no quantity"))?;
    let (key, value) = quantity.key_and_value();
    check::not_negative(&JsonPath::Root.key(key), value)?;
    Ok(quantity)
}

/// Puts a quantity's error, whose path starts at its emitter, at its place in the scene.
pub(super) fn validate_quantity(at: &JsonPath, quantity: Result<QuantityFile>) -> Result<()> {
    quantity.map(|_| ()).map_err(|mut error| {
        let below = error.place.path.take().unwrap_or_default();
        error.on_path(if below.is_empty() { at.to_string() } else { at.key(&below).to_string() })
    })
}
