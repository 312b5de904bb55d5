//! The emission of objects in the scene file.

use crate::prelude::*;
use crate::quantity::{one_quantity, validate_quantity};
use crate::{JsonPath, QuantityFile, ReflectanceFile, SpectrumFile, check, spectrum::SpectrumUse};
use abbe_spectra::error::Result;

/// The emission of an object, which makes the object an area light. State exactly one of `power`,
/// `luminous_flux`, `radiance` and `luminance`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Emission", example = json!({"spectrum": "D65", "power": 20, "group": "lamps"}))]
#[schemars(example = json!({"spectrum": "A", "luminous_flux": 800}))]
#[schemars(example = json!({"spectrum": {"blackbody": {"temperature": 2856}}, "radiance": 10}))]
#[schemars(example = json!({"spectrum": "D65", "luminance": 300, "slide": {"image": "screen.png"}}))]
pub struct EmissionFile {
    /// Relative distribution of the light over wavelength. The given quantity (power or radiance)
    /// sets the scale.
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Power over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W"))]
    pub power: Option<f64>,
    /// Luminous flux.
    #[schemars(range(min = 0), extend("x-unit" = "lm"))]
    pub luminous_flux: Option<f64>,
    /// Radiance over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W/m²/sr"))]
    pub radiance: Option<f64>,
    /// Luminance.
    #[schemars(range(min = 0), extend("x-unit" = "cd/m²"))]
    pub luminance: Option<f64>,
    /// Transmittance of a slide in front of the surface, for example a picture. The stated quantity is
    /// that of the light without the slide.
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-default" = "no slide"))]
    pub slide: Option<ReflectanceFile>,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
}

impl EmissionFile {
    /// Returns the quantity, or an error if there is not exactly one, or if it is below 0.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[
            (self.power, QuantityFile::Power),
            (self.luminous_flux, QuantityFile::LuminousFlux),
            (self.radiance, QuantityFile::Radiance),
            (self.luminance, QuantityFile::Luminance),
        ])
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let spectrum = self.spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative);
        let slide = self.slide.as_ref().map_or(Ok(()), |slide| slide.validate(&at.key("slide")));
        check::all([spectrum, validate_quantity(at, self.quantity()), slide])
    }
}
