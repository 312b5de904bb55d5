//! The division of a stratum's emission square into rectangles that aim alike.
//!
//! The best density of photons is in proportion to the root mean square of their contributions.
//! The pilot's paths estimate it well in large rectangles and sharply in small ones. Among all
//! divisions by halving along either axis, with rectangles of at least 2⁻¹² of the area, dynamic
//! programming finds the best one (Donoho 1997, "CART and best-ortho-basis: a connection").
//!
//! The measure is the second moment of the estimate, cross-validated: with the density r from one
//! half of the paths, and the mean squares m from the other, it is ∫r · ∫m/r. The geometric mean of
//! both factors is at most their arithmetic mean, with equality for the best r, so the sum over all
//! rectangles of their area times (r + m/r) is minimised, to which each rectangle contributes by
//! itself. A division that only follows chance does badly with the other half of the paths.

use crate::emit::{Aim, AimTree};

/// The number of halvings between the square and the smallest rectangles: at most 4,096 leaves.
const MOST_HALVINGS: usize = 12;

/// The paths that the smallest rectangle holds on average under a uniform distribution.
const LEAST_PATHS: usize = 4;

/// The score of a rectangle is computed as if this many paths in it contributed like those of the
/// rectangle around it: without them, a rectangle whose paths all missed would have no density.
/// Cross-validation chooses one of these numbers. The division is found with the first.
const PRIOR_PATHS: [f64; 3] = [1.0, 1.0 / 8.0, 1.0 / 64.0];

/// How much a rectangle adds to the measure for the chance in its score, relative to its root mean
/// square and the relative variance of its mean square. The best of many divisions would follow
/// chance in both halves of the paths otherwise.
const CHANCE: f64 = 3.0;

/// A distribution is used only if it reduces the second moment to this fraction.
const WORTHWHILE: f64 = 0.9;

/// A path of the pilot with a weight: the reciprocal density of such paths in its stratum.
#[derive(Debug, Clone, Copy)]
pub(super) struct AimedPath {
    pub(super) point: [f64; 2],
    pub(super) weight: f64,
    /// The square of its contribution to the picture.
    pub(super) square: f64,
}

/// Learns the emission distribution of a stratum from both halves of its paths. Also returns the
/// mean of the root mean square contributions, over all rays of the stratum.
pub(super) fn learned_aim(halves: [&[AimedPath]; 2]) -> (Aim, f64) {
    let mut rectangles = Rectangles::new(halves);
    let overall = rectangles.whole([1.0, 1.0]).mean_square().sqrt();
    if overall == 0.0 {
        return (Aim::plain(), 0.0);
    }
    let division = rectangles.best_division();
    let densities = |prior_paths: f64, included: [f64; 2]| {
        let whole = rectangles.whole(included).mean_square();
        Densities { rectangles: &rectangles, division: &division, prior_paths, included }.of(Place::SQUARE, whole)
    };
    let moment = |aim: &Aim, half: usize| -> f64 {
        halves[half].iter().map(|path| path.weight * path.square / aim.relative_pdf(path.point)).sum()
    };
    // Each half tests the distribution from the other one.
    let tested = |prior_paths: f64| {
        let aims = [[0.0, 1.0], [1.0, 0.0]].map(|included| Aim::learned(&densities(prior_paths, included)));
        (prior_paths, moment(&aims[0], 0) + moment(&aims[1], 1))
    };
    let best = PRIOR_PATHS.map(tested).into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let plain = moment(&Aim::plain(), 0) + moment(&Aim::plain(), 1);
    match best {
        Some((prior_paths, learned)) if learned < WORTHWHILE * plain => {
            let densities = densities(prior_paths, [1.0, 1.0]);
            (Aim::learned(&densities), densities.integral())
        }
        Some(_) | None => (Aim::plain(), overall),
    }
}

/// Sums over the paths of a rectangle.
#[derive(Debug, Clone, Copy, Default)]
struct PathSums {
    count: f64,
    weight: f64,
    /// The weighted sum of the squared contributions.
    squares: f64,
    /// The sum of the squared terms of `squares`.
    squared_terms: f64,
}

impl PathSums {
    fn add(&mut self, other: Self, times: f64) {
        self.count += times * other.count;
        self.weight += times * other.weight;
        self.squares += times * other.squares;
        self.squared_terms += times * other.squared_terms;
    }

    fn mean_square(&self) -> f64 {
        if self.weight > 0.0 { self.squares / self.weight } else { 0.0 }
    }

    /// Returns the relative variance of the sum of squares: 1 for a single contribution, or none.
    fn relative_variance(&self) -> f64 {
        if self.squares > 0.0 { self.squared_terms / self.squares.powi(2) } else { 1.0 }
    }

    /// Returns the mean square, as if `prior_paths` further paths had the mean square `around`.
    fn mean_square_within(&self, around: f64, prior_paths: f64) -> f64 {
        (self.count * self.mean_square() + prior_paths * around) / (self.count + prior_paths)
    }
}

/// A rectangle of the square: the number of halvings along each axis, and its position among the
/// rectangles of this size, along each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    halvings: [usize; 2],
    position: [usize; 2],
}

