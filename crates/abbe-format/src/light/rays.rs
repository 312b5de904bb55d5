//! Lights that replay the rays of a file.

use super::validate_pose;
use crate::prelude::*;
use crate::quantity::{quantity_instead, validate_quantity};
use crate::{JsonPath, KeyframeFile, QuantityFile, SpectrumFile, TransformFile, check, spectrum::SpectrumUse};
use abbe_spectra::error::Result;

/// A light that replays the rays of a file. State at most one of `power` and `luminous_flux`. By
/// default, the rays have the flux of the file. Only photons carry this light: the path tracer does
/// not find it.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RaysFile {
    /// Position of the origin of the file.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub at: [f64; 3],
    /// Direction of the z axis of the file, which is usually the axis of the light.
    #[serde(default = "z_axis", skip_serializing_if = "is_z_axis")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-range" = "not zero"))]
    pub toward: [f64; 3],
    /// Path of the ray file, relative to the scene's folder: IES TM-25 (`.TM25RAY`), or a source
    /// file of Zemax (`.dat`), binary or text.
    pub path: String,
    /// Relative distribution of the light over wavelength, which replaces that of the file. It is
    /// required if the file has no wavelengths.
    #[schemars(extend("minimum" = 0, "x-default" = "the spectra of the file"))]
    pub spectrum: Option<SpectrumFile>,
    /// Power over 360–830 nm. It replaces the flux of the file.
    #[schemars(range(min = 0), extend("x-unit" = "W"))]
    pub power: Option<f64>,
    /// Luminous flux. It replaces the flux of the file.
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

fn z_axis() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn is_z_axis(direction: &[f64; 3]) -> bool {
    *direction == z_axis()
}

impl RaysFile {
    /// Returns the quantity, or `None` if the file sets the scale. Two, or one below 0, are errors.
    pub fn quantity(&self) -> Result<Option<QuantityFile>> {
        quantity_instead(self.power, self.luminous_flux)
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let quantity = self.quantity().map_or_else(|error| validate_quantity(at, Err(error)), |_| Ok(()));
        let spectrum = self.spectrum.as_ref();
        check::all([
            check::direction(&at.key("toward"), self.toward),
            spectrum.map_or(Ok(()), |it| it.validate(&at.key("spectrum"), SpectrumUse::NotNegative)),
            quantity,
            validate_pose(at, &self.transform, &self.motion),
        ])
    }
}
