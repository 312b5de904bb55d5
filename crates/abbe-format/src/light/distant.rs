//! Distant lights in the scene file.

use super::validate_pose;
use crate::prelude::*;
use crate::quantity::{one_quantity, validate_quantity};
use crate::{
    ImageFile, JsonPath, KeyframeFile, QuantityFile, SpectrumFile, TransformFile, check, forms, spectrum::SpectrumUse,
};
use abbe_spectra::error::Result;
use std::path::Path;

/// A directional light. State exactly one of `irradiance` and `illuminance`. The power is not a key
/// of this light, because it depends on the size of the scene.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionalFile {
    /// Direction in which the light travels.
    #[schemars(extend("x-range" = "not zero"))]
    pub toward: [f64; 3],
    /// Angular diameter of the source. The sun has 0.53°.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0))]
    #[schemars(extend("exclusiveMaximum" = 180, "x-unit" = "°"))]
    pub angular_diameter: f64,
    /// Relative distribution of the light over wavelength. The given quantity sets the scale.
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Irradiance over 360–830 nm on a surface that faces the light.
    #[schemars(range(min = 0), extend("x-unit" = "W/m²"))]
    pub irradiance: Option<f64>,
    /// Illuminance on a surface that faces the light.
    #[schemars(range(min = 0), extend("x-unit" = "lx"))]
    pub illuminance: Option<f64>,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
    /// Rotation of the light. Translations have no effect.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
}

/// An environment. State exactly one of `spectrum` and `image`, and exactly one of `irradiance`,
/// `illuminance` and `luminance`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentFile {
    /// Relative distribution of the light over wavelength, the same from all directions.
    #[schemars(extend("minimum" = 0))]
    pub spectrum: Option<SpectrumFile>,
    /// A picture of all directions. PNG, JPEG, WebP, OpenEXR and Radiance HDR files are read. The
    /// channels `S0.…nm` of an OpenEXR file are spectral radiances, which are used in the place of
    /// its colours.
    pub image: Option<ImageFile>,
    /// Projection of the picture.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub projection: ProjectionFile,
    /// π × the mean radiance over 360–830 nm.
    #[schemars(range(min = 0), extend("x-unit" = "W/m²"))]
    pub irradiance: Option<f64>,
    /// π × the mean luminance.
    #[schemars(range(min = 0), extend("x-unit" = "lx"))]
    pub illuminance: Option<f64>,
    /// Luminance of the light. For a picture, luminance of a pixel with the linear value (1, 1, 1),
    /// or in a picture with spectral radiances, of a pixel with 1 cd/m². Such a picture has the
    /// luminance 1 if no quantity is given.
    #[schemars(range(min = 0), extend("x-unit" = "cd/m²"))]
    pub luminance: Option<f64>,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
    /// Rotation of the light. Translations have no effect.
    #[serde(default, skip_serializing_if = "TransformFile::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub transform: TransformFile,
    /// Keyframes of the motion, in the order of their times.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub motion: Vec<KeyframeFile>,
}

/// The projection of a picture of all directions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Projection")]
pub enum ProjectionFile {
    /// Equirectangular: longitude and latitude are linear over the picture. +y is the upper edge,
    /// and −z is in the middle.
    #[default]
    Equirectangular,
    /// Equal-area octahedral, as in pbrt: a square whose pixels have equal solid angles. +z is in
    /// the middle, −z is in the corners, +x is to the right, and +y is at the lower edge.
    EqualArea,
}

impl DirectionalFile {
    /// Returns the quantity, or an error if there is not exactly one, or if it is below 0.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[(self.irradiance, QuantityFile::Irradiance), (self.illuminance, QuantityFile::Illuminance)])
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let inside = (0.0..180.0).contains(&self.angular_diameter);
        let allowed = "a number of at least 0 and below 180";
        check::all([
            check::direction(&at.key("toward"), self.toward),
            check::rule(&at.key("angular_diameter"), self.angular_diameter, inside, allowed),
            self.spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
            validate_quantity(at, self.quantity()),
            validate_pose(at, &self.transform, &self.motion),
        ])
    }
}

impl EnvironmentFile {
    /// Returns the quantity, or an error if there is not exactly one, or if it is below 0.
    pub fn quantity(&self) -> Result<QuantityFile> {
        one_quantity(&[
            (self.irradiance, QuantityFile::Irradiance),
            (self.illuminance, QuantityFile::Illuminance),
            (self.luminance, QuantityFile::Luminance),
        ])
    }

    /// Returns whether a quantity is given.
    pub fn has_quantity(&self) -> bool {
        self.irradiance.is_some() || self.illuminance.is_some() || self.luminance.is_some()
    }

    /// Returns whether the light may be a picture with spectral radiances, which needs no quantity.
    fn may_be_spectral(&self) -> bool {
        let is_exr = |path: &str| Path::new(path).extension().is_some_and(|end| end.eq_ignore_ascii_case("exr"));
        self.image.as_ref().is_some_and(|image| is_exr(&image.path))
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let needs_one = self.has_quantity() || !self.may_be_spectral();
        let quantity = if needs_one { validate_quantity(at, self.quantity()) } else { Ok(()) };
        check::all([
            check::exactly_one(at, &[("spectrum", self.spectrum.is_some()), ("image", self.image.is_some())]),
            self.spectrum.as_ref().map_or(Ok(()), |it| it.validate(&at.key("spectrum"), SpectrumUse::NotNegative)),
            self.validate_projection(at),
            quantity,
            validate_pose(at, &self.transform, &self.motion),
        ])
    }

    /// Checks that a projection belongs to a picture.
    fn validate_projection(&self, at: &JsonPath) -> Result<()> {
        if self.image.is_some() || self.projection == ProjectionFile::default() {
            return Ok(());
        }
        Err(check::fault(&at.key("projection"), "found a projection without a picture", "`image`"))
    }
}
