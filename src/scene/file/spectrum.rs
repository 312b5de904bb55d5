//! A spectrum as written: wherever a scene wants a function of wavelength.

use schemars::JsonSchema;
use serde::de::{Error as _, MapAccess};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::check;
use super::forms::{self, Form, Forms};
use super::path::JsonPath;
use crate::error::Result;
use crate::optics::phase::MAX_MEAN_COSINE;

/// A function of wavelength: a number (constant), the name of one of the scene's `spectra` or of the built-in library,
/// or an object with one key.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "SpectrumFile", transform = forms::or_number_or_name)]
pub enum SpectrumFile {
    /// The same value at every wavelength.
    #[serde(skip)]
    Number(f64),
    /// A name from the scene's `spectra` or the built-in library.
    #[serde(skip)]
    Name(String),
    /// Values at wavelengths, linear between them.
    Table {
        /// Wavelengths in nm, rising.
        nm: Vec<f64>,
        /// One value for each wavelength.
        values: Vec<f64>,
    },
    /// A file with the columns nm,value, or an IES TM-27 `.spdx` file; relative to the scene's folder.
    File(String),
    /// Spectral lines.
    Lines(Vec<LineFile>),
    /// A black body (Planck's law).
    Blackbody {
        /// Temperature in K.
        #[schemars(extend("exclusiveMinimum" = 0))]
        temperature: f64,
    },
    /// A Gaussian band with the value 1 at its peak.
    Gaussian {
        /// Wavelength of the peak in nm.
        #[schemars(extend("exclusiveMinimum" = 0))]
        peak_nm: f64,
        /// Full width at half maximum in nm.
        #[schemars(extend("exclusiveMinimum" = 0))]
        fwhm_nm: f64,
    },
    /// Linear sRGB, upsampled to a smooth spectrum; as a reflectance each component is from 0 to 1.
    Rgb([f64; 3]),
    /// A weighted sum of spectra.
    Mix(Vec<WeightedSpectrumFile>),
    /// value · (λ / reference_nm)^exponent; Rayleigh scattering has the exponent −4.
    PowerLaw {
        /// Wavelength in nm at which `value` holds.
        #[schemars(extend("exclusiveMinimum" = 0))]
        reference_nm: f64,
        /// Value at the reference wavelength.
        value: f64,
        /// Exponent of the wavelength.
        exponent: f64,
    },
    /// The non-negative mix of the primaries whose XYZ comes nearest the target's.
    Match {
        /// The spectrum whose colour is wanted.
        target: Box<SpectrumFile>,
        /// The spectra to mix.
        #[schemars(length(min = 1))]
        primaries: Vec<SpectrumFile>,
    },
}

/// One spectral line.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LineFile {
    /// Wavelength of the centre in nm.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub nm: f64,
    /// Power of the line, relative to the other lines.
    #[schemars(range(min = 0))]
    pub power: f64,
    /// Full width at half maximum in nm (default 0.001).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub fwhm_nm: Option<f64>,
}

/// One part of a mix of spectra.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightedSpectrumFile {
    /// The spectrum.
    pub spectrum: SpectrumFile,
    /// Its factor.
    #[schemars(range(min = 0))]
    pub weight: f64,
}

impl Forms for SpectrumFile {
    const EXPECTED: &'static str = "a number, a spectrum's name, or an object with one of the keys table, file, lines, \
                                    blackbody, gaussian, rgb, mix, power_law, match";

    fn from_number(number: f64) -> Option<Self> {
        Some(Self::Number(number))
    }

    fn from_name(name: String) -> Option<Self> {
        Some(Self::Name(name))
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for SpectrumFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for SpectrumFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        if let Self::Number(number) = self {
            serializer.serialize_f64(*number)
        } else if let Self::Name(name) = self {
            serializer.serialize_str(name)
        } else {
            Self::serialize(self, serializer)
        }
    }
}

/// A reflectance: a spectrum with values from 0 to 1, or a pattern over the shape's uv.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "ReflectanceFile", transform = or_spectrum)]
pub enum ReflectanceFile {
    /// The same at every point.
    #[serde(skip)]
    Spectrum(SpectrumFile),
    /// A picture over uv.
    Image(ImageFile),
    /// A checkerboard over uv.
    Checker {
        /// The reflectance of the square at the origin of uv.
        a: Box<ReflectanceFile>,
        /// The reflectance of its neighbours.
        b: Box<ReflectanceFile>,
        /// Squares per unit of uv.
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: f64,
    },
}

/// Schema: a spectrum is allowed also.
fn or_spectrum(schema: &mut schemars::Schema) {
    forms::allow_also(schema, &[serde_json::json!({"$ref": "#/$defs/SpectrumFile"})]);
}

/// The object forms that a reflectance has beyond a spectrum's.
const PATTERN_FORMS: [&str; 2] = ["image", "checker"];

/// All object forms of a reflectance.
pub(super) const REFLECTANCE_FORMS: [&str; 11] =
    ["table", "file", "lines", "blackbody", "gaussian", "rgb", "mix", "power_law", "match", "image", "checker"];

impl Forms for ReflectanceFile {
    const EXPECTED: &'static str = "a number from 0 to 1, a spectrum's name, or an object with one of the keys table, \
                                    file, lines, blackbody, gaussian, rgb, mix, power_law, match, image, checker";

    fn from_number(number: f64) -> Option<Self> {
        Some(Self::Spectrum(SpectrumFile::Number(number)))
    }

