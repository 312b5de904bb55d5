//! The result of scattering, and what all kinds of scattering share.

use super::ray_state::RayState;
use super::surface_interaction::SurfaceInteraction;
use abbe_optics::bsdf::{ScatterEvent, TransportMode};
use abbe_polarisation::crystal::CrystalMode;
use abbe_spectra::spectrum::{LANES, Lanes};
use glam::DVec3;

#[derive(Debug, Clone, Copy)]
pub struct ScatteredRay {
    pub direction: DVec3,
    /// The factor of the power or radiance of each wavelength, 0 if the path no longer carries it.
    pub weight: Lanes,
    /// For each wavelength, the fraction of the power that the surface absorbs.
    pub absorbed: Lanes,
    /// The lane of the only remaining wavelength, if the event was dispersive.
    pub kept: Option<usize>,
    /// True if the BSDF is a delta distribution in this direction.
    pub delta: bool,
    /// The density (1/sr) of the direction at the hero wavelength, 0 for a delta distribution.
    pub pdf: f64,
    pub event: ScatterEvent,
    /// The wave in which the path continues inside a crystal. `None` everywhere else.
    pub wave: Option<CrystalMode>,
}

impl ScatteredRay {
    /// Creates an event of a delta distribution that absorbs nothing and keeps all wavelengths.
    pub(crate) fn specular(direction: DVec3, weight: Lanes, event: ScatterEvent) -> Self {
        Self { direction, weight, absorbed: [0.0; LANES], kept: None, delta: true, pdf: 0.0, event, wave: None }
    }
}

impl SurfaceInteraction<'_> {
    #[inline]
    pub fn spawn_scattered(&self, scattered: &ScatteredRay) -> RayState {
        let stack = self.medium_stack_after(scattered.event);
        let stack = match scattered.wave {
            None => stack,
            Some(wave) => stack.with_wave(self.hit.object, wave == CrystalMode::Extraordinary),
        };
        self.spawn_ray(scattered.direction, stack)
    }
}

/// Returns the factor by which refraction scales the transported quantity.
#[inline]
pub(super) fn transmitted_scale(transport: TransportMode, n_here: f64, n_there: f64) -> f64 {
    match transport {
        TransportMode::Radiance => (n_here / n_there) * (n_here / n_there),
        TransportMode::Importance => 1.0,
    }
}

#[inline]
pub(crate) fn single_lane(lane: usize, value: f64) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes[lane] = value;
    lanes
}
