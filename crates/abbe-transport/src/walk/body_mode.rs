//! The inner loops exist twice: for scenes with bodies (objects with an inside: glass, a liquid,
//! fog), and for scenes that have air on both sides of every surface. Without bodies, paths need no
//! medium stack and keep all their wavelengths, because no glass disperses the light.
//!
//! The loops of photons and of camera paths take a [`BodyMode`] as a type parameter, so that the
//! compiler removes the unused half of the code and no loop can mix the two modes.

use super::next_interaction::{next_interaction, next_interaction_in_air};
use super::ray_state::RayState;
use super::scatter::{scatter, scatter_all_wavelengths};
use super::scattered_ray::ScatteredRay;
use super::surface_interaction::{SurfaceInteraction, SurfaceLookup};
use abbe_optics::bsdf::TransportMode;
use abbe_scene::Scene;
use abbe_scene::medium_stack::MediumStack;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{LANES, Wavelengths};

/// Tells whether the scene has bodies, once for each loop over photons or camera paths.
pub trait BodyMode {
    const HAS_BODIES: bool;

    /// Returns the medium stack at the start of a path. Calls `find` only if the scene has bodies.
    #[inline(always)]
    fn initial_medium_stack(find: impl FnOnce() -> MediumStack) -> MediumStack {
        if Self::HAS_BODIES { find() } else { MediumStack::AIR }
    }

    /// Finds the next visible surface along the ray and ignores media on the way.
    #[inline(always)]
    fn next_interaction<'a>(
        scene: &'a Scene,
        ray_state: RayState,
        lookup: SurfaceLookup,
    ) -> Option<SurfaceInteraction<'a>> {
        if Self::HAS_BODIES {
            next_interaction(scene, ray_state, lookup)
        } else {
            next_interaction_in_air(scene, ray_state, lookup)
        }
    }

    /// Scatters a path. Returns `None` if the surface absorbs the path.
    #[inline(always)]
    fn scatter(
        interaction: &SurfaceInteraction<'_>,
        wavelengths: &Wavelengths,
        transport: TransportMode,
        stream: &mut Stream,
    ) -> Option<ScatteredRay> {
        if Self::HAS_BODIES {
            scatter(interaction, wavelengths, transport, stream)
        } else {
            // The constant count lets the compiler unroll the loops over wavelengths.
            scatter_all_wavelengths(interaction, &Wavelengths::new(wavelengths.nm), transport, stream)
        }
    }

    /// Returns the number of wavelengths that a path carries.
    #[inline(always)]
    fn wavelength_count(wavelengths: &Wavelengths) -> usize {
        if Self::HAS_BODIES { wavelengths.count } else { LANES }
    }

    /// Returns the ray that leaves the surface after scattering.
    #[inline(always)]
    fn spawn_scattered(interaction: &SurfaceInteraction<'_>, scattered: &ScatteredRay) -> RayState {
        if Self::HAS_BODIES {
            interaction.spawn_scattered(scattered)
        } else {
            interaction.spawn_ray(scattered.direction, MediumStack::AIR)
        }
    }
}

#[derive(Debug)]
pub enum WithBodies {}

/// Paths have air on both sides of every surface and keep all wavelengths.
#[derive(Debug)]
pub enum WithoutBodies {}

impl BodyMode for WithBodies {
    const HAS_BODIES: bool = true;
}

impl BodyMode for WithoutBodies {
    const HAS_BODIES: bool = false;
}
