//! The learned visibility of the lights: which emitters light which part of the scene (compare
//! Vévoda, Kondapaneni & Křivánek 2018, "Bayesian Online Regression for Adaptive Direct
//! Illumination Sampling").
//!
//! A light tree does not know that a wall hides a light. Before pass 0, trials from camera paths
//! measure the light that reaches surfaces. The surfaces are divided into cells: by the axis
//! nearest to the normal, and then at the medians of the positions. Each cell keeps the emitters
//! that brought most light, with the ratio between this light and their importance; the trials of
//! the cells around it also count, with a small weight. A point samples an emitter by the product
//! of the ratio and of the importance at the point. Other samples follow the tree, so the estimate
//! is unbiased for any trials.

use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_spectra::math::sort::sort_by_number;
use glam::DVec3;

/// The largest fraction of the samples that follow the learned weights. The others follow the tree,
/// so the variance is at most ten times that of the tree.
const LEARNED_FRACTION: f64 = 0.9;

/// A cell with twice this number of trials is divided.
const TRIALS_OF_CELL: usize = 256;

/// A group has between this number and twice this number of trials, or is a whole direction.
const TRIALS_OF_GROUP: usize = 2048;

/// The trials of the group count as much as this number of trials of an emitter in the cell. They
/// find emitters that no trial in the cell selected.
const GROUP_WEIGHT: f64 = 4.0;

/// The number of points at which the importance of an emitter in a cell is measured.
const IMPORTANCE_POINTS: usize = 32;

const MOST_EMITTERS: usize = 24;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightTrial {
    /// The position of the point in m.
    pub position: DVec3,
    /// The unit normal of the surface, on the side of the path.
    pub normal: DVec3,
    pub(super) emitter: u32,
    /// The light divided by the importance of the emitter, 0 if a surface hides it.
    pub(super) light_per_importance: f64,
}

/// The trials of one emitter in a part of the scene.
#[derive(Debug, Clone, Copy)]
struct EmitterTrials {
    emitter: u32,
    count: f64,
    lit: f64,
    /// The sum of the squares of [`LightTrial::light_per_importance`].
    squares: f64,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct LearnedLights {
    /// For each direction of an axis, the root of a tree of cells in `nodes`.
    roots: [Option<u32>; 6],
    nodes: Vec<CellNode>,
    emitters: Vec<LearnedEmitter>,
}

/// A node of a tree of cells. The first child of an inner node follows the node in the list.
#[derive(Debug, Clone, Copy, PartialEq)]
enum CellNode {
    /// Positions below `middle_m` on the axis belong to the first child.
    Divided { axis: usize, middle_m: f64, second: u32 },
    /// The emitters `emitters[from..to]`, and the fraction of the samples that follows them.
    Cell { from: u32, to: u32, fraction: f64 },
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct LearnedEmitter {
    number: u32,
    /// The root mean square of [`LightTrial::light_per_importance`].
    light_per_importance: f64,
}

/// The weights with which a point samples the emitters of its cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct LearnedWeights<'a> {
    emitters: &'a [LearnedEmitter],
    weights: [f64; MOST_EMITTERS],
    sum: f64,
    /// The fraction of the samples that follow the weights.
    pub(super) fraction: f64,
}

impl LearnedLights {
    /// Learns from trials. `importance` is that of an emitter at the point of a trial.
    pub(super) fn new(trials: &[LightTrial], importance: &impl Fn(u32, &LightTrial) -> f64) -> Self {
        let mut learned = Self::default();
        for direction in 0..6 {
            let mut of_direction: Vec<LightTrial> =
                trials.iter().copied().filter(|trial| direction_of(trial.normal) == direction).collect();
            if !of_direction.is_empty() {
                learned.roots[direction] = Some(learned.nodes.len() as u32);
                learned.divide(&mut of_direction, None, importance);
            }
        }
        learned
    }

