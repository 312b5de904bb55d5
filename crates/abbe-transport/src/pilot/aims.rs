//! Learns emission distributions, which send more photons where they contribute.

use super::guiding_spheres::GuidingSpheres;
use super::importance::{GridLayout, Importance};
use crate::emit::{EmissionStrata, WavelengthSampling, trace};
use crate::pass::{EmissionRequest, PassContext};
use crate::walk::ledger::Ledger;
use abbe_optics::bsdf::BsdfClass;
use abbe_scene::Scene;
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::math::random::Purpose;
use rayon::prelude::*;
use std::borrow::Cow;

/// The pilot paths per stratum in each round, which emits photons as the preceding round learned.
/// If that learned nothing, the rounds end.
pub(crate) const PATHS_PER_STRATUM: &[u64] = &[1 << 14, 1 << 15];

/// The pilot paths of all strata for a sketch while the reader moves something, in one round. Each
/// half of the paths needs a task.
pub(super) const PATHS_FOR_SKETCH: u64 = 2 * PATHS_PER_TASK;

/// The number of paths per round grows with the number of strata, up to this many strata.
const MAX_STRATA: u64 = 4;

/// The largest number of paths per round, as a fraction of a pass. Both rounds together then take
/// at most a tenth of the time of eight passes.
const LARGEST_ROUND: f64 = 0.4;

/// The photon paths of one parallel task, which fix the order in which results are added.
const PATHS_PER_TASK: u64 = 4096;

/// The fraction of the photons that strata receive in proportion to their contributions.
const BY_CONTRIBUTION: f64 = 0.5;

/// The fraction of the photons that all contributing strata receive in equal parts. A small caustic
/// contributes little to the whole picture, but it is bright.
const BY_STRATUM: f64 = 0.3;

pub(crate) struct LearnedAims {
    pub(crate) strata: EmissionStrata,
    /// The names of the specular objects that no photon reached.
    pub(crate) unlit: Vec<String>,
}

impl LearnedAims {
    /// Returns strata that follow the emission distributions of the lights.
    pub(crate) fn plain(context: &PassContext<'_>) -> Self {
        Self { strata: EmissionStrata::plain(&context.lights.lights), unlit: Vec::new() }
    }
}

/// Learns from photons traced in the scene at several times, in rounds of so many paths per
/// stratum.
pub(crate) fn learn_aims(context: &PassContext<'_>, scenes: &[Cow<'_, Scene>], rounds: &[u64]) -> LearnedAims {
    let (spheres, lights) = (GuidingSpheres::new(scenes, &context.portals.all()), &context.lights.lights);
    let (extent, count) = (context.scene.extent(), context.scene.lights.len() as f64);
    // Half of the pilot's paths belong to all lights in equal parts, so that it finds the dim ones.
    let probability = |light: usize| 0.5 * (lights.probability(light) + 1.0 / count);
    let spheres = [&spheres.inner[..], &spheres.outer];
    let strata = EmissionStrata::new(&context.scene.lights, extent, spheres, probability);
    let Some(mut strata) = strata else { return LearnedAims::plain(context) };
    let counted = (strata.list.len() as u64).min(MAX_STRATA);
    let affordable = (LARGEST_ROUND * context.budget.photons as f64) as u64;
    let mut reached = Vec::new();
    let mut contributions = Vec::new();
    for (round, &per_stratum) in (0..).zip(rounds) {
        // The paths of one stratum take a fraction of a second.
        let paths = (counted * per_stratum).min(affordable.max(per_stratum));
        let layout = GridLayout::new(&strata, paths);
        let found = trace_round(context, scenes, &strata, &layout, (round, paths));
        contributions.clear();
        for (number, stratum) in strata.list.iter_mut().enumerate() {
            let (aim, mean_score) = found.aim(number);
            stratum.aim = aim;
            contributions.push(stratum.fraction * lights.probability(stratum.light) * mean_score);
        }
        reached = found.reached;
        if strata.list.iter().all(|stratum| stratum.aim.is_plain()) {
            // The next round would emit its photons as this one.
            break;
        }
    }
    let sum: f64 = contributions.iter().sum();
    let contributing = contributions.iter().filter(|&&contribution| contribution > 0.0).count();
    if sum > 0.0 {
        let fractions = strata.list.iter().zip(&contributions).map(|(stratum, &contribution)| {
            let unlearned = stratum.fraction * lights.probability(stratum.light);
            let equal = if contribution > 0.0 { BY_STRATUM / contributing as f64 } else { 0.0 };
            BY_CONTRIBUTION * contribution / sum + equal + (1.0 - BY_CONTRIBUTION - BY_STRATUM) * unlearned
        });
        strata.choice = DiscreteDistribution::new(fractions).unwrap_or(strata.choice);
    }
    LearnedAims { strata, unlit: unlit_objects(context.scene, &reached) }
}

fn unlit_objects(scene: &Scene, reached: &[bool]) -> Vec<String> {
    let enclosures = scene.enclosures();
    let objects = (0..).zip(&scene.objects).zip(reached);
    let unlit = objects.filter(|((number, _), reached)| {
        let mut components = scene.material_of(*number).surface.components();
        !**reached
            && !enclosures.contains_key(number)
            && components.any(|component| component.class() == BsdfClass::Specular)
    });
    unlit.map(|((_, object), _)| object.name.clone()).collect()
}

/// Traces the photons of a round. `round` contains the number of the round and of its paths.
fn trace_round<'a>(
    context: &PassContext<'a>,
    scenes: &'a [Cow<'_, Scene>],
    strata: &EmissionStrata,
    layout: &'a GridLayout,
    (round, count): (u64, u64),
) -> Importance<'a> {
    let tasks = count.div_ceil(PATHS_PER_TASK);
    let request =
        EmissionRequest { wavelengths: WavelengthSampling::Free, count, purpose: Purpose::AimPhoton, pass: round };
    let parts = (0..tasks)
        .into_par_iter()
        .map(|task: u64| {
            let scene = &scenes[(task * scenes.len() as u64 / tasks) as usize];
            let source = context.photon_source(scene, strata, request);
            let points = source.points();
            let mut part = Importance::new(scene, layout, task);
            let mut ledger = Ledger::new(context.scene.materials.len());
            for index in task * PATHS_PER_TASK..((task + 1) * PATHS_PER_TASK).min(count) {
                trace(&source, &points, index..index + 1, &mut part, &mut ledger);
                part.end_path();
            }
            part
        })
        .collect::<Vec<_>>();
    let mut whole = Importance::new(context.scene, layout, 0);
    parts.iter().for_each(|part| whole.add(part));
    whole
}
