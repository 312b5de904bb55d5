//! Paths of the path tracer in scenes that limit their number of surface events.

use super::tracer::{PathTracer, TracedPath};
use crate::gather::camera::sampler::PixelSampler;
use crate::plan::Tally;
use crate::walk::{DepthLimit, MAX_EVENTS, Sink, TruncatedLight};

impl PathTracer<'_> {
    /// Follows a path through as many surface events as the limit allows, and to the next surface.
    /// Some paths then continue, and contribute only to the estimated bias.
    pub(super) fn follow_to_limit<S: Sink>(
        &self,
        mut path: TracedPath,
        limit: DepthLimit,
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) {
        let last = limit.events();
        for depth in 0..last {
            path.events_left = last - depth;
            if !self.follow(&mut path, depth..depth + 1, sampler, tally, sink) {
                return;
            }
        }
        path.events_left = 0;
        let Some(interaction) = self.arrive(&mut path, sampler, tally, sink) else { return };
        let Some(factor) = limit.sample_truncated_path(&mut sampler.stream) else { return };
        path.events_left = TracedPath::UNLIMITED;
        path.throughput.iter_mut().for_each(|throughput| *throughput *= factor);
        path.initial_throughput.iter_mut().for_each(|throughput| *throughput *= factor);
        let sink = &mut TruncatedLight { sink, factor: 1.0 };
        if self.interact(&mut path, (&interaction, last), sampler, tally, sink) {
            self.follow(&mut path, last + 1..MAX_EVENTS, sampler, tally, sink);
        }
    }
}
