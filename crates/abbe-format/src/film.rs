//! The film in the scene file: what the camera records and how the PNG shows it.

use crate::prelude::*;
use crate::{JsonPath, check, forms::is_default};
use abbe_scene::Bloom;
use abbe_spectra::error::Result;

/// The picture: its size, its observer, and how the PNG shows it. The EXR always holds absolute
/// radiance.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Film", example = json!({"width": 640, "height": 360, "observer": "cie1931", "spectral_bands": 0,
    "layers": ["albedo", "paths"], "stokes": false, "denoise": true, "gamut": "compress", "tone": "roll_off", "white_balance": "none",
    "output_space": "srgb", "exposure": "auto", "bloom": {"fov": 40}}))]
pub struct FilmFile {
    /// Width of the picture.
    #[schemars(range(min = 1, max = 100_000), extend("x-unit" = "pixels"))]
    pub width: u32,
    /// Height of the picture.
    #[schemars(range(min = 1, max = 100_000), extend("x-unit" = "pixels"))]
    pub height: u32,
    /// The standard observer: the colour-matching functions that convert spectra to colours.
    #[serde(default)]
    pub observer: ObserverFile,
    /// Number of spectral bands that the EXR holds in addition to the colours.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0, max = 1024))]
    pub spectral_bands: u32,
    /// Layers that the EXR holds in addition to the colours.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub layers: Vec<LayerFile>,
    /// Whether the EXR holds the layer `stokes`.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub stokes: bool,
    /// Whether the EXR holds the denoised picture in addition to the picture as it was rendered,
    /// and the PNG shows it. Without this key, both do so where it is possible and safe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub denoise: Option<bool>,
    /// How colours outside the PNG's colour space are mapped into it. The EXR keeps colours outside
    /// the gamut.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub gamut: GamutFile,
    /// How the PNG shows colours that are too bright for the display.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub tone: ToneFile,
    /// The light that the PNG shows as white, by Bradford's chromatic adaptation. "none" applies no
    /// adaptation, "scene" takes the sum of all lights, and the name of a spectrum of the scene or
    /// the library, such as "A", takes this spectrum. Monochromatic light cannot be balanced and is
    /// an error.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub white_balance: WhiteBalanceFile,
    /// Colour space of the PNG. The PNG has 8 bits per channel in sRGB and Display P3, and 16 bits
    /// in the others. The RGB channels of the EXR are always linear Rec. 709.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub output_space: OutputSpaceFile,
    /// Brightness of the PNG.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub exposure: ExposureFile,
    /// The light that the eye of a viewer would scatter around the bright parts of the scene, by
    /// the measured glare function of CIE 135/1. Only the PNG shows it. Without this key, the PNG
    /// has no bloom.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bloom: Option<BloomFile>,
}

/// The eye whose glare the PNG shows.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Bloom", example = json!({"fov": 40, "age": 25}))]
pub struct BloomFile {
    /// Horizontal angle that the picture fills in the field of view.
    #[schemars(range(min = 0.1, max = 120), extend("x-unit" = "°"))]
    pub fov: f64,
    /// Age of the viewer. Older eyes scatter more light.
    #[serde(default = "default_age", skip_serializing_if = "is_default_age")]
    #[schemars(range(min = 0, max = 100), extend("x-unit" = "years"))]
    pub age: f64,
}

fn default_age() -> f64 {
    Bloom::DEFAULT_AGE
}

fn is_default_age(age: &f64) -> bool {
    *age == default_age()
}

/// A CIE standard observer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Observer")]
pub enum ObserverFile {
    /// CIE 1931, 2° field.
    #[default]
    Cie1931,
    /// CIE 1964, 10° field.
    Cie1964,
    /// CIE 2015 (cone fundamentals), 2° field.
    #[serde(rename = "cie2015_2")]
    Cie2015Two,
    /// CIE 2015 (cone fundamentals), 10° field.
    #[serde(rename = "cie2015_10")]
    Cie2015Ten,
}

