//! Lights and media of pbrt files.

use super::parameters::Parameters;
use super::spectrum::{PbrtLightSpectrum, SpectrumContext};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::cos;
use glam::{DMat4, DVec3};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// Returns the rotation of an infinite light. The projection "equal_area" has pbrt's axes.
fn rotation(to_world: &DMat4) -> Value {
    let rows: Vec<Vec<f64>> = (0..4)
        .map(|row| (0..4).map(|column| if row < 3 && column == 3 { 0.0 } else { to_world.col(column)[row] }).collect())
        .collect();
    json!([{"matrix": rows}])
}

/// Reads the spectrum of a light, or returns the standard light.
fn spectrum(parameters: &Parameters, key: &str, spectra: &SpectrumContext) -> Result<PbrtLightSpectrum> {
    parameters.get(key).map_or_else(|| Ok(PbrtLightSpectrum::standard()), |parameter| spectra.light(parameter))
}

/// Reads a light of the type `class`. Returns `None` if the light is left out.
///
/// pbrt scales the spectra of lights so that RGB (1, 1, 1) has a photometric quantity of 1: 1
/// cd/m², 1 cd or 1 lx (pbrt-v4, `Light::Create`).
pub(super) fn read_light(
    class: &str,
    parameters: &Parameters,
    to_world: &DMat4,
    folder: &str,
    spectra: &SpectrumContext,
    left_out: &mut Vec<String>,
) -> Result<Option<Value>> {
    let scale = parameters.number_or("scale", 1.0)?;
    let power = parameters.number("power")?.filter(|&power| power > 0.0);
    let point = |key: &str, default: [f64; 3]| -> Result<DVec3> {
        Ok(to_world.transform_point3(parameters.tuple::<3>(key)?.unwrap_or(default).into()))
    };
    let light = match class {
        "point" => {
            let PbrtLightSpectrum { spectrum, luminance } = spectrum(parameters, "I", spectra)?;
            let intensity = scale * luminance * power.map_or(1.0, |power| power / (4.0 * PI));
            let at = point("from", [0.0; 3])?.to_array();
            json!({"point": {"at": at, "spectrum": spectrum, "luminous_intensity": intensity}})
        }
        "spot" => {
            let PbrtLightSpectrum { spectrum, luminance } = spectrum(parameters, "I", spectra)?;
            let cone = parameters.number_or("coneangle", 30.0)?;
            let delta = parameters.number_or("conedeltaangle", 5.0)?.clamp(0.0, cone);
            let [start, end] = [cone - delta, cone].map(|degrees| cos(degrees.to_radians()));
            let normaliser = TAU * ((1.0 - start) + 0.5 * (start - end));
            let intensity = scale * luminance * power.map_or(1.0, |power| power / normaliser);
            json!({"spot": {
                "at": point("from", [0.0; 3])?.to_array(), "to": point("to", [0.0, 0.0, 1.0])?.to_array(),
                "half_angle": cone, "penumbra": delta, "spectrum": spectrum, "luminous_intensity": intensity
            }})
        }
        "distant" => {
            let PbrtLightSpectrum { spectrum, luminance } = spectrum(parameters, "L", spectra)?;
            let toward = point("to", [0.0, 0.0, 1.0])? - point("from", [0.0; 3])?;
            let explicit = parameters.number("illuminance")?.filter(|&lux| lux > 0.0);
            let illuminance = scale * luminance * explicit.unwrap_or(1.0);
            json!({"directional": {"toward": toward.to_array(), "spectrum": spectrum, "illuminance": illuminance}})
        }
        "infinite" => {
            if parameters.get("portal").is_some() {
                left_out.push("the portal of an infinite light is not used".into());
            }
            let explicit = parameters.number("illuminance")?.filter(|&lux| lux > 0.0);
            let mut light = json!({});
            if let Some(file) = parameters.file("filename", spectra.folder, spectra.file_access)? {
                light["image"] = json!(format!("{folder}{file}"));
                light["projection"] = json!("equal_area");
                if let Some(illuminance) = explicit {
                    left_out.push("the illuminance of a picture of directions is that of the mean radiance".into());
                    light["illuminance"] = json!(scale * illuminance);
                } else {
                    light["luminance"] = json!(scale);
                }
                light["transform"] = rotation(to_world);
            } else {
                let PbrtLightSpectrum { spectrum, luminance } = spectrum(parameters, "L", spectra)?;
                light["spectrum"] = spectrum;
                light["luminance"] = json!(scale * luminance * explicit.map_or(1.0, |lux| lux / PI));
            }
            json!({"environment": light})
        }
        "goniometric" | "projection" => {
            parameters.ignore(&["filename", "fov", "I"]);
            left_out.push(format!("light \"{class}\" is left out"));
            return Ok(None);
        }
        _ => {
            parameters.ignore_all();
            left_out.push(format!("light \"{class}\" is left out"));
            return Ok(None);
        }
    };
    Ok(Some(light))
}

