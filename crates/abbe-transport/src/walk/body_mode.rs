//! The inner loops exist in two versions: one for scenes with bodies, and one for scenes without
//! bodies.
//!
//! A *body* is an object with an inside: glass, a liquid, or a region of fog. A scene without
//! bodies has air on both sides of every surface. In such a scene, paths need no medium stack, and
//! they keep all their wavelengths because no glass disperses the light. The loops of photons and
//! of camera paths take a [`BodyMode`] as a type parameter, so that the compiler removes the unused
//! half of the code. All functions called by one loop carry the same type parameter. Therefore a
//! loop cannot mix the two modes.

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

/// Tells whether the scene has bodies. The decision is made once for each loop over photons or
/// camera paths.
pub trait BodyMode {
    /// True if the scene has bodies.
    const HAS_BODIES: bool;

    /// Returns the medium stack at the start of a path. Calls `find` only if the scene has bodies.
    fn initial_medium_stack(find: impl FnOnce() -> MediumStack) -> MediumStack;

    /// Finds the next visible surface along the ray and ignores media on the way.
    fn next_interaction<'a>(
        scene: &'a Scene,
        ray_state: RayState,
        lookup: SurfaceLookup,
    ) -> Option<SurfaceInteraction<'a>>;

    /// Scatters a path. Returns `None` if the surface absorbs the path.
    fn scatter(
        interaction: &SurfaceInteraction<'_>,
        wavelengths: &Wavelengths,
        transport: TransportMode,
        stream: &mut Stream,
    ) -> Option<ScatteredRay>;

    /// Returns the number of wavelengths that a path carries.
    fn wavelength_count(wavelengths: &Wavelengths) -> usize;

    /// Returns the ray that leaves the surface after scattering.
    fn spawn_scattered(interaction: &SurfaceInteraction<'_>, scattered: &ScatteredRay) -> RayState;
}

/// The scene has bodies.
#[derive(Debug)]
pub enum WithBodies {}

/// The scene has no bodies: air is on both sides of every surface, and paths keep all their
/// wavelengths.
#[derive(Debug)]
pub enum WithoutBodies {}

impl BodyMode for WithBodies {
    const HAS_BODIES: bool = true;

    #[inline(always)]
    fn initial_medium_stack(find: impl FnOnce() -> MediumStack) -> MediumStack {
        find()
    }

    #[inline(always)]
    fn next_interaction<'a>(
        scene: &'a Scene,
        ray_state: RayState,
        lookup: SurfaceLookup,
    ) -> Option<SurfaceInteraction<'a>> {
        next_interaction(scene, ray_state, lookup)
    }

    #[inline(always)]
    fn scatter(
        interaction: &SurfaceInteraction<'_>,
        wavelengths: &Wavelengths,
        transport: TransportMode,
        stream: &mut Stream,
    ) -> Option<ScatteredRay> {
        scatter(interaction, wavelengths, transport, stream)
    }

    #[inline(always)]
    fn wavelength_count(wavelengths: &Wavelengths) -> usize {
        wavelengths.count
    }

    #[inline(always)]
    fn spawn_scattered(interaction: &SurfaceInteraction<'_>, scattered: &ScatteredRay) -> RayState {
        interaction.spawn_scattered(scattered)
    }
}

impl BodyMode for WithoutBodies {
    const HAS_BODIES: bool = false;

    #[inline(always)]
    fn initial_medium_stack(_: impl FnOnce() -> MediumStack) -> MediumStack {
        MediumStack::AIR
    }

    #[inline(always)]
    fn next_interaction<'a>(
        scene: &'a Scene,
        ray_state: RayState,
        lookup: SurfaceLookup,
    ) -> Option<SurfaceInteraction<'a>> {
        next_interaction_in_air(scene, ray_state, lookup)
    }

    #[inline(always)]
    fn scatter(
        interaction: &SurfaceInteraction<'_>,
        wavelengths: &Wavelengths,
        transport: TransportMode,
        stream: &mut Stream,
    ) -> Option<ScatteredRay> {
        // The constant count lets the compiler unroll the loops over wavelengths.
        scatter_all_wavelengths(interaction, &Wavelengths::new(wavelengths.nm), transport, stream)
    }

    #[inline(always)]
    fn wavelength_count(_: &Wavelengths) -> usize {
        LANES
    }

    #[inline(always)]
    fn spawn_scattered(interaction: &SurfaceInteraction<'_>, scattered: &ScatteredRay) -> RayState {
        interaction.spawn_ray(scattered.direction, MediumStack::AIR)
    }
}
