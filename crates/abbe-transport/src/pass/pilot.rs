//! The pilot: a small render before pass 0. It has its own random streams.
//!
//! The pilot fixes all data that passes must not learn from each other: the emission distributions
//! of the lights, the first kernel radii and the number of camera samples of each pixel, and the
//! division of the photons between the two sets.
//!
//! If anything in the scene moves, the pilot surveys the scene at several times. The pilot learns
//! the emission distributions from the photons of all these times. Each pixel gets the smallest of
//! its radii at these times. This radius suits the time with the highest photon density, which
//! needs the sharpest kernel. At the other times, the radius adds noise, but these times contribute
//! less light. Outlines are stored only where nothing moves.

use super::aims::{LearnedAims, learn_aims};
use super::balance::{Balance, BalanceLimits};
use super::camera_samples::CameraSamples;
use super::coarse::coarse_photon_picture;
use super::context::{EmissionRequest, PassContext, SharedWavelengths};
use super::keep_probability::{KEEP_ALL, KeepProbability};
use super::outlines::outlines;
use super::receptors::first_radii;
use super::recorder::RecordingOptions;
use super::sums::StageSeconds;
use super::survey::PixelSurvey;
use super::trial::balanced;
use super::volume_radii::{VolumeKernelWidths, keep_probabilities};
use crate::emit::{EmissionStrata, PhotonSource};
use crate::gather::{CameraPass, LightSelector, Outlines, VisiblePoint};
use crate::map::radius::{PerKernel, scales};
use crate::map::{FirstRadii, LightMaps, SetMaps};
use crate::plan::partition::{PerClass, PerSet, PhotonClass, PhotonSet};
use crate::plan::{AimPlan, Budget, CausticPlan, IndirectPlan, MotionPlan};
use crate::sensor::Picture;
use crate::walk::RayDensities;
use abbe_optics::bsdf::BsdfClass;
use abbe_scene::Scene;
use abbe_spectra::error::Result;
use std::borrow::Cow;
use std::time::Instant;

/// If both sets are in use, each set receives at least this share of the photons.
const MIN_SET_SHARE: f64 = 0.08;

/// The emission distributions of a single coarse picture are learned as if a pass had this number
/// of photon paths.
const COARSE_AIM_PHOTONS: u64 = 40_000;

/// The number of shutter times in the pilot's survey of a moving scene.
const MOMENTS: usize = 4;

/// The results of the pilot.
#[derive(Debug)]
pub struct Pilot {
    /// The strata of the emitted rays, with their emission distributions.
    pub(super) strata: EmissionStrata,
    /// The names of the specular objects that no pilot photon reached.
    pub unlit: Vec<String>,
    /// The densities of the emitted rays. `None` if no photon competes with camera paths.
    pub(super) ray_densities: Option<RayDensities>,
    /// The first kernel radii of each pixel.
    pub(super) radii: FirstRadii,
    /// The first kernel radius of each receptor in m. Empty if there are no receptors or caustics.
    pub(super) receptor_radii: Vec<f64>,
    /// The outlines of directly visible surfaces.
    pub(super) outlines: Outlines,
    /// The number of photon paths of each set.
    pub(super) photons: PerSet<u64>,
    /// The number of camera samples of each pixel.
    pub(super) camera_samples: CameraSamples,
    /// The number of photons that a pass stores, divided by the number for which the first radii
    /// are chosen. Always 1 if the scene states the first radius.
    pub(super) stored_photons: PerKernel<f64>,
    /// The probabilities of storing photons.
    pub(super) keep: PerClass<KeepProbability>,
}

/// Returns the scene at the pilot's times. The open time of the shutter is divided into intervals
/// that transmit equal amounts of light. Each interval gives one time: half of the interval's light
/// passes before this time.
fn posed_scenes<'a>(context: &PassContext<'a>) -> Result<Vec<Cow<'a, Scene>>> {
    let scene = context.scene;
    match context.plan.motion {
        MotionPlan::PosedPerPass if scene.moves() => {
            let share = |i: usize| (i as f64 + 0.5) / MOMENTS as f64;
            (0..MOMENTS).map(|i| scene.at(scene.shutter.time_s(share(i)))).collect()
        }
        MotionPlan::PosedPerPass | MotionPlan::Still => Ok(vec![Cow::Borrowed(scene)]),
    }
}

impl Pilot {
    /// Runs the pilot. Adds the duration of the pilot to `seconds`. If `show` is given and the film
    /// is not small, the function calls `show` with a coarse picture of the scene as soon as
    /// possible.
    ///
    /// # Errors
    /// Returns an error if the scene cannot be posed at one of the pilot's times.
    pub fn run(
        context: &PassContext<'_>,
        seconds: &mut StageSeconds,
        show: Option<impl FnOnce(&Picture)>,
    ) -> Result<Self> {
        let start = Instant::now();
        let scenes = posed_scenes(context)?;
        let mut pilot = Self::with_plain_aims(context);
        // Few photons reach glass and mirrors if they are not aimed.
        let needs_aims = context.plan.caustics != CausticPlan::Absent;
        let (before, after) = if needs_aims { (None, show) } else { (show, None) };
        pilot.show_coarse_picture(context, &scenes[0], before)?;
        if context.plan.aim == AimPlan::Learned {
            pilot.set_aims(learn_aims(context, &scenes), context);
        }
        pilot.show_coarse_picture(context, &scenes[0], after)?;
        let visible = pilot.measure(context, &scenes);
        pilot.balance(context, &scenes[0]);
        pilot.measure_outlines(context, &scenes[0], &visible);
        pilot.receptor_radii = first_radii(context, &scenes[0], &pilot.strata, pilot.photons.free);
        seconds.pilot += start.elapsed().as_secs_f64();
        Ok(pilot)
    }

