//! Coarse pictures of the scene before pass 0.
//!
//! The survey of the pilot takes as long as several passes. A coarse picture has fewer pixels and
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

/// The number of pixels of a sketch of size 1. It may have up to 1.8 times this number.
const PIXELS: f64 = 3_500.0;

/// The smallest side length of a pixel of a sketch of size 1, in pixels of the film. Smaller films
/// have no coarse pictures, because a pass takes little time.
const LEAST_FACTOR: u32 = 3;

/// The number of photon paths of a sketch of size 1.
const PHOTONS: f64 = 5_000.0;

/// The number of camera samples per pixel of a sketch.
const CAMERA_SAMPLES: u64 = 2;

/// A full coarse picture has the photons of a pass, divided by this number.
pub(super) const FULL_DIVISOR: u64 = 4;

/// The number of light map cells along the longest side of a medium's box.
const LIGHT_MAP_CELLS: u32 = 12;

/// How coarse a picture before pass 0 is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoarseLevel {
    /// About 3500 pixels with two camera samples each, and 5000 photons, both times this size.
    Sketch(f64),
    /// Half of the pixels of the film along each side, and an eighth of the photons of a pass.
    Half,
    /// All pixels of the film, and a quarter of the photons of a pass. The pilot's own survey fixes
    /// the kernels.
    Full,
}

impl CoarseLevel {
    /// Returns the side length of a pixel in pixels of the film, or `None` if the film is small.
    fn factor(self, film_pixels: f64) -> Option<u32> {
        let of_sketch = |size: f64| (film_pixels / (PIXELS * size)).sqrt() as u32;
        (of_sketch(1.0) >= LEAST_FACTOR).then(|| match self {
            Self::Sketch(size) => of_sketch(size).max(1),
            Self::Half => 2,
            Self::Full => 1,
        })
    }

    fn photons(self, of_pass: u64) -> u64 {
        match self {
            Self::Sketch(size) => of_pass.min((PHOTONS * size) as u64),
            Self::Half => of_pass / 8,
            Self::Full => of_pass / FULL_DIVISOR,
        }
        .max(1)
    }

    fn camera_samples(self) -> u64 {
        if matches!(self, Self::Sketch(_)) { CAMERA_SAMPLES } else { 1 }
    }
}

/// A coarse picture without bands and with unknown errors.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarsePicture {
    pub picture: Picture,
    pub photons: u64,
    /// The side length of a pixel in pixels of the film.
    pub factor: usize,
    /// The width and the height of the film in pixels.
    pub film: [usize; 2],
}

impl CoarsePicture {
    /// Returns the picture in the size of the film.
    pub fn enlarged(&self) -> Picture {
        let [width, height] = self.film;
        self.picture.enlarged(self.factor, (width, height))
    }
}

#[derive(Debug)]
struct CoarseScene {
    scene: Scene,
    plan: Plan,
    budget: Budget,
    /// The side length of a coarse pixel in pixels of the film.
    factor: u32,
}

/// Renders a sketch by path tracing. Returns `None` if the film has few pixels.
pub fn coarse_path_picture(context: &PassContext<'_>) -> Result<Option<CoarsePicture>> {
    let Some(coarse) = CoarseScene::of(context, context.scene, CoarseLevel::Sketch(1.0)) else { return Ok(None) };
    let passes = |context: PassContext<'_>, sums: &mut PassSums| {
        (0..CAMERA_SAMPLES).try_for_each(|pass| path_pass(context, pass, sums).map(|_| ()))
    };
    coarse.picture(context, passes).map(Some)
}

/// Renders with the emission distributions of a pilot, in the scene at one of its times. `None` if
/// the film has few pixels. After a picture that is not full, the pilot must measure the scene, and
/// before a full one.
pub(super) fn coarse_photon_picture(
    context: &PassContext<'_>,
    scene: &Scene,
    parameters: &mut PassParameters,
    level: CoarseLevel,
) -> Result<Option<CoarsePicture>> {
    let Some(coarse) = CoarseScene::of(context, scene, level) else { return Ok(None) };
    let pass = |context: PassContext<'_>, sums: &mut PassSums| {
        if level != CoarseLevel::Full {
            let visible = measure(parameters, &context, &[Cow::Borrowed(context.scene)]);
            measure_surface_extents(parameters, &context, context.scene, &visible);
        }
        parameters.camera_samples = CameraSamples::Same(level.camera_samples());
        photon_pass(context, parameters, &mut LightMaps::default(), 0, sums).map(|_| ())
    };
    coarse.picture(context, pass).map(Some)
}

impl CoarseScene {
    /// Reduces the film of the scene or a posed copy. `None` if the film has few pixels.
    fn of(context: &PassContext<'_>, scene: &Scene, level: CoarseLevel) -> Option<Self> {
        let factor = level.factor(scene.camera.pixel_count() as f64)?;
        let mut scene = scene.clone();
        scene.stop();
        scene.camera = scene.camera.coarser(factor);
        Some(Self {
            scene,
            plan: Plan { motion: MotionPlan::Still, ..context.plan.clone() },
            budget: Budget {
                photons: level.photons(context.budget.photons),
                light_map_cells: LIGHT_MAP_CELLS.min(context.budget.light_map_cells),
                ..context.budget.clone()
            },
            factor,
        })
    }

    fn picture(
        &self,
        full: &PassContext<'_>,
        passes: impl FnOnce(PassContext<'_>, &mut PassSums) -> Result<()>,
    ) -> Result<CoarsePicture> {
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
        Ok(CoarsePicture {
            picture: sums.film.picture(),
            photons: budget.photons,
            factor: *factor as usize,
            film: [scene.film.width as usize, scene.film.height as usize],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_become_finer_up_to_the_film() {
        let film = 320.0 * 180.0;
        let factor = |level: CoarseLevel| level.factor(film).unwrap();
        assert_eq!([0.25, 1.0, 4.0, 100.0].map(|size| factor(CoarseLevel::Sketch(size))), [8, 4, 2, 1]);
        assert_eq!([CoarseLevel::Half, CoarseLevel::Full].map(factor), [2, 1]);
        assert_eq!(CoarseLevel::Full.factor(160.0 * 120.0), None, "a small film has no coarse pictures");
        assert_eq!(CoarseLevel::Sketch(0.5).photons(200_000), 2_500);
        assert_eq!([CoarseLevel::Half, CoarseLevel::Full].map(|level| level.photons(200_000)), [25_000, 50_000]);
        assert_eq!(CoarseLevel::Full.photons(3), 1);
    }
}
