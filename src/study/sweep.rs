//! Varies one setting at a time that affects the picture, and finds the fastest by error.

use super::convergence::ConvergencePoint;
use super::curves::ConvergenceCurve;
use super::film::pass_seconds;
use super::monitor::StudyError;
use super::reference_choice::ChosenReference;
use super::runner::{RenderStep, Runner};
use super::study_scene::{RenderSettings, Setting, SettingChange};
use super::time_fractions::TIME_FRACTIONS;
use abbe_format::resolve::DEFAULT_MARCH_STEPS;
use abbe_format::{MediumFile, SceneFile, TransmittanceFile};
use abbe_session::render::{Integrator, Job, Stats};
use abbe_spectra::math::sort::sort_by_number;
use abbe_transport::plan::{CausticPlan, IndirectPlan};
use serde::Serialize;

#[derive(Debug, Clone, Serialize)]
pub struct SweepRun {
    /// The difference from the scene's own settings, or null if there is none.
    pub change: Option<SettingChange>,
    /// The error after some passes.
    pub points: Vec<ConvergencePoint>,
    /// The time of the render as a function of its passes.
    #[serde(skip)]
    pub render_time: RenderTime,
}

/// The time of a render as a function of its passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderTime {
    pub pilot: f64,
    /// The part of a pass's time that does not depend on the film size, in seconds.
    pub fixed: f64,
    /// The time of the camera paths in a pass at the film size of the study, in seconds.
    pub gather: f64,
}

/// A point of the Pareto front: no other measured point has a smaller error in less time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ParetoPoint {
    pub run: usize,
    /// The error and the time.
    pub point: ConvergencePoint,
}

#[derive(Debug, Clone, Serialize)]
pub struct SettingSweep {
    /// All runs; the first one has the scene's own settings.
    pub runs: Vec<SweepRun>,
    pub front: Vec<ParetoPoint>,
    /// The point of the scene's own settings and passes, or null without time for them.
    pub default: Option<ConvergencePoint>,
    /// Changes that were skipped for lack of time.
    pub left_out: Vec<SettingChange>,
}

/// Factors that multiply the scene's own values of the settings.
const PHOTONS: [f64; 3] = [1.0 / 16.0, 0.25, 4.0];
const NEAREST: [f64; 3] = [0.25, 0.5, 4.0];
const RADII: [f64; 2] = [0.5, 2.0];
const MARCH_STEPS: [f64; 3] = [0.125, 0.5, 2.0];

/// Values of the maximum path depth.
const DEPTHS: [f64; 2] = [4.0, 12.0];

/// Returns the changes of settings that affect the picture of the scene.
pub(super) fn changes(scene_file: &SceneFile, job: &Job) -> Vec<SettingChange> {
    let budget = &job.budget;
    let fractions = |setting: Setting, own: f64, fractions: &[f64]| {
        let whole = |value: f64| if setting == Setting::Radius { value } else { value.round().max(1.0) };
        let changes = fractions.iter().map(|fraction| SettingChange { setting, value: whole(own * fraction) });
        changes.filter(|change| change.value != own).collect::<Vec<SettingChange>>()
    };
    let has_kernels = job.plan.indirect != IndirectPlan::Absent || job.plan.caustics != CausticPlan::Absent;
    let mut changes = fractions(Setting::Photons, budget.photons as f64, &PHOTONS);
    if has_kernels {
        changes.extend(match scene_file.render.radius {
            Some(radius) => fractions(Setting::Radius, radius, &RADII),
            None => fractions(Setting::Nearest, f64::from(budget.nearest), &NEAREST),
        });
        let depths = DEPTHS
            .into_iter()
            .filter(|&depth| job.scene.settings.max_depth.is_none_or(|explicit| depth < f64::from(explicit)));
        changes.extend(depths.map(|value| SettingChange { setting: Setting::MaxDepth, value }));
    }
    if marches(scene_file) {
        let steps = scene_file.render.march_steps.unwrap_or(DEFAULT_MARCH_STEPS);
        changes.extend(fractions(Setting::MarchSteps, f64::from(steps), &MARCH_STEPS));
    }
    changes
}

/// Returns true if rays march through any medium.
fn marches(scene_file: &SceneFile) -> bool {
    scene_file.media.values().any(|medium| match medium {
        MediumFile::Grid(grid) => grid.transmittance == TransmittanceFile::March,
        MediumFile::Homogeneous(_) => false,
    })
}