    /// Renders only the coarse picture of a pilot, with fewer photons for the emission
    /// distributions. Returns `None` if the film is small.
    ///
    /// # Errors
    /// See [`Self::run`].
    pub fn coarse_picture(context: &PassContext<'_>) -> Result<Option<Picture>> {
        let photons = context.budget.photons.min(COARSE_AIM_PHOTONS);
        let budget = Budget { photons, ..context.budget.clone() };
        let context = &PassContext { budget: &budget, ..*context };
        let scenes = posed_scenes(context)?;
        let mut pilot = Self::with_plain_aims(context);
        if context.plan.aim == AimPlan::Learned {
            pilot.set_aims(learn_aims(context, &scenes), context);
        }
        coarse_photon_picture(context, &scenes[0], &mut pilot)
    }

    /// Returns a pilot that has measured nothing. The emitted rays follow the lights.
    fn with_plain_aims(context: &PassContext<'_>) -> Self {
        let LearnedAims { strata, unlit } = LearnedAims::plain(context);
        let mut pilot = Self {
            strata,
            unlit,
            ray_densities: None,
            radii: FirstRadii::default(),
            receptor_radii: Vec::new(),
            outlines: Outlines::default(),
            photons: PerSet::default(),
            camera_samples: CameraSamples::Same(1),
            stored_photons: PerKernel::splat(1.0),
            keep: KEEP_ALL,
        };
        pilot.set_ray_densities(context);
        pilot
    }

    fn set_aims(&mut self, LearnedAims { strata, unlit }: LearnedAims, context: &PassContext<'_>) {
        (self.strata, self.unlit) = (strata, unlit);
        self.set_ray_densities(context);
    }

    fn set_ray_densities(&mut self, context: &PassContext<'_>) {
        let densities = || self.strata.ray_densities(&context.scene.lights, context.scene.extent());
        self.ray_densities = has_competition(context).then(densities);
    }

    /// Calls `show` with a coarse picture, unless the film is small.
    fn show_coarse_picture(
        &mut self,
        context: &PassContext<'_>,
        scene: &Scene,
        show: Option<impl FnOnce(&Picture)>,
    ) -> Result<()> {
        if let Some(show) = show
            && let Some(picture) = coarse_photon_picture(context, scene, self)?
        {
            show(&picture);
        }
        Ok(())
    }

    /// Measures the radii, the probabilities of storing photons in media, and the division of the
    /// photons between the sets. Returns the visible point of each pixel. There are no outlines
    /// until [`Self::measure_outlines`].
    pub(super) fn measure(
        &mut self,
        context: &PassContext<'_>,
        scenes: &[Cow<'_, Scene>],
    ) -> Vec<Option<VisiblePoint>> {
        self.photons = even_division(context.plan.photon_sets(), context.budget.photons);
        self.camera_samples = CameraSamples::Same(1);
        self.outlines = Outlines::default();
        let mut survey = PixelSurvey::default();
        for (moment, scene) in (0..).zip(scenes) {
            let moment = (moment, scenes.len());
            survey.merge(PixelSurvey::of_moment(context, scene, moment, &self.strata, self.photons));
        }
        let PixelSurvey { mut radii, visible, volume, stored, readers } = survey;
        let widths = VolumeKernelWidths::of(context);
        self.keep = keep_probabilities(&volume, stored, &widths);
        for (radii, counts) in radii.iter_mut().zip(volume) {
            counts.set_radii(radii, self.keep, &widths);
        }
        // The paths of a receptor reach surfaces everywhere, so the radius of one of its paths does
        // not suit the others.
        self.radii = FirstRadii::with_medians(&radii, context.scene.measures());
        if context.plan.photon_sets() == (PerSet { free: true, shared: true }) {
            self.photons = divided(context.budget.photons, readers);
        }
        visible
    }

    /// Measures the outlines of the surfaces around the visible points, up to the kernel radii of
    /// pass 0.
    pub(super) fn measure_outlines(
        &mut self,
        context: &PassContext<'_>,
        scene: &Scene,
        visible: &[Option<VisiblePoint>],
    ) {
        // If the camera moves, the visible point of a pixel changes from pass to pass, so no
        // outlines are stored.
        if context.plan.indirect != IndirectPlan::Absent && context.scene.motions.camera.is_none() {
            let scale = scales(0, self.stored_photons).surface.indirect;
            let swept = context.scene.swept_boxes();
            self.outlines = outlines(context, scene, visible, &swept, (&self.radii, scale));
        }
    }

    /// Returns the number of photon paths of each set, divided by the mean number of camera
    /// samples per pixel.
    pub(super) fn photons_per_sample(&self) -> PerSet<f64> {
        PerSet::from_fn(|set| self.photons[set] as f64 / self.camera_samples.mean())
    }

    /// Returns how the photons of a set are recorded.
    pub(super) fn recording(&self, set: PhotonSet) -> RecordingOptions<'static> {
        RecordingOptions { keep: self.keep, photons_per_sample: self.photons_per_sample()[set], receptors: None }
    }

