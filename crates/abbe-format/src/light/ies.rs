//! Luminaires with a measured distribution of intensity.

use super::validate_pose;
use crate::luminaire;
use crate::prelude::*;
use crate::quantity::{quantity_instead, validate_quantity};
use crate::{JsonPath, KeyframeFile, QuantityFile, SpectrumFile, TransformFile, check, forms, spectrum::SpectrumUse};
use abbe_spectra::error::Result;
use glam::DVec3;
use std::path::Path;

/// A luminaire with a measured distribution of intensity. State at most one of `power` and
/// `luminous_flux`. By default, the luminaire has the luminous intensities of the file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IesFile {
    /// Position of the light.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub at: [f64; 3],
    /// Direction of the photometric axis. It points down for a ceiling luminaire.
    #[schemars(extend("x-range" = "not zero"))]
    pub toward: [f64; 3],
    /// Direction of the half-plane C0 (horizontal angle 0). Only the part across `toward` counts.
    /// Seen from above a ceiling luminaire, the angles C increase counter-clockwise.
    #[schemars(extend("x-range" = "not parallel to `toward`"))]
    #[schemars(extend("x-default" = "`[1, 0, 0]`, turned with the axis if `toward` is not down"))]
    pub c0: Option<[f64; 3]>,
    /// Path of the IES LM-63 file (`.ies`), EULUMDAT file (`.ldt`) or IES TM-33 file (`.tm33`,
    /// `.xml`), relative to the scene's folder.
    pub path: String,
    /// True if the light leaves the luminous opening of the file, a flat rectangle or ellipse.
    /// False if it leaves a point. The opening is invisible.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub area: bool,
    /// Relative distribution of the light over wavelength. The file or the given quantity sets the
    /// scale. An IES LM-63 or EULUMDAT file requires it, and so does a TM-33 file without a
    /// spectrum.
    #[schemars(extend("minimum" = 0, "x-default" = "the spectrum of the TM-33 file"))]
    pub spectrum: Option<SpectrumFile>,
    /// Power over 360–830 nm. It replaces the luminous flux of the file.
    #[schemars(range(min = 0), extend("x-unit" = "W"))]
    pub power: Option<f64>,
    /// Luminous flux. It replaces the luminous flux of the file.
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

impl IesFile {
    /// Returns the quantity, or `None` if the file sets the scale. Two, or one below 0, are errors.
    pub fn quantity(&self) -> Result<Option<QuantityFile>> {
        quantity_instead(self.power, self.luminous_flux)
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let quantity = self.quantity().map_or_else(|error| validate_quantity(at, Err(error)), |_| Ok(()));
        check::all([
            check::direction(&at.key("toward"), self.toward),
            self.validate_c0(at),
            self.validate_spectrum(at),
            quantity,
            validate_pose(at, &self.transform, &self.motion),
        ])
    }

    fn validate_spectrum(&self, at: &JsonPath) -> Result<()> {
        match &self.spectrum {
            Some(spectrum) => spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
            None if luminaire::lacks_spectrum(Path::new(&self.path)) => {
                let expected = "the spectrum of the light, which IES LM-63 and EULUMDAT files do not contain";
                Err(check::fault(at, "missing key \"spectrum\"", expected))
            }
            None => Ok(()),
        }
    }

    /// Checks that C0 and the photometric axis span a plane.
    fn validate_c0(&self, at: &JsonPath) -> Result<()> {
        let Some(c0) = self.c0 else { return Ok(()) };
        let at = at.key("c0");
        check::direction(&at, c0)?;
        let across = DVec3::from(c0).normalize_or_zero().cross(DVec3::from(self.toward).normalize_or_zero());
        let is_across = self.toward == [0.0; 3] || across.length() > 1e-9;
        let parallel = || {
            check::fault(&at, format!("found {}", check::triple(c0)), "a direction that is not parallel to `toward`")
        };
        if is_across { Ok(()) } else { Err(parallel()) }
    }
}
