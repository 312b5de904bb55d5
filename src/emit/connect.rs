//! Connection of photons to the camera (light tracing). A connection needs no kernel and has no
//! bias.

use super::visitor::SurfaceArrival;
use crate::math::random::hash64;
use crate::optics::bsdf::{BsdfClass, TransportMode};
use crate::plan::MediumPlan;
use crate::scene::Scene;
use crate::spectrum::{LANES, Lanes, REFERENCE_NM};
use crate::walk::{CausticWeights, RayDensity, path_transmittance, transmittance};

/// The contribution of a connected photon to one pixel.
#[derive(Debug, Clone, Copy)]
pub struct Splat {
    /// The pixel.
    pub pixel: u32,
    /// The radiance at each wavelength of the photon, in W/m²/sr. This radiance is already divided
    /// by all probability densities.
    pub radiance: Lanes,
}

/// Connects photons to the camera.
#[derive(Debug, Clone, Copy)]
pub struct CameraConnection<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The plan for bodies and media.
    pub media_plan: MediumPlan,
    /// The number of photon paths in the photon's set.
    pub photons_per_sample: f64,
}

impl CameraConnection<'_> {
    /// Connects a photon at a surface to the camera. `lens` in [0, 1)² selects the point of the
    /// aperture. Returns `None` if the camera does not see the photon.
    pub fn connect(&self, arrival: &SurfaceArrival<'_>, lens: [f64; 2]) -> Option<Splat> {
        let Self { scene, media_plan, photons_per_sample } = *self;
        let SurfaceArrival { interaction, photon, .. } = arrival;
        let sighting = scene.camera.connect(interaction.hit.position, lens)?;
        let to_camera = interaction.frame.to_local(sighting.direction);
        let to_light = interaction.wo;
        let sides = interaction.sides_towards(sighting.direction);
        let geometry = to_camera.z.abs()
            * interaction.adjoint_correction(arrival.to_light(), sighting.direction)
            * sighting.importance;
        let geometry = if photon.ray_density == RayDensity::NONE || interaction.bsdf.class() != BsdfClass::Glossy {
            geometry
        } else {
            let pixel_m = scene.camera.pixel_angle() * sighting.distance;
            let weights = CausticWeights { photons_m2: photons_per_sample * pixel_m * pixel_m };
            let pdf = interaction.bsdf.pdf(to_camera, to_light, sides, REFERENCE_NM);
            geometry * weights.of_photon(photon.ray_density, pdf)
        };
        let mut radiance = [0.0; LANES];
        let mut any = false;
        for (k, &nm) in photon.wavelengths.active().iter().enumerate() {
            let f = interaction.bsdf.eval(to_camera, to_light, sides, TransportMode::Radiance, nm);
            radiance[k] = f * photon.power[k] * geometry;
            any |= radiance[k] > 0.0;
        }
        if !(any && interaction.is_unoccluded(scene, sighting.direction, sighting.distance, None)) {
            return None;
        }
        if !media_plan.is_clear() {
            let medium_stack = interaction.medium_stack_towards(sighting.direction);
            let ray_state = interaction.spawn_ray(sighting.direction, medium_stack);
            let seed = hash64([u64::from(sighting.pixel), lens[0].to_bits()]);
            let along = path_transmittance(scene, ray_state, sighting.distance, seed);
            let active = photon.wavelengths.active().iter().zip(&mut radiance);
            active.for_each(|(&nm, radiance)| *radiance *= transmittance(&along, nm));
        }
        Some(Splat { pixel: sighting.pixel, radiance })
    }
}
