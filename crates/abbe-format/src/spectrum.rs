//! Spectra and reflectances in the scene file.

use crate::forms::{Form, Forms};
use crate::prelude::*;
use crate::{JsonPath, SrgbFile, check, forms};
use abbe_optics::phase::MAX_MEAN_COSINE;
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::DAYLIGHT_K;
#[cfg(feature = "schema")]
use abbe_spectra::spectrum::DEFAULT_LINE_WIDTH_NM;
use serde::de::MapAccess;

/// A function of wavelength: a constant number, the name of a spectrum in the scene's `spectra` or
/// in the built-in library, an sRGB colour such as `"#ff8800"`, or an object with one key. `abbe
/// spectrum --list` prints the library.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "SpectrumFile", title = "Spectrum", transform = crate::schema::or_number_or_name)]
#[schemars(example = json!(0.5), example = &"D65", example = &"#ff8800")]
pub enum SpectrumFile {
    /// The same value at every wavelength.
    #[serde(skip)]
    Number(f64),
    /// The name of a spectrum in the scene's `spectra` or in the built-in library, or an sRGB
    /// colour such as `#ff8800`.
    #[serde(skip)]
    Name(String),
    /// Values at given wavelengths, with linear interpolation between them.
    #[schemars(example = json!({"table": {"nm": [400, 550, 700], "values": [0.1, 0.5, 0.9]}}))]
    Table {
        /// Wavelengths in rising order.
        #[schemars(length(min = 2), transform = crate::schema::positive_items, extend("x-unit" = "nm"))]
        nm: Vec<f64>,
        /// One value for each wavelength.
        values: Vec<f64>,
    },
    /// Path of a CSV file with the columns nm,value, of an IES TM-27 `.spdx` file, or of a CGATS
    /// file (`.ti3` and the like), relative to the scene's folder; or an object with the path and a
    /// sample of a CGATS file.
    #[schemars(example = json!({"file": "lamp.csv"}))]
    #[schemars(example = json!({"file": {"path": "chart.ti3", "sample": "A1"}}))]
    File(Box<SpectrumPathFile>),
    /// Spectral lines.
    #[schemars(example = json!({"lines": [{"nm": 588.995, "power": 2}, {"nm": 589.592, "power": 1}]}))]
    Lines(#[schemars(length(min = 1))] Vec<LineFile>),
    /// A black body (Planck's law).
    #[schemars(example = json!({"blackbody": {"temperature": 2856}}))]
    Blackbody {
        /// Temperature.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "K"))]
        temperature: f64,
    },
    /// A phase of daylight by its correlated colour temperature (CIE 15, D series).
    #[schemars(example = json!({"daylight": {"temperature": 5500}}))]
    Daylight {
        /// Correlated colour temperature.
        #[schemars(range(min = DAYLIGHT_K.0, max = DAYLIGHT_K.1), extend("x-unit" = "K"))]
        temperature: f64,
    },
    /// A Gaussian band with the value 1 at its peak.
    #[schemars(example = json!({"gaussian": {"peak_nm": 530, "fwhm_nm": 30}}))]
    Gaussian {
        /// Wavelength of the peak.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "nm"))]
        peak_nm: f64,
        /// Full width at half maximum.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "nm"))]
        fwhm_nm: f64,
    },
    /// A linear sRGB colour, which is upsampled to a smooth spectrum. Each component of a
    /// reflectance is from 0 to 1.
    #[schemars(example = json!({"rgb": [0.2, 0.5, 0.8]}))]
    Rgb([f64; 3]),
    /// An sRGB colour as in image editors: `"#ff8800"`, or components from 0 to 1. It is upsampled
    /// like `rgb`. The plain string `"#ff8800"` means the same.
    #[schemars(example = json!({"srgb": "#ff8800"}), example = json!({"srgb": [1, 0.53, 0]}))]
    Srgb(SrgbFile),
    /// A weighted sum of spectra.
    #[schemars(example = json!({"mix": [{"spectrum": "A", "weight": 0.3}, {"spectrum": "D65", "weight": 1}]}))]
    Mix(#[schemars(length(min = 1))] Vec<WeightedSpectrumFile>),
    /// A power law: value · (λ / reference_nm)^exponent. Rayleigh scattering has the exponent −4.
    #[schemars(example = json!({"power_law": {"reference_nm": 550, "value": 0.01, "exponent": -4}}))]
    PowerLaw {
        /// The reference wavelength.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "nm"))]
        reference_nm: f64,
        /// Value at the reference wavelength.
        value: f64,
        /// Exponent of the wavelength.
        exponent: f64,
    },
    /// The mix of primaries that is nearest to the target in XYZ. All weights are at least 0.
    #[schemars(example = json!({"match": {"target": 1, "primaries": [{"gaussian": {"peak_nm": 530, "fwhm_nm": 30}}, "A"]}}))]
    Match {
        /// The spectrum that the mix matches in colour.
        #[schemars(extend("minimum" = 0))]
        target: Box<SpectrumFile>,
        /// The spectra to mix.
        #[schemars(length(min = 1))]
        primaries: Vec<SpectrumFile>,
    },
}

/// A file with a spectrum: its path, or an object with the keys `path` and `sample`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", deny_unknown_fields)]
#[schemars(rename = "SpectrumPathFile", title = "File of a spectrum", transform = crate::schema::or_name)]
#[schemars(example = &"lamp.csv", example = json!({"path": "chart.ti3", "sample": "A1"}))]
pub struct SpectrumPathFile {
    /// Path of the file, relative to the scene's folder: a CSV file, an IES TM-27 `.spdx` file, or
    /// a CGATS file, which is recognised by its contents.
    pub path: String,
    /// `SAMPLE_ID`, `SAMPLE_NAME` or `SAMPLE_LOC` of a sample of a CGATS file. A file with several
    /// samples needs it. Reflectances in percent become fractions: a file is in percent if one of
    /// its values is above 2, unless its column names (`SPECTRAL_PCT`) or `SPECTRAL_NORM` tell it.
    #[schemars(extend("x-default" = "the only sample of the file"))]
    pub sample: Option<String>,
}

impl Forms for SpectrumPathFile {
    const EXPECTED: &'static str = "a path, or an object with the keys path and sample";

    fn from_name(path: String) -> Option<Self> {
        Some(Self { path, sample: None })
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for SpectrumPathFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for SpectrumPathFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        if self.sample.is_none() { serializer.serialize_str(&self.path) } else { Self::serialize(self, serializer) }
    }
}

/// A spectral line.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spectral line", example = json!({"nm": 588.995, "power": 2, "fwhm_nm": 0.01}))]
pub struct LineFile {
    /// Wavelength of the centre.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "nm"))]
    pub nm: f64,
    /// Power relative to the other lines. At least one line must have a power above 0.
    #[schemars(range(min = 0))]
    pub power: f64,
    /// Full width at half maximum.
    #[schemars(extend("default" = DEFAULT_LINE_WIDTH_NM, "exclusiveMinimum" = 0, "x-unit" = "nm"))]
    pub fwhm_nm: Option<f64>,
}

/// One part of a mix of spectra.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Part of a spectrum mix", example = json!({"spectrum": "D65", "weight": 0.5}))]
pub struct WeightedSpectrumFile {
    /// The spectrum.
    pub spectrum: SpectrumFile,
    /// Factor of the spectrum. At least one factor must be above 0.
    #[schemars(range(min = 0))]
    pub weight: f64,
}

impl Forms for SpectrumFile {
    const EXPECTED: &'static str = "a number, a spectrum's name, a colour such as \"#ff8800\", or an object with one of the \
                                    keys table, file, lines, blackbody, daylight, gaussian, rgb, srgb, mix, power_law, match";

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

/// A picture: its path, or an object with the key `path`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", deny_unknown_fields)]
#[schemars(rename = "ImageFile", title = "Picture", transform = crate::schema::or_name)]
#[schemars(example = &"photo.png", example = json!({"path": "photo.png"}))]
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

/// The use of a spectrum, which determines its allowed values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SpectrumUse {
    /// Any value is allowed, because the use of an entry of the scene's `spectra` is unknown.
    Any,
    /// A light, an absorption coefficient or a scattering coefficient. Values are at least 0.
    NotNegative,
    /// A reflectance or a transmittance. Values are from 0 to 1.
    Fraction,
    /// The mean cosine of a phase function. Values are from −0.999999 to 0.999999.
    MeanCosine,
}

impl SpectrumUse {
    fn check(self, at: &JsonPath, value: f64) -> Result<()> {
        match self {
            Self::Any => Ok(()),
            Self::NotNegative => check::not_negative(at, value),
            Self::Fraction => check::fraction(at, value),
            Self::MeanCosine => {
                let allowed = format!("a number from {} to {MAX_MEAN_COSINE}", -MAX_MEAN_COSINE);
                check::rule(at, value, value.abs() <= MAX_MEAN_COSINE, &allowed)
            }
        }
    }
}

impl SpectrumFile {
    pub(super) fn validate(&self, at: &JsonPath, used: SpectrumUse) -> Result<()> {
        match self {
            Self::Number(value) => used.check(at, *value),
            Self::Name(_) | Self::File(_) => Ok(()),
            Self::Table { nm, values } => validate_table(&at.key("table"), nm, values, &|at, it| used.check(at, it)),
            Self::Lines(lines) => validate_lines(&at.key("lines"), lines),
            Self::Blackbody { temperature } => check::positive(&at.key("blackbody").key("temperature"), *temperature),
            Self::Daylight { temperature } => {
                let inside = (DAYLIGHT_K.0..=DAYLIGHT_K.1).contains(temperature);
                let at = at.key("daylight");
                check::rule(&at.key("temperature"), *temperature, inside, "a number from 4000 to 25000")
            }
            Self::Gaussian { peak_nm, fwhm_nm } => {
                let at = at.key("gaussian");
                let peak = check::positive(&at.key("peak_nm"), *peak_nm);
                check::all([peak, check::positive(&at.key("fwhm_nm"), *fwhm_nm)])
            }
            Self::Rgb(rgb) => {
                let at = at.key("rgb");
                check::all(rgb.iter().enumerate().map(|(i, &value)| used.check(&at.index(i), value)))
            }
            Self::Srgb(colour) => colour.validate(&at.key("srgb")),
            Self::Mix(parts) => {
                let at = at.key("mix");
                check::entries(&at, parts.len(), 1, "at least one spectrum with its weight")?;
                check::weights(&at, parts.iter().map(|part| part.weight))?;
                let parts = parts.iter().enumerate();
                check::all(parts.map(|(i, it)| it.spectrum.validate(&at.index(i).key("spectrum"), SpectrumUse::Any)))
            }
            Self::PowerLaw { reference_nm, value, exponent: _ } => {
                let at = at.key("power_law");
                let reference = check::positive(&at.key("reference_nm"), *reference_nm);
                check::all([reference, used.check(&at.key("value"), *value)])
            }
            Self::Match { target, primaries } => {
                let at = at.key("match");
                target.validate(&at.key("target"), SpectrumUse::NotNegative)?;
                let at = at.key("primaries");
                check::entries(&at, primaries.len(), 1, "at least one spectrum")?;
                let primaries = primaries.iter().enumerate();
                check::all(primaries.map(|(i, primary)| primary.validate(&at.index(i), SpectrumUse::NotNegative)))
            }
        }
    }
}

/// Checks that a table has at least two wavelengths, that the wavelengths are above 0 and rise, and
/// that there is one value for each wavelength. `value_rule` checks each value.
pub(super) fn validate_table(
    at: &JsonPath,
    nm: &[f64],
    values: &[f64],
    value_rule: &dyn Fn(&JsonPath, f64) -> Result<()>,
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
