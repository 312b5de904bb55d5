//! The pilot's trials of the lights of a scene with many lights.

use crate::gather::{DirectLighting, LightSelector};
use crate::pass::{PassContext, StageSeconds};
use abbe_spectra::math::random::Purpose;
use rayon::prelude::*;
use std::borrow::Cow;
use web_time::Instant;

/// The largest number of camera paths.
const MOST_PATHS: u64 = 1 << 17;

/// The number of camera paths of a small film.
const FEWEST_PATHS: u64 = 1 << 12;

const TASK: u64 = 256;

/// Returns the selector with learned weights, if the scene has many local lights, and adds the
/// duration to `seconds`. The camera paths are half as many as the pixels, so that the trials take
/// a small part of the time of the first eight passes. The flag of the context ends them early.
pub fn learn_lights<'a>(context: &PassContext<'a>, seconds: &mut StageSeconds) -> Cow<'a, LightSelector> {
    let PassContext { scene, selector, plan, .. } = *context;
    if !selector.learns() || plan.direct.is_absent() {
        return Cow::Borrowed(selector);
    }
    let start = Instant::now();
    let streams = context.budget.seed.streams(Purpose::LightTrial);
    let direct = DirectLighting::new(scene, selector, plan.media_plan).with_portals(context.portals);
    let paths = (scene.camera.pixel_count() as u64 / 2).clamp(FEWEST_PATHS, MOST_PATHS) / TASK * TASK;
    let trials = |task: u64| match context.stop.is_raised() {
        true => Vec::new(),
        false => direct.light_trials(streams, task * TASK..(task + 1) * TASK, paths),
    };
    let trials = (0..paths / TASK).into_par_iter().map(trials).collect::<Vec<_>>().concat();
    let learned = selector.learned_from(&trials);
    seconds.pilot += start.elapsed().as_secs_f64();
    Cow::Owned(learned)
}
