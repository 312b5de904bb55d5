//! Spectra of a Mitsuba scene.
//!
//! In Mitsuba, an emitter with the colour (1, 1, 1) or with the value 1 at every wavelength has the
//! luminance 1, because Y is divided by the integral of ȳ. The photometric quantities of the scene
//! file therefore have the values of Mitsuba's pictures.

use super::xml::{XmlElement, number, numbers, parse};
use super::{properties::Properties, reader::MitsubaReader};
use crate::dark_outside::dark_outside;
use abbe_spectra::colour::decode_srgb;
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::{Observer, Outside, SmoothReflectance, Spectrum};
use serde_json::{Value, json};

/// The wavelengths (nm) at which products of spectra are tabulated.
const TABULATED_NM: std::ops::RangeInclusive<u32> = 72..=166;

/// The step of [`TABULATED_NM`] in nm.
const STEP_NM: f64 = 5.0;

/// The largest number of samples of a table in a file.
const MAX_SAMPLES: usize = 100_000;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum MitsubaSpectrum {
    /// A number. As a light, it is a multiple of D65.
    Number(f64),
    /// The same value at each wavelength, for lights too.
    Uniform(f64),
    /// A linear sRGB colour. As a light, it is a filtered D65.
    Rgb([f64; 3]),
    /// Values at given wavelengths in nm.
    Table { nm: Vec<f64>, values: Vec<f64> },
    /// A black body.
    Blackbody { temperature: f64, scale: f64 },
}

/// A light: its spectrum in the form of the scene file, and its photometric quantity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct EmissionSpectrum {
    pub(super) spectrum: Value,
    pub(super) quantity: f64,
}

impl EmissionSpectrum {
    pub(super) fn is_dark(&self) -> bool {
        self.quantity <= 0.0
    }
}

impl MitsubaReader<'_> {
    /// Reads a property that is a spectrum. `element` is already resolved and is no texture.
    pub(super) fn spectrum(&mut self, element: &XmlElement) -> Result<MitsubaSpectrum> {
        match element.tag.as_str() {
            "float" | "integer" => Ok(MitsubaSpectrum::Number(number(element)?)),
            "rgb" | "srgb" => rgb(element, element.required("value")?),
            "spectrum" | "texture" if !element.plugin().is_empty() => self.spectrum_plugin(element),
            "spectrum" => match (element.attribute("value"), element.attribute("filename")) {
                (Some(text), None) => explicit_spectrum(element, text),
                (None, Some(name)) => self.spectrum_file(element, name),
                _ => Err(element.error("a <spectrum> needs either \"value\" or \"filename\"")),
            },
            "blackbody" => Ok(MitsubaSpectrum::Blackbody {
                temperature: parse(element, element.required("temperature")?.trim_end_matches(['K', 'k']))?,
                scale: element.attribute("scale").map_or(Ok(1.0), |text| parse(element, text))?,
            }),
            other => Err(element.error(format!("found <{other}>")).expected("a number, a colour or a spectrum")),
        }
    }

    fn spectrum_plugin(&mut self, element: &XmlElement) -> Result<MitsubaSpectrum> {
        let properties = Properties::new(element);
        let spectrum = match element.plugin() {
            "rawconstant" if properties.is_vector("value") => {
                MitsubaSpectrum::Rgb(properties.vector("value")?.unwrap_or_default().to_array())
            }
            "uniform" | "rawconstant" => MitsubaSpectrum::Uniform(properties.number("value", 1.0)?),
            "d65" => self.d65(&properties)?,
            "srgb" => match properties.find("color") {
                Some(colour) => self.spectrum(colour)?,
                None => return Err(element.error("a spectrum of the type \"srgb\" without the property \"color\"")),
            },
            "blackbody" => MitsubaSpectrum::Blackbody {
                temperature: properties.number("temperature", 5000.0)?,
                scale: properties.number("scale", 1.0)?,
            },
            "regular" => {
                let values = numbers(element, properties.text("values")?.unwrap_or_default())?;
                let low = properties.number("wavelength_min", 360.0)?;
                let high = properties.number("wavelength_max", 830.0)?;
                let step = (high - low) / (values.len().max(2) - 1) as f64;
                table(element, (0..values.len()).map(|i| low + step * i as f64).collect(), values)?
            }
            "irregular" => {
                let [nm, values] =
                    ["wavelengths", "values"].map(|name| numbers(element, properties.text(name)?.unwrap_or_default()));
                table(element, nm?, values?)?
            }
            other => {
                self.note(element, format!("a spectrum of the type \"{other}\" is not supported and becomes 0.5"));
                return Ok(MitsubaSpectrum::Number(0.5));
            }
        };
        self.note_unread(&properties);
        Ok(spectrum)
    }

    /// Reads a multiple of D65. As a light, numbers and colours are multiples of D65 anyway.
    fn d65(&mut self, properties: &Properties) -> Result<MitsubaSpectrum> {
        let scale = properties.number("scale", 1.0)?;
        let nested = properties.find("color").or_else(|| properties.take(|child| !child.plugin().is_empty()).pop());
        let Some(nested) = nested else { return Ok(MitsubaSpectrum::Number(scale)) };
        let nested = self.document.resolve(nested);
        match self.spectrum(&nested)? {
            MitsubaSpectrum::Number(x) | MitsubaSpectrum::Uniform(x) => Ok(MitsubaSpectrum::Number(scale * x)),
            MitsubaSpectrum::Rgb(rgb) => Ok(MitsubaSpectrum::Rgb(rgb.map(|c| scale * c))),
            MitsubaSpectrum::Table { .. } | MitsubaSpectrum::Blackbody { .. } => {
                let what = "a filter of D65 that is neither a number nor a colour is not supported and is left out";
                self.note(&nested, what);
                Ok(MitsubaSpectrum::Number(scale))
            }
        }
    }

    /// Reads a file with a wavelength in nm and a value in each line.
    fn spectrum_file(&mut self, element: &XmlElement, name: &str) -> Result<MitsubaSpectrum> {
        let (_, path) = self.document.file(element, name)?;
        let text = abbe_format::read_text(&path).map_err(|error| element.locate(error))?;
        let (mut nm, mut values) = (Vec::new(), Vec::new());
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
            match numbers(element, line)?.as_slice() {
                &[wavelength, value] => (nm.push(wavelength), values.push(value)),
                other => {
                    let what = format!("\"{name}\" has a line with {} numbers", other.len());
                    return Err(element.error(what).expected("a wavelength and a value in each line"));
                }
            };
        }
        table(element, nm, values)
    }
}