impl RenderTime {
    pub(super) fn of(stats: &Stats) -> Self {
        let (fixed, gather) = pass_seconds(stats);
        Self { pilot: stats.seconds.pilot, fixed, gather }
    }

    /// Predicts the time (s) of passes on a film of `pixel_ratio` times the pixels.
    pub fn seconds(&self, passes: f64, pixel_ratio: f64) -> f64 {
        self.pilot + passes * (self.fixed + self.gather * pixel_ratio)
    }
}

impl SweepRun {
    pub fn settings(&self) -> RenderSettings {
        RenderSettings { integrator: Integrator::Photon, change: self.change }
    }
}

impl SettingSweep {
    /// Renders the scene once for every change. All renders have an equal share of the time.
    pub(super) fn of(
        runner: &mut Runner<'_>,
        changes: &[SettingChange],
        curve: &ConvergenceCurve,
        reference: &ChosenReference,
        budget_seconds: f64,
    ) -> Result<Self, StudyError> {
        let own = SweepRun { change: None, points: curve.points.clone(), render_time: RenderTime::of(&curve.stats) };
        let default = curve.points.iter().find(|point| point.passes == curve.passes_wanted).copied();
        let (mut runs, mut left_out) = (vec![own], Vec::new());
        let before = runner.seconds_spent;
        for change in changes {
            let (fraction, word) = (TIME_FRACTIONS.sweep * budget_seconds, change.patch().replace(['.', '='], "-"));
            // The pilots of earlier changes may have used up the time.
            if runner.seconds_spent - before > 1.5 * fraction {
                runner.steps_done += 1;
                left_out.push(*change);
                continue;
            }
            let seconds = fraction / changes.len() as f64;
            let step = RenderStep::new(&format!("sweep-{word}"), &format!("sweep, {}", change.words()), seconds);
            let step = runner.render(&step.with_changes([change.patch()]), reference.identified())?;
            runs.push(SweepRun {
                change: Some(*change),
                points: step.result.points,
                render_time: RenderTime::of(&step.result.stats),
            });
        }
        Ok(Self { front: front(&runs), runs, default, left_out })
    }
}

/// Returns the points that no other point beats in time and error, if significant.
fn front(runs: &[SweepRun]) -> Vec<ParetoPoint> {
    let places =
        |(run, of): (usize, &SweepRun)| of.points.clone().into_iter().map(move |point| ParetoPoint { run, point });
    let mut places: Vec<ParetoPoint> = runs.iter().enumerate().flat_map(places).collect();
    places.retain(|place| place.point.error.whole.is_significant());
    sort_by_number(&mut places, |place| place.point.seconds);
    let mut least = f64::INFINITY;
    places.retain(|place| {
        let is_better = place.point.error.whole.value < least;
        least = least.min(place.point.error.whole.value);
        is_better
    });
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::reference::{MeanEstimate, PictureError};

    fn run(points: &[(f64, f64)]) -> SweepRun {
        let point = |&(seconds, value): &(f64, f64)| {
            let whole = MeanEstimate { value, standard_error: 0.01 };
            ConvergencePoint { passes: 1, seconds, error: PictureError { whole, smooth: None, typical: whole } }
        };
        let render_time = RenderTime { pilot: 0.5, fixed: 0.1, gather: 0.2 };
        SweepRun { change: None, points: points.iter().map(point).collect(), render_time }
    }

    #[test]
    fn the_front_holds_the_best_points() {
        let runs = [run(&[(1.0, 0.9), (2.0, 0.5), (4.0, 0.4)]), run(&[(1.5, 0.95), (3.0, 0.2), (5.0, 0.02)])];
        let found: Vec<(usize, f64)> = front(&runs).iter().map(|place| (place.run, place.point.seconds)).collect();
        // The last error is not significant: it is less than three standard errors.
        assert_eq!(found, [(0, 1.0), (0, 2.0), (1, 3.0)]);
    }

    #[test]
    fn only_camera_paths_scale_with_the_film() {
        let render_time = run(&[]).render_time;
        assert!(
            (render_time.seconds(10.0, 1.0) - 3.5).abs() < 1e-12
                && (render_time.seconds(10.0, 4.0) - 9.5).abs() < 1e-12
        );
    }
}
