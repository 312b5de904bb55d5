//! Materials that a mesh file brings along.

use super::materials::alpha;
use crate::error::Result;
use crate::optics::glass::Index;
use crate::optics::surface::Surface;
use crate::scene::mesh::MeshMaterial;
use crate::scene::{Body, Material};
use crate::spectrum::{BAND_NM, Outside, Spectrum};

/// Roughness from which a coat no longer shows.
const MATT: f64 = 0.95;

/// The material that a mesh file describes: metal, glass, or a coated diffuse surface, whichever has the largest share.
/// `metres` are those in a unit of the mesh.
pub(super) fn material(file: &MeshMaterial, metres: f64) -> Result<Material> {
    let base = Spectrum::rgb_reflectance(file.base_colour.map(|c| c.clamp(0.0, 1.0)))?;
    let roughness = alpha(file.roughness.clamp(0.0, 1.0));
    let index = match file.abbe_number {
        Some(vd) => Index::abbe(file.ior, vd)?,
        None => Index::constant(file.ior)?,
    };
    let (surface, body) = if file.metallic >= 0.5 {
        (metal(&base, roughness)?, None)
    } else if file.transmission >= 0.5 {
        let absorption = match &file.attenuation {
            None => None,
            Some(attenuation) => Some(absorption(attenuation.colour, attenuation.distance * metres)?),
        };
        (Surface::dielectric(roughness)?, Some(Body { index: Some(index), absorption, medium: None, priority: 0 }))
    } else if file.roughness >= MATT {
        (Surface::diffuse(base)?, None)
    } else {
        (Surface::glossy(base, index, roughness)?, None)
    };
    let name = if file.name.is_empty() { "mesh material".to_string() } else { file.name.clone() };
    Ok(Material { name, surface, body })
}

/// A metal of this reflectance R at normal incidence: the real index n = (1 + √R)/(1 − √R) has it.
fn metal(reflectance: &Spectrum, roughness: f64) -> Result<Surface> {
    let index_of = |r: f64| {
        let root = r.clamp(0.0, 0.999).sqrt();
        (1.0 + root) / (1.0 - root)
    };
    Surface::conductor(mapped(reflectance, index_of)?, Spectrum::constant(0.0), roughness)
}

/// The absorption coefficient (1/m) that leaves white light this colour after `distance_m`.
fn absorption(colour: [f64; 3], distance_m: f64) -> Result<Spectrum> {
    let transmittance = Spectrum::rgb_reflectance(colour.map(|c| c.clamp(0.0, 1.0)))?;
    mapped(&transmittance, |t| -t.max(1e-6).ln() / distance_m)
}

/// A function of a spectrum, on a 1 nm grid.
fn mapped(spectrum: &Spectrum, f: impl Fn(f64) -> f64) -> Result<Spectrum> {
    let nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let values: Vec<f64> = nm.iter().map(|&nm| f(spectrum.at(nm)).max(0.0)).collect();
    Ok(Spectrum::table(&nm, &values, Outside::Hold)?.with_origin_of(spectrum))
}