    fn from_name(name: String) -> Option<Self> {
        Some(Self::Spectrum(SpectrumFile::Name(name)))
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        let key = form.key.as_str();
        if PATTERN_FORMS.contains(&key) {
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

/// A picture: `{"path": …}` or just the path.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", deny_unknown_fields)]
#[schemars(rename = "ImageFile", transform = forms::or_name)]
pub struct ImageFile {
    /// Path of the picture, relative to the scene's folder.
    pub path: String,
}

impl Forms for ImageFile {
    const EXPECTED: &'static str = "a path, or an object with the key path";

    fn from_name(path: String) -> Option<Self> {
        Some(Self { path })
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for ImageFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for ImageFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

/// What a spectrum is used for, which bounds its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// Not known yet: an entry of the scene's `spectra`.
    Any,
    /// Light, an absorption, a scattering coefficient: not negative.
    NotNegative,
    /// A reflectance or transmittance: 0 to 1.
    Share,
    /// The mean cosine of a phase function: above −1 and below 1, as far as double precision can tell.
    MeanCosine,
}

impl Use {
    /// Checks one value.
    fn check(self, at: &JsonPath, value: f64) -> Result<()> {
        match self {
            Self::Any => Ok(()),
            Self::NotNegative => check::not_negative(at, value),
            Self::Share => check::share(at, value),
            Self::MeanCosine => {
                let allowed = format!("a number from {} to {MAX_MEAN_COSINE}", -MAX_MEAN_COSINE);
                check::rule(at, value, value.abs() <= MAX_MEAN_COSINE, &allowed)
            }
        }
    }
}

impl SpectrumFile {
    /// Checks ranges and lengths; `used` bounds the values.
    pub(super) fn validate(&self, at: &JsonPath, used: Use) -> Result<()> {
        match self {
            Self::Number(value) => used.check(at, *value),
            Self::Name(_) | Self::File(_) => Ok(()),
            Self::Table { nm, values } => {
                validate_table(&at.key("table"), nm, values, |at, value| used.check(at, value))
            }
            Self::Lines(lines) => validate_lines(&at.key("lines"), lines),
            Self::Blackbody { temperature } => check::positive(&at.key("blackbody").key("temperature"), *temperature),
            Self::Gaussian { peak_nm, fwhm_nm } => {
                let at = at.key("gaussian");
                check::positive(&at.key("peak_nm"), *peak_nm)?;
                check::positive(&at.key("fwhm_nm"), *fwhm_nm)
            }
            Self::Rgb(rgb) => {
                let at = at.key("rgb");
                rgb.iter().enumerate().try_for_each(|(i, &value)| used.check(&at.index(i), value))
            }
            Self::Mix(parts) => {
                let at = at.key("mix");
                check::entries(&at, parts.len(), 1, "at least one spectrum with its weight")?;
                check::weights(&at, parts.iter().map(|part| part.weight))?;
                let mut parts = parts.iter().enumerate();
                parts.try_for_each(|(i, part)| part.spectrum.validate(&at.index(i).key("spectrum"), Use::Any))
            }
            Self::PowerLaw { reference_nm, value, exponent: _ } => {
                let at = at.key("power_law");
                check::positive(&at.key("reference_nm"), *reference_nm)?;
                used.check(&at.key("value"), *value)
            }
            Self::Match { target, primaries } => {
                let at = at.key("match");
                target.validate(&at.key("target"), Use::NotNegative)?;
                let at = at.key("primaries");
                check::entries(&at, primaries.len(), 1, "at least one spectrum")?;
                let mut primaries = primaries.iter().enumerate();
                primaries.try_for_each(|(i, primary)| primary.validate(&at.index(i), Use::NotNegative))
            }
        }
    }
}

/// Checks a table: as many values as wavelengths, at least two, wavelengths above 0 and rising.
pub(super) fn validate_table(
    at: &JsonPath,
    nm: &[f64],
    values: &[f64],
    value_rule: impl Fn(&JsonPath, f64) -> Result<()>,
) -> Result<()> {
    let (nm_at, values_at) = (at.key("nm"), at.key("values"));
    check::entries(&nm_at, nm.len(), 2, "at least 2 wavelengths")?;
    if values.len() != nm.len() {
        let found = format!("found an array of {}", values.len());
        return Err(check::fault(&values_at, found, format!("an array of {}, one value for each of `nm`", nm.len())));
    }
    nm.iter().enumerate().try_for_each(|(i, &nm)| check::positive(&nm_at.index(i), nm))?;
    check::rising(&nm_at, nm.iter().copied(), None)?;
    values.iter().enumerate().try_for_each(|(i, &value)| value_rule(&values_at.index(i), value))
}

/// Checks lines: at least one, each at a wavelength above 0 with a width above 0, and some power.
fn validate_lines(at: &JsonPath, lines: &[LineFile]) -> Result<()> {
    check::entries(at, lines.len(), 1, "at least one line")?;
    for (i, LineFile { nm, power, fwhm_nm }) in lines.iter().enumerate() {
        let at = at.index(i);
        check::positive(&at.key("nm"), *nm)?;
        check::not_negative(&at.key("power"), *power)?;
        fwhm_nm.map_or(Ok(()), |fwhm_nm| check::positive(&at.key("fwhm_nm"), fwhm_nm))?;
    }
    if lines.iter().all(|line| line.power == 0.0) {
        return Err(check::fault(at, "found only lines without power", "at least one line with a power above 0"));
    }
    Ok(())
}

impl ReflectanceFile {
    /// Checks ranges and lengths.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Spectrum(spectrum) => spectrum.validate(at, Use::Share),
            Self::Image(_) => Ok(()),
            Self::Checker { a, b, scale } => {
                let at = at.key("checker");
                a.validate(&at.key("a"))?;
                b.validate(&at.key("b"))?;
                check::positive(&at.key("scale"), *scale)
            }
        }
    }
}
