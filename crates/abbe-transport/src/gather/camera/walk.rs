//! The camera walk: follows a camera path over mirrors, glass and glossy surfaces to the first
//! diffuse surface, and gathers light along the way. With a final gather, the path goes on to the
//! next such surface.
//!
//! The loop is compiled twice (see [`BodyMode`]). The code that every path runs is inlined, so that
//! the path and the interaction stay in registers; rare code (for mirrors and visible lights)
//! receives copies.

use super::path::{CameraPath, PathBuffers};
use super::sampler::PixelSampler;
use super::throughput::{Factor, SpectralMode, product};
use super::visible_point::VisiblePoint;
use crate::gather::camera_pass::{CameraPass, PathContext};
use crate::map::PixelRadii;
use crate::plan::partition::CameraView;
use crate::plan::{CameraEvents, MediumPlan, Tally, WavelengthPlan};
use crate::walk::{
    BodyMode, DepthLimit, MAX_EVENTS, Sink, SurfaceInteraction, SurfaceLookup, WithBodies, WithoutBodies,
    event_at_camera_filter, rotation_to_picture,
};
use abbe_optics::bsdf::BsdfClass;
use abbe_scene::camera::SystemAt;
use abbe_scene::geometry::Ray;
use abbe_spectra::spectrum::LANES;

impl<'a> CameraPass<'a> {
    /// Estimates the radiance of one sample of a pixel and adds it to the sink.
    pub fn sample<S: Sink>(
        &self,
        pixel: u64,
        mut sampler: PixelSampler,
        radii: &PixelRadii,
        buffers: &mut PathBuffers<'a>,
        tally: &mut Tally,
        sink: &mut S,
    ) {
        buffers.start_path(self.plan.polarisation.is_on());
        if self.stop.is_raised() {
            return;
        }
        let camera = &self.scene.camera;
        tally.camera_samples += 1;
        tally.lens_rays += u64::from(self.plan.aperture.is_finite());
        let path = |ray| CameraPath::new(ray, self.scene.medium_stack_of_camera(ray));
        let scene = self.scene;
        let filter = |ray: Ray, context: &mut PathContext<'_, 'a, S>| {
            let event = event_at_camera_filter(&scene.camera, -ray.direction);
            context.tally.polarised_events += u64::from(event.is_some());
            let stokes =
                self.plan.polarisation.records_stokes().then(|| rotation_to_picture(&scene.camera, -ray.direction));
            context.buffers.factors.to_picture = stokes;
            context.buffers.factors.events.extend(event);
        };
        let events = DepthLimit::of(self.scene).events();
        let mut context = PathContext { pixel, events, sampler: &mut sampler, radii, buffers, sink, tally };
        if let Some(sensor) = camera.sensor(pixel) {
            self.sample_sensor(sensor, &mut context);
            return;
        }
        match (&self.lens_systems, self.plan.wavelengths) {
            (Some(systems), _) => {
                let [lens, ..] = systems.each_ref().map(SystemAt::system);
                // A sample traces image paths at all wavelengths, and then ghost paths.
                let kinds = if lens.has_ghosts() { 0..2 * LANES } else { 0..LANES };
                for number in kinds {
                    let (lane, is_ghost) = (number % LANES, number >= LANES);
                    let choice = is_ghost.then(|| context.sampler.stream.uniform());
                    let ray = context.sampler.ray_through_lens(&systems[lane], camera, pixel, choice);
                    let Some((ray, weight)) = ray else { continue };
                    context.tally.ghost_rays += u64::from(is_ghost);
                    context.tally.film_events += u64::from(lens.is_coated());
                    context.buffers.factors.events.clear();
                    if self.plan.polarisation.is_on() {
                        filter(ray, &mut context);
                    }
                    if let Some(mut single) = self.to_shared_wavelength(path(ray), lane, &mut context) {
                        single.multiply(Factor::Grey(weight), context.buffers);
                        self.follow(&single, &mut context);
                    }
                }
            }
            (None, WavelengthPlan::Shared) => {
                let ray = context.sampler.ray(camera, pixel);
                if self.plan.polarisation.is_on() {
                    filter(ray, &mut context);
                }
                self.follow_each_shared(path(ray), &mut context);
            }
            (None, WavelengthPlan::Free | WavelengthPlan::Both) => {
                let ray = context.sampler.ray(camera, pixel);
                if self.plan.polarisation.is_on() {
                    filter(ray, &mut context);
                }
                self.follow(&path(ray), &mut context);
            }
        }
    }

