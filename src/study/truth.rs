//! Who renders the reference, and how good it is.
//!
//! Noise that a reference has can be measured and taken off; bias cannot. So the path tracer, which has none, renders it where it can find all
//! light in time, and elsewhere the photon integrator with kernels of a tenth of the area: a tenth of the bias, for more noise.

use super::course::{Done, Order, Workshop};
use super::reference::{Reference, Wrong};
use super::report::title_of;
use super::{Halt, SHARES};
use crate::render::{Integrator, Job};
use crate::scene::facts::Facts;
use crate::scene::file::SceneFile;
use crate::sensor::Picture;
use serde::Serialize;

/// A reference and what is known of it.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The reference.
    pub reference: Reference,
    /// Where it comes from.
    pub account: Account,
    /// Tells it from any other.
    pub(super) identity: String,
}

/// Where a reference comes from, and how good it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Account {
    /// `path`, `photon` or `given`.
    pub origin: &'static str,
    /// Why.
    pub because: String,
    /// Passes, of both halves together; 0 if it was given.
    pub passes: u64,
    /// Seconds, of both halves together; 0 if it was given.
    pub seconds: f64,
    /// Its own relative variance, which is taken off every error.
    pub relative_variance: f64,
    /// The same in smooth regions; null where there are too few.
    pub smooth_relative_variance: Option<f64>,
    /// The square of the bias that it claims, relative as errors are; errors near it cannot be told. 0 for the path tracer.
    pub relative_bias_square: f64,
    /// The share of pixels in smooth regions.
    pub smooth_share: Option<f64>,
    /// Which light the path tracer never finds, if there is any.
    pub out_of_reach: Option<String>,
}

/// The photon integrator's reference has kernels of this share of the scene's area.
const KERNEL_SHARE: f64 = 0.1;

/// Seeds of their own: the halves of the reference, the trials.
const HALVES: [u64; 2] = [101, 102];
const TRIALS: [u64; 2] = [201, 202];

/// How many renders finding the reference takes.
pub(super) fn steps(job: &Job, given: Option<&(String, Picture)>) -> usize {
    match (given, out_of_reach(&Facts::of(&job.scene))) {
        (Some(_), _) => 0,
        (None, Some(_)) => 2,
        (None, None) => 6,
    }
}

/// A change of the seed.
pub(super) fn seed(job: &Job, offset: u64) -> String {
    format!("render.seed={}", job.budget.seed.wrapping_add(offset) % (1 << 53))
}

impl Truth {
    /// Takes the given reference, or renders one.
    pub(super) fn find(
        workshop: &mut Workshop<'_>,
        (written, job): (&SceneFile, &Job),
        given: Option<&(String, Picture)>,
        budget: f64,
    ) -> Result<Self, Halt> {
        let out_of_reach = out_of_reach(&Facts::of(&job.scene));
        if let Some((name, picture)) = given {
            let because = format!("{name}, as asked; its noise is what its error layer says");
            let identity = format!("{name} {:?}", picture.mean_y());
            return Ok(Self::new(
                Reference::given(picture.clone()),
                ("given", because),
                (0, 0.0),
                (identity, out_of_reach),
            ));
        }
        let (integrator, because) = match &out_of_reach {
            Some(reason) => (Integrator::Photon, reason.clone()),
            None => try_both(workshop, job, budget)?,
        };
        let narrow = (integrator == Integrator::Photon).then(|| narrow_kernels(written, job));
        let halves = HALVES.iter().zip(["one", "two"]).map(|(&offset, half)| {
            let words = format!("reference by {}, half {half}", title_of(integrator.word()));
            let seconds = 0.5 * SHARES.reference * budget;
            let order = Order::new(&format!("reference-{half}"), &words, seconds).by(integrator);
            let order = order.changed([seed(job, offset)]).changed(narrow.clone());
            let identity = workshop.identity(&order, &[], None);
            workshop.render(&order, None).map(|done| (done, identity))
        });
        let halves: Vec<(Done, String)> = halves.collect::<Result<_, Halt>>()?;
        let reference = Reference::of_halves([&halves[0].0.picture, &halves[1].0.picture]);
        let passes = halves.iter().map(|(half, _)| half.found.stats.passes).sum();
        let seconds = halves.iter().map(|(half, _)| half.found.stats.seconds.total).sum();
        // Halves of the same settings may differ, since time decided on their passes.
        let identity = format!("{} {passes} {seconds:?}", halves[0].1);
        Ok(Self::new(reference, (integrator.word(), because), (passes, seconds), (identity, out_of_reach)))
    }

