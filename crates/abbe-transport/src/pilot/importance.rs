//! The importance of photons: how much each part of a light contributes to the picture.

use crate::emit::{Aim, CELLS, EmissionStrata, MediumCrossing, PhotonState, PhotonVisitor, SurfaceArrival};
use crate::plan::partition::{LightPath, PhotonClass};
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::random::Stream;
use std::iter;
use std::ops::Range;

const PATHS_PER_CELL: u64 = 16;

/// The smallest number of cells along each side of a grid.
const MIN_CELLS: usize = 4;

/// A distribution is used only if it reduces the mean square of the contributions to this fraction.
const WORTHWHILE: f64 = 0.9;

/// The positions of the grids of all strata in one list of cells.
pub(super) struct GridLayout {
    /// For each stratum, the number of cells along each side of its grid.
    sides: Vec<usize>,
    /// For each stratum, the index of its first cell.
    first_cells: Vec<usize>,
    cells: usize,
}

impl GridLayout {
    /// Creates grids with [`PATHS_PER_CELL`] of the paths per cell, within their limits.
    pub(super) fn new(strata: &EmissionStrata, paths: u64) -> Self {
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

    fn cells_of(&self, stratum: usize) -> Range<usize> {
        let first = self.first_cells[stratum];
        first..first + self.sides[stratum] * self.sides[stratum]
    }
}

/// The importance of photons, per stratum and cell of its grid.
///
/// The score of a path estimates its contribution to the picture. A distribution that was learned
/// from one half of the paths is tested with the other half.
pub(super) struct Importance<'a> {
    scene: &'a Scene,
    layout: &'a GridLayout,
    halves: [CellSums; 2],
    half: usize,
    /// For each object: true if a path reached the object.
    pub(super) reached: Vec<bool>,
    current: usize,
    start_power: f64,
    surface_score: f64,
    /// Of the current path's segments in media: the largest, because those in a dense medium have
    /// nearly the same information.
    volume_score: f64,
}

#[derive(Clone)]
struct CellSums {
    paths: Vec<f64>,
    squares: Vec<f64>,
}

impl<'a> Importance<'a> {
    /// Prepares the scoring of the paths of one task. Even and odd tasks form the two halves.
    pub(super) fn new(scene: &'a Scene, layout: &'a GridLayout, task: u64) -> Self {
        let none = CellSums { paths: vec![0.0; layout.cells], squares: vec![0.0; layout.cells] };
        let (halves, reached) = ([none.clone(), none], vec![false; scene.objects.len()]);
        let half = (task % 2) as usize;
        Self {
            scene,
            layout,
            halves,
            half,
            reached,
            current: 0,
            start_power: 0.0,
            surface_score: 0.0,
            volume_score: 0.0,
        }
    }

    pub(super) fn end_path(&mut self) {
        self.halves[self.half].squares[self.current] += (self.surface_score + self.volume_score).powi(2);
        (self.surface_score, self.volume_score) = (0.0, 0.0);
    }

    /// Returns the photon's power, divided by its power at the start of the path.
    fn relative_power(&self, photon: &PhotonState) -> f64 {
        photon.power.iter().sum::<f64>() / self.start_power
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sums, others) in self.halves.iter_mut().zip(&other.halves) {
            sums.paths.iter_mut().zip(&others.paths).for_each(|(a, b)| *a += b);
            sums.squares.iter_mut().zip(&others.squares).for_each(|(a, b)| *a += b);
        }
        self.reached.iter_mut().zip(&other.reached).for_each(|(a, b)| *a |= b);
    }

    /// Returns the mean squared scores of a stratum's cells in some halves, `None` without paths.
    fn mean_squares(&self, stratum: usize, halves: &[usize]) -> Vec<Option<f64>> {
        let sum = |values: fn(&CellSums) -> &[f64], cell: usize| -> f64 {
            halves.iter().map(|&half| values(&self.halves[half])[cell]).sum()
        };
        let mean = |cell: usize| {
            let paths = sum(|sums| &sums.paths, cell);
            (paths > 0.0).then(|| sum(|sums| &sums.squares, cell) / paths)
        };
        self.layout.cells_of(stratum).map(mean).collect()
    }

    /// Returns the emission distribution of a stratum, and its mean score.
    ///
    /// If few paths of a cell contribute, its score is mostly noise. The scores are therefore
    /// averaged over square blocks of cells, of the size at which the distribution from one half of
    /// the paths suits the other half best.
    pub(super) fn aim(&self, stratum: usize) -> (Aim, f64) {
        let side = self.layout.sides[stratum];
        let [even, odd] = [0, 1].map(|half| self.mean_squares(stratum, &[half]));
        let block = block_size([&even, &odd], side);
        let scores = scores(&self.mean_squares(stratum, &[0, 1]), side, block);
        (learned_aim(&scores, side), scores.iter().sum::<f64>() / scores.len() as f64)
    }
}

/// Returns the side in cells of the blocks in which scores are averaged, by the mean squared scores
/// of each half. If no distribution is worthwhile, one block contains the whole grid.
fn block_size(halves: [&[Option<f64>]; 2], side: usize) -> usize {
    let moment = |block: usize| -> f64 {
        let learned = halves.map(|half| learned_aim(&scores(half, side, block), side));
        second_moment(&learned[0], halves[1], side) + second_moment(&learned[1], halves[0], side)
    };
    let plain = moment(side);
    let sizes = iter::successors(Some(1), |size| Some(2 * size)).take_while(|&size| size < side);
    let best = sizes.map(|size| (size, moment(size))).min_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|&(_, moment)| moment < WORTHWHILE * plain).map_or(side, |(size, _)| size)
}

