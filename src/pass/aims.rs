//! Learns the emission distributions of the lights. These distributions send more photons in
//! directions that contribute to the picture.

use super::context::{EmissionRequest, PassContext};
use crate::emit::{Aim, CELLS, MediumCrossing, PhotonVisitor, SurfaceArrival, WavelengthSampling, trace};
use crate::math::random::{Purpose, Stream};
use crate::plan::partition::{LightPath, PhotonClass};
use crate::scene::Scene;
use crate::walk::ledger::Ledger;
use rayon::prelude::*;
use std::borrow::Cow;

/// The number of pilot paths per light in each round. Each cell receives several of these paths.
const PATHS_PER_LIGHT: u64 = 16 * (CELLS * CELLS) as u64;

/// The number of paths per round grows with the number of lights, up to this many lights.
const MAX_LIGHTS: u64 = 4;

/// The number of rounds. Each round except the first emits photons according to the distributions
/// that the preceding round learned.
const ROUNDS: u64 = 2;

/// The pass number of the first round's random streams. This number is larger than the pass numbers
/// of the pilot's other photons, which begin at 0. The streams therefore differ.
const FIRST_STREAM_PASS: u64 = 100;

/// The number of photon paths in one parallel task. This number fixes the order in which the
/// results of the paths are added.
const PATHS_PER_TASK: u64 = 4096;

/// Learns the emission distribution of each light from photons traced in the scene at several
/// times.
pub(super) fn learn_aims(context: &PassContext<'_>, scenes: &[Cow<'_, Scene>]) -> Vec<Aim> {
    let lights = context.scene.lights.len();
    let mut aims = vec![Aim::plain(); lights];
    for round in 0..ROUNDS {
        let count = PATHS_PER_LIGHT * (lights as u64).min(MAX_LIGHTS);
        let tasks = count.div_ceil(PATHS_PER_TASK);
        let request = EmissionRequest {
            wavelengths: WavelengthSampling::Free,
            count,
            purpose: Purpose::Pilot,
            pass: FIRST_STREAM_PASS + round,
        };
        let parts: Vec<ImportanceGrid<'_>> = (0..tasks)
            .into_par_iter()
            .map(|task| {
                // Each shutter time gets an equal share of the tasks.
                let scene = &scenes[(task * scenes.len() as u64 / tasks) as usize];
                let source = context.photon_source(scene, &aims, request);
                let points = source.points();
                let mut part = ImportanceGrid::new(scene, lights);
                let mut ledger = Ledger::new(context.scene.materials.len());
                for index in task * PATHS_PER_TASK..((task + 1) * PATHS_PER_TASK).min(count) {
                    trace(&source, &points, index..index + 1, &mut part, &mut ledger);
                    part.end_path();
                }
                part
            })
            .collect();
        let mut whole = ImportanceGrid::new(context.scene, lights);
        parts.iter().for_each(|part| whole.add(part));
        aims = (0..lights).map(|light| whole.aim(light)).collect();
    }
    aims
}

/// The importance of photons, per light and per cell of the light's emission grid.
///
/// The score of a path estimates its contribution to the picture.
struct ImportanceGrid<'a> {
    scene: &'a Scene,
    /// The number of paths per light and cell.
    paths: Vec<f64>,
    /// The sum of squared scores per light and cell.
    squares: Vec<f64>,
    /// The index of the current path's light and cell.
    current: usize,
    /// The score of the current path's arrivals at surfaces.
    surface_score: f64,
    /// The largest score of the current path's segments in media. Only one segment counts, because
    /// a path in a dense medium has many segments with nearly the same information.
    volume_score: f64,
}

impl<'a> ImportanceGrid<'a> {
    fn new(scene: &'a Scene, lights: usize) -> Self {
        let size = lights * CELLS * CELLS;
        let (paths, squares) = (vec![0.0; size], vec![0.0; size]);
        Self { scene, paths, squares, current: 0, surface_score: 0.0, volume_score: 0.0 }
    }

