//! Photon paths with their vertices, for drawings, traced by the code of a pass. They have their
//! own random streams, so they change no picture.

use crate::emit::{EmissionStrata, MediumCollision, PhotonState, PhotonVisitor, SurfaceArrival};
use crate::emit::{WavelengthSampling, trace};
use crate::pass::{EmissionRequest, PassContext};
use crate::pilot::{LearnedAims, PATHS_PER_STRATUM, learn_aims};
use crate::plan::AimPlan;
use crate::walk::ledger::Ledger;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::math::random::{Purpose, Stream};
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::spectrum::{Lanes, Wavelengths};
use glam::DVec3;
use rayon::prelude::*;
use std::borrow::Cow;

const PATHS_PER_TASK: u64 = 256;

/// The number of tasks that run before the paths are counted.
const TASKS_PER_ROUND: u64 = 32;

/// The largest number of segments of a recorded path. Later segments are left out.
const MOST_SEGMENTS: usize = 64;

/// Paths that arrive at a target are selected from this many times as many paths.
const CANDIDATES: usize = 4;

#[derive(Debug, Clone, Copy)]
pub struct PathQuery {
    /// The number of the light, or `None` for all lights in proportion to their power.
    pub light: Option<usize>,
    pub count: usize,
    /// Only paths that arrive at a surface or collide in this sphere are wanted, and end there.
    pub target: Option<BoundingSphere>,
    /// The search for such paths ends after this many photons.
    pub most_traced: u64,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct PhotonPaths {
    /// The paths, in the order of their photons.
    pub paths: Vec<RecordedPath>,
    pub traced: u64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct RecordedPath {
    /// The origin in m, relative to the scene's centre.
    pub origin: DVec3,
    /// The segments in the order in which the photon passes them.
    pub segments: Vec<RecordedSegment>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedSegment {
    /// In m, relative to the scene's centre; outside if the photon leaves the scene.
    pub end: DVec3,
    pub wavelengths: Wavelengths,
    /// The power of each wavelength at the end, in W.
    pub power_w: Lanes,
}

/// Records paths on the current thread pool, aimed like those of a pass, and the same for the same
/// query. A moving scene is that when the shutter opens. Returns no paths if the light does not
/// exist or emits nothing.
pub fn photon_paths(context: &PassContext<'_>, query: &PathQuery) -> PhotonPaths {
    let aims = match context.plan.aim {
        AimPlan::Learned => learn_aims(context, &[Cow::Borrowed(context.scene)], PATHS_PER_STRATUM),
        AimPlan::Plain => LearnedAims::plain(context),
    };
    let Some(strata) = of_light(aims.strata, query.light) else { return PhotonPaths::default() };
    let (wanted, most) = match query.target {
        None => (query.count, query.count as u64),
        Some(_) => (query.count * CANDIDATES, query.most_traced),
    };
    let request =
        EmissionRequest { wavelengths: WavelengthSampling::Free, count: most, purpose: Purpose::ShownPhoton, pass: 0 };
    let source = context.photon_source(context.scene, &strata, request);
    let points = source.points();
    let (mut paths, mut traced) = (Vec::new(), 0);
    while traced < most && paths.len() < wanted {
        let end = (traced + TASKS_PER_ROUND * PATHS_PER_TASK).min(most);
        let firsts: Vec<u64> = (traced..end).step_by(PATHS_PER_TASK as usize).collect();
        let tasks = firsts
            .into_par_iter()
            .map(|first| {
                let mut recorder = PathRecorder::new(context.scene, query.target);
                let mut ledger = Ledger::new(context.scene.materials.len());
                for index in first..(first + PATHS_PER_TASK).min(end) {
                    trace(&source, &points, index..index + 1, &mut recorder, &mut ledger);
                    recorder.end_path();
                }
                recorder.paths
            })
            .collect::<Vec<_>>();
        paths.extend(tasks.into_iter().flatten());
        traced = end;
    }
    if query.target.is_some() {
        paths = selected_by_power(paths, query.count);
    }
    PhotonPaths { paths, traced }
}

/// Returns the strata of one light. Returns `None` if the light emits no light.
fn of_light(strata: EmissionStrata, light: Option<usize>) -> Option<EmissionStrata> {
    let Some(light) = light else { return Some(strata) };
    let weight = |(number, of): (usize, usize)| if of == light { strata.choice.probability(number) } else { 0.0 };
    let choice = DiscreteDistribution::new(strata.list.iter().map(|stratum| stratum.light).enumerate().map(weight))?;
    Some(EmissionStrata { choice, ..strata })
}

/// Selects paths in proportion to the power with which they arrive: aimed photons have different
/// powers, so these represent the light better. Paths with more than their fraction of the power
/// are always selected (systematic sampling with unequal probabilities: Särndal, Swensson & Wretman
/// 1992, "Model Assisted Survey Sampling", section 3.6).
fn selected_by_power(paths: Vec<RecordedPath>, count: usize) -> Vec<RecordedPath> {
    if paths.len() <= count {
        return paths;
    }
    let power = |path: &RecordedPath| path.segments.last().map_or(0.0, |last| last.power_w.iter().sum::<f64>());
    let powers: Vec<f64> = paths.iter().map(power).collect();
    let is_selected = selection(&powers, count);
    paths.into_iter().zip(is_selected).filter(|(_, is_selected)| *is_selected).map(|(path, _)| path).collect()
}

fn selection(powers: &[f64], count: usize) -> Vec<bool> {
    let mut selected = vec![false; powers.len()];
    let step = loop {
        let rest = || powers.iter().zip(&selected).filter(|(_, selected)| !**selected).map(|(power, _)| *power);
        let left = count - selected.iter().filter(|selected| **selected).count();
        let step = rest().sum::<f64>() / left as f64;
        if !rest().any(|power| power > step) {
            break step;
        }
        selected.iter_mut().zip(powers).for_each(|(selected, power)| *selected |= *power > step);
    };
    // Half a step keeps the selection away from the total, which rounding may miss.
    let mut sum = 0.5 * step;
    for (selected, power) in selected.iter_mut().zip(powers).filter(|(selected, _)| !**selected) {
        let before = (sum / step).floor();
        sum += power;
        *selected = (sum / step).floor() > before;
    }
    selected
}

#[derive(Debug)]
struct PathRecorder<'a> {
    scene: &'a Scene,
    target: Option<BoundingSphere>,
    paths: Vec<RecordedPath>,
    /// The present path, or `None` before its start and after its end.
    path: Option<RecordedPath>,
    /// True if the present path has arrived at the target.
    has_arrived: bool,
}

impl<'a> PathRecorder<'a> {
    fn new(scene: &'a Scene, target: Option<BoundingSphere>) -> Self {
        Self { scene, target, paths: Vec::new(), path: None, has_arrived: false }
    }

    /// Adds a vertex, unless the path has arrived at the target.
    fn add(&mut self, end: DVec3, photon: &PhotonState) {
        let Some(path) = self.path.as_mut().filter(|_| !self.has_arrived && !photon.is_truncated()) else { return };
        if path.segments.len() < MOST_SEGMENTS {
            path.segments.push(RecordedSegment { end, wavelengths: photon.wavelengths, power_w: photon.power });
            self.has_arrived = self.target.is_some_and(|target| target.centre.distance(end) <= target.radius_m);
        }
    }

    fn end_path(&mut self) {
        let is_wanted = self.target.is_none() || self.has_arrived;
        self.paths.extend(self.path.take().filter(|_| is_wanted));
        self.has_arrived = false;
    }
}

impl PhotonVisitor for PathRecorder<'_> {
    fn on_emission(&mut self, _stratum: usize, _aim: [f64; 2]) {}

    fn on_start(&mut self, ray: &Ray, _photon: &PhotonState) {
        self.path = Some(RecordedPath { origin: ray.origin, segments: Vec::new() });
    }

    fn on_arrival(&mut self, arrival: &SurfaceArrival<'_>) {
        self.add(arrival.interaction.hit.position, arrival.photon);
    }

    fn on_medium_collision(&mut self, collision: &MediumCollision<'_>, _stream: &mut Stream) {
        self.add(collision.position, collision.photon);
    }

    fn on_escape(&mut self, ray: &Ray, photon: &PhotonState) {
        if self.target.is_none() {
            self.add(ray.at(self.scene.radius_m), photon);
        }
    }

    fn on_surface(&mut self, _arrival: &SurfaceArrival<'_>, _stream: &mut Stream) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Some paths may have more than their fraction of the power.
    #[test]
    fn as_many_paths_are_selected_as_are_wanted() {
        let uneven: Vec<f64> = (0..60).map(|i| 1.3_f64.powi(i)).collect();
        for powers in [vec![1.0; 60], uneven] {
            let selected = selection(&powers, 50);
            assert_eq!(selected.iter().filter(|selected| **selected).count(), 50);
        }
    }
}
