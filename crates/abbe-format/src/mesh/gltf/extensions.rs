//! Material extensions that the crate `gltf` does not know: dispersion, clearcoat, specular and
//! diffuse transmission. Also names what the extensions state and the reader ignores.

use super::super::material::{MeshCoat, MeshDiffuseTransmission, MeshFilm};
use super::texture::GltfPictures;
use ::gltf::Material;
use abbe_spectra::error::{Error, Result};
use serde_json::Value;

/// The extensions that this module reads.
const READ: [&str; 6] = [
    "KHR_materials_dispersion",
    "KHR_materials_clearcoat",
    "KHR_materials_specular",
    "KHR_materials_diffuse_transmission",
    SPECULAR_GLOSSINESS,
    IRIDESCENCE,
];

const IRIDESCENCE: &str = "KHR_materials_iridescence";

pub(super) const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// The consequences of extensions that are not read.
const CONSEQUENCES: [(&str, &str); 3] = [
    ("KHR_materials_sheen", "cloth has no bright rim"),
    ("KHR_materials_anisotropy", "highlights are round"),
    ("KHR_materials_unlit", "the surface is lit like any other"),
];

/// Returns true if a file may require the extension: it is read, or a note states what is left out.
pub(super) fn is_accepted(name: &str) -> bool {
    READ.contains(&name) || CONSEQUENCES.iter().any(|(known, _)| *known == name) || name == "KHR_materials_variants"
}

/// Returns the Abbe number V_d. The extension states 20/V_d, or 0 for none, and never below 0.
pub(super) fn abbe_number(file: &Material) -> Result<Option<f64>> {
    let Some(extension) = file.extension_value("KHR_materials_dispersion") else { return Ok(None) };
    let Some(dispersion) = extension.get("dispersion") else { return Ok(None) };
    match dispersion.as_f64().filter(|dispersion| *dispersion >= 0.0) {
        Some(0.0) => Ok(None),
        Some(dispersion) => Ok(Some(20.0 / dispersion)),
        None => {
            Err(Error::input(format!("a material's dispersion is {dispersion}")).expected("a number of at least 0"))
        }
    }
}

pub(super) fn coat(file: &Material) -> Option<MeshCoat> {
    let extension = file.extension_value("KHR_materials_clearcoat")?;
    let factor = fraction(extension, "clearcoatFactor", 0.0);
    (factor > 0.0).then(|| MeshCoat { factor, roughness: fraction(extension, "clearcoatRoughnessFactor", 0.0) })
}

/// Returns the factor of the reflectance at normal incidence: the colour's luminance × the factor.
pub(super) fn specular(file: &Material) -> f64 {
    let Some(extension) = file.extension_value("KHR_materials_specular") else { return 1.0 };
    let [r, g, b] = colour(extension, "specularColorFactor");
    fraction(extension, "specularFactor", 1.0) * (0.2126 * r + 0.7152 * g + 0.0722 * b)
}

pub(super) fn diffuse_transmission(file: &Material) -> Option<MeshDiffuseTransmission> {
    let extension = file.extension_value("KHR_materials_diffuse_transmission")?;
    let factor = fraction(extension, "diffuseTransmissionFactor", 0.0);
    let colour = colour(extension, "diffuseTransmissionColorFactor").map(|c| c.min(1.0));
    (factor > 0.0).then_some(MeshDiffuseTransmission { factor, colour })
}

pub(super) fn film(file: &Material, pictures: &mut GltfPictures, set: u32) -> Option<MeshFilm> {
    let extension = file.extension_value(IRIDESCENCE).filter(|_| can_have_film(file))?;
    let number = |key: &str, default: f64| extension[key].as_f64().unwrap_or(default).max(0.0);
    let thickness_nm = [number("iridescenceThicknessMinimum", 100.0), number("iridescenceThicknessMaximum", 400.0)];
    let thickness_texture = extension.get(FILM_THICKNESS).and_then(|info| pictures.explicit(info, set));
    let ior = number("iridescenceIor", 1.3).max(1.0);
    let film = MeshFilm { factor: fraction(extension, "iridescenceFactor", 0.0), ior, thickness_nm, thickness_texture };
    (film.factor > 0.0).then_some(film)
}

const FILM_THICKNESS: &str = "iridescenceThicknessTexture";

/// Returns true if the surface is smooth glass.
fn can_have_film(file: &Material) -> bool {
    let surface = file.pbr_metallic_roughness();
    let is_glass = file.transmission().is_some_and(|it| it.transmission_factor() > 0.0);
    is_glass && surface.metallic_factor() < 1.0
}

/// Returns the names of the extensions that are not, or not fully, read, with the consequence.
pub(super) fn unread(file: &Material) -> Vec<String> {
    let mut unread = Vec::new();
    for (name, extension) in file.extensions().into_iter().flatten() {
        if !READ.contains(&name.as_str()) && has_effect(name, extension) {
            let consequence = CONSEQUENCES.iter().find(|(known, _)| known == name);
            unread.push(consequence.map_or_else(|| name.clone(), |(name, what)| format!("{name} ({what})")));
        }
        let textures = extension.as_object().into_iter().flatten().filter(|(key, _)| key.ends_with("Texture"));
        let textures = textures.filter(|(key, _)| key.as_str() != FILM_THICKNESS);
        if name != SPECULAR_GLOSSINESS {
            unread.extend(textures.map(|(key, _)| format!("{key} of {name} (its factor applies everywhere)")));
        } else if extension.get("specularGlossinessTexture").is_some() {
            unread.push("specularGlossinessTexture (its mean applies everywhere)".to_owned());
        }
    }
    let metallic = file.pbr_metallic_roughness().metallic_factor() > 0.5;
    if coat(file).is_some() && metallic && file.pbr_metallic_roughness().metallic_roughness_texture().is_none() {
        unread.push("KHR_materials_clearcoat of a metal (the metal has no coat)".to_owned());
    }
    if file.extension_value(IRIDESCENCE).is_some() && !can_have_film(file) {
        unread.push(format!("{IRIDESCENCE} (thin films on opaque surfaces have no colours)"));
    }
    if let Some(extension) = file.extension_value("KHR_materials_specular") {
        let [r, g, b] = colour(extension, "specularColorFactor");
        if r != g || g != b {
            unread.push("specularColorFactor (highlights are white)".to_owned());
        }
    }
    unread
}

/// Returns false if the factor of an extension switches it off.
fn has_effect(name: &str, extension: &Value) -> bool {
    match name {
        "KHR_materials_anisotropy" => extension["anisotropyStrength"].as_f64().unwrap_or(0.0) != 0.0,
        "KHR_materials_sheen" => {
            let colour = extension["sheenColorFactor"].as_array();
            colour.is_some_and(|colour| colour.iter().any(|part| part.as_f64() != Some(0.0)))
        }
        _ => true,
    }
}

/// Returns a number from 0 to 1.
pub(super) fn fraction(extension: &Value, key: &str, default: f64) -> f64 {
    extension[key].as_f64().unwrap_or(default).clamp(0.0, 1.0)
}

/// Returns a colour, which is white by default. Its components are at least 0.
pub(super) fn colour(extension: &Value, key: &str) -> [f64; 3] {
    let numbers: Vec<f64> = extension[key].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    <[f64; 3]>::try_from(numbers).unwrap_or([1.0; 3]).map(|c| c.max(0.0))
}
