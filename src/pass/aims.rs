//! Learns the emission distributions of the lights. These distributions send more photons in
//! directions that contribute to the picture.

use super::context::{EmissionRequest, PassContext};
use super::targets::aim_targets;
use crate::emit::{
    Aim, CELLS, EmissionStrata, MediumCrossing, PhotonVisitor, SurfaceArrival, WavelengthSampling, trace,
};
use crate::math::distribution::DiscreteDistribution;
use crate::math::random::{Purpose, Stream};
use crate::optics::bsdf::BsdfClass;
use crate::plan::partition::{LightPath, PhotonClass};
use crate::scene::Scene;
use crate::walk::ledger::Ledger;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// The number of pilot paths per cell of a grid.
const PATHS_PER_CELL: u64 = 16;

/// The number of pilot paths per stratum in each round. Each cell of the largest grid receives
/// several of these paths.
const PATHS_PER_STRATUM: u64 = PATHS_PER_CELL * (CELLS * CELLS) as u64;

/// The number of paths per round grows with the number of strata, up to this many strata.
const MAX_STRATA: u64 = 4;

/// The number of paths per round, divided by the number of photon paths of a pass, is at most this
/// value. Both rounds together then take at most a tenth of the time of eight passes.
const LARGEST_ROUND: f64 = 0.4;

/// The limit of [`LARGEST_ROUND`] is never below the number of paths for one stratum. These paths
/// take a fraction of a second.
const MIN_PATHS: u64 = PATHS_PER_STRATUM;

/// The smallest number of cells along each side of a grid.
const MIN_CELLS: usize = 4;

/// The number of rounds. Each round except the first emits photons according to the distributions
/// that the preceding round learned.
const ROUNDS: u64 = 2;

/// The pass number of the first round's random streams. This number is larger than the pass numbers
/// of the pilot's other photons, which begin at 0. The streams therefore differ.
const FIRST_STREAM_PASS: u64 = 100;

/// The number of photon paths in one parallel task. This number fixes the order in which the
/// results of the paths are added.
const PATHS_PER_TASK: u64 = 4096;

/// The share of the photons that strata receive in proportion to their contributions.
const BY_CONTRIBUTION: f64 = 0.5;

/// The share of the photons that all contributing strata receive in equal parts. A small caustic
/// contributes little to the whole picture, but it is bright.
const BY_STRATUM: f64 = 0.3;

/// The results of the aiming rounds.
pub(super) struct LearnedAims {
    /// The strata of the emitted rays, with their emission distributions.
    pub(super) strata: EmissionStrata,
    /// The names of the specular objects that no photon reached.
    pub(super) unlit: Vec<String>,
}

impl LearnedAims {
    /// Returns strata that follow the emission distributions of the lights.
    pub(super) fn plain(context: &PassContext<'_>) -> Self {
        Self { strata: EmissionStrata::plain(&context.lights.lights), unlit: Vec::new() }
    }
}

/// Learns the emission distribution of each light from photons traced in the scene at several
/// times.
pub(super) fn learn_aims(context: &PassContext<'_>, scenes: &[Cow<'_, Scene>]) -> LearnedAims {
    let (targets, lights) = (aim_targets(scenes, &context.openings.spheres), &context.lights.lights);
    let (extent, count) = (context.scene.extent(), context.scene.lights.len() as f64);
    // Half of the pilot's paths belong to all lights in equal parts, so that it finds the dim ones.
    let probability = |light: usize| 0.5 * (lights.probability(light) + 1.0 / count);
    let strata = EmissionStrata::new(&context.scene.lights, extent, targets.iter(), probability);
    let Some(mut strata) = strata else { return LearnedAims::plain(context) };
    let wanted = PATHS_PER_STRATUM * (strata.list.len() as u64).min(MAX_STRATA);
    let paths = wanted.min(((LARGEST_ROUND * context.budget.photons as f64) as u64).max(MIN_PATHS));
    let layout = GridLayout::new(&strata, paths);
    let mut found = Importance::new(context.scene, &layout);
    for round in 0..ROUNDS {
        found = trace_round(context, scenes, &strata, &layout, (round, paths));
        for (number, stratum) in strata.list.iter_mut().enumerate() {
            stratum.aim = found.aim(number);
        }
    }
    let contribution =
        |number: usize| strata.list[number].share * lights.probability(strata.list[number].light) * found.mean(number);
    let contributions: Vec<f64> = (0..strata.list.len()).map(contribution).collect();
    let sum: f64 = contributions.iter().sum();
    let contributing = contributions.iter().filter(|&&contribution| contribution > 0.0).count();
    if sum > 0.0 {
        let shares = strata.list.iter().zip(&contributions).map(|(stratum, &contribution)| {
            let unlearned = stratum.share * lights.probability(stratum.light);
            let equal = if contribution > 0.0 { BY_STRATUM / contributing as f64 } else { 0.0 };
            BY_CONTRIBUTION * contribution / sum + equal + (1.0 - BY_CONTRIBUTION - BY_STRATUM) * unlearned
        });
        strata.choice = DiscreteDistribution::new(shares).unwrap_or(strata.choice);
    }
    LearnedAims { strata, unlit: unlit_objects(context.scene, &found.reached) }
}

