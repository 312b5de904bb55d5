//! The error you want → settings → time on this machine.

use super::course::Point;
use super::curves::Curve;
use super::film::StudyFilm;
use super::fit::Fit;
use super::subject::{Recipe, Subject};
use super::sweep::{Pace, Sweep};
use super::truth::Account;
use crate::render::Integrator;
use serde::Serialize;

/// What it takes to reach an error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Wanted {
    /// The relative mean square error.
    pub relative_mse: f64,
    /// The settings, in words.
    pub settings: String,
    /// The passes that reach it.
    pub passes: u64,
    /// The command that renders so, at the scene's own film.
    pub command: String,
    /// Seconds at the study's film.
    pub seconds: f64,
    /// Seconds at the scene's own film, by its number of pixels.
    pub seconds_own_film: f64,
    /// Whether the study got that far itself, or follows the slope of theory from where it ended.
    pub extrapolated: bool,
}

/// The errors that are asked for.
pub const ERRORS: [f64; 6] = [0.1, 0.03, 0.01, 0.003, 0.001, 0.0003];

/// Beyond this many times the longest render nothing is said.
const FARTHEST: f64 = 1000.0;

/// Settings that were tried.
struct Tried<'a> {
    recipe: Recipe,
    points: Vec<&'a Point>,
    pace: Pace,
    /// The slope with which its error may be expected to fall on, if it falls.
    slope: Option<f64>,
}

/// The slope of theory, or that of the last points if these fall more slowly; none if they hardly fall at all.
fn slope_at_the_end(points: &[&Point], curve: &Curve) -> Option<f64> {
    const LAST: usize = 4;
    const LEAST: f64 = -0.3;
    let last = points[points.len().saturating_sub(LAST)..].iter();
    let fit = Fit::of(last.map(|point| (point.passes as f64, point.wrong.whole.value)))?;
    (fit.slope < LEAST).then(|| curve.slopes_in_theory().into_iter().fold(fit.slope, f64::max))
}

/// Rows for all errors that can be told of.
pub(super) fn table(
    subject: &Subject,
    (film, truth): (&StudyFilm, &Account),
    curves: &[Curve; 2],
    sweep: &Sweep,
) -> Vec<Wanted> {
    let photons = sweep.runs.iter().map(|run| (run.recipe(), &run.points, run.pace, &curves[0]));
    let path = Recipe { integrator: Integrator::Path, change: None };
    // An integrator that never finds some of the light is no way to a picture.
    let finds_all = truth.out_of_reach.is_none();
    let path = finds_all.then(|| (path, &curves[1].points, Pace::of(&curves[1].stats), &curves[1]));
    let tried: Vec<Tried<'_>> = photons
        .chain(path)
        .map(|(recipe, points, pace, curve)| {
            let points: Vec<&Point> = points.iter().filter(|point| point.wrong.whole.is_certain()).collect();
            let slope = slope_at_the_end(&points, curve);
            Tried { recipe, points, pace, slope }
        })
        .collect();
    let row = |&error: &f64| {
        let reached = tried.iter().filter_map(|tried| Some((tried.passes_to(error)?, tried, false)));
        let reached = reached.min_by(|a, b| a.1.seconds(a.0).total_cmp(&b.1.seconds(b.0)));
        let beyond = || {
            let all = tried.iter().filter_map(|tried| Some((tried.passes_beyond(error)?, tried, true)));
            all.min_by(|a, b| a.1.seconds(a.0).total_cmp(&b.1.seconds(b.0)))
        };
        let (passes, tried, extrapolated) = reached.or_else(beyond)?;
        let passes = passes.ceil();
        Some(Wanted {
            relative_mse: error,
            settings: tried.recipe.words(),
            passes: passes as u64,
            command: tried.recipe.command(subject, passes as u64),
            seconds: tried.seconds(passes),
            seconds_own_film: tried.pace.seconds(passes, film.pixel_ratio()),
            extrapolated,
        })
    };
    ERRORS.iter().filter_map(row).collect()
}

impl Tried<'_> {
    fn seconds(&self, passes: f64) -> f64 {
        self.pace.seconds(passes, 1.0)
    }

    /// The passes after which the error was first reached, between two points along the line through their logarithms.
    fn passes_to(&self, error: f64) -> Option<f64> {
        let value = |i: usize| self.points[i].wrong.whole.value;
        let passes = |i: usize| self.points[i].passes as f64;
        let i = (0..self.points.len()).find(|&i| value(i) <= error)?;
        if i == 0 {
            return Some(passes(0));
        }
        let share = (value(i - 1) / error).ln() / (value(i - 1) / value(i)).ln();
        Some((passes(i - 1).ln() + share * (passes(i) / passes(i - 1)).ln()).exp())
    }

    /// The passes after which it would be reached, if it falls on as theory says.
    fn passes_beyond(&self, error: f64) -> Option<f64> {
        let last = self.points.last()?;
        let more = (error / last.wrong.whole.value).powf(1.0 / self.slope?);
        (more < FARTHEST).then_some(more * last.passes as f64)
    }
}
