//! Materials of pbrt files.

use super::parameters::{Parameter, Parameters};
use super::spectrum::metal;
use super::texture::{TextureReader, map_numbers, mean};
use abbe_spectra::error::Result;
use serde_json::{Value, json};

#[derive(Debug, Clone, PartialEq)]
pub(super) enum ReadMaterial {
    /// A material of the scene file.
    Surface {
        material: Value,
        /// The normal map in the form of the scene file, without the key `material`.
        normal_map: Option<Value>,
    },
    /// The boundary of a medium, without an optical surface.
    Interface,
    /// A mix of two named materials. The number is the fraction of the second one.
    Mix([String; 2], Value),
}

pub(super) fn read(class: &str, parameters: &Parameters, textures: &mut TextureReader) -> Result<ReadMaterial> {
    if parameters.get("displacement").is_some() {
        textures.left_out.push("a displacement is left out".into());
    }
    let spectra = &textures.spectra;
    let file = parameters.file("normalmap", spectra.folder, spectra.file_access)?;
    let normal_map = file.map(|file| json!({"path": format!("{}{file}", textures.folder)}));
    let surface = match class {
        "" | "interface" | "none" => return Ok(ReadMaterial::Interface),
        "mix" => {
            let names = parameters.strings("materials")?.unwrap_or_default();
            let names: [String; 2] = names.to_vec().try_into().unwrap_or_default();
            return Ok(ReadMaterial::Mix(names, textures.value(parameters, "amount", true, 0.5)?));
        }
        "diffuse" => json!({"diffuse": {"reflectance": textures.value(parameters, "reflectance", false, 0.5)?}}),
        "coateddiffuse" => {
            let reflectance = textures.value(parameters, "reflectance", false, 0.5)?;
            let roughness = roughness(parameters, "", 0.0, textures)?;
            let ior = index(parameters, "eta", 1.5, textures)?;
            parameters.ignore(&["thickness", "maxdepth", "nsamples"]);
            leave_out_layer(parameters, textures)?;
            json!({"glossy": {
                "reflectance": reflectance, "ior": ior, "roughness": roughness, "interreflection": true
            }})
        }
        "conductor" => conductor(parameters, "", textures)?,
        "coatedconductor" => {
            textures.left_out.push("the coat of a metal is left out".into());
            parameters.ignore(&["interface.eta", "interface.roughness", "interface.uroughness"]);
            parameters.ignore(&["interface.vroughness", "thickness", "maxdepth", "nsamples"]);
            leave_out_layer(parameters, textures)?;
            conductor(parameters, "conductor.", textures)?
        }
        "dielectric" => {
            let roughness = roughness(parameters, "", 0.0, textures)?;
            json!({"dielectric": {"ior": index(parameters, "eta", 1.5, textures)?, "roughness": roughness}})
        }
        "thindielectric" => json!({"thin_dielectric": {"ior": index(parameters, "eta", 1.5, textures)?}}),
        "diffusetransmission" => {
            let scale = parameters.number_or("scale", 1.0)?;
            let mut part = |key| -> Result<Value> {
                let value = textures.value(parameters, key, false, 0.25)?;
                Ok(textures.product(value, &json!(scale), false))
            };
            json!({"translucent": {"reflectance": part("reflectance")?, "transmittance": part("transmittance")?}})
        }
        "subsurface" => {
            textures.left_out.push("subsurface scattering is replaced by a coated diffuse surface".into());
            let roughness = roughness(parameters, "", 0.0, textures)?;
            let ior = index(parameters, "eta", 1.33, textures)?;
            let reflectance = textures.value(parameters, "reflectance", false, 0.5)?;
            parameters.ignore(&["mfp", "sigma_a", "sigma_s", "name", "g", "scale"]);
            json!({"glossy": {"reflectance": reflectance, "ior": ior, "roughness": roughness}})
        }
        _ => {
            textures.left_out.push(format!("material \"{class}\" is replaced by a diffuse surface of reflectance 0.5"));
            parameters.ignore_all();
            json!({"diffuse": {"reflectance": 0.5}})
        }
    };
    Ok(ReadMaterial::Surface { material: surface, normal_map })
}