    /// Adds the score of the current path to its cell.
    fn end_path(&mut self) {
        self.squares[self.current] += (self.surface_score + self.volume_score).powi(2);
        (self.surface_score, self.volume_score) = (0.0, 0.0);
    }

    fn add(&mut self, other: &Self) {
        self.paths.iter_mut().zip(&other.paths).for_each(|(a, b)| *a += b);
        self.squares.iter_mut().zip(&other.squares).for_each(|(a, b)| *a += b);
    }

    /// Returns the emission distribution of a light. The density of a cell is proportional to its
    /// root-mean-square score. The scores are smoothed over neighbouring cells, so that a small
    /// feature is not missed.
    fn aim(&self, light: usize) -> Aim {
        /// A distribution is used only if the highest score is larger than the mean score times
        /// this value.
        const MIN_CONTRAST: f64 = 1.5;
        let base = light * CELLS * CELLS;
        let score = |cell: usize| {
            let paths = self.paths[base + cell];
            if paths > 0.0 { (self.squares[base + cell] / paths).sqrt() } else { 0.0 }
        };
        let raw: Vec<f64> = (0..CELLS * CELLS).map(score).collect();
        let smooth: Vec<f64> = (0..CELLS * CELLS).map(|cell| smoothed(&raw, cell)).collect();
        let mean = smooth.iter().sum::<f64>() / smooth.len() as f64;
        let highest = smooth.iter().copied().fold(0.0, f64::max);
        if mean > 0.0 && highest > MIN_CONTRAST * mean { Aim::learned(&smooth) } else { Aim::plain() }
    }
}

/// Returns the average of two scores: the score of a cell, and the highest score among this cell
/// and its neighbours.
fn smoothed(raw: &[f64], cell: usize) -> f64 {
    let (x, y) = (cell % CELLS, cell / CELLS);
    let mut highest = 0.0_f64;
    for j in y.saturating_sub(1)..(y + 2).min(CELLS) {
        for i in x.saturating_sub(1)..(x + 2).min(CELLS) {
            highest = highest.max(raw[j * CELLS + i]);
        }
    }
    0.5 * (raw[cell] + highest)
}

impl PhotonVisitor for ImportanceGrid<'_> {
    fn on_surface(&mut self, arrival: &SurfaceArrival<'_>, _stream: &mut Stream) {
        let in_view = self.scene.camera.connect(arrival.interaction.hit.position, [0.5; 2]).is_some();
        self.surface_score += match (arrival.photon.light_path, in_view) {
            (LightPath::Direct, _) => 0.0,
            (LightPath::Caustic, true) => 1.0,
            (LightPath::Indirect, true) => 0.3,
            // The surface may be visible to the camera in a mirror.
            (LightPath::Caustic | LightPath::Indirect, false) => 0.02,
        };
    }

    fn on_medium_crossing(&mut self, crossing: &MediumCrossing<'_>, _stream: &mut Stream) {
        let MediumCrossing { segment, medium, photon } = crossing;
        let Some(class) = photon.light_path.photon_class() else { return };
        if !medium.medium.scatters() || !segment.length_m.is_finite() {
            return;
        }
        // Estimates the visible share of the segment from five points.
        let points = [0.1, 0.3, 0.5, 0.7, 0.9].map(|share| segment.ray.at(share * segment.length_m));
        let in_view = points.iter().filter(|&&point| self.scene.camera.connect(point, [0.5; 2]).is_some()).count();
        let weight = match class {
            PhotonClass::Caustic => 1.0,
            PhotonClass::Indirect => 0.3,
        };
        self.volume_score = self.volume_score.max(weight * 0.2 * in_view as f64);
    }

    fn on_emission(&mut self, light: usize, aim: [f64; 2]) {
        self.current = light * CELLS * CELLS + Aim::cell(aim);
        self.paths[self.current] += 1.0;
    }
}
