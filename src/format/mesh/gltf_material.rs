//! Materials of glTF files: the metallic-roughness model with the KHR extensions transmission, ior,
//! volume, dispersion and emissive_strength.

use ::gltf::Material;

use super::{MeshAttenuation, MeshMaterial};
use crate::error::{Error, Result};

/// Converts a glTF material. Textures are ignored.
///
/// # Errors
/// Returns an error if the dispersion or the index of refraction is not a number or is out of
/// range.
pub(super) fn material(file: &Material<'_>) -> Result<MeshMaterial> {
    let surface = file.pbr_metallic_roughness();
    let [r, g, b, _alpha] = surface.base_color_factor();
    let strength = f64::from(file.emissive_strength().unwrap_or(1.0));
    let volume = file.volume();
    let ior = f64::from(file.ior().unwrap_or(1.5));
    if !(ior.is_finite() && ior >= 1.0) {
        return Err(Error::input(format!("a material's ior is {ior}")).expected("at least 1"));
    }
    Ok(MeshMaterial {
        name: file.name().unwrap_or_default().to_string(),
        base_colour: [r, g, b].map(f64::from),
        metallic: f64::from(surface.metallic_factor()),
        roughness: f64::from(surface.roughness_factor()),
        transmission: file.transmission().map_or(0.0, |t| f64::from(t.transmission_factor())),
        ior,
        abbe_number: abbe_number(file)?,
        attenuation: volume.as_ref().filter(|volume| volume.attenuation_distance().is_finite()).map(|volume| {
            MeshAttenuation {
                colour: volume.attenuation_color().map(f64::from),
                distance: f64::from(volume.attenuation_distance()),
            }
        }),
        emission: file.emissive_factor().map(|c| strength * f64::from(c)),
    })
}

/// Returns the Abbe number V_d. The extension KHR_materials_dispersion states 20/V_d, or 0 for no
/// dispersion.
fn abbe_number(file: &Material<'_>) -> Result<Option<f64>> {
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

/// Returns whether the material has textures.
pub(super) fn has_textures(file: &Material<'_>) -> bool {
    let surface = file.pbr_metallic_roughness();
    surface.base_color_texture().is_some()
        || surface.metallic_roughness_texture().is_some()
        || file.normal_texture().is_some()
        || file.emissive_texture().is_some()
        || file.transmission().is_some_and(|transmission| transmission.transmission_texture().is_some())
}
