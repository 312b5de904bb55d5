//! A coarse picture of the scene before pass 0.
//!
//! The survey of the pilot takes as long as several passes. A coarse picture has few pixels and few
//! photons, so it is ready much sooner. It is only shown: nothing in the render depends on it.

use super::measure::{measure, measure_surface_extents};
use crate::map::LightMaps;
use crate::pass::{CameraSamples, PassContext, PassParameters, PassSums, StageSeconds, path_pass, photon_pass};
use crate::plan::{Budget, MotionPlan, Plan, Tally};
use crate::sensor::{Film, FilmUnit, Picture};
use crate::walk::ledger::Ledger;
use abbe_scene::Scene;
use abbe_spectra::error::Result;
use std::borrow::Cow;

/// A coarse picture has about this number of pixels, or up to 1.8 times this number.
const PIXELS: f64 = 3_500.0;

/// The smallest side length of a coarse pixel, in pixels of the film. On smaller films, a pass
/// takes little time.
const LEAST_FACTOR: u32 = 3;

/// The number of photon paths in a pass of a coarse picture.
const PHOTONS: u64 = 5_000;

/// The number of camera samples per pixel of a coarse picture.
const CAMERA_SAMPLES: u64 = 2;

/// The number of light map cells along the longest side of a medium's box.
const LIGHT_MAP_CELLS: u32 = 12;

#[derive(Debug)]
pub(super) struct CoarseScene {
    scene: Scene,
    plan: Plan,
    budget: Budget,
    /// The side length of a coarse pixel in pixels of the film.
    factor: u32,
}

/// Renders a coarse picture by path tracing. Returns `None` if the film has few pixels.
pub fn coarse_path_picture(context: &PassContext<'_>) -> Result<Option<Picture>> {
    let Some(coarse) = CoarseScene::of(context, context.scene) else { return Ok(None) };
    let passes = |context: PassContext<'_>, sums: &mut PassSums| {
        (0..CAMERA_SAMPLES).try_for_each(|pass| path_pass(context, pass, sums).map(|_| ()))
    };
    coarse.picture(context, passes).map(Some)
}

/// Renders with the emission distributions of a pilot, in the scene at one of its times. `None` if
/// the film has few pixels. Afterwards, the pilot must measure the scene.
pub(super) fn coarse_photon_picture(
    context: &PassContext<'_>,
    scene: &Scene,
    parameters: &mut PassParameters,
) -> Result<Option<Picture>> {
    let Some(coarse) = CoarseScene::of(context, scene) else { return Ok(None) };
    let pass = |context: PassContext<'_>, sums: &mut PassSums| {
        let visible = measure(parameters, &context, &[Cow::Borrowed(context.scene)]);
        measure_surface_extents(parameters, &context, context.scene, &visible);
        parameters.camera_samples = CameraSamples::Same(CAMERA_SAMPLES);
        photon_pass(context, parameters, &mut LightMaps::default(), 0, sums).map(|_| ())
    };
    coarse.picture(context, pass).map(Some)
}

impl CoarseScene {
    /// Reduces the film of the scene or a posed copy. `None` if the film has few pixels.
    fn of(context: &PassContext<'_>, scene: &Scene) -> Option<Self> {
        let factor = (scene.camera.pixel_count() as f64 / PIXELS).sqrt() as u32;
        let few_pixels = || {
            let mut scene = scene.clone();
            scene.stop();
            scene.camera = scene.camera.coarser(factor);
            scene
        };
        (factor >= LEAST_FACTOR).then(|| Self {
            scene: few_pixels(),
            plan: Plan { motion: MotionPlan::Still, ..context.plan.clone() },
            budget: Budget {
                photons: PHOTONS.min(context.budget.photons),
                light_map_cells: LIGHT_MAP_CELLS.min(context.budget.light_map_cells),
                ..context.budget.clone()
            },
            factor,
        })
    }

    /// Renders passes, and enlarges their picture to the size of the film.
    fn picture(
        &self,
        full: &PassContext<'_>,
        passes: impl FnOnce(PassContext<'_>, &mut PassSums) -> Result<()>,
    ) -> Result<Picture> {
        let Self { scene, plan, budget, factor } = self;
        let (width, count) = (scene.camera.width(), scene.camera.pixel_count());
        let mut sums = PassSums {
            film: Film::new(width, count / width, scene.film.observer, 0).with_unit(FilmUnit::of(scene)),
            ledger: Ledger::new(scene.materials.len()),
            tally: Tally::default(),
            seconds: StageSeconds::default(),
        };
        let selector = full.light_selector(scene);
        passes(PassContext { scene, plan, budget, selector: &selector, ..*full }, &mut sums)?;
        let (width, height) = (scene.film.width as usize, scene.film.height as usize);
        Ok(sums.film.picture().enlarged(*factor as usize, (width, height)))
    }
}