/// Returns the names of the specular objects that no photon reached.
fn unlit_objects(scene: &Scene, reached: &[bool]) -> Vec<String> {
    let enclosures = scene.enclosures();
    let objects = (0..).zip(&scene.objects).zip(reached);
    let unlit = objects.filter(|((number, _), reached)| {
        let mut components = scene.material_of(*number).surface.components();
        !**reached
            && !enclosures.contains_key(number)
            && components.any(|component| component.class() == BsdfClass::Specular)
    });
    unlit.map(|((_, object), _)| object.name.clone()).collect()
}

/// Traces the photons of a round. `round` contains the number of the round and of its paths.
fn trace_round<'a>(
    context: &PassContext<'a>,
    scenes: &'a [Cow<'_, Scene>],
    strata: &EmissionStrata,
    layout: &'a GridLayout,
    (round, count): (u64, u64),
) -> Importance<'a> {
    let tasks = count.div_ceil(PATHS_PER_TASK);
    let request = EmissionRequest {
        wavelengths: WavelengthSampling::Free,
        count,
        purpose: Purpose::Pilot,
        pass: FIRST_STREAM_PASS + round,
    };
    let parts: Vec<Importance<'_>> = (0..tasks)
        .into_par_iter()
        .map(|task| {
            // Each shutter time gets an equal share of the tasks.
            let scene = &scenes[(task * scenes.len() as u64 / tasks) as usize];
            let source = context.photon_source(scene, strata, request);
            let points = source.points();
            let mut part = Importance::new(scene, layout);
            let mut ledger = Ledger::new(context.scene.materials.len());
            for index in task * PATHS_PER_TASK..((task + 1) * PATHS_PER_TASK).min(count) {
                trace(&source, &points, index..index + 1, &mut part, &mut ledger);
                part.end_path();
            }
            part
        })
        .collect();
    let mut whole = Importance::new(context.scene, layout);
    parts.iter().for_each(|part| whole.add(part));
    whole
}

/// The positions of the grids of all strata in one list of cells.
struct GridLayout {
    /// For each stratum, the number of cells along each side of its grid.
    sides: Vec<usize>,
    /// For each stratum, the index of its first cell.
    first_cells: Vec<usize>,
    /// The number of cells of all strata.
    cells: usize,
}

impl GridLayout {
    /// Creates grids whose cells receive [`PATHS_PER_CELL`] of the paths, if the grids stay within
    /// their limits.
    fn new(strata: &EmissionStrata, paths: u64) -> Self {
        let side = |stratum: usize| {
            let paths = paths as f64 * strata.choice.probability(stratum);
            ((paths / PATHS_PER_CELL as f64).sqrt().round() as usize).clamp(MIN_CELLS, CELLS)
        };
        let (mut layout, count) = (Self { sides: Vec::new(), first_cells: Vec::new(), cells: 0 }, strata.list.len());
        for side in (0..count).map(side) {
            layout.sides.push(side);
            layout.first_cells.push(layout.cells);
            layout.cells += side * side;
        }
        layout
    }

    /// Returns the cells of a stratum.
    fn cells_of(&self, stratum: usize) -> Range<usize> {
        let first = self.first_cells[stratum];
        first..first + self.sides[stratum] * self.sides[stratum]
    }
}

