//! The path tracer in media: null-collision tracking (Woodcock et al. 1965; Kutz, Habel, Li & Novák
//! 2017; Miller, Georgiev & Jarosz 2019, "A Null-Scattering Path Integral Formulation of Light
//! Transport"), which evaluates densities and their bounds, but never column densities.

use super::tracer::{PathTracer, TracedPath};
use crate::gather::camera::sampler::PixelSampler;
use crate::gather::direct::light_tree::ReceivingPoint;
use crate::gather::direct::lighting::{HitWeighting, VolumeLightSampleContext};
use crate::plan::{LightOrigin, Tally};
use crate::walk::{
    MAX_EVENTS, MediumSegment, NumberedMedium, RayState, SegmentEnd, Sink, SurfaceLookup, TruncatedLight,
    crosses_more_panes, next_interaction_through_media, transmittance,
};
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::phase::{Deflection, PhaseFunction, PhaseMixture};
use abbe_polarisation::ScatteringEvent;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::medium::Medium;
use abbe_spectra::math::elementary::{exp, ln_1p};
use abbe_spectra::math::random::Seed;
use abbe_spectra::spectrum::{LANES, WavelengthDistribution};
use std::ops::ControlFlow;

/// The rate of null collisions in media that only absorb, relative to their largest extinction.
const ABSORPTION_RATE: f64 = 4.0;

/// The relative throughput below which paths undergo Russian roulette in media. In white fog, paths
/// keep their throughput, and roulette would only add noise.
const ROULETTE_THROUGHPUT: f64 = 0.2;

impl<'a> PathTracer<'a> {
    pub(super) fn advance_through_media<S: Sink>(
        &self,
        path: &mut TracedPath,
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) -> SegmentEnd<'a> {
        for _ in 0..MAX_EVENTS {
            let lookup = SurfaceLookup::of_line(sampler.stream.uniform());
            let mut collision = None;
            let end = next_interaction_through_media(self.scene, path.ray_state, lookup, |segment| {
                path.add_emission(self.scene, segment, sampler, sink);
                let exciting = segment.medium.and_then(|filling| self.exciting_wavelengths(filling.medium));
                collision = path.sample_segment(segment, exciting, sampler, tally).map(|t| (*segment, t));
                if collision.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            let Some((segment, (t, event))) = collision else { return end };
            if !self.scatter_in_medium(path, &segment, (t, event), sampler, tally, sink) {
                return ControlFlow::Break(());
            }
        }
        tally.capped_paths += 1;
        ControlFlow::Break(())
    }

    /// Returns the dye of a medium, if some light excites it.
    fn exciting_wavelengths<'m>(&self, medium: &'m Medium) -> Option<ExcitableDye<'m>>
    where
        'a: 'm,
    {
        let dye = medium.fluorophore.as_deref()?;
        Some(ExcitableDye { dye, wavelengths: self.excitation[dye.number].as_ref()? })
    }

