//! The reference for photon mapping: a spectral path tracer with next-event estimation.
//!
//! It shares surfaces, lights and geometry with photon mapping, but none of its estimators: no
//! photons, no kernels and no shared wavelengths. A path carries four stratified wavelengths until
//! its first dispersive refraction. Unlike photon mapping, it does not find the light of a light
//! without extent behind glass.

use crate::gather::camera::sampler::PixelSampler;
use crate::gather::camera::throughput::relative_n2;
use crate::gather::direct::light_tree::ReceivingPoint;
use crate::gather::direct::lighting::{DirectLighting, HitWeighting, LightSample, LightSampleContext};
use crate::gather::luminescence::{ExcitingLight, Luminescence};
use crate::map::PhotonSpectra;
use crate::plan::partition::LightPath;
use crate::plan::{CameraEvents, LightOrigin, MediumPlan, Tally};
use crate::walk::{
    DepthLimit, MAX_EVENTS, PathMatrices, PathTransmittance, RayState, ScatteredRay, SegmentEnd, Sink, StopFlag,
    SurfaceInteraction, SurfaceLookup, TruncatedLight, WithBodies, crosses_more_panes, event_at_camera_filter,
    light_between_panes, long_path_survival, next_interaction, rotation_to_picture, scatter, transmittance,
};
use abbe_optics::bsdf::{BsdfClass, Fluorescent, ScatterEvent, TransportMode};
use abbe_optics::fluorophore::Fluorophore;
use abbe_polarisation::Rotation;
use abbe_scene::Scene;
use abbe_scene::camera::SystemLens;
use abbe_scene::geometry::{Hit, Ray};
use abbe_spectra::spectrum::{LANES, Lanes, WavelengthDistribution, Wavelengths};
use glam::DVec3;
use std::ops::{ControlFlow, Range};

/// The number of surface events after which Russian roulette may end a path of the path tracer.
const TRACER_DEPTH_BEFORE_ROULETTE: u32 = 3;

/// The least survival probability of Russian roulette.
const LEAST_SURVIVAL: f64 = 0.05;

#[derive(Debug)]
pub struct PathTracer<'a> {
    pub scene: &'a Scene,
    pub direct: DirectLighting<'a>,
    pub wavelengths: &'a WavelengthDistribution,
    pub spectra: &'a PhotonSpectra,
    /// The wavelengths that excite each fluorophore in the light of all lights and fluorophores.
    pub excitation: &'a [Option<WavelengthDistribution>],
    /// The media of the scene. Paths need a medium stack if the scene contains bodies or media.
    pub media_plan: MediumPlan,
    /// True if paths carry the polarisation of light.
    pub polarised: bool,
    /// True if the film records Stokes vectors.
    pub stokes: bool,
    /// Samples are black after it is raised.
    pub stop: &'a StopFlag,
}

pub(super) struct TracedPath {
    pub(super) ray_state: RayState,
    pub(super) wavelengths: Wavelengths,
    /// The wavelengths (nm) at which the camera sees each lane. They differ from `wavelengths`
    /// behind a fluorescent surface.
    pub(super) observed: Lanes,
    /// The throughput at each wavelength, divided by all sampling densities.
    pub(super) throughput: Lanes,
    /// What lies between the path and the camera does to polarised light.
    pub(super) matrices: PathMatrices,
    /// From the canonical frame at the camera to that of the picture, if the film records Stokes
    /// vectors.
    pub(super) to_picture: Option<Rotation>,
    /// The throughput at the start of the path, for Russian roulette.
    pub(super) initial_throughput: Lanes,
    /// The number of wavelengths at the start of the path.
    pub(super) initial_count: usize,
    pub(super) hit_weighting: HitWeighting,
    /// The events that decide the class of the path's light.
    pub(super) events: CameraEvents,
    /// The number of surface events before the limit of the scene, at the start of the segment.
    pub(super) events_left: u32,
}