/// Reads the emission of a surface with the area `area`, if the area is known.
pub(super) fn read_emission(
    parameters: &Parameters,
    area: Option<f64>,
    spectra: &SpectrumContext,
    left_out: &mut Vec<String>,
) -> Result<Value> {
    let PbrtLightSpectrum { spectrum, luminance } = spectrum(parameters, "L", spectra)?;
    let scale = parameters.number_or("scale", 1.0)?;
    let twosided = parameters.flag_or("twosided", false)?;
    if twosided {
        left_out.push("a two-sided area light shines only to the front".into());
    }
    // pbrt divides the power between the two sides.
    let scale = if twosided && parameters.number_or("power", 0.0)? > 0.0 { 0.5 * scale } else { scale };
    if parameters.get("filename").is_some() {
        left_out.push("the picture of an area light is left out".into());
    }
    let power = parameters.number("power")?.filter(|&power| power > 0.0);
    Ok(match (power, area) {
        (None, _) => json!({"spectrum": spectrum, "luminance": scale * luminance}),
        (Some(power), Some(area)) => {
            json!({"spectrum": spectrum, "luminance": scale * luminance * power / (PI * area)})
        }
        (Some(power), None) => json!({"spectrum": spectrum, "luminous_flux": scale * luminance * power}),
    })
}

pub(super) fn read_medium(
    parameters: &Parameters,
    to_world: &Value,
    spectra: &SpectrumContext,
    left_out: &mut Vec<String>,
) -> Result<Option<Value>> {
    let class = parameters.string("type")?.unwrap_or("homogeneous").to_string();
    let scale = parameters.number_or("scale", 1.0)?;
    if let Some(preset) = parameters.string("preset")? {
        left_out.push(format!("the preset \"{preset}\" of a medium is replaced by pbrt's default coefficients"));
    }
    let coefficient = |key: &str, default: [f64; 3]| match parameters.get(key) {
        Some(parameter) => spectra.coefficient(parameter, scale),
        None => Ok(super::spectrum::scaled_rgb(default, scale)),
    };
    let is_grid = class == "uniformgrid";
    let [default_a, default_s] = if is_grid { [[1.0; 3]; 2] } else { [[0.0011, 0.0024, 0.014], [2.55, 3.21, 3.77]] };
    let (absorption, scattering) = (coefficient("sigma_a", default_a)?, coefficient("sigma_s", default_s)?);
    let g = parameters.number_or("g", 0.0)?;
    let phase = if g == 0.0 { json!("isotropic") } else { json!({"henyey_greenstein": {"g": g}}) };
    if ["Le", "temperature", "Lescale"].iter().filter(|key| parameters.get(key).is_some()).count() > 0 {
        left_out.push("the emission of a medium is left out".into());
    }
    match class.as_str() {
        "homogeneous" => Ok(Some(json!({"homogeneous": {
            "absorption": absorption, "scattering": scattering, "phase": phase
        }}))),
        "uniformgrid" => {
            let cells = |key| Ok(parameters.number_or(key, 1.0)?.clamp(1.0, 65536.0) as u32);
            let resolution: Vec<u32> = ["nx", "ny", "nz"].into_iter().map(cells).collect::<Result<_>>()?;
            let density = parameters.get("density").map(|parameter| parameter.numbers()).transpose()?;
            let bounds =
                [parameters.tuple::<3>("p0")?.unwrap_or([0.0; 3]), parameters.tuple::<3>("p1")?.unwrap_or([1.0; 3])];
            Ok(Some(json!({"grid": {
                "bounds": bounds, "density": {"values": density.unwrap_or(&[1.0]), "resolution": resolution},
                "absorption": absorption, "scattering": scattering, "phase": phase, "transform": to_world
            }})))
        }
        _ => {
            parameters.ignore_all();
            left_out.push(format!("medium \"{class}\" is left out"));
            Ok(None)
        }
    }
}