/// The importance of photons, per stratum and per cell of the stratum's emission grid.
///
/// The score of a path estimates its contribution to the picture.
struct Importance<'a> {
    scene: &'a Scene,
    layout: &'a GridLayout,
    /// The number of paths per cell.
    paths: Vec<f64>,
    /// The sum of squared scores per cell.
    squares: Vec<f64>,
    /// For each object: true if a path reached the object.
    reached: Vec<bool>,
    /// The index of the current path's cell.
    current: usize,
    /// The score of the current path's arrivals at surfaces.
    surface_score: f64,
    /// The largest score of the current path's segments in media. Only one segment counts, because
    /// a path in a dense medium has many segments with nearly the same information.
    volume_score: f64,
}

impl<'a> Importance<'a> {
    fn new(scene: &'a Scene, layout: &'a GridLayout) -> Self {
        let (paths, squares) = (vec![0.0; layout.cells], vec![0.0; layout.cells]);
        let reached = vec![false; scene.objects.len()];
        Self { scene, layout, paths, squares, reached, current: 0, surface_score: 0.0, volume_score: 0.0 }
    }

    /// Adds the score of the current path to its cell.
    fn end_path(&mut self) {
        self.squares[self.current] += (self.surface_score + self.volume_score).powi(2);
        (self.surface_score, self.volume_score) = (0.0, 0.0);
    }

    fn add(&mut self, other: &Self) {
        self.paths.iter_mut().zip(&other.paths).for_each(|(a, b)| *a += b);
        self.squares.iter_mut().zip(&other.squares).for_each(|(a, b)| *a += b);
        self.reached.iter_mut().zip(&other.reached).for_each(|(a, b)| *a |= b);
    }

    /// Returns the root-mean-square scores of a stratum's cells.
    fn scores(&self, stratum: usize) -> Vec<f64> {
        let score = |cell: usize| {
            let paths = self.paths[cell];
            if paths > 0.0 { (self.squares[cell] / paths).sqrt() } else { 0.0 }
        };
        self.layout.cells_of(stratum).map(score).collect()
    }

    /// Returns the mean score of a stratum's cells.
    fn mean(&self, stratum: usize) -> f64 {
        let scores = self.scores(stratum);
        scores.iter().sum::<f64>() / scores.len() as f64
    }

    /// Returns the emission distribution of a stratum. The density of a cell is proportional to its
    /// root-mean-square score. The scores are smoothed over neighbouring cells, so that a small
    /// feature is not missed.
    fn aim(&self, stratum: usize) -> Aim {
        /// A distribution is used only if the highest score is larger than the mean score times
        /// this value.
        const MIN_CONTRAST: f64 = 1.5;
        let (raw, side) = (self.scores(stratum), self.layout.sides[stratum]);
        let smooth: Vec<f64> = (0..raw.len()).map(|cell| smoothed(&raw, side, cell)).collect();
        let mean = smooth.iter().sum::<f64>() / smooth.len() as f64;
        let highest = smooth.iter().copied().fold(0.0, f64::max);
        if mean > 0.0 && highest > MIN_CONTRAST * mean { Aim::learned(side, &smooth) } else { Aim::plain() }
    }
}

/// Returns the average of two scores: the score of a cell, and the highest score among this cell
/// and its neighbours.
fn smoothed(raw: &[f64], side: usize, cell: usize) -> f64 {
    let (x, y) = (cell % side, cell / side);
    let mut highest = 0.0_f64;
    for j in y.saturating_sub(1)..(y + 2).min(side) {
        for i in x.saturating_sub(1)..(x + 2).min(side) {
            highest = highest.max(raw[j * side + i]);
        }
    }
    0.5 * (raw[cell] + highest)
}

impl PhotonVisitor for Importance<'_> {
    fn on_surface(&mut self, arrival: &SurfaceArrival<'_>, _stream: &mut Stream) {
        if arrival.photon.lost {
            return;
        }
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
        if photon.lost || !medium.medium.scatters() || !segment.length_m.is_finite() {
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

    fn on_emission(&mut self, stratum: usize, aim: [f64; 2]) {
        self.current = self.layout.first_cells[stratum] + Aim::cell(aim, self.layout.sides[stratum]);
        self.paths[self.current] += 1.0;
    }

    fn on_arrival(&mut self, object: u32) {
        self.reached[object as usize] = true;
    }
}
