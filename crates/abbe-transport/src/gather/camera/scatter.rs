//! Continuation of camera paths at mirrors, glass and rough surfaces.

use super::path::{CameraPath, GlossyEvent};
use super::throughput::{Factor, SpectralMode, product, relative_n2};
use crate::gather::camera_pass::{CameraPass, PathContext};
use crate::gather::direct::lighting::HitWeighting;
use crate::plan::WavelengthPlan;
use crate::walk::{Sink, SurfaceInteraction, long_path_survival, scatter_at_crystal};
use abbe_optics::bsdf::{Bsdf, BsdfClass, PowerFractions, ScatterEvent, TransportMode};
use abbe_scene::Scene;
use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_spectra::spectrum::{LANES, Wavelengths};

/// The walk follows both paths at a smooth interface if both have at least this weight.
const LEAST_BRANCH_WEIGHT: f64 = 0.01;

/// The number of surface events after which Russian roulette may end a camera path.
const CAMERA_DEPTH_BEFORE_ROULETTE: u32 = 8;

impl<'a> CameraPass<'a> {
    /// Scatters a path at a mirror, glass or rough surface. Returns `None` if the path ends.
    pub(super) fn scatter<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<CameraPath> {
        context.tally.film_events += u64::from(interaction.bsdf.model.films().is_some());
        context.tally.polarised_events += u64::from(self.plan.polarisation.is_on());
        if interaction.bsdf.model.crystal().is_some() {
            return self.scatter_at_crystal(*path, interaction, context);
        }
        let glossy = self.glossy_event(path, interaction, context);
        let mut path = *path;
        let continues = if let (SpectralMode::Free, true) = (path.spectral_mode, self.disperses(interaction)) {
            self.scatter_free_at_dispersive(&mut path, interaction, glossy, context)
        } else if is_smooth_interface(interaction) && self.splits(&path, natural_reflectance(&path, interaction)) {
            self.follow_reflection(path, interaction, context);
            self.scatter_forced(&mut path, interaction, ScatterEvent::Transmission, 1.0, context)
        } else if let Some(reflectance) = self.polarised_reflectance(&path, interaction, context) {
            let reflects = context.sampler.stream.uniform() < reflectance;
            let (event, probability) = if reflects {
                (ScatterEvent::Reflection, reflectance)
            } else {
                (ScatterEvent::Transmission, 1.0 - reflectance)
            };
            self.scatter_forced(&mut path, interaction, event, probability, context)
        } else {
            let u = context.sampler.stream.triple();
            self.scatter_by_bsdf(&mut path, interaction, u, glossy, context)
        };
        (continues && survives(self.scene, &mut path, context)).then_some(path)
    }

    /// Scatters a path at a crystal. A free path is followed once for each shared wavelength, and
    /// ends.
    fn scatter_at_crystal<S: Sink>(
        &self,
        mut path: CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<CameraPath> {
        if let (SpectralMode::Free, true) = (path.spectral_mode, self.disperses(interaction)) {
            context.tally.dispersions += 1;
            self.split(path, interaction, SplitEvent::Crystal, context);
            return None;
        }
        let continues = self.scatter_wave_at_crystal(&mut path, interaction, context);
        (continues && survives(self.scene, &mut path, context)).then_some(path)
    }

    /// Scatters one wavelength at a crystal. Returns whether the path continues.
    fn scatter_wave_at_crystal<S: Sink>(
        &self,
        path: &mut CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) -> bool {
        let wavelengths = Wavelengths::single(path.reference_nm());
        let light = context.buffers.factors.response(wavelengths.hero());
        let stream = &mut context.sampler.stream;
        let scattered = scatter_at_crystal(interaction, &wavelengths, TransportMode::Radiance, |_| light, stream);
        scattered.is_some_and(|scattered| {
            path.continue_at_crystal(interaction, &scattered, context.buffers);
            true
        })
    }

    fn glossy_event<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &PathContext<'_, 'a, S>,
    ) -> GlossyEvent {
        let caustic = self.caustic_weights(path, interaction, context);
        GlossyEvent { caustic, reference_nm: path.reference_nm() }
    }

    /// Returns true if each wavelength takes other directions at this surface, and the plan has
    /// shared wavelengths for it.
    fn disperses(&self, interaction: &SurfaceInteraction<'a>) -> bool {
        self.plan.wavelengths != WavelengthPlan::Free && interaction.disperses()
    }