impl<'a> PathTracer<'a> {
    /// Estimates the radiance of one sample of a pixel and adds it to the sink.
    pub fn sample<S: Sink>(&self, pixel: u64, mut sampler: PixelSampler, tally: &mut Tally, sink: &mut S) {
        if self.stop.is_raised() {
            return;
        }
        tally.camera_samples += 1;
        let started = match self.scene.camera.sensor(pixel) {
            Some((_, sensor)) => Some(self.start_at_sensor(sensor, &sampler, tally, sink)),
            None => self.start_path(pixel, &sampler, None, tally),
        };
        if let Some(path) = started {
            self.follow_to_end(path, &mut sampler, tally, sink);
        }
        if self.scene.camera.system().is_some_and(SystemLens::has_ghosts) {
            let choice = sampler.stream.uniform();
            if let Some(path) = self.start_path(pixel, &sampler, Some(choice), tally) {
                self.follow_to_end(path, &mut sampler, tally, sink);
            }
        }
    }

    #[inline(never)]
    fn follow_to_end<S: Sink>(
        &self,
        mut path: TracedPath,
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) {
        let limit = DepthLimit::of(self.scene);
        if limit.is_explicit() {
            self.follow_to_limit(path, limit, sampler, tally, sink);
        } else if self.follow(&mut path, 0..MAX_EVENTS, sampler, tally, sink) {
            tally.capped_paths += 1;
        }
    }

    /// Follows a path through these surface events, from 0. Returns true if it survives.
    pub(super) fn follow<S: Sink>(
        &self,
        path: &mut TracedPath,
        events: Range<u32>,
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) -> bool {
        for depth in events {
            let Some(interaction) = self.arrive(path, sampler, tally, sink) else { return false };
            if !self.interact(path, (&interaction, depth), sampler, tally, sink) {
                return false;
            }
        }
        true
    }

