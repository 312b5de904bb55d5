//! Materials of glTF files: the metallic-roughness model with the KHR extensions transmission, ior,
//! volume, emissive_strength and those of `gltf_extensions`.

use super::super::material::{MeshAttenuation, MeshMaterial, MeshOpacity};
use super::super::part::listed;
use super::extensions::{abbe_number, coat, diffuse_transmission, film, specular, unread};
use super::texture::{GltfPictures, normal_uv_set_of, uv_set_of};
use super::{specular_glossiness, specular_glossiness::ConvertedMaterial};
use ::gltf::accessor::Dimensions;
use ::gltf::material::AlphaMode;
use ::gltf::texture::Info;
use ::gltf::{Document, Material, Semantic};
use abbe_spectra::error::{Error, Result};

/// Converts a glTF material. A dispersion or an index of refraction out of range is an error.
pub(super) fn read_material(file: &Material, pictures: &mut GltfPictures) -> Result<MeshMaterial> {
    let set = uv_set(file);
    let surface = file.pbr_metallic_roughness();
    let mut base = surface.base_color_factor().map(f64::from);
    let strength = f64::from(file.emissive_strength().unwrap_or(1.0));
    let volume = file.volume();
    let ior = f64::from(file.ior().unwrap_or(1.5));
    if !(ior.is_finite() && ior >= 1.0) {
        return Err(Error::input(format!("a material's ior is {ior}")).expected("at least 1"));
    }
    let mut base_colour_texture = surface.base_color_texture().and_then(|info| pictures.texture(&info, set));
    let metallic_roughness_texture = surface.metallic_roughness_texture().and_then(|info| pictures.texture(&info, set));
    let [mut metallic, mut roughness] = [surface.metallic_factor(), surface.roughness_factor()].map(f64::from);
    let converted = specular_glossiness::convert(file, pictures, set);
    let metallic_roughness_texture = metallic_roughness_texture.filter(|_| converted.is_none());
    if let Some(ConvertedMaterial { base: colour, base_texture, metallic: metal, roughness: rough }) = converted {
        (base, base_colour_texture, metallic, roughness) = (colour, base_texture, metal, rough);
    }
    let [r, g, b, alpha] = base;
    let transmission = file.transmission();
    let transmission_texture = transmission.as_ref().and_then(|it| it.transmission_texture());
    let transmission_texture = transmission_texture.and_then(|info| pictures.texture(&info, set));
    let opacity = match file.alpha_mode() {
        AlphaMode::Opaque => MeshOpacity::Opaque,
        AlphaMode::Mask => MeshOpacity::Cut { alpha, cutoff: f64::from(file.alpha_cutoff().unwrap_or(0.5)) },
        AlphaMode::Blend => MeshOpacity::Blend { alpha },
    };
    let emission_texture = file.emissive_texture().and_then(|info| pictures.texture(&info, set));
    let normals = file.normal_texture();
    let normal_texture = normals.as_ref().and_then(|normals| pictures.normal_map(normals, set));
    Ok(MeshMaterial {
        name: file.name().unwrap_or_default().to_string(),
        base_colour: [r, g, b],
        base_colour_texture,
        metallic,
        roughness,
        metallic_roughness_texture,
        transmission: transmission.map_or(0.0, |it| f64::from(it.transmission_factor())),
        is_sheet: is_sheet(file),
        transmission_texture,
        diffuse_transmission: diffuse_transmission(file),
        coat: coat(file),
        specular: specular(file),
        film: film(file, pictures, set),
        ior,
        abbe_number: abbe_number(file)?,
        attenuation: volume.as_ref().filter(|volume| volume.attenuation_distance().is_finite()).map(|volume| {
            MeshAttenuation {
                colour: volume.attenuation_color().map(f64::from),
                distance: f64::from(volume.attenuation_distance()),
            }
        }),
        opacity,
        emission: std::array::from_fn(|i| strength * f64::from(file.emissive_factor()[i])),
        emission_texture,
        normal_texture,
        normal_strength: normals.map_or(1.0, |normals| f64::from(normals.scale())),
    })
}

/// Returns the textures that multiply the factors of a material.
fn textures_of<'a>(file: &Material<'a>) -> impl Iterator<Item = Info<'a>> + use<'a> {
    let surface = file.pbr_metallic_roughness();
    let transmission = file.transmission().and_then(|it| it.transmission_texture());
    let colours = [surface.base_color_texture(), surface.metallic_roughness_texture()];
    colours.into_iter().chain([transmission, file.emissive_texture()]).flatten()
}

/// Returns the number of the set of texture coordinates of a material. A material whose textures
/// use several sets has the set of its first texture.
pub(super) fn uv_set(file: &Material) -> u32 {
    let normals = file.normal_texture().map_or(0, |normals| normal_uv_set_of(&normals));
    textures_of(file).next().map_or(normals, |info| uv_set_of(&info))
}