    pub(super) fn follow_each_shared<S: Sink>(&self, path: CameraPath, context: &mut PathContext<'_, 'a, S>) {
        for lane in 0..LANES {
            if let Some(single) = self.to_shared_wavelength(path, lane, context) {
                self.follow(&single, context);
            }
        }
    }

    /// Restricts a free path to a shared wavelength, unless the lights have no power there.
    pub(in crate::gather) fn to_shared_wavelength<S: Sink>(
        &self,
        path: CameraPath,
        lane: usize,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<CameraPath> {
        let (nm, pdf) = (self.shared_nm[lane], self.shared_pdf[lane]);
        if pdf <= 0.0 {
            return None;
        }
        context.tally.shared_paths += 1;
        let throughput = product(&context.buffers.factors.natural, nm) / (pdf * LANES as f64);
        Some(CameraPath { spectral_mode: SpectralMode::Shared { lane, nm, throughput }, ..path })
    }

    /// Follows a path to its end. Only this function chooses the [`BodyMode`] of camera paths. It is
    /// large, so its callers share one copy.
    #[inline(never)]
    pub(in crate::gather) fn follow<S: Sink>(&self, path: &CameraPath, context: &mut PathContext<'_, 'a, S>) {
        let length = context.buffers.factors.length();
        match self.plan.media_plan {
            MediumPlan::Air => self.follow_in_mode::<WithoutBodies, S>(path, context),
            MediumPlan::Clear | MediumPlan::Absorbing | MediumPlan::Scattering(_) => {
                self.follow_in_mode::<WithBodies, S>(path, context);
            }
        }
        context.buffers.factors.return_to(length);
    }

    #[inline(always)]
    fn follow_in_mode<M: BodyMode, S: Sink>(&self, path: &CameraPath, context: &mut PathContext<'_, 'a, S>) {
        let mut path = *path;
        while path.depth < context.events {
            let Some(interaction) = self.arrive::<M, S>(&mut path, context) else { return };
            match self.interact::<M, S>(&path, &interaction, context) {
                Some(scattered) => path = scattered,
                None => return,
            }
        }
        self.end_at_limit::<M, S>(&path, context);
    }

    /// Advances a path to the next surface, and adds the lights at the end of the segment.
    #[inline(always)]
    fn arrive<M: BodyMode, S: Sink>(
        &self,
        path: &mut CameraPath,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<SurfaceInteraction<'a>> {
        let next = if M::HAS_BODIES && !self.plan.media_plan.is_clear() {
            self.advance_through_media(path, context)
        } else {
            let lookup = self.lookup(path, context.sampler.stream.uniform());
            M::next_interaction(self.scene, path.ray_state, lookup)
        };
        context.tally.camera_segments += 1;
        if M::HAS_BODIES {
            let face = next.as_ref().is_some_and(|next| {
                self.scene.body_of(next.hit.object).is_some() || next.bsdf.model.grating().is_some()
            });
            context.tally.body_events += u64::from(face);
        }
        let Some(interaction) = next else {
            self.add_emitters_hit(path, path.ray_state.ray.direction, None, context);
            return None;
        };
        path.depth += 1;
        path.distance_m += interaction.distance_m;
        if interaction.crossed_hidden_face {
            path.view = CameraView::Indirect;
            path.events = path.events.after_specular_event();
            path.hit_weighting = path.hit_weighting.after_specular_event();
        }
        self.add_emitters_hit(path, interaction.incoming, Some(&interaction.hit), context);
        Some(interaction)
    }

    /// Gathers light at a surface and scatters the path there. Returns `None` if the path ends.
    #[inline(always)]
    fn interact<M: BodyMode, S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<CameraPath> {
        context.tally.texture_lookups += u64::from(interaction.textured);
        let class = interaction.bsdf.class();
        let gathers_behind = self.final_gather && class == BsdfClass::Diffuse && gathers_behind(path, interaction);
        let ends = class == BsdfClass::Diffuse && !gathers_behind;
        if class >= BsdfClass::Glossy {
            self.gather_at_surface::<M, S>(path, interaction, ends, context);
        }
        if ends || class == BsdfClass::Absorbing {
            return None;
        }
        let (mut path_copy, interaction_copy) = (*path, *interaction);
        if gathers_behind {
            context.tally.final_gathers += 1;
            path_copy.final_radius_m = Some(self.final_radius(&path_copy, context));
        }
        self.scatter(&path_copy, &interaction_copy, context)
    }

    #[inline(always)]
    pub(in crate::gather) fn lookup(&self, path: &CameraPath, u: f64) -> SurfaceLookup {
        SurfaceLookup::of_camera(&self.scene.camera, path.distance_m, u)
    }

    /// Ends a path at the limit of its number of events. If the limit is explicit, the path still
    /// adds the light up to the next surface, and some paths continue as truncated paths.
    #[inline(never)]
    fn end_at_limit<M: BodyMode, S: Sink>(&self, path: &CameraPath, context: &mut PathContext<'_, 'a, S>) {
        if context.events >= MAX_EVENTS {
            context.tally.capped_paths += 1;
            return;
        }
        let mut path = *path;
        let Some(interaction) = self.arrive::<M, S>(&mut path, context) else { return };
        let factor = DepthLimit::of(self.scene).sample_truncated_path(&mut context.sampler.stream);
        let Some(factor) = factor.filter(|_| !context.buffers.records) else { return };
        path.multiply(Factor::Grey(factor), context.buffers);
        context.with_truncated_light(1.0, |truncated| {
            if let Some(scattered) = self.interact::<M, _>(&path, &interaction, truncated) {
                self.follow(&scattered, truncated);
            }
        });
    }

    /// Gathers direct light and light from photons, without indirect light unless the path `ends`.
    #[inline(always)]
    fn gather_at_surface<M: BodyMode, S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        ends: bool,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        context.tally.rough_events += u64::from(interaction.bsdf.class() == BsdfClass::Glossy);
        if context.buffers.records {
            context.buffers.visible_points.push(self.visible_point(path, interaction));
        }
        let luminescence = self.luminescence(path, interaction, context);
        if !self.plan.direct.is_absent() {
            self.gather_direct::<M, S>(path, interaction, luminescence.as_ref(), context);
        }
        // A continued path can hit a light itself.
        if ends && self.plan.direct.traces_scattered_rays() {
            self.gather_direct_by_bsdf::<M, S>(path, interaction, luminescence.as_ref(), context);
        }
        // Indirect light arrives at a path that continues as at a glossy surface.
        let class = if ends { BsdfClass::Diffuse } else { BsdfClass::Glossy };
        self.gather_photons(path, interaction, class, context);
        if let Some(luminescence) = &luminescence {
            self.gather_excitation(path, interaction, luminescence, context);
        }
    }

    #[inline]
    pub(in crate::gather) fn visible_point(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
    ) -> VisiblePoint {
        let normal = interaction.hit.normal;
        VisiblePoint {
            position: interaction.hit.position,
            facing: if interaction.leads_back(normal) { normal } else { -normal },
            object: interaction.hit.object,
            footprint_m: self.scene.camera.pixel_width_m(path.distance_m),
            view: path.view,
            shared: matches!(path.spectral_mode, SpectralMode::Shared { .. }),
            is_diffuse: interaction.bsdf.class() == BsdfClass::Diffuse,
            is_fluorescent: interaction.bsdf.model.as_fluorescent().is_some(),
        }
    }
}

/// Returns true if a final gather replaces the indirect photons at a diffuse surface: at the first
/// one that scatters the path. Photons excite fluorescent surfaces in place.
fn gathers_behind(path: &CameraPath, interaction: &SurfaceInteraction<'_>) -> bool {
    path.events == CameraEvents::Specular && interaction.bsdf.model.as_fluorescent().is_none()
}
