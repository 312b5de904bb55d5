//! The settings that matter, one at a time, and which of them reaches which error first.

use super::course::{Order, Point, Workshop};
use super::curves::Curve;
use super::film::pass_seconds;
use super::subject::{Change, Recipe, Setting};
use super::truth::Truth;
use super::{Halt, SHARES};
use crate::plan::{CausticPlan, IndirectPlan};
use crate::render::{Integrator, Job, Stats};
use crate::scene::file::{MediumFile, SceneFile, TransmittanceFile};
use crate::scene::resolve::DEFAULT_MARCH_STEPS;
use serde::Serialize;

/// A render of the sweep.
#[derive(Debug, Clone, Serialize)]
pub struct SweepRun {
    /// What differs from the scene's own settings; null for these themselves.
    pub change: Option<Change>,
    /// How its error fell.
    pub points: Vec<Point>,
    /// What a render of so many passes takes.
    #[serde(skip)]
    pub pace: Pace,
}

/// How long a render takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    /// Seconds of the pilot.
    pub pilot: f64,
    /// Seconds of a pass whatever the film's size.
    pub fixed: f64,
    /// Seconds of a pass's camera paths at the study's film.
    pub gather: f64,
}

/// A place on the Pareto front: nothing that was tried is more accurate in less time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrontPlace {
    /// Which run.
    pub run: usize,
    /// How it stood.
    pub point: Point,
}

/// What the sweep found.
#[derive(Debug, Clone, Serialize)]
pub struct Sweep {
    /// The scene's own settings first.
    pub runs: Vec<SweepRun>,
    /// The Pareto front, by time.
    pub front: Vec<FrontPlace>,
    /// The scene's own settings after the passes that they ask for, if the study had the time for them.
    pub default: Option<Point>,
    /// Changes that there was no time for.
    pub left_out: Vec<Change>,
}

/// Photons in a pass and within the first radius, and radii, as shares of the scene's own.
const PHOTONS: [f64; 3] = [1.0 / 16.0, 0.25, 4.0];
const NEAREST: [f64; 3] = [0.25, 0.5, 4.0];
const RADII: [f64; 2] = [0.5, 2.0];
const MARCH_STEPS: [f64; 3] = [0.125, 0.5, 2.0];

/// Most surface events.
const DEPTHS: [f64; 2] = [4.0, 12.0];

/// The changes that matter to a scene.
pub(super) fn changes(written: &SceneFile, job: &Job) -> Vec<Change> {
    let budget = &job.budget;
    let shares = |setting: Setting, own: f64, shares: &[f64]| {
        let whole = |value: f64| if setting == Setting::Radius { value } else { value.round().max(1.0) };
        let changes = shares.iter().map(|share| Change { setting, value: whole(own * share) });
        changes.filter(|change| change.value != own).collect::<Vec<Change>>()
    };
    let has_kernels = job.plan.indirect != IndirectPlan::Absent || job.plan.caustics != CausticPlan::Absent;
    let mut changes = shares(Setting::Photons, budget.photons as f64, &PHOTONS);
    if has_kernels {
        changes.extend(match written.render.radius {
            Some(radius) => shares(Setting::Radius, radius, &RADII),
            None => shares(Setting::Nearest, f64::from(budget.nearest), &NEAREST),
        });
        let depths = DEPTHS.into_iter().filter(|&depth| depth < f64::from(budget.max_depth));
        changes.extend(depths.map(|value| Change { setting: Setting::MaxDepth, value }));
    }
    if marches(written) {
        let steps = written.render.march_steps.unwrap_or(DEFAULT_MARCH_STEPS);
        changes.extend(shares(Setting::MarchSteps, f64::from(steps), &MARCH_STEPS));
    }
    changes
}

/// Whether rays march through any medium.
fn marches(written: &SceneFile) -> bool {
    written.media.values().any(|medium| match medium {
        MediumFile::Grid(grid) => grid.transmittance == TransmittanceFile::March,
        MediumFile::Homogeneous(_) => false,
    })
}

