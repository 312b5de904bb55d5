//! Recommends settings for wanted errors, and predicts the time on this machine.

use super::convergence::ConvergencePoint;
use super::curves::ConvergenceCurve;
use super::film::StudyFilm;
use super::fit::PowerLawFit;
use super::reference_choice::ReferenceProvenance;
use super::study_scene::{RenderSettings, StudyScene};
use super::sweep::{RenderTime, SettingSweep};
use abbe_session::render::Integrator;
use abbe_spectra::math::elementary::{exp, ln, powf};
use serde::Serialize;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recommendation {
    /// The wanted error of a typical pixel, to which `abbe render --target-error` refers too.
    pub typical_error: f64,
    /// The relative mean square error over all pixels after these passes.
    pub relative_mse: f64,
    pub settings: String,
    pub passes: u64,
    /// The shell command that renders with these settings at the scene's own film size.
    pub command: String,
    pub seconds: f64,
    /// The seconds at the scene's own film size. They are extrapolated from the number of pixels.
    pub seconds_own_film: f64,
    /// No measured render reached the error: the numbers are extrapolated.
    pub extrapolated: bool,
}

/// The errors of a typical pixel in the table.
pub const ERRORS: [f64; 6] = [0.3, 0.2, 0.1, 0.05, 0.02, 0.01];

/// The limit of extrapolation, as a multiple of the passes of the last measured point.
const MAX_EXTRAPOLATION: f64 = 1000.0;

struct TriedSettings<'a> {
    settings: RenderSettings,
    points: Vec<&'a ConvergencePoint>,
    render_time: RenderTime,
    /// The slope of the error beyond the measurements, or `None` if the error hardly falls.
    slope: Option<f64>,
}

/// Returns the theoretical slope, or that of the last points if their errors fall more slowly, or
/// `None` if they hardly fall.
fn slope_at_the_end(points: &[&ConvergencePoint], curve: &ConvergenceCurve) -> Option<f64> {
    const LAST_POINTS: usize = 4;
    const SHALLOWEST: f64 = -0.3;
    let last = points[points.len().saturating_sub(LAST_POINTS)..].iter();
    let fit = PowerLawFit::of(last.map(|point| (point.passes as f64, point.error.typical.value)))?;
    (fit.slope < SHALLOWEST).then(|| curve.slopes_in_theory().into_iter().fold(fit.slope, f64::max))
}

/// Recommends settings for each error of [`ERRORS`] that can be predicted.
pub(super) fn table(
    study_scene: &StudyScene,
    film: &StudyFilm,
    reference: &ReferenceProvenance,
    curves: &[ConvergenceCurve; 2],
    sweep: &SettingSweep,
) -> Vec<Recommendation> {
    let photons = sweep.runs.iter().map(|run| (run.settings(), &run.points, run.render_time, &curves[0]));
    let path = RenderSettings { integrator: Integrator::Path, change: None };
    // The path tracer is not recommended if it can never find some of the light.
    let finds_all = reference.unreachable_light.is_none();
    let path = finds_all.then(|| (path, &curves[1].points, RenderTime::of(&curves[1].stats), &curves[1]));
    let tried: Vec<TriedSettings<'_>> = photons
        .chain(path)
        .map(|(settings, points, render_time, curve)| {
            let points: Vec<&ConvergencePoint> =
                points.iter().filter(|point| point.error.typical.is_significant()).collect();
            let slope = slope_at_the_end(&points, curve);
            TriedSettings { settings, points, render_time, slope }
        })
        .collect();
    let row = |&typical_error: &f64| {
        let error = typical_error * typical_error;
        let reached = tried.iter().filter_map(|tried| Some((tried.passes_to(error)?, tried, false)));
        let reached = reached.min_by(|a, b| a.1.seconds(a.0).total_cmp(&b.1.seconds(b.0)));
        let beyond = || {
            let all = tried.iter().filter_map(|tried| Some((tried.passes_beyond(error)?, tried, true)));
            all.min_by(|a, b| a.1.seconds(a.0).total_cmp(&b.1.seconds(b.0)))
        };
        let (passes, tried, extrapolated) = reached.or_else(beyond)?;
        let passes = passes.ceil();
        Some(Recommendation {
            typical_error,
            relative_mse: tried.whole_after(passes),
            settings: tried.settings.words(),
            passes: passes as u64,
            command: tried.settings.command(study_scene, passes as u64),
            seconds: tried.seconds(passes),
            seconds_own_film: tried.render_time.seconds(passes, film.pixel_ratio()),
            extrapolated,
        })
    };
    ERRORS.iter().filter_map(row).collect()
}

impl TriedSettings<'_> {
    fn seconds(&self, passes: f64) -> f64 {
        self.render_time.seconds(passes, 1.0)
    }

    /// Returns after how many passes the error was first reached, by logarithms.
    fn passes_to(&self, error: f64) -> Option<f64> {
        let value = |i: usize| self.points[i].error.typical.value;
        let passes = |i: usize| self.points[i].passes as f64;
        let i = (0..self.points.len()).find(|&i| value(i) <= error)?;
        if i == 0 {
            return Some(passes(0));
        }
        let fraction = ln(value(i - 1) / error) / ln(value(i - 1) / value(i));
        Some(exp(ln(passes(i - 1)) + fraction * ln(passes(i) / passes(i - 1))))
    }

    /// Returns after how many passes the error is reached with the expected slope.
    fn passes_beyond(&self, error: f64) -> Option<f64> {
        let last = self.points.last()?;
        let more = powf(error / last.error.typical.value, 1.0 / self.slope?);
        (more < MAX_EXTRAPOLATION).then_some(more * last.passes as f64)
    }

    /// Returns the relative mean square error after this many passes, by logarithms between the
    /// measured points, and beyond them with the expected slope.
    fn whole_after(&self, passes: f64) -> f64 {
        let at = |i: usize| (self.points[i].passes as f64, self.points[i].error.whole.value);
        let Some(last) = self.points.len().checked_sub(1) else { return f64::NAN };
        let next = (0..=last).find(|&i| at(i).0 >= passes);
        match next {
            Some(0) => at(0).1,
            Some(i) => {
                let ((n0, e0), (n1, e1)) = (at(i - 1), at(i));
                exp(ln(e0) + ln(passes / n0) / ln(n1 / n0) * ln(e1 / e0))
            }
            None => at(last).1 * powf(passes / at(last).0, self.slope.unwrap_or(0.0)),
        }
    }
}
