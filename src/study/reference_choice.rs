//! Chooses the integrator of the reference, and renders the reference.
//!
//! The noise of a reference can be measured and subtracted, but its bias cannot. The path tracer
//! has no bias, so it renders the reference if it can find all light in time. Otherwise photon
//! mapping does, with kernels of a tenth of the usual area, which have a tenth of the usual bias
//! but more noise.

use super::monitor::StudyError;
use super::reference::ReferencePicture;
use super::runner::{FinishedStep, RenderStep, Runner};
use super::study_scene::integrator_title;
use super::time_fractions::TIME_FRACTIONS;
use abbe_format::SceneFile;
use abbe_scene::facts::Facts;
use abbe_session::render::{Integrator, Job};
use abbe_spectra::math::elementary::powf;
use abbe_transport::sensor::Picture;
use serde::Serialize;

#[derive(Debug, Clone)]
pub struct ChosenReference {
    pub reference: ReferencePicture,
    pub provenance: ReferenceProvenance,
    /// Identifies the picture in the step cache.
    pub(super) identity: String,
}

/// The method and the accuracy of a reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceProvenance {
    /// `path`, `photon` or `given`.
    pub origin: &'static str,
    pub because: String,
    /// The number of passes of both halves together, or 0 for a given picture.
    pub passes: u64,
    /// The total time of both halves in seconds, or 0 for a given picture.
    pub seconds: f64,
    /// The relative variance of the reference, which is subtracted from every error.
    pub relative_variance: f64,
    /// The relative variance in smooth regions, or null if too few pixels are in smooth regions.
    pub smooth_relative_variance: Option<f64>,
    /// The mean square of the reference's own bias estimate, divided by the same unit as the
    /// errors; 0 for the path tracer. Errors near this value cannot be measured.
    pub relative_bias_square: f64,
    /// The fraction of the pixels in smooth regions.
    #[serde(rename = "smooth_share")]
    pub smooth_fraction: Option<f64>,
    /// Why the path tracer cannot find some of the light, or null if it finds all.
    #[serde(rename = "out_of_reach")]
    pub unreachable_light: Option<String>,
}

/// The kernel area of a photon-mapped reference, relative to the scene's settings.
const KERNEL_AREA_RATIO: f64 = 0.1;

const HALVES: [u64; 2] = [101, 102];

/// Seed offsets of the two trial renders of each integrator.
const TRIALS: [u64; 2] = [201, 202];

struct ReferenceOrigin {
    /// `path`, `photon` or `given`.
    integrator: &'static str,
    because: String,
    passes: u64,
    seconds: f64,
    unreachable_light: Option<String>,
}

/// Returns the number of renders that choose the integrator and render the reference.
pub(super) fn steps(job: &Job, given: Option<&(String, Picture)>) -> usize {
    match (given, unreachable_light(&Facts::of(&job.scene))) {
        (Some(_), _) => 0,
        (None, Some(_)) => 2,
        (None, None) => 6,
    }
}

pub(super) fn seed(job: &Job, offset: u64) -> String {
    format!("render.seed={}", job.budget.seed.number().wrapping_add(offset) % (1 << 53))
}

impl ChosenReference {
    /// Uses the given reference, or renders one.
    pub(super) fn find(
        runner: &mut Runner<'_>,
        scene_file: &SceneFile,
        job: &Job,
        given: Option<&(String, Picture)>,
        budget_seconds: f64,
    ) -> Result<Self, StudyError> {
        let unreachable_light = unreachable_light(&Facts::of(&job.scene));
        if let Some((name, picture)) = given {
            let because = format!("{name}, as requested; its noise is that of its error layer");
            let identity = format!("{name} {:?}", picture.mean_y());
            let origin = ReferenceOrigin { integrator: "given", because, passes: 0, seconds: 0.0, unreachable_light };
            return Ok(Self::new(ReferencePicture::given(picture.clone()), origin, identity));
        }
        let (integrator, because) = match &unreachable_light {
            Some(reason) => (Integrator::Photon, reason.clone()),
            None => try_both(runner, job, budget_seconds)?,
        };
        let narrow = (integrator == Integrator::Photon).then(|| narrow_kernels(scene_file, job));
        let halves = HALVES.iter().zip(["one", "two"]).map(|(&offset, half)| {
            let words = format!("reference by {}, half {half}", integrator_title(integrator.word()));
            let seconds = 0.5 * TIME_FRACTIONS.reference * budget_seconds;
            let step = RenderStep::new(&format!("reference-{half}"), &words, seconds).with_integrator(integrator);
            let step = step.with_changes([seed(job, offset)]).with_changes(narrow.clone());
            let identity = runner.identity(&step, &[], None);
            runner.render(&step, None).map(|half| (half, identity))
        });
        let halves: Vec<(FinishedStep, String)> = halves.collect::<Result<_, StudyError>>()?;
        let reference = ReferencePicture::of_halves([&halves[0].0.picture, &halves[1].0.picture]);
        let passes = halves.iter().map(|(half, _)| half.result.stats.passes).sum();
        let seconds = halves.iter().map(|(half, _)| half.result.stats.seconds.total).sum();
        // A time limit ends each half, so two halves with equal settings may have different passes.
        // The identity therefore contains the passes and the time.
        let identity = format!("{} {passes} {seconds:?}", halves[0].1);
        let origin = ReferenceOrigin { integrator: integrator.word(), because, passes, seconds, unreachable_light };
        Ok(Self::new(reference, origin, identity))
    }