impl Pace {
    pub(super) fn of(stats: &Stats) -> Self {
        let (fixed, gather) = pass_seconds(stats);
        Self { pilot: stats.seconds.pilot, fixed, gather }
    }

    /// Seconds of so many passes on a film of so many times as many pixels.
    pub fn seconds(&self, passes: f64, pixel_ratio: f64) -> f64 {
        self.pilot + passes * (self.fixed + self.gather * pixel_ratio)
    }
}

impl SweepRun {
    /// How it is rendered.
    pub fn recipe(&self) -> Recipe {
        Recipe { integrator: Integrator::Photon, change: self.change }
    }
}

impl Sweep {
    /// Tries every change for an equal share of the time.
    pub(super) fn of(
        workshop: &mut Workshop<'_>,
        changes: &[Change],
        curve: &Curve,
        (truth, budget): (&Truth, f64),
    ) -> Result<Self, Halt> {
        let own = SweepRun { change: None, points: curve.points.clone(), pace: Pace::of(&curve.stats) };
        let default = curve.points.iter().find(|point| point.passes == curve.passes_wanted).copied();
        let (mut runs, mut left_out) = (vec![own], Vec::new());
        let before = workshop.spent;
        for change in changes {
            let (share, word) = (SHARES.sweep * budget, change.patch().replace(['.', '='], "-"));
            // Pilots take their time too.
            if workshop.spent - before > 1.5 * share {
                workshop.step.0 += 1;
                left_out.push(*change);
                continue;
            }
            let seconds = share / changes.len() as f64;
            let order = Order::new(&format!("sweep-{word}"), &format!("sweep, {}", change.words()), seconds);
            let done = workshop.render(&order.changed([change.patch()]), truth.measure())?;
            runs.push(SweepRun { change: Some(*change), points: done.found.points, pace: Pace::of(&done.found.stats) });
        }
        Ok(Self { front: front(&runs), runs, default, left_out })
    }
}

/// The places that no other beats in both time and error. What is not certain counts for nothing.
fn front(runs: &[SweepRun]) -> Vec<FrontPlace> {
    let places =
        |(run, of): (usize, &SweepRun)| of.points.clone().into_iter().map(move |point| FrontPlace { run, point });
    let mut places: Vec<FrontPlace> = runs.iter().enumerate().flat_map(places).collect();
    places.retain(|place| place.point.wrong.whole.is_certain());
    places.sort_by(|a, b| a.point.seconds.total_cmp(&b.point.seconds));
    let mut least = f64::INFINITY;
    places.retain(|place| {
        let is_better = place.point.wrong.whole.value < least;
        least = least.min(place.point.wrong.whole.value);
        is_better
    });
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::reference::{Estimate, Wrong};

    fn run(points: &[(f64, f64)]) -> SweepRun {
        let point = |&(seconds, value): &(f64, f64)| {
            let whole = Estimate { value, standard_error: 0.01 };
            Point { passes: 1, seconds, wrong: Wrong { whole, smooth: None } }
        };
        let pace = Pace { pilot: 0.5, fixed: 0.1, gather: 0.2 };
        SweepRun { change: None, points: points.iter().map(point).collect(), pace }
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let runs = [run(&[(1.0, 0.9), (2.0, 0.5), (4.0, 0.4)]), run(&[(1.5, 0.95), (3.0, 0.2), (5.0, 0.02)])];
        let found: Vec<(usize, f64)> = front(&runs).iter().map(|place| (place.run, place.point.seconds)).collect();
        // The last is within three standard errors of nothing.
        assert_eq!(found, [(0, 1.0), (0, 2.0), (1, 3.0)]);
    }

    #[test]
    fn camera_paths_grow_with_the_film_and_photons_do_not() {
        let pace = run(&[]).pace;
        assert!((pace.seconds(10.0, 1.0) - 3.5).abs() < 1e-12 && (pace.seconds(10.0, 4.0) - 9.5).abs() < 1e-12);
    }
}
