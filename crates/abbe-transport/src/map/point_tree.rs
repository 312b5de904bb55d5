//! A kd-tree over points with large leaves.
//!
//! A balanced tree needs no pointers: the numbers of points and leaves determine its shape. A leaf
//! holds groups of four points, which one SIMD instruction tests. A kernel contains many photons,
//! so queries are faster than with leaves of a few points.

use rayon::join;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::num::NonZero;
use wide::f32x4;

const LEAF: usize = 32;

const GROUP: usize = 4;

/// Parts of the tree with fewer points are built by one thread.
const POINTS_PER_TASK: usize = 8192;

/// A bound for the depth of the tree. The number of points has 32 bits.
const MAX_DEPTH: usize = 32;

/// A balanced kd-tree over points in single precision, which may be coplanar or coincident.
#[derive(Debug, Default)]
pub(super) struct PointTree {
    /// The inner nodes in preorder. A subtree of n leaves has n − 1 inner nodes.
    splits: Vec<PlaneSplit>,
    /// Each leaf has the same number of groups. Empty places are NaN, at no distance from any
    /// place.
    groups: Vec<Group>,
    /// The number of the first point of each leaf, and the number of points.
    starts: Vec<u32>,
}

/// A plane that divides the points of a node.
#[derive(Debug, Clone, Copy, Default)]
struct PlaneSplit {
    /// No point of the first child is above this coordinate, and none of the second is below it.
    at: f32,
    axis: u32,
}

/// The coordinates of four points: x of all points, then y, then z.
type Group = [[f32; GROUP]; 3];

#[derive(Debug, Clone, Copy)]
struct Key {
    position: [f32; 3],
    number: u32,
}

#[derive(Debug, Clone, Copy, Default)]
struct Subtree {
    node: u32,
    leaf: u32,
    leaves: u32,
    /// The squared distance from the query's centre to the plane that bounds the subtree.
    distance2: f32,
}

impl PointTree {
    /// Builds the tree on the current thread pool, with the same result for any number of threads.
    /// Also returns the order of the points in the tree, as numbers of `positions`.
    pub(super) fn build(positions: impl ExactSizeIterator<Item = [f32; 3]>) -> (Self, Vec<u32>) {
        let count = positions.len();
        let mut keys: Vec<Key> = positions.zip(0..).map(|(position, number)| Key { position, number }).collect();
        let leaves = count.div_ceil(LEAF);
        let starts: Vec<u32> = (0..=leaves).map(|leaf| (leaf * count / leaves.max(1)) as u32).collect();
        let mut splits = vec![PlaneSplit::default(); leaves.saturating_sub(1)];
        divide(&mut keys, &starts, &mut splits);
        let mut groups = vec![[[f32::NAN; GROUP]; 3]; leaves * LEAF / GROUP];
        for (leaf, range) in starts.windows(2).enumerate() {
            for (place, key) in keys[range[0] as usize..range[1] as usize].iter().enumerate() {
                let group = &mut groups[(leaf * LEAF + place) / GROUP];
                (0..3).for_each(|axis| group[axis][place % GROUP] = key.position[axis]);
            }
        }
        (Self { splits, groups, starts }, keys.iter().map(|key| key.number).collect())
    }

    /// Calls `visit` with the number in the tree, the position and the squared distance of each
    /// point whose squared distance from `centre` is at most `radius2`.
    #[inline(always)]
    pub(super) fn within(&self, centre: [f32; 3], radius2: f32, mut visit: impl FnMut(usize, [f32; 3], f32)) {
        self.search(centre, radius2, |first, groups| {
            for_each_near(groups, centre, radius2, |place, distance2| {
                let group = &groups[place / GROUP];
                visit(first + place, [0, 1, 2].map(|axis| group[axis][place % GROUP]), distance2);
            });
            radius2
        });
    }

    /// Returns the squared distance to the `k`-th nearest point, or `None` above `farthest2`.
    pub(super) fn kth_distance2(&self, centre: [f32; 3], k: NonZero<usize>, farthest2: f32) -> Option<f32> {
        // The bits of numbers that are not negative have the order of the numbers.
        let mut nearest: BinaryHeap<u32> = BinaryHeap::with_capacity(k.get() + 1);
        let mut bound2 = farthest2;
        self.search(centre, farthest2, |_, groups| {
            for_each_near(groups, centre, bound2, |_, distance2| {
                if nearest.len() < k.get() {
                    nearest.push(distance2.to_bits());
                } else if let Some(mut last) = nearest.peek_mut()
                    && distance2.to_bits() < *last
                {
                    *last = distance2.to_bits();
                }
            });
            if let (true, Some(&last)) = (nearest.len() == k.get(), nearest.peek()) {
                bound2 = f32::from_bits(last);
            }
            bound2
        });
        (nearest.len() == k.get()).then_some(bound2)
    }