    /// Adds direct light at a collision, and samples a direction. Returns whether the path
    /// continues.
    fn scatter_in_medium<S: Sink>(
        &self,
        path: &mut TracedPath,
        segment: &MediumSegment<'a>,
        (t, event): (f64, MediumEvent),
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) -> bool {
        let Some(NumberedMedium { medium, .. }) = segment.medium else { return false };
        let phase = match event {
            MediumEvent::Scattering => &medium.phase,
            MediumEvent::Emission => {
                tally.fluorescent_events += 1;
                &PhaseFunction::Isotropic
            }
        };
        let incoming = segment.ray.direction;
        let ray = Ray { origin: segment.ray.at(t), direction: incoming };
        let ray_state = RayState { ray, from: None, medium_stack: segment.medium_stack };
        let mixture = PhaseMixture::new(phase, &path.wavelengths, &path.importance());
        let (from, u) = (ReceivingPoint::in_medium(ray.origin), sampler.stream.triple());
        for selected in self.direct.select_lights(from, u) {
            let point = VolumeLightSampleContext { ray_state, phase: mixture, continues: true };
            let Some(sample) = self.direct.sample_direct_in_medium(point, selected, tally) else { continue };
            let deflection = Deflection::between(sample.incoming, -incoming);
            let origin = LightOrigin { class: path.events.class_in_medium(), light: selected.number };
            let event = self.polarised.then(|| ScatteringEvent::in_medium(phase, sample.incoming, -incoming));
            let arriving = path.wavelengths.active().iter().enumerate().map(|(k, &nm)| {
                let arriving =
                    sample.light.spd_at(sample.spd, nm) * sample.strength * transmittance(&sample.transmittance, nm);
                let along = &sample.transmittance;
                let received = event.as_ref().map(|event| path.matrices.received(k, event, along, nm));
                (k, path.throughput[k] * phase.eval(deflection, nm) * arriving, received)
            });
            if crosses_more_panes(&sample.transmittance, path.events_left) {
                let truncated = &mut TruncatedLight { sink, factor: 1.0 };
                arriving.for_each(|(k, weight, received)| path.deliver(origin, k, weight, received, truncated));
            } else {
                arriving.for_each(|(k, weight, received)| path.deliver(origin, k, weight, received, sink));
            }
        }
        let direction = mixture.sample(incoming, sampler.stream.pair());
        let onwards = Deflection::between(incoming, direction);
        let (of_light, pdf) = (onwards.reversed(), mixture.pdf(onwards));
        for (k, &nm) in path.wavelengths.active().iter().enumerate() {
            path.throughput[k] *= phase.eval(of_light, nm) / pdf;
        }
        if self.polarised {
            let event = ScatteringEvent::in_medium(phase, -direction, -incoming);
            path.matrices.precede(&event, &path.wavelengths, &mut path.throughput);
        }
        path.events = path.events.after_medium();
        path.hit_weighting = HitWeighting::Mis { from, pdf, caustic: None };
        path.ray_state = RayState { ray: Ray { origin: ray.origin, direction }, ..ray_state };
        path.survives_collision(sampler)
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) enum MediumEvent {
    Scattering,
    /// The dye emits into the path, which now carries wavelengths of the exciting light.
    Emission,
}

/// The dye of a medium, and the distribution of the wavelengths that excite it.
#[derive(Clone, Copy)]
struct ExcitableDye<'d> {
    dye: &'d Fluorophore,
    wavelengths: &'d WavelengthDistribution,
}

impl TracedPath {
    /// Adds the light that a medium emits at one random position of the segment. After a scattering
    /// event, next-event estimation counts this light instead.
    fn add_emission<S: Sink>(
        &self,
        scene: &Scene,
        segment: &MediumSegment<'_>,
        sampler: &mut PixelSampler,
        sink: &mut S,
    ) {
        let Some(NumberedMedium { number, medium }) =
            segment.medium.filter(|filling| filling.medium.emission.is_some())
        else {
            return;
        };
        let Some(light) = scene.medium_lights[number] else { return };
        let origin = LightOrigin { class: self.events.class_of_emission(), light };
        let Some((from, to)) = medium.interval(&segment.ray, segment.length_m) else { return };
        if !matches!(self.hit_weighting, HitWeighting::Full) {
            return;
        }
        let t = from + sampler.stream.uniform() * (to - from);
        let position = segment.ray.at(t);
        let along = segment.path_transmittance_tracked(t, Seed::of_numbers(position.to_array()));
        for (k, &nm) in self.wavelengths.active().iter().enumerate() {
            let emitted = medium.emission_per_m(position, nm) * transmittance(&along, nm) * (to - from);
            self.deliver(origin, k, self.throughput[k] * emitted, Some(self.matrices.of_natural_light(k)), sink);
        }
    }

    /// Advances the path along a segment with absorption. Returns the distance in m of an event.
    fn sample_segment(
        &mut self,
        segment: &MediumSegment<'_>,
        dye: Option<ExcitableDye<'_>>,
        sampler: &mut PixelSampler,
        tally: &mut Tally,
    ) -> Option<(f64, MediumEvent)> {
        let mut scattered = None;
        if let Some(NumberedMedium { medium, .. }) = segment.medium {
            tally.medium_segments += 1;
            scattered = self.sample_free_flight((medium, dye), segment, sampler);
        }
        if let Some(absorption) = segment.absorption {
            let distance = scattered.map_or(segment.length_m, |(t, _)| t);
            for k in 0..self.wavelengths.count {
                self.throughput[k] *= exp(-absorption.at(self.wavelengths.nm[k]) * distance);
            }
        }
        scattered
    }