impl Place {
    const SQUARE: Self = Self { halvings: [0; 2], position: [0; 2] };

    fn depth(self) -> usize {
        self.halvings[0] + self.halvings[1]
    }

    fn area(self) -> f64 {
        0.5_f64.powi(self.depth() as i32)
    }

    /// Returns the index among the rectangles of all sizes, with the larger ones first.
    fn index(self) -> usize {
        let (depth, [rows, columns]) = (self.depth(), self.position);
        first_index(depth) + (self.halvings[0] << depth) + (rows << self.halvings[1]) + columns
    }

    fn halves(self, axis: usize) -> [Self; 2] {
        [0, 1].map(|half| {
            let mut place = self;
            place.halvings[axis] += 1;
            place.position[axis] = 2 * place.position[axis] + half;
            place
        })
    }
}

/// Returns the number of rectangles with fewer halvings: the sum of (d + 1) 2^d over d < `depth`.
fn first_index(depth: usize) -> usize {
    if depth == 0 { 0 } else { ((depth - 1) << depth) + 1 }
}

/// How a rectangle is divided best.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Division {
    Whole,
    Halves { axis: usize },
}

/// All rectangles of a square by halving, with the sums of both halves of the paths.
struct Rectangles {
    most_halvings: usize,
    sums: Vec<[PathSums; 2]>,
}

impl Rectangles {
    fn new(halves: [&[AimedPath]; 2]) -> Self {
        let paths = halves[0].len() + halves[1].len();
        let most_halvings = (paths / LEAST_PATHS).max(1).ilog2() as usize;
        let most_halvings = most_halvings.min(MOST_HALVINGS);
        let mut rectangles =
            Self { most_halvings, sums: vec![[PathSums::default(); 2]; first_index(most_halvings + 1)] };
        for (half, paths) in halves.iter().enumerate() {
            for path in *paths {
                let square = path.weight * path.square;
                let (weight, squared_terms) = (path.weight, square * square);
                let sums = PathSums { count: 1.0, weight, squares: square, squared_terms };
                for first in 0..=most_halvings {
                    let halvings = [first, most_halvings - first];
                    let position = [0, 1].map(|axis| {
                        let count = 1_usize << halvings[axis];
                        ((path.point[axis] * count as f64) as usize).min(count - 1)
                    });
                    rectangles.sums[Place { halvings, position }.index()][half].add(sums, 1.0);
                }
            }
        }
        for depth in (0..most_halvings).rev() {
            rectangles.for_each_of(depth, |rectangles, place| {
                let axis = usize::from(place.halvings[1] > place.halvings[0]);
                let [a, mut b] = place.halves(axis).map(|half| rectangles.sums[half.index()]);
                (0..2).for_each(|half| b[half].add(a[half], 1.0));
                rectangles.sums[place.index()] = b;
            });
        }
        rectangles
    }

    fn for_each_of(&mut self, depth: usize, mut action: impl FnMut(&mut Self, Place)) {
        for first in 0..=depth {
            let halvings = [first, depth - first];
            for row in 0..1 << halvings[0] {
                for column in 0..1 << halvings[1] {
                    action(self, Place { halvings, position: [row, column] });
                }
            }
        }
    }

    /// Returns the sums of the whole square over the halves of the paths that are `included`.
    fn whole(&self, included: [f64; 2]) -> PathSums {
        self.sums_of(Place::SQUARE, included)
    }

    fn sums_of(&self, place: Place, included: [f64; 2]) -> PathSums {
        let mut sums = PathSums::default();
        self.sums[place.index()].iter().zip(included).for_each(|(half, times)| sums.add(*half, times));
        sums
    }

    /// Returns the best division of each rectangle, by its index.
    fn best_division(&mut self) -> Vec<Division> {
        let whole = [[1.0, 0.0], [0.0, 1.0]].map(|included| self.whole(included).mean_square());
        let mut measures = vec![0.0; self.sums.len()];
        let mut divisions = vec![Division::Whole; self.sums.len()];
        for depth in (0..=self.most_halvings).rev() {
            self.for_each_of(depth, |rectangles, place| {
                let (index, sums) = (place.index(), rectangles.sums[place.index()]);
                let measure = |learned: usize| {
                    let density = sums[learned].mean_square_within(whole[learned], PRIOR_PATHS[0]).sqrt();
                    density + if density > 0.0 { sums[1 - learned].mean_square() / density } else { 0.0 }
                };
                let mut both = sums[0];
                both.add(sums[1], 1.0);
                let root = both.mean_square_within(0.5 * (whole[0] + whole[1]), PRIOR_PATHS[0]).sqrt();
                let chance = CHANCE * root * both.relative_variance();
                measures[index] = place.area() * (measure(0) + measure(1) + chance);
                if depth < rectangles.most_halvings {
                    for axis in 0..2 {
                        let halved: f64 = place.halves(axis).iter().map(|half| measures[half.index()]).sum();
                        if halved < measures[index] {
                            (measures[index], divisions[index]) = (halved, Division::Halves { axis });
                        }
                    }
                }
            });
        }
        divisions
    }
}

