//! Colours and spectra of pbrt files.

use super::parameters::{Parameter, Values};
use super::token::{Token, Tokens};
use crate::dark_outside::dark_outside;
use abbe_format::FileAccess;
use abbe_format::json::read_text;
use abbe_spectra::colour::RgbSpace;
use abbe_spectra::error::Result;
use serde_json::{Value, json};
use std::path::Path;

/// The folder, the file access and the colour space with which spectra are read.
#[derive(Debug, Clone)]
pub(super) struct SpectrumContext<'a> {
    pub(super) folder: &'a Path,
    pub(super) file_access: FileAccess,
    pub(super) space: RgbSpace,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct PbrtLightSpectrum {
    pub(super) spectrum: Value,
    /// The photometric quantity in pbrt's unit: for RGB values the relative luminance, otherwise 1.
    /// pbrt scales all other spectra of lights to this value.
    pub(super) luminance: f64,
}

impl PbrtLightSpectrum {
    /// The light of a pbrt light without a spectrum.
    pub(super) fn standard() -> Self {
        Self { spectrum: json!("D65"), luminance: 1.0 }
    }
}

impl SpectrumContext<'_> {
    /// Returns the linear sRGB components of an RGB parameter.
    fn rgb(&self, parameter: &Parameter) -> Result<[f64; 3]> {
        let rgb: [f64; 3] = parameter.numbers()?.try_into().map_err(|_| parameter.fault("three numbers"))?;
        let is_srgb = self.space == RgbSpace::Srgb;
        Ok(if is_srgb { rgb } else { RgbSpace::Srgb.from_xyz(self.space.to_xyz(rgb)) })
    }

    /// Returns a reflectance or a transmittance. The values are limited to the range from 0 to 1.
    pub(super) fn reflectance(&self, parameter: &Parameter) -> Result<Value> {
        match parameter.kind.as_str() {
            "rgb" | "color" => Ok(reflectance_of_rgb(self.rgb(parameter)?)),
            "float" => Ok(json!(one_number(parameter)?.clamp(0.0, 1.0))),
            "spectrum" => {
                let mut spectrum = self.spectrum(parameter)?;
                let mut list = |key: &str| -> Option<Vec<f64>> {
                    spectrum.pointer_mut(key)?.as_array()?.iter().map(Value::as_f64).collect()
                };
                if let (Some(nm), Some(mut values)) = (list("/table/nm"), list("/table/values")) {
                    values.iter_mut().for_each(|x| *x = x.clamp(0.0, 1.0));
                    return Ok(dark_outside(&nm, &values));
                }
                Ok(spectrum)
            }
            _ => Err(parameter.fault("a reflectance: rgb or spectrum")),
        }
    }

    /// Returns a spectrum of values that may be above 1, such as a coefficient of a medium or an
    /// index of refraction. `scale` multiplies the values.
    pub(super) fn coefficient(&self, parameter: &Parameter, scale: f64) -> Result<Value> {
        match parameter.kind.as_str() {
            "rgb" | "color" => Ok(scaled_rgb(self.rgb(parameter)?, scale)),
            "float" => Ok(json!(scale * one_number(parameter)?)),
            "spectrum" => Ok(scaled(self.spectrum(parameter)?, scale)),
            _ => Err(parameter.fault("rgb, spectrum or float")),
        }
    }

    pub(super) fn light(&self, parameter: &Parameter) -> Result<PbrtLightSpectrum> {
        match parameter.kind.as_str() {
            "rgb" | "color" => {
                let rgb = self.rgb(parameter)?.map(|c| c.max(0.0));
                let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
                let spectrum = if rgb[0] == rgb[1] && rgb[1] == rgb[2] { json!("D65") } else { json!({"rgb": rgb}) };
                Ok(PbrtLightSpectrum { spectrum, luminance })
            }
            "blackbody" => {
                let temperature = parameter.numbers()?.first().copied().unwrap_or(0.0);
                if temperature <= 0.0 {
                    return Err(parameter.fault("a temperature above 0 K"));
                }
                Ok(PbrtLightSpectrum { spectrum: json!({"blackbody": {"temperature": temperature}}), luminance: 1.0 })
            }
            "spectrum" => Ok(PbrtLightSpectrum { spectrum: self.spectrum(parameter)?, luminance: 1.0 }),
            _ => Err(parameter.fault("rgb, blackbody or spectrum")),
        }
    }

    pub(super) fn index(&self, parameter: &Parameter) -> Result<Value> {
        if parameter.kind == "spectrum" {
            return self.spectrum(parameter);
        }
        one_number(parameter).map(|number| json!(number))
    }

    /// Returns a spectrum from a list of wavelengths and values, from a name, or from a file.
    fn spectrum(&self, parameter: &Parameter) -> Result<Value> {
        match &parameter.values {
            Values::Numbers(numbers) => table(parameter, numbers),
            Values::Strings(_) => {
                let name = parameter.string()?;
                if let Some(known) = named(name) {
                    return Ok(json!(known));
                }
                let path = self.file_access.file(self.folder, Path::new(name))?;
                if !path.is_file() {
                    let what = format!("the spectrum \"{name}\" is not known, and is not a file");
                    return Err(parameter.place.error(what));
                }
                let mut tokens = Tokens::new(read_text(&path)?, path.clone().into());
                let mut numbers = Vec::new();
                while let Some(token) = tokens.read()? {
                    let Token::Number(number) = token else { return Err(tokens.place().error("expected a number")) };
                    numbers.push(number);
                }
                table(parameter, &numbers)
            }
            Values::Flags(_) => Err(parameter.fault("a spectrum")),
        }
    }
}

