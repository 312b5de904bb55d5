//! The pilot: small measurements of the scene before pass 0, with random streams of their own.
//!
//! It fixes all data that passes must not learn from each other: the emission distributions, the
//! first kernel radii and the camera samples of each pixel, and the division of the photons between
//! the two sets.
//!
//! If anything moves, the pilot surveys the scene at several times and learns the emission
//! distributions from the photons of all of them. Each pixel gets the smallest of its radii, that
//! of the time with the highest photon density, which needs the sharpest kernel. At the other times
//! it adds noise, but these contribute less light. Surface extents are stored only where nothing
//! moves.

use super::aims::{LearnedAims, PATHS_FOR_SKETCH, PATHS_PER_STRATUM, learn_aims};
use super::balance::{Balance, BalanceLimits};
use super::coarse::{CoarseLevel, CoarsePicture, FULL_DIVISOR, coarse_photon_picture};
use super::gathering::forces_final_gather;
use super::measure::{measure, measure_surface_extents};
use super::pass_size::PassSize;
use super::sensor_radii::first_radii;
use super::trial::{Choice, balanced};
use crate::gather::SurfaceExtents;
use crate::map::FirstRadii;
use crate::map::radius::PerKernel;
use crate::pass::{CameraSamples, KEEP_ALL, KeepProbability, PassContext, PassParameters, StageSeconds};
use crate::plan::partition::{PerClass, PerSet, PhotonClass};
use crate::plan::{AimPlan, Budget, CausticPlan, MotionPlan};
use abbe_optics::bsdf::BsdfClass;
use abbe_scene::Scene;
use abbe_spectra::error::Result;
use std::borrow::Cow;
use web_time::Instant;

/// The full coarse picture is skipped if the one before it takes less than this time in s, because
/// the first pass is near.
const SLOW_HALF_S: f64 = 1.0;

/// The number of shutter times in the pilot's survey of a moving scene.
const MOMENTS: usize = 4;

#[derive(Debug)]
pub struct Pilot {
    pub parameters: PassParameters,
    /// The names of the specular objects that no pilot photon reached.
    pub unlit: Vec<String>,
    /// The largest work of a pass in instructions, if a limit made the passes smaller.
    pub largest_work: Option<f64>,
}

/// Returns the scene at the pilot's times: the middles, by transmitted light, of intervals that
/// transmit equal amounts of light.
fn posed_scenes<'a>(context: &PassContext<'a>) -> Result<Vec<Cow<'a, Scene>>> {
    let scene = context.scene;
    match context.plan.motion {
        MotionPlan::PosedPerPass if scene.moves() => {
            let fraction = |i: usize| (i as f64 + 0.5) / MOMENTS as f64;
            (0..MOMENTS).map(|i| scene.at(scene.shutter.time_s(fraction(i)))).collect()
        }
        MotionPlan::PosedPerPass | MotionPlan::Still => Ok(vec![Cow::Borrowed(scene)]),
    }
}

impl Pilot {
    /// Runs the pilot, and adds its duration to `seconds`. Calls `show` with coarse pictures of
    /// these levels, from coarse to fine and the first one as soon as possible, unless the film is
    /// small. If the context's flag is raised, the pilot ends early and must not be used. Returns
    /// an error if the scene cannot be posed.
    pub fn run(
        context: &PassContext<'_>,
        size: PassSize,
        seconds: &mut StageSeconds,
        levels: &[CoarseLevel],
        mut show: impl FnMut(&CoarsePicture),
    ) -> Result<Self> {
        let start = Instant::now();
        let scenes = posed_scenes(context)?;
        let mut pilot = Self::with_plain_aims(context);
        // Few photons reach glass and mirrors if they are not aimed.
        let needs_aims = context.plan.caustics != CausticPlan::Absent;
        let (before, after) = levels.split_at(if needs_aims { 0 } else { levels.len().min(1) });
        let mut last_s = f64::INFINITY;
        for &level in before {
            last_s = pilot.show_coarse_picture(context, &scenes[0], level, &mut show)?;
        }
        if context.plan.aim == AimPlan::Learned {
            pilot.set_aims(learn_aims(context, &scenes, PATHS_PER_STRATUM), context);
        }
        for &level in after.iter().filter(|&&level| level != CoarseLevel::Full) {
            last_s = pilot.show_coarse_picture(context, &scenes[0], level, &mut show)?;
        }
        let is_full_wanted = levels.contains(&CoarseLevel::Full) && last_s >= SLOW_HALF_S;
        pilot.measure(context, size, &scenes, is_full_wanted.then_some(&mut show))?;
        seconds.pilot += start.elapsed().as_secs_f64();
        Ok(pilot)
    }

