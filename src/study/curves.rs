//! Measures error against time for both integrators.

use super::convergence::ConvergencePoint;
use super::fit::PowerLawFit;
use super::monitor::StudyError;
use super::reference::MeanEstimate;
use super::reference_choice::ChosenReference;
use super::runner::{FinishedStep, RenderStep, Runner};
use super::study_scene::integrator_title;
use super::time_fractions::TIME_FRACTIONS;
use abbe_session::render::{Integrator, Job, Stats};
use abbe_transport::plan::{CausticPlan, IndirectPlan, Plan, VolumePlan};
use abbe_transport::sensor::Picture;
use serde::Serialize;

/// The error of an integrator as a function of passes and time.
#[derive(Debug, Clone, Serialize)]
pub struct ConvergenceCurve {
    /// `photon` or `path`.
    pub integrator: &'static str,
    pub points: Vec<ConvergencePoint>,
    /// The fitted slope of the error as a function of passes, in smooth regions, or over the whole
    /// picture if it has too few of them.
    pub fit: Option<PowerLawFit>,
    /// The fitted slope of the error as a function of the seconds of work, with the pilot.
    pub fit_seconds: Option<PowerLawFit>,
    /// The theoretical slopes of the estimators in use. They hold in smooth regions.
    pub theory: Vec<TheoreticalSlope>,
    /// The number of passes in the scene's settings.
    pub passes_wanted: u64,
    pub stats: Stats,
    #[serde(skip)]
    pub picture: Picture,
}

/// The theoretical slope of an estimator's mean square error as a function of passes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TheoreticalSlope {
    pub estimator: &'static str,
    pub slope: f64,
}

/// The fewest passes of a fit. Before, wavelengths and lens samples are not yet even.
pub(super) const FIRST_PASSES: u64 = 4;

impl ConvergenceCurve {
    /// Measures the curves of photon mapping and of the path tracer, in this order.
    pub(super) fn of_both(
        runner: &mut Runner<'_>,
        job: &Job,
        reference: &ChosenReference,
        budget_seconds: f64,
    ) -> Result<[Self; 2], StudyError> {
        let mut one = |integrator: Integrator, fraction: f64, theory: Vec<TheoreticalSlope>| {
            let words = format!("error against time, {}", integrator_title(integrator.word()));
            let step = RenderStep::new(&format!("curve-{}", integrator.word()), &words, fraction * budget_seconds)
                .with_integrator(integrator);
            Ok::<Self, StudyError>(Self::new(integrator, runner.render(&step, reference.identified())?, theory))
        };
        let unbiased = TheoreticalSlope { estimator: "unbiased", slope: -1.0 };
        Ok([
            one(Integrator::Photon, TIME_FRACTIONS.photon_curve, theory(&job.plan))?,
            one(Integrator::Path, TIME_FRACTIONS.path_curve, vec![unbiased])?,
        ])
    }

    fn new(integrator: Integrator, step: FinishedStep, theory: Vec<TheoreticalSlope>) -> Self {
        let result = step.result;
        let fitted = |across: fn(&ConvergencePoint) -> f64| {
            let points = result.points.iter().filter(|point| point.passes >= FIRST_PASSES);
            let significant = points.filter(|point| error_to_fit(point).is_significant());
            PowerLawFit::of(significant.map(|point| (across(point), error_to_fit(point).value)))
        };
        Self {
            integrator: integrator.word(),
            fit: fitted(|point| point.passes as f64),
            fit_seconds: fitted(|point| point.seconds),
            points: result.points,
            theory,
            passes_wanted: result.passes_wanted,
            stats: result.stats,
            picture: step.picture,
        }
    }

    /// Returns the different slopes, from the least steep one, which dominates after many passes.
    pub fn slopes_in_theory(&self) -> Vec<f64> {
        let mut slopes: Vec<f64> = self.theory.iter().map(|theory| theory.slope).collect();
        slopes.sort_by(|a, b| b.total_cmp(a));
        slopes.dedup();
        slopes
    }
}

/// Returns the error in smooth regions, or over the whole picture if it has too few of them.
pub fn error_to_fit(point: &ConvergencePoint) -> MeanEstimate {
    point.error.smooth.unwrap_or(point.error.whole)
}

/// Returns the estimators of a plan, with the slopes for two-dimensional and one-dimensional
/// kernels of Knaus & Zwicker 2011.
fn theory(plan: &Plan) -> Vec<TheoreticalSlope> {
    // Caustics also need kernels if they are seen through glass or in mirrors.
    let on_surfaces = plan.indirect == IndirectPlan::Photons || plan.caustics == CausticPlan::Photons;
    let (points, beams) = match plan.volume {
        VolumePlan::Absent => (false, false),
        VolumePlan::Points => (true, false),
        VolumePlan::Beams => (false, true),
        VolumePlan::ByDensity => (true, true),
    };
    let kernels = [
        (on_surfaces, TheoreticalSlope { estimator: "photons on surfaces", slope: -2.0 / 3.0 }),
        (points, TheoreticalSlope { estimator: "beam radiance estimate", slope: -2.0 / 3.0 }),
        (beams, TheoreticalSlope { estimator: "photon beams", slope: -0.8 }),
        (true, TheoreticalSlope { estimator: "estimators without kernels", slope: -1.0 }),
    ];
    kernels.into_iter().filter(|(takes_part, _)| *takes_part).map(|(_, theory)| theory).collect()
}
