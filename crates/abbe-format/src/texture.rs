//! Textures in the scene file: reflectances and numbers that may vary over a surface.

use crate::forms::{Form, Forms};
use crate::picture::{is_one, one};
use crate::prelude::*;
use crate::{
    BandImageFile, ColourImageFile, JsonPath, ScalarImageFile, SpectrumFile, UvFile, check, forms,
    spectrum::SpectrumUse,
};
use abbe_spectra::error::Result;
use serde::de::{Error as _, MapAccess};

/// A reflectance or a transmittance: a spectrum with values from 0 to 1, or a texture over the
/// texture coordinates uv of the shape.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
pub enum ReflectanceFile {
    /// The same spectrum at every point.
    #[serde(skip)]
    Spectrum(SpectrumFile),
    /// The colours of a picture.
    Image(ColourImageFile),
    /// The spectral bands of a picture.
    Bands(BandImageFile),
    /// A checkerboard.
    Checker(PatternFile<Box<ReflectanceFile>>),
    /// Stripes.
    Stripes(PatternFile<Box<ReflectanceFile>>),
    /// Fractal noise.
    Noise(NoisePatternFile<Box<ReflectanceFile>>),
}

/// The forms of a texture of reflectances. The schema lists them after the forms of a spectrum.
#[cfg(feature = "schema")]
#[derive(JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[expect(dead_code, reason = "only the schema of this type is used")]
enum ReflectanceTextureForms {
    /// The colours of a picture, upsampled to smooth spectra.
    #[schemars(example = json!({"image": "wood.jpg"}))]
    Image(ColourImageFile),
    /// The spectral bands of a picture.
    #[schemars(example = json!({"bands": "painting.exr"}))]
    Bands(BandImageFile),
    /// A checkerboard. The squares have the side 1 in uv, divided by the scale.
    #[schemars(example = json!({"checker": {"a": 0.1, "b": {"rgb": [0.8, 0.6, 0.2]}, "scale": 8,
        "uv": {"rotate": 45}}}))]
    Checker(PatternFile<Box<ReflectanceFile>>),
    /// Stripes parallel to v. The stripes have the width 1 in uv, divided by the scale.
    #[schemars(example = json!({"stripes": {"a": 0, "b": 0.9, "scale": 20, "uv": {"rotate": 45}}}))]
    Stripes(PatternFile<Box<ReflectanceFile>>),
    /// Fractal noise between two reflectances.
    #[schemars(example = json!({"noise": {"a": 0.2, "b": 0.6, "scale": 5, "octaves": 6, "seed": 1,
        "uv": {"scale": [1, 4]}}}))]
    Noise(NoisePatternFile<Box<ReflectanceFile>>),
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for ReflectanceFile {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ReflectanceFile".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let spectrum = generator.subschema_for::<SpectrumFile>();
        let mut schema = ReflectanceTextureForms::json_schema(generator);
        schema.insert("title".into(), "Reflectance".into());
        let description = "A reflectance or a transmittance: a spectrum with values from 0 to 1, or a texture over the \
                           texture coordinates uv of the shape.";
        schema.insert("description".into(), description.into());
        crate::schema::allow_also(&mut schema, &[spectrum.to_value()]);
        schema
    }
}

/// The keys of a texture of reflectances.
const TEXTURE_FORMS: [&str; 5] = ["image", "bands", "checker", "stripes", "noise"];

/// The keys of a reflectance that is written as an object.
pub(super) const REFLECTANCE_FORMS: [&str; 16] = [
    "table",
    "file",
    "lines",
    "blackbody",
    "daylight",
    "gaussian",
    "rgb",
    "srgb",
    "mix",
    "power_law",
    "match",
    "image",
    "bands",
    "checker",
    "stripes",
    "noise",
];

impl Forms for ReflectanceFile {
    const EXPECTED: &'static str = "a number from 0 to 1, a spectrum's name, a colour such as \"#ff8800\", or an object \
                                    with one of the keys table, file, lines, blackbody, daylight, gaussian, rgb, srgb, mix, \
                                    power_law, match, image, bands, checker, stripes, noise";

    fn from_number(number: f64) -> Option<Self> {
        Some(Self::Spectrum(SpectrumFile::Number(number)))
    }

    fn from_name(name: String) -> Option<Self> {
        Some(Self::Spectrum(SpectrumFile::Name(name)))
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        let key = form.key.as_str();
        if TEXTURE_FORMS.contains(&key) {
            Self::deserialize(form)
        } else if REFLECTANCE_FORMS.contains(&key) {
            SpectrumFile::deserialize(form).map(Self::Spectrum)
        } else {
            Err(A::Error::unknown_variant(key, &REFLECTANCE_FORMS))
        }
    }
}

impl<'de> Deserialize<'de> for ReflectanceFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for ReflectanceFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        if let Self::Spectrum(spectrum) = self {
            serde::Serialize::serialize(spectrum, serializer)
        } else {
            Self::serialize(self, serializer)
        }
    }
}