/// The scores of the parts of a divided square.
struct Densities<'a> {
    rectangles: &'a Rectangles,
    division: &'a [Division],
    prior_paths: f64,
    included: [f64; 2],
}

impl Densities<'_> {
    /// Returns the root mean squares of the parts of a rectangle. `around` is the mean square of
    /// the rectangle that contains it.
    fn of(&self, place: Place, around: f64) -> AimTree {
        let sums = self.rectangles.sums_of(place, self.included);
        let mean_square = sums.mean_square_within(around, self.prior_paths);
        match self.division[place.index()] {
            Division::Whole => AimTree::Leaf(mean_square.sqrt()),
            Division::Halves { axis } => {
                AimTree::Halves { axis, halves: Box::new(place.halves(axis).map(|half| self.of(half, mean_square))) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};

    /// Returns paths that start at the points of a distribution and contribute with a probability
    /// that depends on the point.
    fn paths(aim: &Aim, count: usize, seed: u64, probability: impl Fn([f64; 2]) -> f64) -> Vec<AimedPath> {
        let mut stream = Stream::new(Seed::new(seed), Purpose::SurveyPhoton, 0, 0);
        let mut path = || {
            let (point, relative_pdf) = aim.sample([stream.uniform(), stream.uniform()]);
            let square = if stream.uniform() < probability(point) { 1.0 } else { 0.0 };
            AimedPath { point, weight: 1.0 / relative_pdf, square }
        };
        (0..count).map(|_| path()).collect()
    }

    /// Returns the fraction of later paths that contribute, after three rounds of learning.
    fn contributing(probability: impl Fn([f64; 2]) -> f64) -> f64 {
        let (mut aim, mut all) = (Aim::plain(), [Vec::new(), Vec::new()]);
        for seed in [1, 3, 5] {
            for (half, all) in (0..).zip(&mut all) {
                all.extend(paths(&aim, 1 << 13, seed + half, &probability));
            }
            aim = learned_aim([&all[0], &all[1]]).0;
        }
        let later = paths(&aim, 1 << 14, 7, &probability);
        later.iter().map(|path| path.square).sum::<f64>() / later.len() as f64
    }

    /// One path in a thousand contributes, wherever it starts. Following the few rectangles with
    /// such a path would send most photons astray.
    #[test]
    fn rare_contributions_from_everywhere_teach_no_aim() {
        for seed in 1..6 {
            let [even, odd] = [2 * seed, 2 * seed + 1].map(|seed| paths(&Aim::plain(), 1 << 14, seed, |_| 1e-3));
            assert!(learned_aim([&even, &odd]).0.is_plain(), "{seed}");
        }
    }

    /// A slit 3 % as wide as the beam, at no multiple of a power of two: 90 % of the photons pass.
    #[test]
    fn a_narrow_slit_receives_nearly_all_photons() {
        let through = contributing(|[_, y]| if (0.4711..0.5011).contains(&y) { 1.0 } else { 0.0 });
        assert!(through > 0.9, "{through}");
        let small = contributing(|[x, y]| if (x - 0.3).hypot(y - 0.6) < 0.03 { 1.0 } else { 0.0 });
        assert!(small > 0.6, "{small}");
    }

    /// Noise in a faint region teaches its outline and nothing within.
    #[test]
    fn a_faint_region_is_aimed_at_as_a_whole() {
        let probability = |[x, y]: [f64; 2]| if x < 0.25 && y < 0.25 { 0.02 } else { 0.0 };
        let found = contributing(probability);
        assert!(found > 0.6 * 0.02, "{found}");
    }

    /// The density in proportion to the root mean square minimises the variance.
    #[test]
    fn the_density_follows_the_root_mean_square() {
        let [even, odd] =
            [1, 2].map(|seed| paths(&Aim::plain(), 1 << 15, seed, |[x, _]| if x < 0.5 { 0.9 } else { 0.1 }));
        let (aim, mean_score) = learned_aim([&even, &odd]);
        let ratio = aim.relative_pdf([0.25, 0.3]) / aim.relative_pdf([0.75, 0.3]);
        // The defensive part makes it smaller than √9.
        let part = |root: f64| 0.05 + 0.95 * root / (0.5 * (0.9_f64.sqrt() + 0.1_f64.sqrt()));
        assert!((ratio / (part(0.9_f64.sqrt()) / part(0.1_f64.sqrt())) - 1.0).abs() < 0.05, "{ratio}");
        assert!((mean_score - 0.5 * (0.9_f64.sqrt() + 0.1_f64.sqrt())).abs() < 0.01, "{mean_score}");
    }

    /// Every rectangle has an index of its own.
    #[test]
    fn rectangles_have_different_indices() {
        let mut rectangles = Rectangles::new([&[], &[]]);
        let mut seen = vec![0; first_index(7)];
        for depth in 0..7 {
            rectangles.for_each_of(depth, |_, place| seen[place.index()] += 1);
        }
        assert!(seen.iter().all(|&times| times == 1));
    }
}