fn one_number(parameter: &Parameter) -> Result<f64> {
    if let [number] = parameter.numbers()? { Ok(*number) } else { Err(parameter.fault("one number")) }
}

fn table(parameter: &Parameter, numbers: &[f64]) -> Result<Value> {
    let (pairs, rest) = numbers.as_chunks::<2>();
    let rising = pairs.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    if !rest.is_empty() || pairs.len() < 2 || !rising {
        return Err(parameter.fault("at least two pairs of a wavelength and a value, with rising wavelengths"));
    }
    let column = |c: usize| pairs.iter().map(|pair| pair[c]).collect::<Vec<_>>();
    Ok(json!({"table": {"nm": column(0), "values": column(1)}}))
}

/// Returns Abbe's name of a spectrum that is built into pbrt.
fn named(name: &str) -> Option<String> {
    if let Some(glass) = name.strip_prefix("glass-") {
        let known = match glass {
            "BK7" => "N-BK7",
            "BAF10" => "N-BAF10",
            "FK51A" => "N-FK51A",
            "LASF9" => "N-LASF9",
            "F5" | "SF5" => "SF5",
            "F10" | "SF10" => "SF10",
            "F11" | "SF11" => "SF11",
            _ => return None,
        };
        return Some(known.to_string());
    }
    let illuminant = name.strip_prefix("stdillum-")?;
    Some(illuminant.strip_prefix('F').map_or_else(|| illuminant.to_string(), |number| format!("FL{number}")))
}

/// Returns Abbe's name of the metal if `eta` and `k` are pbrt's built-in ones of one metal.
pub(super) fn metal(eta: Option<&Parameter>, k: Option<&Parameter>) -> Option<&'static str> {
    let symbol = |parameter: Option<&Parameter>, end: &str| {
        let name = parameter?.string().ok()?.strip_prefix("metal-")?.strip_suffix(end)?;
        Some(name.to_string())
    };
    let (eta, k) = (symbol(eta, "-eta")?, symbol(k, "-k")?);
    let metal = match eta.as_str() {
        "Ag" => "silver",
        "Al" => "aluminium",
        "Au" => "gold",
        "Cu" => "copper",
        _ => return None,
    };
    (eta == k).then_some(metal)
}

pub(super) fn reflectance_of_rgb(rgb: [f64; 3]) -> Value {
    let rgb = rgb.map(|c| c.clamp(0.0, 1.0));
    if rgb[0] == rgb[1] && rgb[1] == rgb[2] { json!(rgb[0]) } else { json!({"rgb": rgb}) }
}

/// Returns the spectrum of RGB values of any size, multiplied by `scale`.
pub(super) fn scaled_rgb(rgb: [f64; 3], scale: f64) -> Value {
    let rgb = rgb.map(|c| c.max(0.0));
    let most = rgb.iter().copied().fold(0.0, f64::max);
    if rgb.iter().all(|&c| c == most) {
        return json!(scale * most);
    }
    scaled(json!({"rgb": rgb.map(|c| c / most)}), scale * most)
}

pub(super) fn scaled(spectrum: Value, scale: f64) -> Value {
    if scale == 1.0 {
        return spectrum;
    }
    match spectrum.as_f64() {
        Some(number) => json!(scale * number),
        None if scale <= 0.0 => json!(0),
        None => json!({"mix": [{"spectrum": spectrum, "weight": scale}]}),
    }
}