    fn new(
        reference: Reference,
        (origin, because): (&'static str, String),
        (passes, seconds): (u64, f64),
        (identity, out_of_reach): (String, Option<String>),
    ) -> Self {
        let own = reference.own_variance();
        let account = Account {
            origin,
            because,
            passes,
            seconds,
            relative_variance: own.whole.value,
            smooth_relative_variance: own.smooth.map(|smooth| smooth.value),
            relative_bias_square: reference.claimed_bias_square(),
            smooth_share: reference.smooth_share(),
            out_of_reach,
        };
        Self { reference, account, identity }
    }

    /// How wrong a picture is against it.
    pub fn wrong(&self, picture: &Picture) -> Wrong {
        self.reference.wrong(picture)
    }

    /// The reference with its identity, for renders to be measured by.
    pub(super) fn measure(&self) -> Option<(&Reference, &str)> {
        Some((&self.reference, &self.identity))
    }
}

/// Kernels of a tenth of the area: the photons within the first radius, or that radius itself where the scene fixes it.
fn narrow_kernels(written: &SceneFile, job: &Job) -> String {
    match written.render.radius {
        Some(radius) => format!("render.radius={}", KERNEL_SHARE.sqrt() * radius),
        None => format!("render.nearest={}", ((f64::from(job.budget.nearest) * KERNEL_SHARE).round() as u32).max(4)),
    }
}

/// Why the path tracer cannot find some of the light, if it cannot: light that comes through glass or from mirrors is found only by paths that
/// hit the lamp by themselves.
fn out_of_reach(facts: &Facts) -> Option<String> {
    let by_itself = |name: &&String| !facts.hittable_lights.contains(name);
    let (lamp, glass) = (facts.lights.iter().find(by_itself)?, facts.specular.first()?);
    Some(format!(
        "no path from the camera can hit {lamp} by itself, so that the path tracer never finds its light through {glass}"
    ))
}

/// Lets both integrators try, and chooses by what their errors would be after the reference's time.
fn try_both(workshop: &mut Workshop<'_>, job: &Job, budget: f64) -> Result<(Integrator, String), Halt> {
    let seconds = SHARES.trial * budget / 4.0;
    let mut pair = |integrator: Integrator| -> Result<Reference, Halt> {
        let mut one = |offset: u64, half: &str| {
            let name = format!("trial-{}-{half}", integrator.word());
            let words = format!("trial of {}, {half}", title_of(integrator.word()));
            let order = Order::new(&name, &words, seconds).by(integrator).changed([seed(job, offset)]);
            workshop.render(&order, None)
        };
        let halves = [one(TRIALS[0], "one")?, one(TRIALS[1], "two")?];
        Ok(Reference::of_halves([&halves[0].picture, &halves[1].picture]))
    };
    let (photon, path) = (pair(Integrator::Photon)?, pair(Integrator::Path)?);
    // How much longer the reference takes than a trial: variance falls with it.
    let longer = SHARES.reference * budget / (2.0 * seconds);
    let (variance, photon_error) =
        (path.own_variance().whole.value, photon.own_variance().whole.value + photon.claimed_bias_square());
    // What separates the two beyond the path tracer's noise is light that it has not found yet, or the photons' bias.
    let apart = photon.wrong(&path.picture).whole;
    let missing = apart.value - variance;
    let has_glass = !Facts::of(&job.scene).specular.is_empty();
    let misses = has_glass && missing > 4.0 * photon_error.max(variance) && missing > 3.0 * apart.standard_error;
    let (path_then, photon_then) = (variance / longer, photon_error / longer.powf(2.0 / 3.0));
    Ok(if misses {
        let because = format!(
            "in a trial the path tracer had not found all light through glass: it was {:.3} (relative square) from the photons' picture, {:.1} times what noise explains",
            apart.value,
            apart.value / variance
        );
        (Integrator::Photon, because)
    } else if path_then > 4.0 * photon_then {
        let because = format!(
            "after that time the path tracer's own relative variance would be {path_then:.1e}, much more than the photon integrator's error of {photon_then:.1e}"
        );
        (Integrator::Photon, because)
    } else {
        (Integrator::Path, format!("it has no bias, and would be good to a relative variance of {path_then:.1e}"))
    })
}
