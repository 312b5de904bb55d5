//! The quantity that gives the scale of an emitter's spectrum.

use crate::{JsonPath, check};
use abbe_spectra::error::{Error, Result};

/// The strength of an emitter, whose `spectrum` gives only the distribution over wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum QuantityFile {
    /// Power in W over 360–830 nm.
    Power(f64),
    /// Luminous flux in lm.
    LuminousFlux(f64),
    /// Intensity in W/sr over 360–830 nm. For a spotlight, the intensity on the axis.
    Intensity(f64),
    /// Luminous intensity in cd. For a spotlight, the luminous intensity on the axis.
    LuminousIntensity(f64),
    /// Radiance in W/m²/sr over 360–830 nm.
    Radiance(f64),
    /// Luminance in cd/m².
    Luminance(f64),
    /// Irradiance in W/m² over 360–830 nm. For an environment, π × the mean radiance.
    Irradiance(f64),
    /// Illuminance in lx. For an environment, π × the mean luminance.
    Illuminance(f64),
}

impl QuantityFile {
    /// Returns the key that the quantity has in the scene file, and the value of the quantity.
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

pub(super) type QuantityVariant = fn(f64) -> QuantityFile;

/// Returns the one quantity that an emitter gives. None, several, or one below 0 are errors, which
/// `validate` finds when a scene is read; but a program may change the scene afterwards.
pub(super) fn one_quantity(choices: &[(Option<f64>, QuantityVariant)]) -> Result<QuantityFile> {
    let given = choices.iter().map(|(value, kind)| (kind(0.0).key_and_value().0, value.is_some()));
    check::exactly_one(&JsonPath::Root, &given.collect::<Vec<_>>())?;
    let found = choices.iter().find_map(|(value, kind)| value.map(kind));
    let quantity = found.ok_or_else(|| Error::input("found no quantity"))?;
    let (key, value) = quantity.key_and_value();
    check::not_negative(&JsonPath::Root.key(key), value)?;
    Ok(quantity)
}

/// Returns the error of a quantity with its full path in the scene. `at` is the path of the
/// emitter, to which the path of the error is relative.
pub(super) fn validate_quantity(at: &JsonPath, quantity: Result<QuantityFile>) -> Result<()> {
    quantity.map(|_| ()).map_err(|mut error| {
        let below = error.location.path.take().unwrap_or_default();
        error.on_path(if below.is_empty() { at.to_string() } else { at.key(&below).to_string() })
    })
}

/// Returns the quantity that replaces that of a file, or `None` without one. Two, or one below 0,
/// are errors.
pub(crate) fn quantity_instead(power: Option<f64>, luminous_flux: Option<f64>) -> Result<Option<QuantityFile>> {
    match (power, luminous_flux) {
        (None, None) => return Ok(None),
        (Some(_), Some(_)) => {
            let error = Error::input("found together with `power`").expected("at most one of power, luminous_flux");
            return Err(error.on_path("luminous_flux"));
        }
        (Some(_), None) | (None, Some(_)) => {}
    }
    let choices = [(power, QuantityFile::Power as _), (luminous_flux, QuantityFile::LuminousFlux as _)];
    one_quantity(&choices).map(Some)
}