    /// Returns a source of the photons of a pass.
    pub(super) fn photon_source<'s>(
        &'s self,
        context: &PassContext<'s>,
        scene: &'s Scene,
        request: EmissionRequest,
    ) -> PhotonSource<'s> {
        PhotonSource {
            ray_densities: self.ray_densities.as_ref(),
            ..context.photon_source(scene, &self.strata, request)
        }
    }

    /// Returns the inputs of the camera paths of a pass with the first kernel radii, in which no
    /// light is missing.
    pub(super) fn camera_pass<'s>(
        &'s self,
        context: &PassContext<'s>,
        (scene, selector): (&'s Scene, &'s LightSelector),
        (maps, light_maps): (&'s PerSet<SetMaps>, &'s LightMaps<'s>),
        shared: SharedWavelengths,
    ) -> CameraPass<'s> {
        let kernels = (&self.outlines, self.photons_per_sample());
        let plain = context.camera_pass((scene, selector), (maps, light_maps), shared, kernels);
        CameraPass { direct: plain.direct.with_ray_densities(self.ray_densities.as_ref()), ..plain }
    }

    /// Divides the work of a pass between photons and camera samples.
    fn balance(&mut self, context: &PassContext<'_>, scene: &Scene) {
        let Budget { photons, photons_stated, camera_samples, .. } = *context.budget;
        let largest_medium_factor = PhotonClass::ALL.map(|class| self.keep[class].largest_medium_factor());
        let largest_medium_factor = largest_medium_factor.into_iter().fold(1.0, f64::max);
        let limits = BalanceLimits { photons, photons_stated, camera_samples, largest_medium_factor };
        let (balance, camera_samples) = if limits.is_fixed() {
            (limits.plain(), CameraSamples::Same(limits.plain().camera_samples))
        } else {
            balanced(context, scene, self, limits)
        };
        self.camera_samples = camera_samples;
        let Balance { photons: chosen, stored_share, medium_factor, .. } = balance;
        let share = chosen as f64 / photons as f64;
        let plain = self.keep;
        self.keep = PerClass::from_fn(|class| plain[class].with_medium_factor(medium_factor));
        self.keep.indirect.surface = stored_share;
        // The scene may state the first radius.
        if context.budget.radius_m.is_none() {
            let stored = |of: fn(&KeepProbability) -> f64| {
                PerClass::from_fn(|class| share * of(&self.keep[class]) / of(&plain[class]))
            };
            self.stored_photons = PerKernel {
                surface: stored(|keep| keep.surface),
                points: stored(|keep| keep.points),
                beams: stored(|keep| keep.beams),
            };
        }
        self.photons = PerSet::from_fn(|set| match self.photons[set] {
            0 => 0,
            count => ((count as f64 * share) as u64).max(1),
        });
    }
}

/// Returns true if photons and camera paths find the same light: the light of lamps that glossy
/// surfaces or meters receive through mirrors or glass.
fn has_competition(context: &PassContext<'_>) -> bool {
    let PassContext { scene, plan, .. } = context;
    let glossy = scene
        .materials
        .iter()
        .any(|material| material.surface.components().any(|component| component.class() == BsdfClass::Glossy));
    let receives = glossy || scene.measures();
    plan.caustics != CausticPlan::Absent && !plan.direct.is_absent() && receives
}

/// Divides the photons evenly between the sets that are in use.
fn even_division(in_use: PerSet<bool>, photons: u64) -> PerSet<u64> {
    let share = if in_use.free && in_use.shared { (photons / 2).max(1) } else { photons };
    PerSet::from_fn(|set| if in_use[set] { share } else { 0 })
}

/// Divides the photons between the sets in proportion to the number of pixels that read each set.
fn divided(photons: u64, readers: PerSet<u64>) -> PerSet<u64> {
    let total = (readers.free + readers.shared).max(1) as f64;
    let share = (readers.shared as f64 / total).clamp(MIN_SET_SHARE, 1.0 - MIN_SET_SHARE);
    let shared = ((photons as f64 * share) as u64).max(1);
    PerSet { free: (photons - shared.min(photons)).max(1), shared }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photons_are_divided_by_the_pixels_that_read_them() {
        assert_eq!(divided(1000, PerSet { free: 75, shared: 25 }), PerSet { free: 750, shared: 250 });
        assert_eq!(divided(1000, PerSet { free: 75, shared: 0 }), PerSet { free: 920, shared: 80 });
        assert_eq!(divided(1, PerSet { free: 0, shared: 0 }), PerSet { free: 1, shared: 1 });
    }
}