    /// Samples tentative collisions at the rate σ̄: the largest extinction coefficient at the
    /// path's wavelengths, times the upper bound of the density. An event is real with the
    /// probability S/(S + N), for the sums S of the scattering and N of the null coefficients over
    /// all wavelengths, weighted by their importance.
    ///
    /// The emission of a dye into the path is a further event, whose rate, the largest absorption
    /// coefficient of the dye, is added to σ̄.
    fn sample_free_flight(
        &mut self,
        (medium, dye): (&Medium, Option<ExcitableDye<'_>>),
        segment: &MediumSegment<'_>,
        sampler: &mut PixelSampler,
    ) -> Option<(f64, MediumEvent)> {
        let (mut t, end) = medium.interval(&segment.ray, segment.length_m)?;
        let sigma_s = self.wavelengths.each(|nm| medium.scattering.at(nm));
        let sigma_t = self.wavelengths.each(|nm| medium.extinction.at(nm));
        let visible =
            |dye: &ExcitableDye<'_>| self.wavelengths.active().iter().any(|&nm| dye.dye.emitted_power().at(nm) > 0.0);
        let dye = dye.filter(visible);
        let sigma_dye = dye.map_or(0.0, |dye| dye.dye.absorptance_spectrum().max());
        let largest = sigma_t.iter().copied().fold(0.0, f64::max) + sigma_dye;
        // Where nothing scatters, no event ends the path: more null collisions of a smaller weight
        // then replace survival by chance.
        let absorbs_only = sigma_dye == 0.0 && sigma_s.iter().all(|&sigma| sigma == 0.0);
        let bound = if absorbs_only { ABSORPTION_RATE * largest } else { largest };
        let rate = bound * medium.majorant(&segment.ray, segment.length_m);
        if rate <= 0.0 {
            return None;
        }
        loop {
            t -= ln_1p(-sampler.stream.uniform()) / rate;
            if t >= end {
                return None;
            }
            let importance = self.importance();
            let density = medium.density_at(segment.ray.at(t));
            let (mut scatters, mut emits, mut either) = (0.0, 0.0, 0.0);
            for k in 0..LANES {
                let (collision, null) = (sigma_s[k] * density, (rate - sigma_t[k] * density).max(0.0));
                scatters += importance[k] * collision;
                emits += importance[k] * sigma_dye * density;
                either += importance[k] * (collision + sigma_dye * density + null);
            }
            if either <= 0.0 {
                self.throughput = [0.0; LANES];
                return None;
            }
            let [probability, emission] = [scatters / either, emits / either];
            let u = sampler.stream.uniform();
            if u < probability {
                (0..LANES).for_each(|k| self.throughput[k] *= sigma_s[k] * density / (rate * probability));
                return Some((t, MediumEvent::Scattering));
            }
            if let Some(ExcitableDye { dye, wavelengths }) = dye
                && u < probability + emission
            {
                self.excite(dye, wavelengths, density / (rate * emission), sampler);
                return Some((t, MediumEvent::Emission));
            }
            let null_rate = rate * (1.0 - probability - emission);
            (0..LANES).for_each(|k| self.throughput[k] *= (rate - sigma_t[k] * density).max(0.0) / null_rate);
        }
    }

    /// Applies roulette to paths of low relative throughput. Returns false if the path ends.
    fn survives_collision(&mut self, sampler: &mut PixelSampler) -> bool {
        let throughput = self.relative_throughput();
        if throughput >= ROULETTE_THROUGHPUT {
            return true;
        }
        let survival = throughput / ROULETTE_THROUGHPUT;
        if sampler.stream.uniform() >= survival {
            return false;
        }
        self.throughput.iter_mut().for_each(|t| *t /= survival);
        true
    }
}