    fn new(reference: ReferencePicture, origin: ReferenceOrigin, identity: String) -> Self {
        let own = reference.own_variance();
        let provenance = ReferenceProvenance {
            origin: origin.integrator,
            because: origin.because,
            passes: origin.passes,
            seconds: origin.seconds,
            relative_variance: own.whole.value,
            smooth_relative_variance: own.smooth.map(|smooth| smooth.value),
            relative_bias_square: reference.estimated_bias_square(),
            smooth_fraction: reference.smooth_fraction(),
            unreachable_light: origin.unreachable_light,
        };
        Self { reference, provenance, identity }
    }

    pub(super) fn identified(&self) -> Option<(&ReferencePicture, &str)> {
        Some((&self.reference, &self.identity))
    }
}

/// Returns a change that shrinks the kernels to a tenth of their area, by the number of photons
/// within the first radius, or by the radius itself if the scene fixes it.
fn narrow_kernels(scene_file: &SceneFile, job: &Job) -> String {
    match scene_file.render.radius {
        Some(radius) => format!("render.radius={}", KERNEL_AREA_RATIO.sqrt() * radius),
        None => {
            format!("render.nearest={}", ((f64::from(job.budget.nearest) * KERNEL_AREA_RATIO).round() as u32).max(4))
        }
    }
}

/// Returns why the path tracer cannot find some of the light, or `None`. It finds light through
/// glass or from mirrors only if a path hits the light by chance.
fn unreachable_light(facts: &Facts) -> Option<String> {
    let cannot_be_hit = |name: &&String| !facts.hittable_lights.contains(name);
    let (lamp, glass) = (facts.lights.iter().find(cannot_be_hit)?, facts.specular.first()?);
    Some(format!(
        "no path from the camera can hit {lamp} by chance, so the path tracer never finds its light through {glass}"
    ))
}

/// Renders trials with both integrators, and predicts their errors for the time of the reference.
/// Returns the integrator and the reason: photon mapping if the path tracer misses light in its
/// trial, or if its predicted error is more than four times that of photon mapping, and the path
/// tracer otherwise.
fn try_both(runner: &mut Runner<'_>, job: &Job, budget_seconds: f64) -> Result<(Integrator, String), StudyError> {
    let seconds = TIME_FRACTIONS.trial * budget_seconds / 4.0;
    let mut pair = |integrator: Integrator| -> Result<ReferencePicture, StudyError> {
        let mut one = |offset: u64, half: &str| {
            let name = format!("trial-{}-{half}", integrator.word());
            let words = format!("trial of {}, {half}", integrator_title(integrator.word()));
            let step =
                RenderStep::new(&name, &words, seconds).with_integrator(integrator).with_changes([seed(job, offset)]);
            runner.render(&step, None)
        };
        let halves = [one(TRIALS[0], "one")?, one(TRIALS[1], "two")?];
        Ok(ReferencePicture::of_halves([&halves[0].picture, &halves[1].picture]))
    };
    let (photon, path) = (pair(Integrator::Photon)?, pair(Integrator::Path)?);
    // The time of the reference divided by that of both trials of one integrator. The variance
    // falls in inverse proportion.
    let longer = TIME_FRACTIONS.reference * budget_seconds / (2.0 * seconds);
    let (variance, photon_error) =
        (path.own_variance().whole.value, photon.own_variance().whole.value + photon.estimated_bias_square());
    // The difference between the two pictures, minus the path tracer's noise, is light that the
    // path tracer has not found yet, and the bias of photon mapping.
    let apart = photon.error_of(&path.picture).whole;
    let missing = apart.value - variance;
    let has_glass = !Facts::of(&job.scene).specular.is_empty();
    let misses = has_glass && missing > 4.0 * photon_error.max(variance) && missing > 3.0 * apart.standard_error;
    let (path_then, photon_then) = (variance / longer, photon_error / powf(longer, 2.0 / 3.0));
    Ok(if misses {
        let because = format!(
            "in a trial, the path tracer did not find all light through glass: its relative mean square difference from photon mapping was {:.3}, {:.1} times its noise",
            apart.value,
            apart.value / variance
        );
        (Integrator::Photon, because)
    } else if path_then > 4.0 * photon_then {
        let because = format!(
            "after the time of the reference, the relative variance of the path tracer would be {path_then:.1e}, much more than the error {photon_then:.1e} of photon mapping"
        );
        (Integrator::Photon, because)
    } else {
        (Integrator::Path, format!("it has no bias, and would reach a relative variance of {path_then:.1e}"))
    })
}
