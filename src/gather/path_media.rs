//! The reference path tracer in media: null-collision tracking (Woodcock; Kutz et al. 2017; Miller, Georgiev & Jarosz 2019), which knows densities and
//! bounds and no column.

use super::CameraNumbers;
use super::direct::{AskingInside, Counts};
use super::path_tracer::{Path, PathTracer};
use crate::scene::geometry::Ray;
use crate::scene::medium::Medium;
use crate::spectrum::LANES;
use crate::walk::{Leg, Sink, Start, Stretch, Tally, passes, travel};
use std::ops::ControlFlow;

/// Scatterings in media that a path may have between two surfaces.
const MAX_COLLISIONS: u32 = 10_000;

impl<'a> PathTracer<'a> {
    /// Takes the path through media to the next surface.
    pub(super) fn drift<S: Sink>(
        &self,
        path: &mut Path,
        numbers: &mut CameraNumbers,
        tally: &mut Tally,
        sink: &mut S,
    ) -> Leg<'a> {
        for _ in 0..MAX_COLLISIONS {
            let component = numbers.stream.uniform();
            let mut met = None;
            let leg = travel(self.scene, path.start, component, |stretch| {
                path.see_glow(stretch, numbers, sink);
                met = path.track(stretch, numbers, tally).map(|(t, medium)| (*stretch, t, medium));
                if met.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            let Some((stretch, t, medium)) = met else {
                return leg;
            };
            if !self.scatter_inside(path, (&stretch, t, medium), numbers, (tally, sink)) {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Break(())
    }

    /// Lamps' light at a particle, and the new direction; false where the path ends.
    fn scatter_inside<S: Sink>(
        &self,
        path: &mut Path,
        (stretch, t, medium): (&Stretch<'a>, f64, &'a Medium),
        numbers: &mut CameraNumbers,
        (tally, sink): (&mut Tally, &mut S),
    ) -> bool {
        let incoming = stretch.ray.direction;
        let ray = Ray { origin: stretch.ray.at(t), direction: incoming };
        let start = Start { ray, from: None, interior: stretch.interior };
        let hero = path.wavelengths.hero();
        let mut u = numbers.stream.triple();
        for number in self.direct.asked(&mut u) {
            let asking = AskingInside { start, medium, scattered_nm: Some(hero), u };
            let Some(lit) = self.direct.ask_inside(asking, number, tally) else { continue };
            let cosine = -lit.incoming.dot(incoming);
            for (k, &nm) in path.wavelengths.active().iter().enumerate() {
                let arriving = lit.light.shape_at(lit.tint, nm) * lit.strength * passes(&lit.through, nm);
                sink.radiance(nm, path.throughput[k] * medium.phase.at(cosine, nm) * arriving);
            }
        }
        let direction = medium.phase.sample(incoming, hero, numbers.stream.pair());
        let cosine = incoming.dot(direction);
        let pdf = medium.phase.at(cosine, hero);
        for (k, &nm) in path.wavelengths.active().iter().enumerate() {
            path.throughput[k] *= medium.phase.at(cosine, nm) / pdf;
        }
        path.counts = Counts::Shared { place: ray.origin, pdf };
        path.start = Start { ray: Ray { origin: ray.origin, direction }, ..start };
        path.survives_collision(numbers)
    }
}

impl Path {
    /// Light that a medium emits into the path, at one place of the stretch. (At scattering events that light is looked for like a lamp's.)
    fn see_glow<S: Sink>(&self, stretch: &Stretch<'_>, numbers: &mut CameraNumbers, sink: &mut S) {
        let Some((_, medium)) = stretch.medium.filter(|(_, medium)| medium.emission.is_some()) else { return };
        let Some((from, to)) = medium.window(&stretch.ray, stretch.length_m) else { return };
        if !matches!(self.counts, Counts::Fully) {
            return;
        }
        let t = from + numbers.stream.uniform() * (to - from);
        let place = stretch.ray.at(t);
        let here = stretch.passages_tracked(t, place.x.to_bits());
        for (k, &nm) in self.wavelengths.active().iter().enumerate() {
            let glow = medium.emission_per_m(place, nm) * passes(&here, nm) * (to - from);
            sink.radiance(nm, self.throughput[k] * glow);
        }
    }

    /// Goes along a stretch, from one tentative collision to the next; returns where the path is scattered. Absorption is in the weights.
    fn track<'a>(
        &mut self,
        stretch: &Stretch<'a>,
        numbers: &mut CameraNumbers,
        tally: &mut Tally,
    ) -> Option<(f64, &'a Medium)> {
        let mut scattered = None;
        if let Some((_, medium)) = stretch.medium {
            tally.media_stretches += 1;
            scattered = self.track_medium(medium, stretch, numbers);
        }
        if let Some(absorption) = stretch.absorption {
            let distance = scattered.map_or(stretch.length_m, |(t, _)| t);
            for k in 0..self.wavelengths.count {
                self.throughput[k] *= (-absorption.at(self.wavelengths.nm[k]) * distance).exp();
            }
        }
        scattered
    }

    fn track_medium<'a>(
        &mut self,
        medium: &'a Medium,
        stretch: &Stretch<'a>,
        numbers: &mut CameraNumbers,
    ) -> Option<(f64, &'a Medium)> {
        let (mut t, end) = medium.window(&stretch.ray, stretch.length_m)?;
        let sigma_s = self.wavelengths.each(|nm| medium.scattering.at(nm));
        let sigma_t = self.wavelengths.each(|nm| medium.extinction.at(nm));
        let rate = sigma_t.iter().copied().fold(0.0, f64::max) * medium.majorant(&stretch.ray, stretch.length_m);
        if rate <= 0.0 {
            return None;
        }
        loop {
            t -= (-numbers.stream.uniform()).ln_1p() / rate;
            if t >= end {
                return None;
            }
            let density = medium.density_at(stretch.ray.at(t));
            let (mut scatters, mut either) = (0.0, 0.0);
            for k in 0..LANES {
                let (collision, null) = (sigma_s[k] * density, (rate - sigma_t[k] * density).max(0.0));
                scatters += self.throughput[k] * collision;
                either += self.throughput[k] * (collision + null);
            }
            if either <= 0.0 {
                self.throughput = [0.0; LANES];
                return None;
            }
            let probability = scatters / either;
            if numbers.stream.uniform() < probability {
                (0..LANES).for_each(|k| self.throughput[k] *= sigma_s[k] * density / (rate * probability));
                return Some((t, medium));
            }
            let left = rate * (1.0 - probability);
            (0..LANES).for_each(|k| self.throughput[k] *= (rate - sigma_t[k] * density).max(0.0) / left);
        }
    }

    /// Russian roulette in media: only paths that have lost most of their light are at risk, so that white fog is not dimmed into noise.
    fn survives_collision(&mut self, numbers: &mut CameraNumbers) -> bool {
        const AT_RISK: f64 = 0.2;
        let passed = self.passed();
        if passed >= AT_RISK {
            return true;
        }
        let survival = passed / AT_RISK;
        if numbers.stream.uniform() >= survival {
            return false;
        }
        self.throughput.iter_mut().for_each(|t| *t /= survival);
        true
    }
}
