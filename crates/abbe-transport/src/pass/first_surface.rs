//! The first surfaces on camera rays, for the layers of a picture.

use crate::gather::PixelSampler;
use crate::sensor::first_surface::{ALBEDO_NM, FirstSurface};
use crate::walk::{SurfaceInteraction, SurfaceLookup, next_interaction};
use abbe_scene::Scene;
use abbe_spectra::spectrum::REFERENCE_NM;

/// Finds the first surface on the camera ray of a sample: the ray of the camera path with the same
/// random numbers or, for a lens system, that at the reference wavelength.
pub(super) fn first_surface(scene: &Scene, pixel: u64, mut sampler: PixelSampler) -> Option<FirstSurface> {
    let (ray_state, _) = sampler.ray_at(scene, pixel, REFERENCE_NM)?;
    let lookup = SurfaceLookup::of_camera(&scene.camera, 0.0, sampler.stream.uniform());
    let interaction = next_interaction(scene, ray_state, lookup)?;
    let normal = interaction.frame.normal();
    let facing = if interaction.leads_back(normal) { normal } else { -normal };
    Some(FirstSurface {
        albedo: albedo(&interaction, sampler.stream.triple()),
        normal: facing.to_array(),
        depth_m: interaction.distance_m,
        uv: scene.geometry.uv(&interaction.hit),
        object: interaction.hit.object as usize,
        material: interaction.material,
    })
}

/// Returns the fraction of light that a surface reflects or transmits, at the wavelengths of the
/// albedo. At rough metals, only its mean over `u` is the albedo.
fn albedo(interaction: &SurfaceInteraction<'_>, u: [f64; 3]) -> [f64; ALBEDO_NM.len()] {
    let SurfaceInteraction { bsdf, wo, sides, .. } = *interaction;
    match bsdf.sample(wo, sides, REFERENCE_NM, u) {
        Some(sample) => ALBEDO_NM.map(|nm| 1.0 - bsdf.absorbed_fraction(wo, &sample, sides, nm)),
        None => [0.0; ALBEDO_NM.len()],
    }
}