    /// Calls `scan` with the first point and the coordinates of the leaves near `centre`, nearer
    /// leaves first. `scan` returns the squared distance at which the search ends from then on.
    #[inline(always)]
    fn search(&self, centre: [f32; 3], mut bound2: f32, mut scan: impl FnMut(usize, &[Group]) -> f32) {
        let mut stack = [Subtree::default(); MAX_DEPTH];
        let mut depth = 0;
        let mut next = Subtree { leaves: (self.starts.len() - 1) as u32, ..Subtree::default() };
        if next.leaves == 0 {
            return;
        }
        loop {
            while next.leaves > 1 {
                let PlaneSplit { at, axis } = self.splits[next.node as usize];
                let offset = centre[axis as usize] - at;
                let half = next.leaves / 2;
                let lower = Subtree { node: next.node + 1, leaf: next.leaf, leaves: half, distance2: 0.0 };
                let upper = Subtree {
                    node: next.node + half,
                    leaf: next.leaf + half,
                    leaves: next.leaves - half,
                    distance2: 0.0,
                };
                let (near, far) = if offset < 0.0 { (lower, upper) } else { (upper, lower) };
                let distance2 = offset * offset;
                if distance2 <= bound2 {
                    stack[depth] = Subtree { distance2, ..far };
                    depth += 1;
                }
                next = near;
            }
            let leaf = next.leaf as usize;
            let groups = &self.groups[leaf * (LEAF / GROUP)..(leaf + 1) * (LEAF / GROUP)];
            bound2 = scan(self.starts[leaf] as usize, groups);
            loop {
                let Some(top) = depth.checked_sub(1) else { return };
                depth = top;
                next = stack[top];
                if next.distance2 <= bound2 {
                    break;
                }
            }
        }
    }
}

/// Calls `visit` with the place and the squared distance of each point within `radius2`.
#[inline(always)]
fn for_each_near(groups: &[Group], centre: [f32; 3], radius2: f32, mut visit: impl FnMut(usize, f32)) {
    let [x, y, z] = centre.map(f32x4::splat);
    let limit = f32x4::splat(radius2);
    for (number, group) in groups.iter().enumerate() {
        let [dx, dy, dz] = [f32x4::from(group[0]) - x, f32x4::from(group[1]) - y, f32x4::from(group[2]) - z];
        let distance2 = dx * dx + dy * dy + dz * dz;
        let mut near = distance2.simd_le(limit).to_bitmask();
        if near == 0 {
            continue;
        }
        let distance2 = distance2.to_array();
        while near != 0 {
            let place = near.trailing_zeros() as usize;
            near &= near - 1;
            visit(number * GROUP + place, distance2[place]);
        }
    }
}

/// Sorts the keys into their leaves and writes the planes of the inner nodes. `starts` holds the
/// first numbers of the leaves, and the number after the last key.
fn divide(keys: &mut [Key], starts: &[u32], splits: &mut [PlaneSplit]) {
    let leaves = starts.len() - 1;
    if leaves < 2 {
        return;
    }
    let (half, axis) = (leaves / 2, widest_axis(keys));
    let middle = (starts[half] - starts[0]) as usize;
    // Points at equal coordinates keep their order, so that the tree depends only on the points.
    let order = |a: &Key, b: &Key| match a.position[axis].total_cmp(&b.position[axis]) {
        Ordering::Equal => a.number.cmp(&b.number),
        unequal @ (Ordering::Less | Ordering::Greater) => unequal,
    };
    let (_, key, _) = keys.select_nth_unstable_by(middle, order);
    let (split, children) = splits.split_at_mut(1);
    split[0] = PlaneSplit { at: key.position[axis], axis: axis as u32 };
    let parallel = keys.len() > POINTS_PER_TASK;
    let (lower, upper) = keys.split_at_mut(middle);
    let (of_lower, of_upper) = children.split_at_mut(half - 1);
    let mut build_lower = || divide(lower, &starts[..=half], of_lower);
    let mut build_upper = || divide(upper, &starts[half..], of_upper);
    if parallel {
        join(build_lower, build_upper);
    } else {
        build_lower();
        build_upper();
    }
}

/// Returns the axis along which the keys extend farthest.
fn widest_axis(keys: &[Key]) -> usize {
    let (mut least, mut largest) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for key in keys {
        for axis in 0..3 {
            least[axis] = least[axis].min(key.position[axis]);
            largest[axis] = largest[axis].max(key.position[axis]);
        }
    }
    let extent = |axis: usize| largest[axis] - least[axis];
    (1..3).fold(0, |widest, axis| if extent(axis) > extent(widest) { axis } else { widest })
}
