//! Translates materials of mesh files to materials of the scene.

use super::materials::alpha;
use crate::error::Result;
use crate::format::mesh::MeshMaterial;
use crate::math::elementary::ln;
use crate::optics::bsdf::Bsdf;
use crate::optics::glass::RefractiveIndex;
use crate::scene::{Body, Material};
use crate::spectrum::{BAND_NM, Outside, Spectrum};

/// A surface has no coat if its roughness is at least this value.
const MATT: f64 = 0.95;

/// Resolves a material of a mesh file. If `metallic` is at least 0.5, the material is a metal.
/// Otherwise, if `transmission` is at least 0.5, the material is glass. Any other material is a
/// coated diffuse surface. `metres` is the length of the mesh's unit in m.
pub(super) fn material(file: &MeshMaterial, metres: f64) -> Result<Material> {
    let base = Spectrum::rgb_reflectance(file.base_colour.map(|c| c.clamp(0.0, 1.0)))?;
    let roughness = alpha(file.roughness.clamp(0.0, 1.0));
    let index = match file.abbe_number {
        Some(vd) => RefractiveIndex::abbe(file.ior, vd)?,
        None => RefractiveIndex::constant(file.ior)?,
    };
    let (surface, body) = if file.metallic >= 0.5 {
        (metal(&base, roughness)?, None)
    } else if file.transmission >= 0.5 {
        let absorption = match &file.attenuation {
            None => None,
            Some(attenuation) => Some(absorption(attenuation.colour, attenuation.distance * metres)?),
        };
        (Bsdf::dielectric(roughness)?, Some(Body { index: Some(index), absorption, medium: None, priority: 0 }))
    } else if file.roughness >= MATT {
        (Bsdf::diffuse(base)?, None)
    } else {
        (Bsdf::glossy(base, index, roughness)?, None)
    };
    let name = if file.name.is_empty() { "mesh material".to_string() } else { file.name.clone() };
    Ok(Material { name, surface, body })
}

/// Returns a metal with the reflectance R at normal incidence. The index of refraction is the real
/// number n = (1 + √R)/(1 − √R).
fn metal(reflectance: &Spectrum, roughness: f64) -> Result<Bsdf> {
    let index_of = |r: f64| {
        let root = r.clamp(0.0, 0.999).sqrt();
        (1.0 + root) / (1.0 - root)
    };
    Bsdf::conductor(mapped(reflectance, index_of)?, Spectrum::constant(0.0), roughness)
}

/// Returns an absorption coefficient in 1/m. In a material with this coefficient, white light gets
/// the colour `colour` after the distance `distance_m`.
fn absorption(colour: [f64; 3], distance_m: f64) -> Result<Spectrum> {
    let transmittance = Spectrum::rgb_reflectance(colour.map(|c| c.clamp(0.0, 1.0)))?;
    mapped(&transmittance, |t| -ln(t.max(1e-6)) / distance_m)
}

/// Samples a spectrum every nanometre and applies a function to each sample.
fn mapped(spectrum: &Spectrum, f: impl Fn(f64) -> f64) -> Result<Spectrum> {
    let nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let values: Vec<f64> = nm.iter().map(|&nm| f(spectrum.at(nm)).max(0.0)).collect();
    Ok(Spectrum::table(&nm, &values, Outside::Hold)?.with_origin_of(spectrum))
}
