//! Error against time, for both integrators.

use super::course::{Done, Order, Point, Workshop};
use super::fit::Fit;
use super::reference::Estimate;
use super::report::title_of;
use super::truth::Truth;
use super::{Halt, SHARES};
use crate::plan::{CausticPlan, IndirectPlan, Plan, VolumePlan};
use crate::render::{Integrator, Job, Stats};
use crate::sensor::Picture;
use serde::Serialize;

/// How an integrator's error falls.
#[derive(Debug, Clone, Serialize)]
pub struct Curve {
    /// `photon` or `path`.
    pub integrator: &'static str,
    /// How it stood after some passes.
    pub points: Vec<Point>,
    /// The slope of the error in smooth regions (of the whole picture where there are too few) against passes.
    pub fit: Option<Fit>,
    /// The same against seconds of work, pilot included.
    pub fit_seconds: Option<Fit>,
    /// What theory says of the estimators that take part, in smooth regions.
    pub theory: Vec<Theory>,
    /// The passes that the scene's settings ask for.
    pub passes_wanted: u64,
    /// What the longest render measured of itself.
    pub stats: Stats,
    /// Its picture.
    #[serde(skip)]
    pub picture: Picture,
}

/// The slope of an estimator's mean square error over passes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Theory {
    /// The estimator.
    pub estimator: &'static str,
    /// Its slope.
    pub slope: f64,
}

/// Fits leave out the first passes, whose wavelengths and places on the lens are not spread evenly yet.
pub(super) const FIRST_PASSES: u64 = 4;

impl Curve {
    /// Both integrators' curves, the photons' first.
    pub(super) fn of_both(
        workshop: &mut Workshop<'_>,
        job: &Job,
        truth: &Truth,
        budget: f64,
    ) -> Result<[Self; 2], Halt> {
        let mut one = |integrator: Integrator, share: f64, theory: Vec<Theory>| {
            let words = format!("error against time, {}", title_of(integrator.word()));
            let order = Order::new(&format!("curve-{}", integrator.word()), &words, share * budget).by(integrator);
            Ok::<Self, Halt>(Self::new(integrator, workshop.render(&order, truth.measure())?, theory))
        };
        let unbiased = Theory { estimator: "unbiased", slope: -1.0 };
        Ok([
            one(Integrator::Photon, SHARES.photon_curve, theory(&job.plan))?,
            one(Integrator::Path, SHARES.path_curve, vec![unbiased])?,
        ])
    }

    fn new(integrator: Integrator, done: Done, theory: Vec<Theory>) -> Self {
        let found = done.found;
        let fitted = |across: fn(&Point) -> f64| {
            let points = found.points.iter().filter(|point| point.passes >= FIRST_PASSES);
            let certain = points.filter(|point| error_to_fit(point).is_certain());
            Fit::of(certain.map(|point| (across(point), error_to_fit(point).value)))
        };
        Self {
            integrator: integrator.word(),
            fit: fitted(|point| point.passes as f64),
            fit_seconds: fitted(|point| point.seconds),
            points: found.points,
            theory,
            passes_wanted: found.passes_wanted,
            stats: found.stats,
            picture: done.picture,
        }
    }

    /// The slopes of its estimators, each once, the least steep first: that one decides in the end.
    pub fn slopes_in_theory(&self) -> Vec<f64> {
        let mut slopes: Vec<f64> = self.theory.iter().map(|theory| theory.slope).collect();
        slopes.sort_by(|a, b| b.total_cmp(a));
        slopes.dedup();
        slopes
    }
}

/// In smooth regions, or over the whole picture where there are too few.
pub fn error_to_fit(point: &Point) -> Estimate {
    point.wrong.smooth.unwrap_or(point.wrong.whole)
}

/// The estimators that take part in a plan, with the slopes of Knaus & Zwicker 2011 for kernels of two and of one dimension.
fn theory(plan: &Plan) -> Vec<Theory> {
    // Caustics too need kernels where they are seen through glass or in mirrors.
    let on_surfaces = plan.indirect == IndirectPlan::Photons || plan.caustics == CausticPlan::Photons;
    let (points, beams) = match plan.volume {
        VolumePlan::Absent => (false, false),
        VolumePlan::Points => (true, false),
        VolumePlan::Beams => (false, true),
        VolumePlan::ByDensity => (true, true),
    };
    let kernels = [
        (on_surfaces, Theory { estimator: "photons on surfaces", slope: -2.0 / 3.0 }),
        (points, Theory { estimator: "beam radiance estimate", slope: -2.0 / 3.0 }),
        (beams, Theory { estimator: "photon beams", slope: -0.8 }),
        (true, Theory { estimator: "light without a kernel", slope: -1.0 }),
    ];
    kernels.into_iter().filter(|(takes_part, _)| *takes_part).map(|(_, theory)| theory).collect()
}