    /// Appends the node of a part of the scene and all nodes below. `around` holds the emitters of
    /// the group around it, if the group is larger.
    fn divide(
        &mut self,
        trials: &mut [LightTrial],
        around: Option<&[EmitterTrials]>,
        importance: &impl Fn(u32, &LightTrial) -> f64,
    ) {
        let (low, high) = trials.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), trial| {
            (low.min(trial.position), high.max(trial.position))
        });
        let axis = (high - low).max_position();
        let is_cell = trials.len() < 2 * TRIALS_OF_CELL || low[axis] >= high[axis];
        let is_group = around.is_none() && (is_cell || trials.len() < 2 * TRIALS_OF_GROUP);
        let here = is_group.then(|| emitters_of(trials));
        let around = around.or(here.as_deref());
        if let (true, Some(around)) = (is_cell, around) {
            return self.add_cell(trials, around, importance);
        }
        sort_by_number(trials, |trial| trial.position[axis]);
        let (below, above) = trials.split_at_mut(trials.len() / 2);
        let (node, middle_m) = (self.nodes.len(), above[0].position[axis]);
        self.nodes.push(CellNode::Divided { axis, middle_m, second: 0 });
        self.divide(below, around, importance);
        let second = self.nodes.len() as u32;
        self.nodes[node] = CellNode::Divided { axis, middle_m, second };
        self.divide(above, around, importance);
    }

    /// Appends a cell. It has no emitters if no trial in its group found light.
    fn add_cell(
        &mut self,
        trials: &[LightTrial],
        around: &[EmitterTrials],
        importance: &impl Fn(u32, &LightTrial) -> f64,
    ) {
        let here = emitters_of(trials);
        let lit = around.iter().filter(|of_group| of_group.lit > 0.0);
        let mut found: Vec<LearnedEmitter> = lit
            .map(|of_group| {
                let of_cell = here.binary_search_by_key(&of_group.emitter, |it| it.emitter);
                let (count, lit) = of_cell.map_or((0.0, 0.0), |place| (here[place].count, here[place].lit));
                let visible = (lit + GROUP_WEIGHT * of_group.lit / of_group.count) / (count + GROUP_WEIGHT);
                let light_per_importance = (visible * of_group.squares / of_group.lit).sqrt();
                LearnedEmitter { number: of_group.emitter, light_per_importance }
            })
            .collect();
        let mut fraction = LEARNED_FRACTION;
        if found.len() > MOST_EMITTERS {
            let step = trials.len().div_ceil(IMPORTANCE_POINTS);
            let light = |it: &LearnedEmitter| {
                let importances = trials.iter().step_by(step).map(|trial| importance(it.number, trial));
                it.light_per_importance * importances.sum::<f64>()
            };
            let sum = |emitters: &[LearnedEmitter]| emitters.iter().map(light).sum::<f64>();
            let whole = sum(&found);
            sort_by_number(&mut found, |it| -light(it));
            found.truncate(MOST_EMITTERS);
            fraction *= if whole > 0.0 { sum(&found) / whole } else { 0.0 };
        }
        let from = self.emitters.len() as u32;
        self.emitters.append(&mut found);
        self.nodes.push(CellNode::Cell { from, to: self.emitters.len() as u32, fraction });
    }

    /// Returns the weights at a point, or `None` if no trial in the cell found light or no weight
    /// is above 0. `importance` is that of an emitter there.
    pub(super) fn weights(
        &self,
        (position, normal): (DVec3, DVec3),
        importance: impl Fn(usize) -> f64,
    ) -> Option<LearnedWeights<'_>> {
        let mut index = self.roots[direction_of(normal)]? as usize;
        let (emitters, fraction) = loop {
            match self.nodes[index] {
                CellNode::Divided { axis, middle_m, second } => {
                    index = if position[axis] < middle_m { index + 1 } else { second as usize };
                }
                CellNode::Cell { from, to, fraction } => break (&self.emitters[from as usize..to as usize], fraction),
            }
        };
        let mut weights = [0.0; MOST_EMITTERS];
        let mut sum = 0.0;
        for (weight, emitter) in weights.iter_mut().zip(emitters) {
            *weight = emitter.light_per_importance * importance(emitter.number as usize);
            sum += *weight;
        }
        (sum > 0.0).then_some(LearnedWeights { emitters, weights, sum, fraction })
    }
}