    /// Advances a path to the next surface, and adds the lights at the end of the segment.
    #[inline(always)]
    pub(super) fn arrive<S: Sink>(
        &self,
        path: &mut TracedPath,
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) -> Option<SurfaceInteraction<'a>> {
        let interaction = match self.advance(path, sampler, tally, sink) {
            ControlFlow::Continue(Some(interaction)) => interaction,
            ControlFlow::Continue(None) => {
                self.add_emitters_hit(path, path.ray_state.ray.direction, None, tally, sink);
                return None;
            }
            ControlFlow::Break(()) => return None,
        };
        if interaction.crossed_hidden_face && !matches!(path.hit_weighting, HitWeighting::Full) {
            // Shadow rays stop at hidden faces, so only the path counts lights behind them.
            path.hit_weighting = HitWeighting::Full;
            path.events = path.events.after_specular_event();
        }
        self.add_emitters_hit(path, interaction.incoming, Some(interaction.hit), tally, sink);
        Some(interaction)
    }

    /// Adds direct light at surface event number `depth`, from 0, and scatters the path there.
    /// Returns true if it survives.
    #[inline(always)]
    pub(super) fn interact<S: Sink>(
        &self,
        path: &mut TracedPath,
        (interaction, depth): (&SurfaceInteraction<'a>, u32),
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) -> bool {
        if matches!(interaction.bsdf.class(), BsdfClass::Diffuse | BsdfClass::Glossy) {
            // A path from a sensor has used these numbers at the sensor.
            let first = depth == 0 && path.events == CameraEvents::Specular;
            let u = if first { sampler.light() } else { sampler.stream.triple() };
            let fluorescent = interaction.bsdf.model.as_fluorescent();
            let excitation_u = fluorescent.map_or(0.0, |_| sampler.stream.uniform());
            self.sample_lights(path, interaction, (u, excitation_u), tally, sink);
        }
        let stream = &mut sampler.stream;
        let polarised =
            self.polarised.then(|| path.matrices.scatter_at_smooth_surface(interaction, &path.wavelengths, stream));
        let scattered = polarised
            .flatten()
            .unwrap_or_else(|| scatter(interaction, &path.wavelengths, TransportMode::Radiance, stream));
        let Some(mut scattered) = scattered else { return false };
        if let Some(surface) = interaction.bsdf.model.as_fluorescent() {
            tally.fluorescent_events += 1;
            let excitation = self.excitation[surface.fluorophore.number].as_ref();
            path.select_emission(surface, excitation, &mut scattered, depth, sampler);
        }
        let through_pane = self.direct.passes_panes()
            && scattered.event == ScatterEvent::Transmission
            && interaction.bsdf.model.uniform_pane().is_some();
        if self.polarised {
            path.polarise(interaction, &mut scattered);
        }
        path.apply_scattering(interaction, &scattered, through_pane);
        path.survives(self.scene, depth, sampler)
    }

    fn advance<S: Sink>(
        &self,
        path: &mut TracedPath,
        sampler: &mut PixelSampler,
        tally: &mut Tally,
        sink: &mut S,
    ) -> SegmentEnd<'a> {
        match self.media_plan {
            MediumPlan::Air | MediumPlan::Clear => {
                let lookup = SurfaceLookup::of_line(sampler.stream.uniform());
                ControlFlow::Continue(next_interaction(self.scene, path.ray_state, lookup))
            }
            MediumPlan::Absorbing | MediumPlan::Scattering(_) => self.advance_through_media(path, sampler, tally, sink),
        }
    }

    /// Starts a path at the camera with four stratified wavelengths, or one for a lens system, or
    /// returns `None` if the lens stops the ray. `ghost` in [0, 1) selects a ghost of the lens;
    /// `None` is the image.
    fn start_path(
        &self,
        pixel: u64,
        sampler: &PixelSampler,
        ghost: Option<f64>,
        tally: &mut Tally,
    ) -> Option<TracedPath> {
        let camera = &self.scene.camera;
        let (ray, wavelengths, throughput) = match camera.system() {
            Some(system) => {
                let (sampled, pdf) = self.wavelengths.sample(sampler.wavelength);
                let (ray, weight) = sampler.ray_through_lens(&system.at(sampled), camera, pixel, ghost)?;
                tally.ghost_rays += u64::from(ghost.is_some());
                tally.film_events += u64::from(system.is_coated());
                (ray, Wavelengths::single(sampled), std::array::from_fn(|k| if k == 0 { weight / pdf } else { 0.0 }))
            }
            None => {
                let (nm, throughput) = self.stratified_wavelengths(sampler);
                (sampler.ray(camera, pixel), Wavelengths::new(nm), throughput)
            }
        };
        let mut path = TracedPath {
            ray_state: RayState { ray, from: None, medium_stack: self.scene.medium_stack_of_camera(ray) },
            initial_count: wavelengths.count,
            observed: wavelengths.nm,
            wavelengths,
            throughput,
            matrices: PathMatrices::IDENTITY,
            to_picture: self.stokes.then(|| rotation_to_picture(camera, -ray.direction)),
            initial_throughput: throughput,
            hit_weighting: HitWeighting::Full,
            events: CameraEvents::Specular,
            events_left: TracedPath::UNLIMITED,
        };
        if self.polarised
            && let Some(filter) = event_at_camera_filter(camera, -ray.direction)
        {
            path.matrices.precede(&filter, &path.wavelengths, &mut path.throughput);
            path.initial_throughput = path.throughput;
        }
        Some(path)
    }

    /// Samples four stratified wavelengths (nm). Returns them, and the inverses of their densities.
    pub(super) fn stratified_wavelengths(&self, sampler: &PixelSampler) -> (Lanes, Lanes) {
        let (mut nm, mut throughput) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let (sampled, pdf) = self.wavelengths.sample((sampler.wavelength + k as f64) / LANES as f64);
            nm[k] = sampled;
            throughput[k] = 1.0 / (pdf * LANES as f64);
        }
        (nm, throughput)
    }

    /// Adds the radiance of the lights on the surface or at infinity at the end of a segment.
    fn add_emitters_hit<S: Sink>(
        &self,
        path: &TracedPath,
        direction: DVec3,
        hit: Option<Hit>,
        tally: &mut Tally,
        sink: &mut S,
    ) {
        for &number in self.direct.emitters_hit(hit.as_ref()) {
            let ray = Ray { origin: path.ray_state.ray.origin, direction };
            let emitted = self.direct.emitted_by_hit(number, ray, hit, path.hit_weighting, tally);
            let Some(emitter) = emitted else { continue };
            let origin = LightOrigin { class: path.events.class_of_emission(), light: number };
            for (k, &nm) in path.wavelengths.active().iter().enumerate() {
                let radiance = path.throughput[k] * emitter.light.spd_at(emitter.spd, nm) * emitter.radiance;
                sink.radiance(origin, path.observed[k], radiance);
                path.deliver_stokes(k, radiance, || path.matrices.of_natural_light(k), sink);
            }
        }
    }

    /// Adds direct light at a surface by shadow rays. `excitation_u` in [0, 1) selects the
    /// wavelengths that excite a fluorescent surface.
    fn sample_lights<S: Sink>(
        &self,
        path: &TracedPath,
        interaction: &SurfaceInteraction<'a>,
        (u, excitation_u): ([f64; 3], f64),
        tally: &mut Tally,
        sink: &mut S,
    ) {
        for selected in self.direct.select_lights(ReceivingPoint::on_surface(interaction), u) {
            let point = LightSampleContext { interaction, nm: path.wavelengths.hero() };
            let Some(sample) = self.direct.sample_direct(point, selected, tally) else { continue };
            let (towards, distance_m) = ((sample.direction, sample.line), sample.distance_m);
            let along = self.direct.transmittance_from::<WithBodies>(interaction, towards, distance_m, selected.u);
            if crosses_more_panes(&along, path.events_left.saturating_sub(1)) {
                let truncated = &mut TruncatedLight { sink, factor: 1.0 };
                self.add_light_sample(path, interaction, (&sample, selected.number, &along), excitation_u, truncated);
            } else {
                self.add_light_sample(path, interaction, (&sample, selected.number, &along), excitation_u, sink);
            }
        }
    }

    /// Adds the direct light of one shadow ray to a surface.
    #[inline(always)]
    fn add_light_sample<S: Sink>(
        &self,
        path: &TracedPath,
        interaction: &SurfaceInteraction<'a>,
        (sample, number, along): (&LightSample<'a>, usize, &PathTransmittance<'a>),
        excitation_u: f64,
        sink: &mut S,
    ) {
        let SurfaceInteraction { bsdf, wo, sides, .. } = *interaction;
        let origin = LightOrigin { class: path.events.class_at_surface(LightPath::Direct), light: number };
        let event = self.polarised.then(|| interaction.event_of_camera(sample.direction, false));
        for (k, &nm) in path.wavelengths.active().iter().enumerate() {
            let f = bsdf.eval(wo, sample.wi, sides, TransportMode::Radiance, nm);
            let scattered = path.throughput[k] * f * sample.light.spd_at(sample.spd, nm);
            let weight = scattered * sample.strength * transmittance(along, nm);
            let received = event.as_ref().map(|event| path.matrices.received(k, event, along, nm));
            let radiance = weight * received.map_or(1.0, |received| received.power().max(0.0));
            path.deliver_stokes(k, weight, || received.unwrap_or_default(), sink);
            sink.biased(origin, path.observed[k], radiance, -radiance * light_between_panes(along, nm));
        }
        if let Some(surface) = bsdf.model.as_fluorescent()
            && bsdf.pdf(wo, sample.wi, sides, path.wavelengths.hero()) > 0.0
        {
            let exciting = ExcitingLight::of_sample(number, sample, along);
            let luminescence = Luminescence::of_surface(surface, &path.wavelengths, &path.throughput);
            let radiance = luminescence.excited_radiance(&exciting, self.spectra, excitation_u);
            luminescence.observed_at(&path.observed).add(origin, &radiance, (1.0, 0.0), sink);
        }
    }
}