    /// Makes the measurements one after the other, as long as the flag is not raised. Calls `show`
    /// with a full coarse picture as soon as the radii are known.
    fn measure(
        &mut self,
        context: &PassContext<'_>,
        size: PassSize,
        scenes: &[Cow<'_, Scene>],
        show: Option<&mut impl FnMut(&CoarsePicture)>,
    ) -> Result<()> {
        if context.stop.is_raised() {
            return Ok(());
        }
        let visible = measure(&mut self.parameters, context, scenes);
        if let Some(show) = show {
            self.show_full_picture(context, &scenes[0], show)?;
        }
        if context.stop.is_raised() {
            return Ok(());
        }
        let parameters = &mut self.parameters;
        self.largest_work = balance(parameters, context, size, &scenes[0]);
        measure_surface_extents(parameters, context, &scenes[0], &visible);
        parameters.sensor_radii = first_radii(context, &scenes[0], &parameters.strata, parameters.photons.free);
        Ok(())
    }

    /// Renders only a sketch of this size, with fewer photons for the aims. `None` if the film is
    /// small.
    pub fn sketch(context: &PassContext<'_>, size: f64) -> Result<Option<CoarsePicture>> {
        let scenes = posed_scenes(context)?;
        let mut pilot = Self::with_plain_aims(context);
        if context.plan.aim == AimPlan::Learned {
            // The budget limits the paths of all strata together.
            let budget = Budget { photons: PATHS_FOR_SKETCH, ..context.budget.clone() };
            let context = PassContext { budget: &budget, ..*context };
            pilot.set_aims(learn_aims(&context, &scenes, &[PATHS_FOR_SKETCH]), &context);
        }
        coarse_photon_picture(context, &scenes[0], &mut pilot.parameters, CoarseLevel::Sketch(size))
    }

    /// Returns a pilot that has measured nothing. The emitted rays follow the lights.
    fn with_plain_aims(context: &PassContext<'_>) -> Self {
        let LearnedAims { strata, unlit } = LearnedAims::plain(context);
        let parameters = PassParameters {
            strata,
            ray_densities: None,
            radii: FirstRadii::default(),
            sensor_radii: Vec::new(),
            surface_extents: SurfaceExtents::default(),
            photons: PerSet::default(),
            final_gather: false,
            photons_per_ribbon: 1,
            camera_samples: CameraSamples::Same(1),
            stored_photons: PerKernel::splat(1.0),
            keep: KEEP_ALL,
        };
        let mut pilot = Self { parameters, unlit, largest_work: None };
        pilot.set_ray_densities(context);
        pilot
    }

    fn set_aims(&mut self, LearnedAims { strata, unlit }: LearnedAims, context: &PassContext<'_>) {
        (self.parameters.strata, self.unlit) = (strata, unlit);
        self.set_ray_densities(context);
    }

    fn set_ray_densities(&mut self, context: &PassContext<'_>) {
        let parameters = &mut self.parameters;
        let densities = || parameters.strata.ray_densities(&context.scene.lights, context.scene.extent());
        parameters.ray_densities = has_competition(context).then(densities);
    }

    /// Shows a coarse picture, and returns its time in s.
    fn show_coarse_picture(
        &mut self,
        context: &PassContext<'_>,
        scene: &Scene,
        level: CoarseLevel,
        show: &mut impl FnMut(&CoarsePicture),
    ) -> Result<f64> {
        let start = Instant::now();
        if !context.stop.is_raised()
            && let Some(coarse) = coarse_photon_picture(context, scene, &mut self.parameters, level)?
            && !context.stop.is_raised()
        {
            show(&coarse);
        }
        Ok(start.elapsed().as_secs_f64())
    }

    /// Shows a picture with fewer photons than a pass, and with the radii of the survey.
    fn show_full_picture(
        &mut self,
        context: &PassContext<'_>,
        scene: &Scene,
        show: &mut impl FnMut(&CoarsePicture),
    ) -> Result<()> {
        let PassParameters { photons, stored_photons, .. } = self.parameters;
        self.parameters.photons = PerSet::from_fn(|set| photons[set].div_ceil(FULL_DIVISOR));
        if context.budget.radius_m.is_none() {
            self.parameters.stored_photons = PerKernel::splat(1.0 / FULL_DIVISOR as f64);
        }
        self.show_coarse_picture(context, scene, CoarseLevel::Full, show)?;
        (self.parameters.photons, self.parameters.stored_photons) = (photons, stored_photons);
        Ok(())
    }
}

/// Divides the work of a pass between photons and camera samples. Returns the largest work of a
/// pass in instructions, if a limit made it smaller.
fn balance(parameters: &mut PassParameters, context: &PassContext<'_>, size: PassSize, scene: &Scene) -> Option<f64> {
    let Budget { photons, photons_are_explicit, camera_samples, .. } = *context.budget;
    let largest_medium_factor = PhotonClass::ALL.map(|class| parameters.keep[class].largest_medium_factor());
    let largest_medium_factor = largest_medium_factor.into_iter().fold(1.0, f64::max);
    let limits = BalanceLimits { photons, photons_are_explicit, camera_samples, largest_medium_factor };
    let limited =
        (size.is_limited() || !limits.is_fixed()).then(|| balanced(context, scene, parameters, (limits, size)));
    // Stated numbers stay unless the time is too short for them.
    let choice = limited.filter(|choice| !limits.is_fixed() || choice.largest_work.is_some());
    let Choice { balance, camera_samples, final_gather, largest_work } = choice.unwrap_or_else(|| {
        let balance = limits.plain();
        Choice {
            balance,
            camera_samples: CameraSamples::Same(balance.camera_samples),
            final_gather: forces_final_gather(context),
            largest_work: None,
        }
    });
    (parameters.camera_samples, parameters.final_gather) = (camera_samples, final_gather);
    let Balance { photons: chosen, stored_fraction, medium_factor, photons_per_ribbon, .. } = balance;
    parameters.photons_per_ribbon = photons_per_ribbon;
    let fraction = chosen as f64 / photons as f64;
    let plain = parameters.keep;
    parameters.keep = PerClass::from_fn(|class| plain[class].with_medium_factor(medium_factor));
    parameters.keep.indirect.surface = stored_fraction;
    // The scene may state the first radius.
    if context.budget.radius_m.is_none() {
        let stored = |of: fn(&KeepProbability) -> f64| {
            PerClass::from_fn(|class| fraction * of(&parameters.keep[class]) / of(&plain[class]))
        };
        parameters.stored_photons = PerKernel {
            surface: stored(|keep| keep.surface),
            points: stored(|keep| keep.points),
            beams: stored(|keep| keep.beams),
        };
    }
    parameters.photons = PerSet::from_fn(|set| match parameters.photons[set] {
        0 => 0,
        count => ((count as f64 * fraction) as u64).max(1),
    });
    largest_work
}

/// Returns true if photons and camera paths find the same light: of lights that glossy surfaces or
/// meters receive through mirrors or glass.
fn has_competition(context: &PassContext<'_>) -> bool {
    let PassContext { scene, plan, .. } = context;
    let glossy = scene
        .materials
        .iter()
        .any(|material| material.surface.components().any(|component| component.class() == BsdfClass::Glossy));
    let receives = glossy || scene.measures();
    plan.caustics != CausticPlan::Absent && !plan.direct.is_absent() && receives
}