/// Notes a scattering medium between a base and its coat.
fn leave_out_layer(parameters: &Parameters, textures: &mut TextureReader) -> Result<()> {
    parameters.ignore(&["g"]);
    let albedo = textures.value(parameters, "albedo", false, 0.0)?;
    if albedo.as_f64() != Some(0.0) {
        textures.left_out.push("the scattering medium inside a coat is left out".into());
    }
    Ok(())
}

fn conductor(parameters: &Parameters, prefix: &str, textures: &mut TextureReader) -> Result<Value> {
    let key = |name: &str| format!("{prefix}{name}");
    let roughness = roughness(parameters, prefix, 0.0, textures)?;
    if parameters.get(&key("reflectance")).is_some() {
        let reflectance = textures.value(parameters, &key("reflectance"), false, 1.0)?;
        return Ok(json!({"conductor": {"reflectance": reflectance, "roughness": roughness}}));
    }
    let (eta, k) = (parameters.get(&key("eta")), parameters.get(&key("k")));
    let metal = if eta.is_none() && k.is_none() { Some("copper") } else { metal(eta, k) };
    if let Some(metal) = metal {
        return Ok(json!({"conductor": {"metal": metal, "roughness": roughness}}));
    }
    let builtin = |it: &&Parameter| it.kind == "spectrum" && it.string().is_ok_and(|name| name.starts_with("metal-"));
    if let Some(unknown) = eta.filter(builtin).or(k.filter(builtin)) {
        textures.left_out.push(format!("the metal \"{}\" is replaced by copper", unknown.string()?));
        return Ok(json!({"conductor": {"metal": "copper", "roughness": roughness}}));
    }
    let mut part = |parameter: Option<&Parameter>, default: f64| match parameter {
        Some(parameter) if parameter.kind == "texture" => {
            textures.left_out.push("a texture of the index of a metal is left out".into());
            Ok(json!(default))
        }
        Some(parameter) => textures.spectra.coefficient(parameter, 1.0),
        None => Ok(json!(default)),
    };
    Ok(json!({"conductor": {"eta": part(eta, 0.5)?, "k": part(k, 3.0)?, "roughness": roughness}}))
}

fn index(parameters: &Parameters, key: &str, default: f64, textures: &mut TextureReader) -> Result<Value> {
    match parameters.get(key) {
        Some(parameter) if parameter.kind == "texture" => {
            textures.left_out.push("a texture of the index of refraction is left out".into());
            Ok(json!(default))
        }
        Some(parameter) => textures.spectra.index(parameter),
        None => Ok(json!(default)),
    }
}

/// Returns Abbe's roughness, which is the square root of the width α of the GGX distribution.
///
/// pbrt's roughness is α. If `remaproughness` is true, α is its square root (pbrt-v4,
/// `TrowbridgeReitzDistribution::RoughnessToAlpha`).
fn roughness(parameters: &Parameters, prefix: &str, default: f64, textures: &mut TextureReader) -> Result<Value> {
    let key = |name: &str| format!("{prefix}{name}");
    let remap = parameters.flag_or("remaproughness", true)?;
    let common = textures.value(parameters, &key("roughness"), true, default)?;
    let mut along = |name: &str| match parameters.get(&key(name)) {
        Some(_) => textures.value(parameters, &key(name), true, default),
        None => Ok(common.clone()),
    };
    let (u, v) = (along("uroughness")?, along("vroughness")?);
    let mut value = u.clone();
    if u != v {
        textures.left_out.push("anisotropic roughness is replaced by its mean".into());
        let number = |value: &Value| mean(value).as_f64().unwrap_or(default).max(0.0);
        value = json!((number(&u) * number(&v)).sqrt());
    }
    let converted = |alpha: f64| {
        let root = alpha.max(0.0).sqrt();
        if remap { root.sqrt() } else { root }.min(1.0)
    };
    if let Some(number) = value.as_f64() {
        return Ok(json!(converted(number)));
    }
    textures.left_out.push("a texture of roughness is interpolated between the roughness of its extreme values".into());
    Ok(map_numbers(value, &converted))
}