impl TracedPath {
    /// The value of `events_left` without an explicit limit, and beyond it.
    pub(super) const UNLIMITED: u32 = u32::MAX;

    /// Applies a scattering event, or none at a pane that shadow rays pass too.
    fn apply_scattering(&mut self, interaction: &SurfaceInteraction<'_>, scattered: &ScatteredRay, through_pane: bool) {
        (0..LANES).for_each(|k| self.throughput[k] *= scattered.weight[k]);
        if let Some(kept) = scattered.kept {
            self.wavelengths = Wavelengths::single(self.wavelengths.nm[kept]);
            let only = |lanes: Lanes| std::array::from_fn(|k| if k == 0 { lanes[kept] } else { 0.0 });
            (self.throughput, self.initial_throughput) = (only(self.throughput), only(self.initial_throughput));
            self.observed = only(self.observed);
            self.matrices.keep_lane(kept);
        }
        self.ray_state = interaction.spawn_scattered(scattered);
        if through_pane {
            return;
        }
        self.events = if scattered.delta { self.events.after_specular_event() } else { self.events.after_surface() };
        self.hit_weighting = if scattered.delta {
            // Shadow rays cannot sample a light behind mirrors or glass.
            HitWeighting::Full
        } else {
            HitWeighting::Mis { from: ReceivingPoint::on_surface(interaction), pdf: scattered.pdf, caustic: None }
        };
    }