/// Returns true if a material uses texture coordinates.
pub(super) fn has_textures(file: &Material) -> bool {
    let glossiness = file.extension_value(super::extensions::SPECULAR_GLOSSINESS);
    let glossiness = glossiness.is_some_and(|it| it.get("diffuseTexture").is_some());
    textures_of(file).next().is_some() || file.normal_texture().is_some() || glossiness
}

/// Describes what a glTF file states and the reader ignores.
pub fn ignored(document: &Document) -> Vec<String> {
    let textures: Vec<String> = document.materials().flat_map(|file| textures(&file)).collect();
    let extensions: Vec<String> = document.materials().flat_map(|file| unread(&file)).collect();
    let mut primitives = document.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>());
    let has_colours_and_textures = primitives
        .any(|primitive| primitive.get(&Semantic::Colors(0)).is_some() && has_textures(&primitive.material()));
    let mut primitives = document.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>());
    let has_colours_with_alpha = primitives.any(|primitive| {
        let colours = primitive.get(&Semantic::Colors(0));
        colours.is_some_and(|it| it.dimensions() == Dimensions::Vec4)
            && primitive.material().alpha_mode() != AlphaMode::Opaque
    });
    let other = [
        (has_colours_and_textures, "vertex colours of materials with textures (their mean applies)"),
        (has_colours_with_alpha, "the alpha of vertex colours"),
        (document.extension_value("KHR_materials_variants").is_some(), "material variants (the default ones apply)"),
    ];
    let other = other.into_iter().filter(|(is_used, _)| *is_used).map(|(_, what)| what);
    let is_tinted = |file: &Material| {
        let surface = file.pbr_metallic_roughness();
        let [r, g, b, _] = surface.base_color_factor();
        is_clear(file) && (r.min(g).min(b) < 0.99 || surface.base_color_texture().is_some())
    };
    let tinted = |sheet: bool| document.materials().any(|file| is_tinted(&file) && is_sheet(&file) == sheet);
    let is_double_sided_light = |file: &Material| file.double_sided() && file.emissive_factor() != [0.0; 3];
    let is_rough_sheet =
        |file: &Material| is_clear(file) && is_sheet(file) && file.pbr_metallic_roughness().roughness_factor() > 0.1;
    let any = |holds: &dyn Fn(&Material) -> bool| document.materials().any(|file| holds(&file));
    let sentences = [
        (
            tinted(false),
            "base colours of clear glass that encloses a volume are ignored; state the colour as attenuation of the \
             volume",
        ),
        (tinted(true), "on closed meshes, base colours of clear glass without a thickness are ignored"),
        (any(&is_double_sided_light), "on open meshes, double-sided lights shine to the front only"),
        (any(&is_rough_sheet), "open sheets of rough glass are smooth"),
    ];
    let sentences = sentences.into_iter().filter(|(holds, _)| *holds).map(|(_, what)| what.to_owned());
    let lists = [
        listed(textures.iter().map(String::as_str)).map(|names| format!("textures are ignored: {names}")),
        listed(extensions.iter().map(String::as_str)).map(|names| format!("material extensions are ignored: {names}")),
        listed(other).map(|names| format!("ignored as well: {names}")),
    ];
    lists.into_iter().flatten().chain(sentences).collect()
}

/// Returns true if light passes through the surface.
fn is_clear(file: &Material) -> bool {
    file.transmission().is_some_and(|it| it.transmission_factor() > 0.0)
}

/// Returns true if the material states no thickness.
fn is_sheet(file: &Material) -> bool {
    file.volume().is_none_or(|volume| volume.thickness_factor() <= 0.0)
}

/// Returns the names of the material's textures that are not read.
fn textures(file: &Material) -> Vec<String> {
    let set = uv_set(file);
    let other = |info: Info<'_>| uv_set_of(&info) != set;
    let surface = file.pbr_metallic_roughness();
    let transmission = file.transmission();
    let volume = file.volume();
    let another = " (another set of coordinates)";
    let other_normals = file.normal_texture().is_some_and(|normals| normal_uv_set_of(&normals) != set);
    let used = [
        (surface.base_color_texture().is_some_and(other), "baseColorTexture", another),
        (surface.metallic_roughness_texture().is_some_and(other), "metallicRoughnessTexture", another),
        (other_normals, "normalTexture", another),
        (file.occlusion_texture().is_some(), "occlusionTexture", ""),
        (file.emissive_texture().is_some_and(other), "emissiveTexture", another),
        (transmission.and_then(|it| it.transmission_texture()).is_some_and(other), "transmissionTexture", another),
        (volume.is_some_and(|it| it.thickness_texture().is_some()), "thicknessTexture", ""),
    ];
    used.into_iter().filter(|(is_used, ..)| *is_used).map(|(_, name, why)| format!("{name}{why}")).collect()
}