impl LearnedWeights<'_> {
    /// Samples an emitter. Replaces `u` by a new uniform number.
    pub(super) fn sample(&self, u: &mut f64) -> usize {
        let (mut left, mut last) = (*u * self.sum, 0);
        for (number, &weight) in self.weights[..self.emitters.len()].iter().enumerate() {
            if weight > 0.0 {
                last = number;
                if left < weight {
                    break;
                }
                left -= weight;
            }
        }
        *u = (left / self.weights[last]).clamp(0.0, ONE_MINUS_ULP);
        self.emitters[last].number as usize
    }

    /// Returns the probability with which [`Self::sample`] samples an emitter.
    pub(super) fn probability(&self, emitter: usize) -> f64 {
        let known = self.emitters.iter().position(|known| known.number as usize == emitter);
        known.map_or(0.0, |number| self.weights[number] / self.sum)
    }

    /// Mixes in the samples that follow the tree, where the emitter has the probability `in_tree`.
    pub(super) fn mixed(&self, emitter: usize, in_tree: f64) -> f64 {
        self.fraction * self.probability(emitter) + (1.0 - self.fraction) * in_tree
    }
}

fn emitters_of(trials: &[LightTrial]) -> Vec<EmitterTrials> {
    let mut sorted = trials.to_vec();
    sort_by_number(&mut sorted, |trial| f64::from(trial.emitter));
    let of_emitters = sorted.chunk_by(|one, other| one.emitter == other.emitter);
    of_emitters
        .map(|of_one| EmitterTrials {
            emitter: of_one[0].emitter,
            count: of_one.len() as f64,
            lit: of_one.iter().filter(|trial| trial.light_per_importance > 0.0).count() as f64,
            squares: of_one.iter().map(|trial| trial.light_per_importance.powi(2)).sum(),
        })
        .collect()
}

fn direction_of(normal: DVec3) -> usize {
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};

    /// The importance of emitter 5 at a point with x = 0.2.
    fn importance(emitter: u32, x: f64) -> f64 {
        if emitter == 5 { 1.0 + x } else { 1.0 }
    }

    /// Trials on a floor. Emitter 3 lights x < 0, and emitters 5 and 8 light the other half.
    fn learned() -> LearnedLights {
        let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
        let trials: Vec<LightTrial> = (0..8192)
            .map(|_| {
                let [u, v, choice] = stream.triple();
                let emitter = [3, 5, 8][(3.0 * choice) as usize];
                let light_per_importance = match (emitter, u < 0.5) {
                    (3, true) | (8, false) => 1.0,
                    (5, false) => 2.0,
                    _ => 0.0,
                };
                let position = DVec3::new(u - 0.5, 0.0, v);
                LightTrial { position, normal: DVec3::Y, emitter, light_per_importance }
            })
            .collect();
        LearnedLights::new(&trials, &|emitter, trial| importance(emitter, trial.position.x))
    }

    fn weights(learned: &LearnedLights, x: f64, normal: DVec3) -> Option<LearnedWeights<'_>> {
        learned.weights((DVec3::new(x, 0.1, 0.3), normal), |emitter| importance(emitter as u32, x))
    }

    #[test]
    fn each_part_samples_the_emitters_that_light_it() {
        let learned = learned();
        let probabilities = |x: f64| {
            let weights = weights(&learned, x, DVec3::Y).unwrap();
            [3, 5, 8, 9].map(|emitter| weights.probability(emitter))
        };
        let [first, second, third, other] = probabilities(-0.2);
        assert!(first > 0.9 && second + third < 0.1 && other == 0.0, "{second} and {third}");
        let [first, second, third, other] = probabilities(0.2);
        assert!((second / third - 2.4).abs() < 0.1 && first < 0.1 && other == 0.0, "{second} and {third}");
        assert!(weights(&learned, 0.2, DVec3::NEG_Y).is_none());
    }

    /// Uniform numbers sample emitters with their probabilities, and stay uniform.
    #[test]
    fn samples_have_their_probability() {
        let learned = learned();
        let weights = weights(&learned, 0.3, DVec3::Y).unwrap();
        let (mut counts, mut rest, n) = ([0.0; 9], 0.0, 10_000);
        for i in 0..n {
            let mut u = (f64::from(i) + 0.5) / f64::from(n);
            counts[weights.sample(&mut u)] += 1.0 / f64::from(n);
            rest += u / f64::from(n);
        }
        assert!((counts.iter().sum::<f64>() - 1.0).abs() < 1e-9 && (rest - 0.5).abs() < 1e-3);
        assert!((0..9).all(|emitter| (counts[emitter] - weights.probability(emitter)).abs() < 2e-4));
    }
}
