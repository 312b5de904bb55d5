//! Construction of the light tree.

use super::bounds::{Cluster, LightBounds};
use super::tree::{LEAF, LightNode, LightTree};
use abbe_spectra::math::elementary::cbrt;
use abbe_spectra::math::sort::sort_by_number;
use glam::DVec3;

/// The number of buckets along an axis at whose borders a cluster may be split.
const BUCKETS: usize = 12;

/// Below this depth, clusters are split into halves of equal numbers, because the path to a leaf
/// must fit into the 64 bits of a trail.
const BALANCED_DEPTH: u32 = 30;

/// The margin around boxes, as a fraction of the largest extent of the cluster that is split.
const MARGIN: f64 = 0.01;

impl LightTree {
    /// Adds a tree over the next emitters. Returns its root.
    pub(super) fn add(&mut self, bounds: &[LightBounds]) -> usize {
        let (root, first) = (self.nodes.len(), self.trails.len());
        self.trails.resize(first + bounds.len(), 0);
        self.leaves.resize(first + bounds.len(), 0);
        build(self, bounds, first);
        root
    }
}

/// Appends the nodes of a tree and the trails of its emitters, which have these bounds. `first` is
/// the number of the first one.
fn build(tree: &mut LightTree, bounds: &[LightBounds], first: usize) {
    let mut numbers: Vec<u32> = (0..bounds.len() as u32).collect();
    tree.nodes.reserve(2 * bounds.len());
    Builder { tree, bounds, first }.cluster(&mut numbers, 0, 0);
}

struct Builder<'a> {
    tree: &'a mut LightTree,
    bounds: &'a [LightBounds],
    first: usize,
}

impl Builder<'_> {
    /// Appends the node of a cluster and all nodes below. `numbers` are its emitters, counted from
    /// the first of the tree. `trail` is the path from the root.
    fn cluster(&mut self, numbers: &mut [u32], depth: u32, trail: u64) -> LightBounds {
        if let [number] = *numbers {
            let (bounds, emitter) = (self.bounds[number as usize], self.first + number as usize);
            self.tree.nodes.push(LightNode { cluster: Cluster::new(&bounds), link: LEAF | emitter as u32 });
            self.tree.trails[emitter] = trail;
            self.tree.leaves[emitter] = self.tree.nodes.len() as u32 - 1;
            return bounds;
        }
        let (count, middle) = (numbers.len(), self.split(numbers, depth));
        let (below, above) = numbers.split_at_mut(middle);
        let index = self.tree.nodes.len();
        self.tree.nodes.push(LightNode { cluster: Cluster::new(&self.bounds[below[0] as usize]), link: 0 });
        let below = self.cluster(below, depth + 1, trail);
        let link = self.tree.nodes.len() as u32;
        let mut bounds = below.union(&self.cluster(above, depth + 1, trail | 1 << depth));
        bounds.least_distance_m = bounds.least_distance_m.max(0.5 * spacing(&bounds, count));
        self.tree.nodes[index] = LightNode { cluster: Cluster::new(&bounds), link };
        bounds
    }

    /// Orders the emitters by the split of least cost, and returns the number in the first child.
    fn split(&self, numbers: &mut [u32], depth: u32) -> usize {
        let half = numbers.len() / 2;
        let centre = |number: u32| self.bounds[number as usize].centre();
        let (low, high) = numbers.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &number| {
            (low.min(centre(number)), high.max(centre(number)))
        });
        let extent = high - low;
        let longest = extent.max_position();
        if depth < BALANCED_DEPTH && extent[longest] > 0.0 {
            let best = (0..3)
                .filter_map(|axis| self.best_split(numbers, axis, (low, extent)))
                .min_by(|a, b| a.cost.total_cmp(&b.cost));
            if let Some(ClusterSplit { axis, bucket, .. }) = best {
                return partition(numbers, |number| bucket_of(centre(number), axis, (low, extent)) <= bucket);
            }
        }
        sort_by_number(numbers, |&number| centre(number)[longest]);
        half
    }

    /// Returns the best split along an axis (section 4.4), unless all centres are in one bucket.
    fn best_split(&self, numbers: &[u32], axis: usize, (low, extent): (DVec3, DVec3)) -> Option<ClusterSplit> {
        let longest = extent.max_element();
        if extent[axis] <= 0.0 {
            return None;
        }
        let mut buckets: [Option<LightBounds>; BUCKETS] = [None; BUCKETS];
        for &number in numbers {
            let bounds = &self.bounds[number as usize];
            let bucket = &mut buckets[bucket_of(bounds.centre(), axis, (low, extent))];
            *bucket = Some(bucket.map_or(*bounds, |known| known.union(bounds)));
        }
        let (margin, mut above, mut suffix) = (MARGIN * longest, [0.0; BUCKETS], None);
        for bucket in (1..BUCKETS).rev() {
            suffix = merged(suffix, buckets[bucket]);
            above[bucket - 1] = suffix.map_or(f64::INFINITY, |bounds: LightBounds| bounds.cost(margin));
        }
        let (mut prefix, mut best) = (None, None);
        for bucket in 0..BUCKETS - 1 {
            prefix = merged(prefix, buckets[bucket]);
            let below = prefix.map_or(f64::INFINITY, |bounds: LightBounds| bounds.cost(margin));
            // The regularisation factor keeps clusters from becoming thin.
            let cost = (below + above[bucket]) * longest / extent[axis];
            if cost.is_finite() && best.as_ref().is_none_or(|best: &ClusterSplit| cost < best.cost) {
                best = Some(ClusterSplit { axis, bucket, cost });
            }
        }
        best
    }
}

/// Returns the mean spacing of emitters in m. A receiver inside the box of a cluster, which may be
/// a line, a sheet or a block, is about half a spacing away from the nearest emitter.
fn spacing(bounds: &LightBounds, count: usize) -> f64 {
    let mut size = (bounds.high - bounds.low).to_array();
    size.sort_by(f64::total_cmp);
    let ([thin, wide, long], count) = (size, count as f64);
    (long / count).max((long * wide / count).sqrt()).max(cbrt(long * wide * thin / count))
}

struct ClusterSplit {
    axis: usize,
    bucket: usize,
    cost: f64,
}

fn merged(a: Option<LightBounds>, b: Option<LightBounds>) -> Option<LightBounds> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(&b)),
        (a, b) => a.or(b),
    }
}

fn bucket_of(centre: DVec3, axis: usize, (low, extent): (DVec3, DVec3)) -> usize {
    (((centre[axis] - low[axis]) / extent[axis] * BUCKETS as f64) as usize).min(BUCKETS - 1)
}

/// Moves the numbers that satisfy a condition to the front, in order, and returns their count.
fn partition(numbers: &mut [u32], is_first: impl Fn(u32) -> bool) -> usize {
    let (first, rest): (Vec<u32>, Vec<u32>) = numbers.iter().partition(|&&number| is_first(number));
    let (place_of_first, place_of_rest) = numbers.split_at_mut(first.len());
    place_of_first.copy_from_slice(&first);
    place_of_rest.copy_from_slice(&rest);
    first.len()
}
