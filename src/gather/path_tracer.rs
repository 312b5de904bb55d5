//! The reference: a plain spectral path tracer with next-event estimation.
//!
//! It shares with photon mapping the surfaces, lights and geometry, and none of the estimators: no photons, no kernels, no shared
//! wavelengths. Four stratified wavelengths go together until the first dispersive refraction. It cannot find a light
//! without extent through glass; photon mapping can.

use super::CameraNumbers;
use super::direct::{Asking, Counts, Direct};
use super::throughput::relative_n2;
use crate::optics::surface::{Class, Transport};
use crate::plan::BetweenPlan;
use crate::scene::Scene;
use crate::scene::geometry::Hit;
use crate::spectrum::{LANES, Lanes, WavelengthDistribution, Wavelengths};
use crate::walk::{Encounter, Leg, Scattered, Sink, Start, Tally, next, passes, scatter};
use glam::DVec3;
use std::ops::ControlFlow;

/// All that the path tracer needs.
#[derive(Debug)]
pub struct PathTracer<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Who asks which lamps.
    pub direct: Direct<'a>,
    /// Draws a path's wavelengths.
    pub wavelengths: &'a WavelengthDistribution,
    /// Surface events a path may have.
    pub max_depth: u32,
    /// What happens between surfaces.
    pub between: BetweenPlan,
}

/// A path under way.
pub(super) struct Path {
    pub(super) start: Start,
    pub(super) wavelengths: Wavelengths,
    /// What the path lets through per wavelength, divided by all densities.
    pub(super) throughput: Lanes,
    /// What the throughput was at the start, for roulette.
    first: Lanes,
    pub(super) counts: Counts,
}

impl<'a> PathTracer<'a> {
    /// Estimates the radiance of one sample of a pixel and hands it to the sink.
    pub fn sample<S: Sink>(&self, pixel: u64, mut numbers: CameraNumbers, tally: &mut Tally, sink: &mut S) {
        let Some(mut path) = self.start(pixel, &numbers) else {
            return;
        };
        for depth in 0..self.max_depth {
            let encounter = match self.next(&mut path, &mut numbers, tally, sink) {
                ControlFlow::Continue(Some(encounter)) => encounter,
                ControlFlow::Continue(None) => {
                    self.see_lamps(&path, (path.start.ray.direction, None), tally, sink);
                    return;
                }
                ControlFlow::Break(()) => return,
            };
            if encounter.crossed_hidden && !matches!(path.counts, Counts::Fully) {
                // Shadow rays stop at hidden faces: a lamp behind one is counted where the path finds it.
                path.counts = Counts::Fully;
            }
            self.see_lamps(&path, (encounter.incoming, Some(encounter.hit)), tally, sink);
            if matches!(encounter.surface.class(), Class::Diffuse | Class::Glossy) {
                let u = if depth == 0 { numbers.lamp() } else { numbers.stream.triple() };
                self.ask_lamps(&path, &encounter, u, tally, sink);
            }
            let Some(scattered) = scatter(&encounter, &path.wavelengths, Transport::Radiance, &mut numbers.stream)
            else {
                return;
            };
            path.go_on(&encounter, &scattered);
            if !path.survives(self.scene, depth, &mut numbers) {
                return;
            }
        }
    }

