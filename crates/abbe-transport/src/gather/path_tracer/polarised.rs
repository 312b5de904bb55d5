//! Polarised light on paths of the path tracer.

use super::tracer::TracedPath;
use crate::plan::LightOrigin;
use crate::walk::{ScatteredRay, Sink, SurfaceInteraction};
use abbe_optics::bsdf::TransportMode;
use abbe_polarisation::Stokes;

impl TracedPath {
    /// Adds light of a weight in a lane, of which the camera receives `received` for a weight of 1.
    pub(super) fn deliver<S: Sink>(
        &self,
        origin: LightOrigin,
        lane: usize,
        weight: f64,
        received: Option<Stokes>,
        sink: &mut S,
    ) {
        let received = received.unwrap_or(Stokes::unpolarised(1.0));
        sink.radiance(origin, self.observed[lane], weight * received.power().max(0.0));
        self.deliver_stokes(lane, weight, || received, sink);
    }

    /// Adds the Stokes vector of light, `received` for a weight of 1, if the film records it.
    #[inline(always)]
    pub(super) fn deliver_stokes<S: Sink>(
        &self,
        lane: usize,
        weight: f64,
        received: impl FnOnce() -> Stokes,
        sink: &mut S,
    ) {
        if let Some(to_picture) = self.to_picture {
            let Stokes([_, stokes @ ..]) = to_picture * received();
            sink.stokes(self.observed[lane], stokes.map(|part| weight * part));
        }
    }

    /// Corrects the weights of a surface event for polarised light, and adds it to the matrices.
    #[inline(never)]
    pub(super) fn polarise(&mut self, interaction: &SurfaceInteraction<'_>, scattered: &mut ScatteredRay) {
        let event = interaction.event_of(scattered, &self.wavelengths, TransportMode::Radiance);
        self.matrices.precede(&event, &self.wavelengths, &mut scattered.weight);
    }
}