/// A number, or a texture of numbers over the texture coordinates uv of the shape.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "ScalarFile", title = "Number or texture", transform = crate::schema::or_number)]
#[schemars(example = json!(0.3))]
pub enum ScalarFile {
    /// The same number at every point.
    #[serde(skip)]
    Number(f64),
    /// A channel of a picture.
    #[schemars(example = json!({"image": {"path": "scratches.png", "channel": "green", "range": [0.1, 0.4]}}))]
    Image(ScalarImageFile),
    /// A checkerboard.
    #[schemars(example = json!({"checker": {"a": 0.1, "b": 0.4, "scale": 8, "uv": {"rotate": 45}}}))]
    Checker(PatternFile<f64>),
    /// Stripes parallel to v.
    #[schemars(example = json!({"stripes": {"a": 0, "b": 1, "scale": 20, "uv": {"rotate": 45}}}))]
    Stripes(PatternFile<f64>),
    /// Fractal noise between two numbers.
    #[schemars(example = json!({"noise": {"a": 0.1, "b": 0.5, "scale": 5, "octaves": 6, "seed": 1,
        "uv": {"scale": [1, 4]}}}))]
    Noise(NoisePatternFile<f64>),
    /// A gradient along v, or from the centre of the unit square of uv.
    #[schemars(example = json!({"gradient": {"a": 0, "b": 0.8, "power": 2, "radial": true,
        "uv": {"offset": [0, 0.1]}}}))]
    Gradient(GradientFile),
}

impl Default for ScalarFile {
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl Forms for ScalarFile {
    const EXPECTED: &'static str =
        "a number, or an object with one of the keys image, checker, stripes, noise, gradient";

    fn from_number(number: f64) -> Option<Self> {
        Some(Self::Number(number))
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for ScalarFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for ScalarFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        if let Self::Number(it) = self { serializer.serialize_f64(*it) } else { Self::serialize(self, serializer) }
    }
}

/// A pattern of two values that alternate.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "PatternFileOf{T}")]
pub struct PatternFile<T> {
    /// The value at the origin of uv.
    pub a: T,
    /// The value next to it.
    pub b: T,
    /// Number of squares or stripes per unit of uv.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// The map of texture coordinates. It is applied before the scale.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(extend("x-default" = "no change"))]
    pub uv: UvFile,
}

/// A pattern of two values that fractal noise mixes.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "NoisePatternFileOf{T}")]
pub struct NoisePatternFile<T> {
    /// The value where the noise is 0.
    pub a: T,
    /// The value where the noise is 1.
    pub b: T,
    /// Number of waves of the first octave per unit of uv.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// Number of octaves.
    #[serde(default = "default_octaves")]
    #[schemars(range(min = 1, max = 16))]
    pub octaves: u32,
    /// Seed of the noise.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub seed: u32,
    /// The map of texture coordinates. It is applied before the scale.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(extend("x-default" = "no change"))]
    pub uv: UvFile,
}

/// A gradient a + (b − a) · t^power, where t is limited to the range from 0 to 1.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GradientFile {
    /// The value at t = 0.
    pub a: f64,
    /// The value at t = 1.
    pub b: f64,
    /// Exponent of t. The thickness of a film that drains under gravity has the power 0.5.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("exclusiveMinimum" = 0))]
    pub power: f64,
    /// True if t is twice the distance from the centre of the unit square of uv. False if t is v,
    /// which increases downwards in a picture.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub radial: bool,
    /// The map of texture coordinates.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(extend("x-default" = "no change"))]
    pub uv: UvFile,
}

fn default_octaves() -> u32 {
    4
}

impl ReflectanceFile {
    /// Checks the ranges of numbers and the lengths of lists.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Spectrum(spectrum) => spectrum.validate(at, SpectrumUse::Fraction),
            Self::Image(image) => {
                let at = at.key("image");
                let at = at.key("factor");
                check::all(image.factor.iter().enumerate().map(|(i, &x)| check::not_negative(&at.index(i), x)))
            }
            Self::Bands(image) => check::not_negative(&at.key("bands").key("factor"), image.factor),
            Self::Checker(pattern) => validate_parts(&at.key("checker"), pattern),
            Self::Stripes(pattern) => validate_parts(&at.key("stripes"), pattern),
            Self::Noise(noise) => {
                let at = at.key("noise");
                check::all([noise.a.validate(&at.key("a")), noise.b.validate(&at.key("b")), noise.validate(&at)])
            }
        }
    }
}

fn validate_parts(at: &JsonPath, pattern: &PatternFile<Box<ReflectanceFile>>) -> Result<()> {
    let scale = check::positive(&at.key("scale"), pattern.scale);
    check::all([pattern.a.validate(&at.key("a")), pattern.b.validate(&at.key("b")), scale])
}

impl<T> NoisePatternFile<T> {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let octaves = check::rule(
            &at.key("octaves"),
            f64::from(self.octaves),
            (1..=16).contains(&self.octaves),
            "a whole number from 1 to 16",
        );
        check::all([check::positive(&at.key("scale"), self.scale), octaves])
    }
}

impl ScalarFile {
    /// Checks that every number that the file states has the given range.
    pub(super) fn validate(&self, at: &JsonPath, number: impl Fn(&JsonPath, f64) -> Result<()>) -> Result<()> {
        let pattern = |at: &JsonPath, pattern: &PatternFile<f64>| {
            let scale = check::positive(&at.key("scale"), pattern.scale);
            check::all([number(&at.key("a"), pattern.a), number(&at.key("b"), pattern.b), scale])
        };
        match self {
            Self::Number(value) => number(at, *value),
            Self::Image(image) => {
                let at = at.key("image");
                let at = at.key("range");
                check::all(image.range.iter().enumerate().map(|(i, &x)| number(&at.index(i), x)))
            }
            Self::Checker(checker) => pattern(&at.key("checker"), checker),
            Self::Stripes(stripes) => pattern(&at.key("stripes"), stripes),
            Self::Noise(noise) => {
                let at = at.key("noise");
                check::all([number(&at.key("a"), noise.a), number(&at.key("b"), noise.b), noise.validate(&at)])
            }
            Self::Gradient(gradient) => {
                let at = at.key("gradient");
                let power = check::positive(&at.key("power"), gradient.power);
                check::all([number(&at.key("a"), gradient.a), number(&at.key("b"), gradient.b), power])
            }
        }
    }
}