    /// Selects at random whether the path continues as reflected light or as light that excites the
    /// fluorophore of a surface, at wavelengths of its own. `depth` is the number of the surface
    /// event.
    fn select_emission(
        &mut self,
        surface: &Fluorescent,
        excitation: Option<&WavelengthDistribution>,
        scattered: &mut ScatteredRay,
        depth: u32,
        sampler: &mut PixelSampler,
    ) {
        /// The limits of the probability that the path continues as exciting light.
        const EXCITATION: (f64, f64) = (0.1, 0.9);
        let active = || self.wavelengths.active().iter();
        let emits = active().any(|&nm| surface.fluorophore.emitted_power().at(nm) > 0.0);
        let Some(excitation) = excitation.filter(|_| emits) else { return };
        // Both outcomes matter alike at the first events. Later, the weight of a reflection must be
        // at most about 1, so that it does not grow along the path.
        let reflected = active().map(|&nm| surface.reflected_fraction(nm)).fold(0.0, f64::max);
        let alike = 0.5 / f64::from(depth + 1);
        let probability = (1.0 - reflected).max(alike).clamp(EXCITATION.0, EXCITATION.1);
        if sampler.stream.uniform() >= probability {
            scattered.weight.iter_mut().for_each(|weight| *weight /= 1.0 - probability);
            return;
        }
        scattered.weight = [1.0; LANES];
        self.excite(&surface.fluorophore, excitation, 1.0 / probability, sampler);
    }

    /// Continues the path as light that excites a fluorophore, at wavelengths from the distribution
    /// `excitation`, with the throughput times `factor`.
    pub(super) fn excite(
        &mut self,
        fluorophore: &Fluorophore,
        excitation: &WavelengthDistribution,
        factor: f64,
        sampler: &mut PixelSampler,
    ) {
        let u = sampler.stream.uniform();
        for k in 0..self.wavelengths.count {
            let lane_u = u + k as f64 / LANES as f64;
            let (nm, pdf) = excitation.sample(lane_u - lane_u.floor());
            self.throughput[k] *= fluorophore.bispectral_factor(nm, self.wavelengths.nm[k]) * factor / pdf;
            self.initial_throughput[k] = 1.0 / (pdf * self.initial_count as f64);
            self.wavelengths.nm[k] = nm;
        }
    }

    /// Returns the throughput at each wavelength, relative to the start of the path, where it is
    /// the inverse of the sampling density, which follows the spectra of the lights. The ratio
    /// therefore measures the light that a wavelength can still contribute, but the throughput does
    /// not: it is small at a spectral line, which contains most of the light.
    pub(super) fn importance(&self) -> Lanes {
        let ratio = |k: usize| match self.initial_throughput[k] {
            initial if initial > 0.0 => self.throughput[k] / initial,
            _ => 0.0,
        };
        std::array::from_fn(ratio)
    }

    /// Returns the sum of these ratios, divided by the wavelengths at the start of the path.
    pub(super) fn relative_throughput(&self) -> f64 {
        let lanes = self.throughput.iter().zip(&self.initial_throughput).take(self.wavelengths.count);
        let sum: f64 = lanes.filter(|(_, initial)| **initial > 0.0).map(|(t, initial)| t / initial).sum();
        sum / self.initial_count as f64
    }

    /// Applies Russian roulette with the relative throughput as the survival probability, smaller
    /// on long paths, so that the throughput of a surviving path does not grow. Returns false if
    /// the path ends.
    ///
    /// The throughput is divided by n² where a path enters glass, and multiplied by n² where it
    /// leaves. The survival probability excludes this factor: otherwise, too many paths would end
    /// inside glass, and the surviving ones would leave it with too large a weight.
    fn survives(&mut self, scene: &Scene, depth: u32, sampler: &mut PixelSampler) -> bool {
        let throughput = self.relative_throughput();
        if throughput <= 0.0 {
            return false;
        }
        if depth < TRACER_DEPTH_BEFORE_ROULETTE {
            return true;
        }
        let relative = throughput * relative_n2(scene, &self.ray_state, self.wavelengths.hero());
        let survival = relative.clamp(LEAST_SURVIVAL, 1.0) * long_path_survival(depth);
        if sampler.stream.uniform() >= survival {
            return false;
        }
        self.throughput.iter_mut().for_each(|t| *t /= survival);
        true
    }
}
