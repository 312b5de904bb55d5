//! Pictures as textures in the scene file.

use crate::forms::{Form, Forms};
use crate::prelude::*;
use crate::{UvFile, forms};
use serde::de::MapAccess;

/// The forms of a picture, for error messages.
const PATH_OR_OBJECT: &str = "a path, or an object with the key path";

/// A picture whose colours are reflectances: its path, or an object. PNG, JPEG, WebP, OpenEXR
/// and Radiance HDR files are read. The alpha channel is not used.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", deny_unknown_fields)]
#[schemars(rename = "ColourImageFile", title = "Picture of reflectances", transform = crate::schema::or_name)]
#[schemars(example = &"wood.jpg", example = json!({"path": "wood.jpg", "encoding": "srgb", "factor": [0.9, 0.9, 0.9],
    "wrap": "mirror", "filter": "bilinear", "uv": {"scale": [4, 4]}}))]
pub struct ColourImageFile {
    /// Path of the picture, relative to the scene's folder.
    pub path: String,
    /// How the file encodes colours.
    #[schemars(extend("x-default" = "`linear` for EXR and HDR files, otherwise `srgb`"))]
    pub encoding: Option<EncodingFile>,
    /// Factors of the linear red, green and blue components.
    #[serde(default = "one_per_channel", skip_serializing_if = "is_one_per_channel")]
    #[schemars(skip_serializing_if = "crate::schema::never", inner(range(min = 0)))]
    pub factor: [f64; 3],
    /// What the picture looks like outside the unit square of uv.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub wrap: WrapFile,
    /// How texels are interpolated.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub filter: FilterFile,
    /// The map of texture coordinates.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(extend("x-default" = "no change"))]
    pub uv: UvFile,
}

fn one_per_channel() -> [f64; 3] {
    [1.0; 3]
}

fn is_one_per_channel(factor: &[f64; 3]) -> bool {
    *factor == one_per_channel()
}

/// A picture with spectral bands: its path, or an object. The file is an OpenEXR file with the
/// channels `S0.…nm`, as `abbe render` writes them. The values of the channels are reflectances.
/// Between the wavelengths of the channels, the reflectance is interpolated linearly.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", deny_unknown_fields)]
#[schemars(rename = "BandImageFile", title = "Picture of spectral bands", transform = crate::schema::or_name)]
#[schemars(example = &"painting.exr", example = json!({"path": "painting.exr", "factor": 0.8, "wrap": "clamp",
    "filter": "nearest", "uv": {"scale": [2, 2]}}))]
pub struct BandImageFile {
    /// Path of the picture, relative to the scene's folder.
    pub path: String,
    /// Factor of all values.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0))]
    pub factor: f64,
    /// What the picture looks like outside the unit square of uv.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub wrap: WrapFile,
    /// How texels are interpolated.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub filter: FilterFile,
    /// The map of texture coordinates.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(extend("x-default" = "no change"))]
    pub uv: UvFile,
}

pub(super) fn one() -> f64 {
    1.0
}

pub(super) fn is_one(value: &f64) -> bool {
    *value == 1.0
}

/// A channel of a picture as numbers: the path of the picture, or an object.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", deny_unknown_fields)]
#[schemars(rename = "ScalarImageFile", title = "Picture of numbers", transform = crate::schema::or_name)]
#[schemars(example = &"mask.png", example = json!({"path": "mask.png", "channel": "alpha", "encoding": "linear",
    "range": [1, 0], "wrap": "clamp", "filter": "nearest", "uv": {"scale": [2, 2]}}))]
pub struct ScalarImageFile {
    /// Path of the picture, relative to the scene's folder.
    pub path: String,
    /// The channel that contains the numbers.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub channel: ChannelFile,
    /// How the file encodes the numbers.
    #[serde(default = "linear", skip_serializing_if = "is_linear")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub encoding: EncodingFile,
    /// The numbers that the values 0 and 1 of the channel become.
    #[serde(default = "unit_range", skip_serializing_if = "is_unit_range")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub range: [f64; 2],
    /// What the picture looks like outside the unit square of uv.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub wrap: WrapFile,
    /// How texels are interpolated.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub filter: FilterFile,
    /// The map of texture coordinates.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(extend("x-default" = "no change"))]
    pub uv: UvFile,
}

fn linear() -> EncodingFile {
    EncodingFile::Linear
}

fn is_linear(encoding: &EncodingFile) -> bool {
    *encoding == EncodingFile::Linear
}

fn unit_range() -> [f64; 2] {
    [0.0, 1.0]
}

fn is_unit_range(range: &[f64; 2]) -> bool {
    *range == unit_range()
}

impl Forms for ColourImageFile {
    const EXPECTED: &'static str = PATH_OR_OBJECT;

    fn from_name(path: String) -> Option<Self> {
        let (wrap, filter, uv) = (WrapFile::default(), FilterFile::default(), UvFile::default());
        Some(Self { path, encoding: None, factor: one_per_channel(), wrap, filter, uv })
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for ColourImageFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for ColourImageFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

impl Forms for BandImageFile {
    const EXPECTED: &'static str = PATH_OR_OBJECT;

    fn from_name(path: String) -> Option<Self> {
        let (wrap, filter, uv) = (WrapFile::default(), FilterFile::default(), UvFile::default());
        Some(Self { path, factor: 1.0, wrap, filter, uv })
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for BandImageFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for BandImageFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

impl Forms for ScalarImageFile {
    const EXPECTED: &'static str = PATH_OR_OBJECT;

    fn from_name(path: String) -> Option<Self> {
        let (wrap, filter, uv) = (WrapFile::default(), FilterFile::default(), UvFile::default());
        Some(Self { path, channel: ChannelFile::default(), encoding: linear(), range: unit_range(), wrap, filter, uv })
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for ScalarImageFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for ScalarImageFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

/// How a picture file encodes values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Picture encoding")]
pub enum EncodingFile {
    /// The transfer function of sRGB.
    Srgb,
    /// Values proportional to light.
    Linear,
}

/// What a picture looks like outside the unit square of uv.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Wrap mode")]
pub enum WrapFile {
    /// The picture repeats.
    #[default]
    Repeat,
    /// The picture repeats, and every second copy is mirrored.
    Mirror,
    /// The colours at the edges continue.
    Clamp,
}

/// How texels are interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Texture filter")]
pub enum FilterFile {
    /// Linear interpolation, and reduced copies of the picture for distant surfaces.
    #[default]
    Bilinear,
    /// The nearest pixel.
    Nearest,
}

/// A channel of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Picture channel")]
pub enum ChannelFile {
    /// Red, or the only channel of a grey picture.
    #[default]
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Alpha. A picture without this channel has the value 1.
    Alpha,
}
