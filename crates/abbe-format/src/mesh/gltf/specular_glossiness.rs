//! Converts the specular-glossiness model of older glTF files to the metallic-roughness model.
//!
//! The conversion finds the metalness for which both models reflect the same diffuse light and the
//! same light at normal incidence (Khronos, KHR_materials_pbrSpecularGlossiness, appendix).

use super::super::material::MeshTexture;
use super::extensions::{SPECULAR_GLOSSINESS, colour, fraction};
use super::texture::GltfPictures;
use ::gltf::Material;
use serde_json::Value;

/// The reflectance of a dielectric at normal incidence.
const DIELECTRIC: f64 = 0.04;

/// A material of the metallic-roughness model.
pub(super) struct ConvertedMaterial {
    /// The base colour and the opacity.
    pub(super) base: [f64; 4],
    /// The picture that multiplies the base colour.
    pub(super) base_texture: Option<MeshTexture>,
    pub(super) metallic: f64,
    pub(super) roughness: f64,
}

/// Converts a material that has the extension. A picture of speculars is replaced by its mean.
pub(super) fn convert(file: &Material, pictures: &mut GltfPictures, set: u32) -> Option<ConvertedMaterial> {
    let extension = file.extension_value(SPECULAR_GLOSSINESS)?;
    let mut specular = colour(extension, "specularFactor").map(|c| c.min(1.0));
    let mut glossiness = fraction(extension, "glossinessFactor", 1.0);
    if let Some(texture) = extension.get("specularGlossinessTexture").and_then(|info| pictures.explicit(info, set)) {
        let picture = &texture.picture;
        let colours = picture.linear_rgb(None);
        let count = colours.len().max(1) as f64;
        specular = std::array::from_fn(|i| specular[i] * colours.iter().map(|c| f64::from(c[i])).sum::<f64>() / count);
        let alphas = picture.linear_channel(3, crate::EncodingFile::Linear);
        glossiness *= alphas.iter().map(|&alpha| f64::from(alpha)).sum::<f64>() / count;
    }
    let explicit = extension.get("diffuseFactor").and_then(Value::as_array).map_or(&[] as &[Value], Vec::as_slice);
    let diffuse: [f64; 4] = std::array::from_fn(|i| explicit.get(i).and_then(Value::as_f64).unwrap_or(1.0));
    let base_texture = extension.get("diffuseTexture").and_then(|info| pictures.explicit(info, set));
    let (base, metallic) = metallic_base([diffuse[0], diffuse[1], diffuse[2]], specular);
    Some(ConvertedMaterial {
        base: [base[0], base[1], base[2], diffuse[3]],
        base_texture,
        metallic,
        roughness: 1.0 - glossiness,
    })
}

/// Returns the base colour and the metalness for a diffuse colour and a specular reflectance.
fn metallic_base(diffuse: [f64; 3], specular: [f64; 3]) -> ([f64; 3], f64) {
    let brightness = |[r, g, b]: [f64; 3]| (0.299 * r * r + 0.587 * g * g + 0.114 * b * b).sqrt();
    let not_specular = 1.0 - specular.into_iter().fold(0.0, f64::max);
    let metallic = metalness(brightness(diffuse), brightness(specular), not_specular);
    let base = std::array::from_fn(|i| {
        let of_diffuse = diffuse[i] * not_specular / ((1.0 - DIELECTRIC) * (1.0 - metallic).max(1e-6));
        let of_specular = (specular[i] - DIELECTRIC * (1.0 - metallic)) / metallic.max(1e-6);
        (of_diffuse + (of_specular - of_diffuse) * metallic * metallic).clamp(0.0, 1.0)
    });
    (base, metallic)
}

/// Solves the conversion's quadratic equation. `not_specular` is 1 − the reflectance's maximum.
fn metalness(diffuse: f64, specular: f64, not_specular: f64) -> f64 {
    if specular < DIELECTRIC {
        return 0.0;
    }
    let b = diffuse * not_specular / (1.0 - DIELECTRIC) + specular - 2.0 * DIELECTRIC;
    let c = DIELECTRIC - specular;
    let root = (b * b - 4.0 * DIELECTRIC * c).max(0.0).sqrt();
    ((root - b) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dielectric keeps its diffuse colour. Without one, it is a metal of the reflected colour.
    #[test]
    fn both_ends_of_the_model_are_exact() {
        let (base, metallic) = metallic_base([0.5, 0.25, 0.1], [DIELECTRIC; 3]);
        assert!(metallic < 1e-9 && (0..3).all(|i| (base[i] - [0.5, 0.25, 0.1][i]).abs() < 1e-9), "{base:?}");
        let gold = [0.9, 0.7, 0.3];
        let (base, metallic) = metallic_base([0.0; 3], gold);
        assert!((metallic - 1.0).abs() < 1e-9 && (0..3).all(|i| (base[i] - gold[i]).abs() < 1e-9), "{base:?}");
    }

    /// Both models reflect the same light at normal incidence, and the same diffuse light.
    #[test]
    fn a_part_of_metal_keeps_both_lights_of_a_grey_surface() {
        let (base, metallic) = metallic_base([0.4; 3], [0.2; 3]);
        let specular = DIELECTRIC * (1.0 - metallic) + base[0] * metallic;
        let diffuse = base[0] * (1.0 - DIELECTRIC) * (1.0 - metallic);
        assert!(metallic > 0.01 && metallic < 0.99, "{metallic}");
        assert!((specular - 0.2).abs() < 0.01 && (diffuse - 0.4 * 0.8).abs() < 0.01, "{specular} {diffuse}");
    }
}