    /// Scatters a free path at dispersive glass: the reflected path stays free, and the refracted
    /// path is followed once for each shared wavelength. Returns whether the free path continues.
    fn scatter_free_at_dispersive<S: Sink>(
        &self,
        path: &mut CameraPath,
        interaction: &SurfaceInteraction<'a>,
        glossy: GlossyEvent,
        context: &mut PathContext<'_, 'a, S>,
    ) -> bool {
        let bsdf = interaction.bsdf;
        if bsdf.class() == BsdfClass::Glossy || matches!(bsdf.model, Bsdf::Grating(_)) {
            // Here, each wavelength samples its own direction, also for reflection.
            context.tally.dispersions += 1;
            self.split(*path, interaction, SplitEvent::Glossy(glossy), context);
            return false;
        }
        let natural = natural_reflectance(path, interaction);
        let reflectance = self.polarised_reflectance(path, interaction, context).unwrap_or(natural);
        let both = self.splits(path, natural);
        let reflects = both || context.sampler.stream.uniform() < reflectance;
        let refracts = both || !reflects;
        if refracts && reflectance < 1.0 {
            let probability = if both { 1.0 } else { 1.0 - reflectance };
            context.tally.dispersions += 1;
            self.split(*path, interaction, SplitEvent::Refraction(probability), context);
        }
        if !reflects {
            return false;
        }
        let probability = if both { 1.0 } else { reflectance };
        self.scatter_forced(path, interaction, ScatterEvent::Reflection, probability, context)
    }

    /// Returns the reflectance of a smooth surface for the light that the camera would receive, or
    /// `None` if the plan has no polarisation, or at all other surfaces. It is 0 or 1 only if the
    /// reflectance of natural light is nearly so, because it holds at one wavelength.
    fn polarised_reflectance<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &PathContext<'_, 'a, S>,
    ) -> Option<f64> {
        /// The least probability of an event that is possible at another wavelength.
        const LEAST: f64 = 0.02;
        /// Less power than this is a rounding error of total reflection.
        const NEGLIGIBLE: f64 = 1e-12;
        if !self.plan.polarisation.is_on() {
            return None;
        }
        let nm = path.reference_nm();
        let light = context.buffers.factors.response(nm);
        let [natural, polarised] = interaction.smooth_powers(-interaction.incoming, light, nm)?;
        let share =
            |powers: PowerFractions| powers.reflected / (powers.reflected + powers.transmitted).max(f64::MIN_POSITIVE);
        let natural =
            if is_smooth_interface(interaction) { natural_reflectance(path, interaction) } else { share(natural) };
        let is_certain = natural.min(1.0 - natural) < NEGLIGIBLE;
        Some(if is_certain { natural.round() } else { share(polarised).clamp(LEAST, 1.0 - LEAST) })
    }

    /// Returns true if the walk follows both paths at a smooth interface with this reflectance of
    /// natural light. Otherwise, it selects one of them.
    fn splits(&self, path: &CameraPath, reflectance: f64) -> bool {
        let weight = path.reference_throughput * relative_n2(self.scene, &path.ray_state, path.reference_nm());
        weight * reflectance.min(1.0 - reflectance) > LEAST_BRANCH_WEIGHT
    }

    /// Follows the path that is reflected at a smooth interface to its end.
    fn follow_reflection<S: Sink>(
        &self,
        mut path: CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let length = context.buffers.factors.length();
        let reflects = self.scatter_forced(&mut path, interaction, ScatterEvent::Reflection, 1.0, context);
        if reflects && survives(self.scene, &mut path, context) {
            self.follow(&path, context);
        }
        context.buffers.factors.return_to(length);
    }

    fn split<S: Sink>(
        &self,
        path: CameraPath,
        interaction: &SurfaceInteraction<'a>,
        event: SplitEvent,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let (u, length) = (context.sampler.stream.triple(), context.buffers.factors.length());
        for lane in 0..LANES {
            let Some(mut single) = self.to_shared_wavelength(path, lane, context) else { continue };
            let continues = match event {
                SplitEvent::Refraction(probability) => {
                    self.scatter_forced(&mut single, interaction, ScatterEvent::Transmission, probability, context)
                }
                SplitEvent::Glossy(glossy) => self.scatter_by_bsdf(&mut single, interaction, u, glossy, context),
                SplitEvent::Crystal => self.scatter_wave_at_crystal(&mut single, interaction, context),
            };
            if continues && survives(self.scene, &mut single, context) {
                self.follow(&single, context);
            }
            context.buffers.factors.return_to(length);
        }
    }

    /// Reflects or refracts at a smooth interface. Returns false for total reflection.
    fn scatter_forced<S: Sink>(
        &self,
        path: &mut CameraPath,
        interaction: &SurfaceInteraction<'a>,
        event: ScatterEvent,
        probability: f64,
        context: &mut PathContext<'_, 'a, S>,
    ) -> bool {
        let u = match event {
            ScatterEvent::Reflection => [0.0; 3],
            ScatterEvent::Transmission => [ONE_MINUS_ULP; 3],
        };
        let nm = path.reference_nm();
        match interaction.bsdf.sample(interaction.wo, interaction.sides, nm, u) {
            Some(mut sample) if sample.event == event => {
                sample.probability = probability;
                path.continue_along(interaction, &sample, GlossyEvent::NONE, context.buffers)
            }
            Some(_) | None => false,
        }
    }

    /// Scatters into a direction sampled from the BSDF. Returns whether the path continues.
    fn scatter_by_bsdf<S: Sink>(
        &self,
        path: &mut CameraPath,
        interaction: &SurfaceInteraction<'a>,
        u: [f64; 3],
        glossy: GlossyEvent,
        context: &mut PathContext<'_, 'a, S>,
    ) -> bool {
        let nm = path.reference_nm();
        match interaction.bsdf.sample(interaction.wo, interaction.sides, nm, u) {
            Some(sample) => {
                let continues = path.continue_along(interaction, &sample, glossy, context.buffers);
                // A light behind this rough surface is direct light at the surface. If the plan
                // contains no direct light, the path ignores the light that it hits.
                if self.plan.direct.is_absent() && matches!(path.hit_weighting, HitWeighting::Mis { .. }) {
                    path.hit_weighting = HitWeighting::Ignored;
                }
                continues
            }
            None => false,
        }
    }
}