/// A layer of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Layer")]
pub enum LayerFile {
    /// Albedo of the first surface on the camera ray: the share of light that it reflects or
    /// transmits, in linear RGB under D65.
    Albedo,
    /// Normal of the first surface in world space, on the visible side.
    Normal,
    /// Distance to the first surface along the camera ray, in m.
    Depth,
    /// Identities and coverages of the objects, as Cryptomatte.
    Object,
    /// Identities and coverages of the materials, as Cryptomatte.
    Material,
    /// Texture coordinates of the first surface.
    Uv,
    /// Number of camera samples.
    Samples,
    /// Light of each class of paths: emission, direct, caustic, indirect and volume.
    Paths,
    /// Light of each group of lights.
    Lights,
    /// Stokes vector of the light in the frame of the picture, with its standard errors, and degree
    /// and angle of polarisation.
    Stokes,
}

/// How colours outside the PNG's colour space are mapped into it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Gamut mapping")]
pub enum GamutFile {
    /// Compresses the chroma of the whole picture, so that spectra keep their order and their
    /// gradations. Hue and luminance stay, and colours well inside the colour space do not change.
    #[default]
    Compress,
    /// Moves each colour outside towards the neutral colour of equal luminance.
    Desaturate,
    /// Clips each component separately.
    Clip,
    /// Reduces the chroma in Oklab at equal lightness and hue.
    Oklab,
}

/// How the PNG shows colours that are too bright for the display.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Tone curve")]
pub enum ToneFile {
    /// Components above 0.6 are compressed, so that highlights keep their colour and their
    /// gradations. A component of 1 is shown as 0.8.
    #[default]
    RollOff,
    /// Components are not changed. A component of 1 is the brightest that the display shows.
    Clip,
    /// The Khronos PBR Neutral tone mapper, for colours of products. Components below 0.8 keep
    /// their hue, and 0.04 is subtracted.
    PbrNeutral,
    /// AgX, as in Blender: a soft contrast curve on a logarithmic scale. Bright colours turn white.
    Agx,
}

/// The light that the PNG shows as white: "none", "scene", or the name of a spectrum.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(from = "String", into = "String")]
#[schemars(title = "White balance", example = &"none", example = &"scene", example = &"A")]
pub enum WhiteBalanceFile {
    /// The white of the output space: colours are shown as they are.
    #[default]
    None,
    /// The colour of all lights of the scene together, each weighted by its power.
    Scene,
    /// The colour of the spectrum with this name.
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

/// The colour space of the PNG.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Output space")]
pub enum OutputSpaceFile {
    /// sRGB.
    #[default]
    Srgb,
    /// Display P3.
    #[serde(rename = "display-p3")]
    DisplayP3,
    /// Rec. 2020.
    Rec2020,
    /// Rec. 2100 with the PQ curve, for HDR displays. White is shown at 203 cd/m², and highlights
    /// at up to 1000 cd/m².
    #[serde(rename = "rec2100-pq")]
    Rec2100Pq,
    /// ACEScg (linear).
    Acescg,
}

/// The exposure of the PNG.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Exposure")]
pub enum ExposureFile {
    /// The exposure is chosen from the brightness of the picture.
    #[default]
    Auto,
    /// The PNG shows absolute radiance, as the EXR holds it.
    None,
    /// Exposure in stops relative to absolute radiance. A positive value is brighter.
    #[schemars(example = json!({"ev": -2.5}))]
    Ev(#[schemars(extend("x-unit" = "stops"))] f64),
    /// Sensitivity of the film. The exposure then also depends on the shutter time and the
    /// f-number.
    #[schemars(example = json!({"iso": 100}))]
    Iso(#[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "ISO"))] f64),
}

impl FilmFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { width, height, spectral_bands, exposure, bloom, .. } = self;
        check::all([
            check::count(&at.key("width"), u64::from(*width), 1, 100_000),
            check::count(&at.key("height"), u64::from(*height), 1, 100_000),
            check::count(&at.key("spectral_bands"), u64::from(*spectral_bands), 0, 1024),
            match exposure {
                ExposureFile::Auto | ExposureFile::None | ExposureFile::Ev(_) => Ok(()),
                ExposureFile::Iso(iso) => check::positive(&at.key("exposure").key("iso"), *iso),
            },
            bloom.map_or(Ok(()), |BloomFile { fov, age }| {
                let at = at.key("bloom");
                check::all([
                    check::from_to(&at.key("fov"), fov, 0.1, 120.0),
                    check::from_to(&at.key("age"), age, 0.0, 100.0),
                ])
            }),
        ])
    }
}