    /// How the path comes to the next surface.
    fn next<S: Sink>(&self, path: &mut Path, numbers: &mut CameraNumbers, tally: &mut Tally, sink: &mut S) -> Leg<'a> {
        match self.between {
            BetweenPlan::Air | BetweenPlan::Clear => {
                let component = numbers.stream.uniform();
                ControlFlow::Continue(next(self.scene, path.start, component))
            }
            BetweenPlan::Absorbing | BetweenPlan::Scattering(_) => self.drift(path, numbers, tally, sink),
        }
    }

    /// A path from the camera with four stratified wavelengths, or with one through a lens of real glass; `None` where that lets nothing through.
    fn start(&self, pixel: u64, numbers: &CameraNumbers) -> Option<Path> {
        let camera = &self.scene.camera;
        let (mut nm, mut throughput) = ([0.0; LANES], [0.0; LANES]);
        let (ray, wavelengths) = match camera.system() {
            Some(system) => {
                let (drawn, pdf) = self.wavelengths.sample(numbers.wavelength);
                let (ray, weight) = numbers.ray_through(&system.at(drawn), camera, pixel)?;
                throughput[0] = weight / pdf;
                (ray, Wavelengths::single(drawn))
            }
            None => {
                for k in 0..LANES {
                    let (drawn, pdf) = self.wavelengths.sample((numbers.wavelength + k as f64) / LANES as f64);
                    nm[k] = drawn;
                    throughput[k] = 1.0 / (pdf * LANES as f64);
                }
                (numbers.ray(camera, pixel), Wavelengths::new(nm))
            }
        };
        let start = Start { ray, from: None, interior: camera.interior };
        Some(Path { start, wavelengths, throughput, first: throughput, counts: Counts::Fully })
    }

    /// Lamps found by the path itself: on a surface, or at infinity.
    fn see_lamps<S: Sink>(&self, path: &Path, (direction, hit): (DVec3, Option<Hit>), tally: &mut Tally, sink: &mut S) {
        for &number in self.direct.seen(hit.as_ref()) {
            let Some(lamp) = self.direct.found(number, (direction, hit), path.counts, tally) else { continue };
            for (k, &nm) in path.wavelengths.active().iter().enumerate() {
                sink.radiance(nm, path.throughput[k] * lamp.light.shape_at(lamp.tint, nm) * lamp.radiance);
            }
        }
    }

    fn ask_lamps<S: Sink>(
        &self,
        path: &Path,
        encounter: &Encounter<'a>,
        mut u: [f64; 3],
        tally: &mut Tally,
        sink: &mut S,
    ) {
        for number in self.direct.asked(&mut u) {
            let asking = Asking { encounter, nm: path.wavelengths.hero(), u };
            let Some(lit) = self.direct.ask(asking, number, tally) else { continue };
            let through = self.direct.through::<true>(encounter, (lit.direction, lit.distance), u);
            for (k, &nm) in path.wavelengths.active().iter().enumerate() {
                let f = encounter.surface.eval(encounter.wo, lit.wi, encounter.sides, Transport::Radiance, nm);
                let sent = path.throughput[k] * f * lit.light.shape_at(lit.tint, nm);
                sink.radiance(nm, sent * lit.strength * passes(&through, nm));
            }
        }
    }
}

impl Path {
    fn go_on(&mut self, encounter: &Encounter<'_>, scattered: &Scattered) {
        (0..LANES).for_each(|k| self.throughput[k] *= scattered.weight[k]);
        if let Some(kept) = scattered.kept {
            self.wavelengths = Wavelengths::single(self.wavelengths.nm[kept]);
            let only = |lanes: Lanes| std::array::from_fn(|k| if k == 0 { lanes[kept] } else { 0.0 });
            (self.throughput, self.first) = (only(self.throughput), only(self.first));
        }
        self.counts = if scattered.delta {
            // A lamp behind mirrors or glass is out of reach for shadow rays.
            Counts::Fully
        } else {
            Counts::Shared { place: encounter.hit.position, pdf: scattered.pdf }
        };
        self.start = encounter.after(scattered);
    }

    /// What the path still lets through, relative to its start, in the mean over the wavelengths that it started with.
    pub(super) fn passed(&self) -> f64 {
        let lanes = self.throughput.iter().zip(&self.first).take(self.wavelengths.count);
        lanes.filter(|(_, first)| **first > 0.0).map(|(t, first)| t / first).sum::<f64>() / LANES as f64
    }

    /// Russian roulette by what the path still lets through, relative to its start, in the mean over the wavelengths that it started with.
    /// Radiance changes with n² where it enters and leaves glass; only what it loses beside that counts, or paths would die inside glass and
    /// the survivors come out of it too heavy.
    fn survives(&mut self, scene: &Scene, depth: u32, numbers: &mut CameraNumbers) -> bool {
        const FREE_EVENTS: u32 = 3;
        let passed = self.passed();
        if passed <= 0.0 {
            return false;
        }
        if depth < FREE_EVENTS {
            return true;
        }
        let survival = (passed * relative_n2(scene, &self.start, self.wavelengths.hero())).clamp(0.05, 0.95);
        if numbers.stream.uniform() >= survival {
            return false;
        }
        self.throughput.iter_mut().for_each(|t| *t /= survival);
        true
    }
}