/// Parses the `value` of a `<spectrum>`: a number, pairs such as `400:0.5`, or in 0.x a colour.
fn explicit_spectrum(element: &XmlElement, text: &str) -> Result<MitsubaSpectrum> {
    if !text.contains(':') {
        return match numbers(element, text)?.as_slice() {
            &[value] => Ok(MitsubaSpectrum::Uniform(value)),
            &[r, g, b] => Ok(MitsubaSpectrum::Rgb([r, g, b])),
            other => Err(element
                .error(format!("found {} numbers", other.len()))
                .expected("one number, or pairs such as \"400:0.5, 700:0.8\"")),
        };
    }
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let pairs: Result<Vec<(f64, f64)>> = words
        .map(|word| {
            let fault = || element.error(format!("found \"{word}\"")).expected("a pair such as 400:0.5");
            let (nm, value) = word.split_once(':').ok_or_else(fault)?;
            Ok((parse(element, nm)?, parse(element, value)?))
        })
        .collect();
    let (nm, values) = pairs?.into_iter().unzip();
    table(element, nm, values)
}

/// Parses a linear sRGB colour: three numbers, one number, or a colour such as `#ff8800`.
fn rgb(element: &XmlElement, text: &str) -> Result<MitsubaSpectrum> {
    let text = text.trim();
    if text.starts_with('#') {
        return abbe_format::linear_of_hex(text).map(MitsubaSpectrum::Rgb).map_err(|error| element.locate(error));
    }
    match numbers(element, text)?.as_slice() {
        &[value] => Ok(MitsubaSpectrum::Rgb([value; 3])),
        &[r, g, b] if element.tag == "srgb" => Ok(MitsubaSpectrum::Rgb([r, g, b].map(decode_srgb))),
        &[r, g, b] => Ok(MitsubaSpectrum::Rgb([r, g, b])),
        other => Err(element.error(format!("found {} numbers", other.len())).expected("one or three numbers")),
    }
}

fn table(element: &XmlElement, nm: Vec<f64>, values: Vec<f64>) -> Result<MitsubaSpectrum> {
    let rises = nm.windows(2).all(|pair| pair[0] < pair[1]);
    let valid = nm.len() == values.len() && (2..=MAX_SAMPLES).contains(&nm.len()) && rises && nm[0] > 0.0;
    if valid && values.iter().all(|&value| value >= 0.0) {
        return Ok(MitsubaSpectrum::Table { nm, values });
    }
    let expected = "at least two rising wavelengths in nm, each with a value of at least 0";
    Err(element.error("the table of the spectrum is not valid").expected(expected))
}

/// Returns the luminance of a colour (1, 1, 1) of a light, relative to a constant spectrum of 1.
fn luminance(spectrum: &Spectrum) -> f64 {
    let observer = Observer::cie1931();
    observer.xyz(spectrum)[1] / observer.xyz(&Spectrum::constant(1.0))[1]
}

