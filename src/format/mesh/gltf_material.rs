//! Materials of glTF files: the metallic-roughness model with the KHR extensions transmission, ior,
//! volume, dispersion and emissive_strength.

use ::gltf::material::AlphaMode;
use ::gltf::texture::Info;
use ::gltf::{Document, Material, Semantic};

use super::gltf_texture::GltfPictures;
use super::{MeshAttenuation, MeshMaterial, MeshOpacity, listed};
use crate::error::{Error, Result};

/// Converts a glTF material.
///
/// # Errors
/// Returns an error if the dispersion or the index of refraction is not a number or is out of
/// range.
pub(super) fn read_material(file: &Material<'_>, pictures: &mut GltfPictures<'_>) -> Result<MeshMaterial> {
    let surface = file.pbr_metallic_roughness();
    let [r, g, b, alpha] = surface.base_color_factor();
    let strength = f64::from(file.emissive_strength().unwrap_or(1.0));
    let volume = file.volume();
    let ior = f64::from(file.ior().unwrap_or(1.5));
    if !(ior.is_finite() && ior >= 1.0) {
        return Err(Error::input(format!("a material's ior is {ior}")).expected("at least 1"));
    }
    let base_colour_texture = surface.base_color_texture().and_then(|info| pictures.texture(&info));
    let metallic_roughness_texture = surface.metallic_roughness_texture().and_then(|info| pictures.texture(&info));
    let opacity = match file.alpha_mode() {
        AlphaMode::Opaque => MeshOpacity::Opaque,
        AlphaMode::Mask => {
            MeshOpacity::Cut { alpha: f64::from(alpha), cutoff: f64::from(file.alpha_cutoff().unwrap_or(0.5)) }
        }
        AlphaMode::Blend => MeshOpacity::Blend { alpha: f64::from(alpha) },
    };
    // An area light has the same radiance everywhere, so a picture of the emission is averaged.
    let emission_picture = file.emissive_texture().and_then(|info| pictures.texture(&info));
    let mean = emission_picture.map_or([1.0; 3], |texture| texture.picture.mean_rgb());
    Ok(MeshMaterial {
        name: file.name().unwrap_or_default().to_string(),
        base_colour: [r, g, b].map(f64::from),
        base_colour_texture,
        metallic: f64::from(surface.metallic_factor()),
        roughness: f64::from(surface.roughness_factor()),
        metallic_roughness_texture,
        transmission: file.transmission().map_or(0.0, |t| f64::from(t.transmission_factor())),
        ior,
        abbe_number: abbe_number(file)?,
        attenuation: volume.as_ref().filter(|volume| volume.attenuation_distance().is_finite()).map(|volume| {
            MeshAttenuation {
                colour: volume.attenuation_color().map(f64::from),
                distance: f64::from(volume.attenuation_distance()),
            }
        }),
        opacity,
        emission: std::array::from_fn(|i| strength * f64::from(file.emissive_factor()[i]) * mean[i]),
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

/// Describes what a glTF file states and the reader ignores.
pub(super) fn ignored(document: &Document) -> Vec<String> {
    let textures: Vec<&str> = document.materials().flat_map(|file| textures(&file)).collect();
    let extensions: Vec<String> = document.materials().flat_map(|file| unread_extensions(&file)).collect();
    let mut primitives = document.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>());
    let has_vertex_colours = primitives.any(|primitive| primitive.get(&Semantic::Colors(0)).is_some());
    let other = [
        (has_vertex_colours, "vertex colours"),
        (document.animations().next().is_some(), "animations"),
        (document.skins().next().is_some(), "skins"),
    ];
    let other = other.into_iter().filter(|(is_used, _)| *is_used).map(|(_, what)| what);
    let sentences = [
        listed(textures).map(|names| format!("textures are ignored: {names}")),
        listed(extensions.iter().map(String::as_str)).map(|names| format!("material extensions are ignored: {names}")),
        listed(other).map(|names| format!("ignored as well: {names}")),
    ];
    sentences.into_iter().flatten().collect()
}

/// Returns the names of the material's textures that are not read.
fn textures(file: &Material<'_>) -> Vec<&'static str> {
    let second = |info: Info<'_>| {
        let stated = info.texture_transform().and_then(|transform| transform.tex_coord());
        stated.unwrap_or(info.tex_coord()) != 0
    };
    let surface = file.pbr_metallic_roughness();
    let transmission = file.transmission();
    let volume = file.volume();
    let used = [
        (surface.base_color_texture().is_some_and(second), "baseColorTexture (second set of coordinates)"),
        (
            surface.metallic_roughness_texture().is_some_and(second),
            "metallicRoughnessTexture (second set of coordinates)",
        ),
        (file.normal_texture().is_some(), "normalTexture"),
        (file.occlusion_texture().is_some(), "occlusionTexture"),
        (file.emissive_texture().is_some(), "emissiveTexture (its mean colour is used)"),
        (transmission.is_some_and(|it| it.transmission_texture().is_some()), "transmissionTexture"),
        (volume.is_some_and(|it| it.thickness_texture().is_some()), "thicknessTexture"),
    ];
    used.into_iter().filter(|(is_used, _)| *is_used).map(|(_, name)| name).collect()
}

/// Returns the names of the material's extensions that are not read.
fn unread_extensions(file: &Material<'_>) -> Vec<String> {
    let extensions = file.extensions().into_iter().flatten();
    extensions.map(|(name, _)| name.clone()).filter(|name| name != "KHR_materials_dispersion").collect()
}
