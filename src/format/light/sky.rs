//! Standard skies in the scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::format::check;
use crate::format::forms;
use crate::format::spectrum::{SpectrumFile, SpectrumUse};
use crate::format::transform::TransformFile;
use crate::json::JsonPath;
use crate::scene::light::StandardSky;

/// A standard sky. The sun shapes the luminance of the sky, but does not shine itself: a
/// `directional` light adds it.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SkyFile {
    /// Number of the sky type: 1 to 15 for the types of the standard (1: overcast, 5: uniform, 12:
    /// clear), 16 for the traditional overcast sky.
    #[serde(rename = "type")]
    #[schemars(range(min = 1, max = 16))]
    pub kind: u32,
    /// Elevation of the sun above the horizon. Required for all types with a luminance that depends
    /// on the sun: 2, 4 and 6 to 15.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 90), extend("x-unit" = "°"))]
    pub sun_elevation: Option<f64>,
    /// Azimuth of the sun from north (−z) through east (+x).
    #[serde(default = "default_azimuth", skip_serializing_if = "is_default_azimuth")]
    #[schemars(extend("x-unit" = "°"))]
    pub sun_azimuth: f64,
    /// Illuminance of a horizontal plane under the unobstructed sky.
    #[schemars(range(min = 0), extend("x-unit" = "lx"))]
    pub illuminance: f64,
    /// Reflectance of the ground. All directions below the horizon have this share of the luminance
    /// of a white ground under the unobstructed sky.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "forms::never", range(min = 0, max = 1))]
    pub ground_reflectance: f64,
    /// Relative distribution of the light over wavelength, of sky and ground.
    #[serde(default = "default_spectrum", skip_serializing_if = "is_default_spectrum")]
    #[schemars(extend("minimum" = 0))]
    pub spectrum: SpectrumFile,
    /// Name of the light's group. With the layer `lights`, the lights of a group share a layer of
    /// the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-default" = "the light is its own group"))]
    pub group: Option<String>,
}

/// Returns the azimuth of the south.
fn default_azimuth() -> f64 {
    180.0
}

fn is_default_azimuth(azimuth: &f64) -> bool {
    *azimuth == default_azimuth()
}

/// Returns daylight of 6504 K.
fn default_spectrum() -> SpectrumFile {
    SpectrumFile::Name("D65".to_string())
}

fn is_default_spectrum(spectrum: &SpectrumFile) -> bool {
    *spectrum == default_spectrum()
}

impl SkyFile {
    /// A sky has no transform.
    pub(super) const TRANSFORM: &'static TransformFile = &TransformFile(Vec::new());

    /// Checks the ranges of values, the position of the sun and the spectrum.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { kind, sun_elevation, sun_azimuth: _, illuminance, ground_reflectance, spectrum, group: _ } = self;
        let elevation_at = at.key("sun_elevation");
        let elevation = match sun_elevation {
            Some(elevation) => {
                let inside = (0.0..=90.0).contains(elevation);
                check::rule(&elevation_at, *elevation, inside, "a number from 0 to 90")
            }
            None if StandardSky::depends_on_sun(*kind) => {
                let what = format!("missing key \"sun_elevation\" for a sky of type {kind}");
                Err(check::fault(at, what, "the elevation of the sun in degrees"))
            }
            None => Ok(()),
        };
        check::all([
            check::count(&at.key("type"), u64::from(*kind), 1, 16),
            elevation,
            check::not_negative(&at.key("illuminance"), *illuminance),
            check::fraction(&at.key("ground_reflectance"), *ground_reflectance),
            spectrum.validate(&at.key("spectrum"), SpectrumUse::NotNegative),
        ])
    }
}