impl MitsubaSpectrum {
    /// Returns the spectrum as a light. A temperature of at most 0 and a value below 0 are errors.
    pub(super) fn light(&self) -> Result<EmissionSpectrum> {
        let (spectrum, quantity) = match self {
            Self::Number(value) => (json!("D65"), *value),
            Self::Uniform(value) => (json!(1), *value),
            Self::Rgb(rgb) if *rgb == [rgb[0]; 3] => (json!("D65"), rgb[0]),
            Self::Rgb(rgb) => {
                let colour = rgb.map(|c| c.max(0.0));
                (json!({"rgb": colour}), 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2])
            }
            Self::Table { nm, values } => (
                json!({"table": {"nm": nm, "values": values}}),
                luminance(&Spectrum::table(nm, values, Outside::Zero)?),
            ),
            Self::Blackbody { temperature, scale } => (
                json!({"blackbody": {"temperature": temperature}}),
                scale * luminance(&Spectrum::blackbody(*temperature)?),
            ),
        };
        let spectrum = if quantity > 0.0 { spectrum } else { json!("D65") };
        Ok(EmissionSpectrum { spectrum, quantity: quantity.max(0.0) })
    }

    /// Returns the number, if the spectrum has the same value at each wavelength.
    pub(super) fn constant(&self) -> Option<f64> {
        match self {
            Self::Number(value) | Self::Uniform(value) => Some(*value),
            Self::Rgb(rgb) if *rgb == [rgb[0]; 3] => Some(rgb[0]),
            Self::Rgb(_) | Self::Table { .. } | Self::Blackbody { .. } => None,
        }
    }

    pub(super) fn mean(&self) -> f64 {
        match self {
            Self::Number(value) | Self::Uniform(value) => *value,
            Self::Rgb([r, g, b]) => (r + g + b) / 3.0,
            Self::Table { values, .. } => values.iter().sum::<f64>() / values.len() as f64,
            Self::Blackbody { .. } => 0.5,
        }
    }

    /// Returns the smallest and the largest value. `None` for a black body.
    fn range(&self) -> Option<[f64; 2]> {
        let of = |values: &[f64]| {
            let values = values.iter().copied();
            Some([values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max)])
        };
        match self {
            Self::Number(value) | Self::Uniform(value) => Some([*value; 2]),
            Self::Rgb(rgb) => of(rgb),
            Self::Table { values, .. } => of(values),
            Self::Blackbody { .. } => None,
        }
    }

    pub(super) fn is_fraction(&self) -> bool {
        self.range().is_some_and(|[smallest, largest]| largest <= 1.0 && smallest >= 0.0)
    }

    pub(super) fn map(&self, change: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Number(value) => Self::Number(change(*value)),
            Self::Uniform(value) => Self::Uniform(change(*value)),
            Self::Rgb(rgb) => Self::Rgb(rgb.map(change)),
            Self::Table { nm, values } => {
                Self::Table { nm: nm.clone(), values: values.iter().map(|&value| change(value)).collect() }
            }
            Self::Blackbody { .. } => self.clone(),
        }
    }

    /// Returns the spectrum as a reflectance or a coefficient in the form of the scene file. Like
    /// Mitsuba, scales a colour above 1 so that its largest component is 0.5.
    pub(super) fn coefficient(&self) -> Value {
        match self {
            Self::Rgb(rgb) if *rgb != [rgb[0]; 3] => match self.range() {
                Some([_, largest]) if largest > 1.0 => {
                    let colour = rgb.map(|c| c / (2.0 * largest));
                    json!({"mix": [{"spectrum": {"rgb": colour}, "weight": 2.0 * largest}]})
                }
                _ => json!({"rgb": rgb}),
            },
            Self::Table { nm, values } => dark_outside(nm, values),
            Self::Blackbody { temperature, .. } => json!({"blackbody": {"temperature": temperature}}),
            Self::Number(_) | Self::Uniform(_) | Self::Rgb(_) => json!(self.constant().unwrap_or_default()),
        }
    }

    /// Returns the spectrum as the index of a metal. Beyond its ends, a table is constant.
    pub(super) fn held(&self) -> Value {
        if let Self::Table { nm, values } = self {
            return json!({"table": {"nm": nm, "values": values}});
        }
        self.coefficient()
    }

    fn at(&self, nm: f64) -> f64 {
        match self {
            Self::Number(value) | Self::Uniform(value) => *value,
            Self::Rgb(rgb) => {
                let largest = rgb.iter().copied().fold(0.0, f64::max);
                let scale = if largest > 1.0 { 2.0 * largest } else { 1.0 };
                scale * SmoothReflectance::of_rgb(rgb.map(|c| c / scale)).at(nm)
            }
            Self::Table { nm: known, values } => {
                Spectrum::table(known, values, Outside::Zero).map_or(0.0, |spectrum| spectrum.at(nm))
            }
            Self::Blackbody { .. } => 0.0,
        }
    }

    /// Combines two spectra wavelength by wavelength.
    pub(super) fn combined(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        if let (Some(a), Some(b)) = (self.constant(), other.constant()) {
            return Self::Number(combine(a, b));
        }
        let nm: Vec<f64> = TABULATED_NM.map(|step| STEP_NM * f64::from(step)).collect();
        let values = nm.iter().map(|&nm| combine(self.at(nm), other.at(nm))).collect();
        Self::Table { nm, values }
    }
}