/// Returns the root of the mean `squares` over square blocks of `block` × `block` cells.
fn scores(squares: &[Option<f64>], side: usize, block: usize) -> Vec<f64> {
    let blocks = side.div_ceil(block);
    let block_of = |cell: usize| (cell / side / block) * blocks + cell % side / block;
    let mut sums = vec![(0.0, 0.0); blocks * blocks];
    for (cell, square) in squares.iter().enumerate() {
        if let Some(square) = square {
            let (sum, count) = &mut sums[block_of(cell)];
            *sum += square;
            *count += 1.0;
        }
    }
    let score = |cell: usize| {
        let (sum, count) = sums[block_of(cell)];
        if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
    };
    (0..squares.len()).map(score).collect()
}

/// Returns the emission distribution in proportion to the scores, smoothed over neighbouring cells,
/// so that a small feature is not missed.
fn learned_aim(scores: &[f64], side: usize) -> Aim {
    if scores.iter().all(|&score| score == scores[0]) {
        return Aim::plain();
    }
    let smooth: Vec<f64> = (0..scores.len()).map(|cell| smoothed(scores, side, cell)).collect();
    Aim::learned(side, &smooth)
}

/// Returns the sum of the mean squared contributions of the cells under a distribution. A
/// contribution is the score of a path divided by its density.
fn second_moment(aim: &Aim, squares: &[Option<f64>], side: usize) -> f64 {
    let centre = |cell: usize| [cell % side, cell / side].map(|place| (place as f64 + 0.5) / side as f64);
    let of_cell = |(cell, square): (usize, &Option<f64>)| square.map(|square| square / aim.relative_pdf(centre(cell)));
    squares.iter().enumerate().filter_map(of_cell).sum()
}

/// Returns the mean of the score of a cell and of the highest score among it and its neighbours.
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
        if arrival.photon.is_truncated() {
            return;
        }
        let in_view = self.scene.camera.connect(arrival.interaction.hit.position, [0.5; 2]).is_some();
        let power = self.relative_power(arrival.photon);
        self.surface_score += power
            * match (arrival.photon.light_path, in_view) {
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
        if photon.is_truncated() || !medium.medium.scatters() || !segment.length_m.is_finite() {
            return;
        }
        // Estimates the visible fraction of the segment from five points.
        let points = [0.1, 0.3, 0.5, 0.7, 0.9].map(|fraction| segment.ray.at(fraction * segment.length_m));
        let in_view = points.iter().filter(|&&point| self.scene.camera.connect(point, [0.5; 2]).is_some()).count();
        let weight = match class {
            PhotonClass::Caustic => 1.0,
            PhotonClass::Indirect => 0.3,
        };
        self.volume_score = self.volume_score.max(weight * 0.2 * in_view as f64 * self.relative_power(photon));
    }

    fn on_start(&mut self, _ray: &Ray, photon: &PhotonState) {
        self.start_power = photon.power.iter().sum();
    }

    fn on_emission(&mut self, stratum: usize, aim: [f64; 2]) {
        self.current = self.layout.first_cells[stratum] + Aim::cell(aim, self.layout.sides[stratum]);
        self.halves[self.half].paths[self.current] += 1.0;
    }

    fn on_arrival(&mut self, arrival: &SurfaceArrival<'_>) {
        let interaction = arrival.interaction;
        self.reached[interaction.hit.object as usize] = true;
        // A path passes through the faces of a body inside of a body of higher priority.
        interaction.here.bodies().for_each(|object| self.reached[object as usize] = true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed};

    const SIDE: usize = 64;

    /// Returns both halves of the mean squared scores of a grid with 16 paths per cell, which
    /// contribute with this probability.
    fn halves(probability: impl Fn(usize) -> f64) -> [Vec<Option<f64>>; 2] {
        let mut stream = Stream::new(Seed::new(3), Purpose::SurveyPhoton, 0, 0);
        let mut half = || {
            let mut mean = |cell| (0..8).filter(|_| stream.uniform() < probability(cell)).count() as f64 / 8.0;
            (0..SIDE * SIDE).map(|cell| Some(mean(cell))).collect()
        };
        [half(), half()]
    }

    fn chosen(probability: impl Fn(usize) -> f64) -> usize {
        let [even, odd] = halves(probability);
        block_size([&even, &odd], SIDE)
    }

    /// One path in a thousand contributes, wherever it starts. Following the few cells with such a
    /// path would send most photons astray.
    #[test]
    fn rare_contributions_from_everywhere_teach_no_aim() {
        assert_eq!(chosen(|_| 1e-3), SIDE);
    }

    #[test]
    fn a_small_bright_region_is_aimed_at_cell_by_cell() {
        assert_eq!(chosen(|cell| if cell % SIDE / 2 == 9 && cell / SIDE / 2 == 20 { 0.5 } else { 1e-4 }), 1);
    }

    #[test]
    fn a_large_faint_region_is_aimed_at_in_blocks() {
        let block = chosen(|cell| if cell % SIDE < 16 && cell / SIDE < 16 { 0.02 } else { 0.0 });
        assert!((2..=16).contains(&block), "{block}");
    }
}