/// Returns the reflectance of a smooth interface for natural light at the wavelength of the path,
/// or a mean over the band for a free path: films may reflect other wavelengths only, and near the
/// critical angle, dispersive glass refracts some wavelengths and totally reflects others.
fn natural_reflectance(path: &CameraPath, interaction: &SurfaceInteraction<'_>) -> f64 {
    let nm = match path.spectral_mode {
        SpectralMode::Free => None,
        SpectralMode::Shared { nm, .. } => Some(nm),
    };
    interaction.bsdf.reflection_probability(interaction.wo, interaction.sides, nm)
}

/// Returns true if the surface is a smooth interface between two dielectrics, or a film.
fn is_smooth_interface(interaction: &SurfaceInteraction<'_>) -> bool {
    matches!(interaction.bsdf.model, Bsdf::Dielectric(_) | Bsdf::CoatedDielectric(_) | Bsdf::ThinFilm(_))
        && interaction.bsdf.class() == BsdfClass::Specular
}

/// How a free path continues at dispersive glass, once for each shared wavelength.
#[derive(Clone, Copy)]
enum SplitEvent {
    /// Holds the probability with which the caller selected this event.
    Refraction(f64),
    /// Each wavelength samples the BSDF of rough glass or of a grating.
    Glossy(GlossyEvent),
    /// Each wavelength selects an event at a crystal.
    Crystal,
}

/// Applies Russian roulette to paths of low throughput. Returns false if the path ends. The
/// survival probability excludes the factor 1/n² inside glass, which cancels when the path leaves
/// the glass.
fn survives<S: Sink>(scene: &Scene, path: &mut CameraPath, context: &mut PathContext<'_, '_, S>) -> bool {
    if path.reference_throughput <= 0.0 && matches!(path.spectral_mode, SpectralMode::Shared { .. }) {
        return false;
    }
    if path.depth < CAMERA_DEPTH_BEFORE_ROULETTE && !path.is_faint {
        return true;
    }
    let throughput = match path.spectral_mode {
        SpectralMode::Shared { .. } => path.reference_throughput,
        SpectralMode::Free => largest_throughput(&context.buffers.factors.natural),
    };
    let throughput = throughput * context.buffers.factors.of_natural_light(path.reference_nm());
    let throughput = throughput * relative_n2(scene, &path.ray_state, path.reference_nm());
    let by_throughput = if throughput >= 0.5 { 1.0 } else { throughput.max(0.05) };
    let survival = by_throughput * long_path_survival(path.depth);
    if survival >= 1.0 {
        return true;
    }
    if context.sampler.stream.uniform() >= survival {
        return false;
    }
    path.multiply(Factor::Grey(1.0 / survival), context.buffers);
    true
}

/// Returns the largest throughput of a free path over the band. At the reference wavelength alone,
/// paths whose mirrors reflect only light of other wavelengths would end too often, and the
/// surviving ones would become too bright.
fn largest_throughput(factors: &[Factor<'_>]) -> f64 {
    /// Wavelengths (nm) over the visible part of the band.
    const PROBES_NM: [f64; 6] = [420.0, 470.0, 520.0, 570.0, 620.0, 670.0];
    PROBES_NM.iter().map(|&nm| product(factors, nm)).fold(0.0, f64::max)
}
