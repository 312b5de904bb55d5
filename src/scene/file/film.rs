//! The film as written: what the camera records and how the picture is shown.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::forms::is_default;
use super::path::JsonPath;
use crate::error::Result;

/// The film.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FilmFile {
    /// Width in pixels.
    #[schemars(range(min = 1, max = 100_000))]
    pub width: u32,
    /// Height in pixels.
    #[schemars(range(min = 1, max = 100_000))]
    pub height: u32,
    /// The colour-matching functions.
    #[serde(default)]
    pub observer: ObserverFile,
    /// Number of spectral bands that the EXR holds beside the colours (default 0).
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(range(max = 1024))]
    pub spectral_bands: u32,
    /// What becomes of colours that the PNG's colour space cannot show. (The EXR keeps them.)
    #[serde(default, skip_serializing_if = "is_default")]
    pub gamut: GamutFile,
    /// Which light the PNG shows as white, by Bradford's transform: `"none"` (default), `"scene"` (all lamps together, by power), or
    /// the name of a spectrum of the scene or the library, such as `"A"`. Light too pure to be balanced, of a single line, is an error.
    #[serde(default, skip_serializing_if = "is_default")]
    pub white_balance: WhiteBalanceFile,
    /// Colour space of the PNG, which states it: 8 bits for sRGB and Display P3, 16 for Rec. 2020 and ACEScg. (The EXR's RGB is
    /// always linear Rec. 709.)
    #[serde(default, skip_serializing_if = "is_default")]
    pub output_space: OutputSpaceFile,
    /// How bright the PNG is.
    #[serde(default, skip_serializing_if = "is_default")]
    pub exposure: ExposureFile,
}

/// A standard observer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ObserverFile {
    /// CIE 1931, 2°.
    #[default]
    Cie1931,
    /// CIE 1964, 10°.
    Cie1964,
    /// CIE 2015 (cone fundamentals), 2°.
    #[serde(rename = "cie2015_2")]
    Cie2015Two,
    /// CIE 2015 (cone fundamentals), 10°.
    #[serde(rename = "cie2015_10")]
    Cie2015Ten,
}

/// A gamut mapping.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GamutFile {
    /// Towards neutral at equal luminance.
    #[default]
    Desaturate,
    /// Each component by itself.
    Clip,
    /// Towards neutral at equal lightness and hue of Oklab.
    Oklab,
}

/// The white that is shown as white.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(from = "String", into = "String")]
pub enum WhiteBalanceFile {
    /// That of the output space: colours are shown as they are.
    #[default]
    None,
    /// The colour of all the scene's lights together, each with the power that it sends into the scene.
    Scene,
    /// An illuminant, by its name.
    Illuminant(String),
}

impl From<String> for WhiteBalanceFile {
    fn from(name: String) -> Self {
        match name.as_str() {
            "none" => Self::None,
            "scene" => Self::Scene,
            _ => Self::Illuminant(name),
        }
    }
}

impl From<WhiteBalanceFile> for String {
    fn from(white: WhiteBalanceFile) -> Self {
        match white {
            WhiteBalanceFile::None => "none".into(),
            WhiteBalanceFile::Scene => "scene".into(),
            WhiteBalanceFile::Illuminant(name) => name,
        }
    }
}

/// A colour space.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OutputSpaceFile {
    /// sRGB.
    #[default]
    Srgb,
    /// Display P3.
    #[serde(rename = "display-p3")]
    DisplayP3,
    /// Rec. 2020.
    Rec2020,
    /// ACEScg: linear.
    Acescg,
}

/// An exposure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ExposureFile {
    /// Found from the picture.
    #[default]
    Auto,
    /// Absolute radiance, as the EXR always holds it.
    None,
    /// Stops brighter (above 0) or darker than absolute radiance.
    Ev(f64),
    /// Sensitivity of the film; the shutter's time and the f-number then count.
    Iso(#[schemars(extend("exclusiveMinimum" = 0))] f64),
}

impl FilmFile {
    /// Checks ranges.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { width, height, spectral_bands, exposure, .. } = self;
        check::count(&at.key("width"), u64::from(*width), 1, 100_000)?;
        check::count(&at.key("height"), u64::from(*height), 1, 100_000)?;
        check::count(&at.key("spectral_bands"), u64::from(*spectral_bands), 0, 1024)?;
        match exposure {
            ExposureFile::Auto | ExposureFile::None | ExposureFile::Ev(_) => Ok(()),
            ExposureFile::Iso(iso) => check::positive(&at.key("exposure").key("iso"), *iso),
        }
    }
}
