//! A light tree: a binary tree of clusters of emitters, from which one emitter is sampled for each
//! point (Conty Estévez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
//! Splitting").
//!
//! - `bounds`: the bounds of a cluster, and the bound of the light that a point or a segment
//!   receives from the cluster (the importance).
//! - `build`: the surface area orientation heuristic, which splits clusters.
//! - `emitters`: the emitters of a scene.
//!
//! Sampling descends from the root. At each node, it selects one of the two children in proportion
//! to their importance. The probability of an emitter is the product of the probabilities of these
//! selections. For a given emitter, the product is evaluated along the trail of the emitter, which
//! is one bit per node.
//!
//! **Differences from the paper.** The paper's importance takes the distance d and the cosines from
//! the bounding sphere of the cluster. They are inaccurate for points near long clusters, such as a
//! row of lamps or a luminous ceiling. This tree takes them from the box:
//!
//! - d² is the product ab of the smallest and the largest distance of the box. The mean of 1/d²
//!   over the distances from a to b is 1/(ab) (section 5.2 of the paper).
//! - cos θ'_i is h/√(ab), where h is the largest height of the box above the tangent plane of the
//!   surface.
//! - cos θ' is h'/√(ab), where h' is the largest height of the point above a plane through a point
//!   of the box. The planes are perpendicular to the normals of the emitters. For lights that shine
//!   into cones, cos θ' is 1 inside the paper's bound θ' = 0, and 0 outside.
//!
//! The importance is still 0 only if no emitter of the cluster can illuminate the point. The tree
//! is never split, so a point samples one emitter of the tree.

mod bounds;
mod build;
mod emitters;
#[cfg(test)]
mod tests;

pub(in crate::gather) use bounds::{Receiver, ReceivingPoint, ReceivingSegment};
pub(super) use emitters::Emitters;

use abbe_spectra::math::random::ONE_MINUS_ULP;
use bounds::{Cluster, LightBounds};

/// The bit of [`LightNode::link`] that marks a leaf.
const LEAF: u32 = 1 << 31;

/// A node of the tree. The first child of an inner node follows the node in the list.
#[derive(Debug, Clone, Copy)]
struct LightNode {
    cluster: Cluster,
    /// In an inner node: the position of the second child in the list. In a leaf: the number of the
    /// emitter, and the bit [`LEAF`].
    link: u32,
}

/// Light trees over disjoint sets of emitters.
#[derive(Debug, Clone, Default)]
pub(super) struct LightTree {
    nodes: Vec<LightNode>,
    /// For each emitter, the path from the root to its leaf. The lowest bit belongs to the root. A
    /// bit is 1 if the path goes to the second child.
    trails: Vec<u64>,
    /// For each emitter, the position of its leaf in the list.
    leaves: Vec<u32>,
}

impl LightTree {
    /// Adds a tree over the emitters that follow the emitters of earlier trees. Returns the root of
    /// the new tree.
    fn add(&mut self, bounds: &[LightBounds]) -> usize {
        let (root, first) = (self.nodes.len(), self.trails.len());
        self.trails.resize(first + bounds.len(), 0);
        self.leaves.resize(first + bounds.len(), 0);
        build::build(self, bounds, first);
        root
    }

    /// Samples an emitter for a receiver. Returns the number of the emitter and its probability.
    /// Replaces `u` by a new uniform number. Returns `None` if the receiver gets no light.
    pub(super) fn sample(&self, root: usize, receiver: &impl Receiver, u: &mut f64) -> Option<(usize, f64)> {
        let (mut index, mut probability) = (root, 1.0);
        loop {
            let node = &self.nodes[index];
            if node.link & LEAF != 0 {
                return Some(((node.link & !LEAF) as usize, probability));
            }
            let [first, second] = self.probabilities(index, receiver)?;
            (*u, probability, index) = if *u < first {
                (*u / first, probability * first, index + 1)
            } else {
                ((*u - first) / second, probability * second, node.link as usize)
            };
            *u = u.min(ONE_MINUS_ULP);
        }
    }

    /// Samples an emitter for a trial, as [`Self::sample`] does. The children of a node are
    /// selected in proportion to the square roots of their importance, so that the trials find weak
    /// emitters in front of strong emitters behind a wall.
    pub(super) fn sample_for_trial(&self, root: usize, receiver: &ReceivingPoint, u: &mut f64) -> Option<usize> {
        let mut index = root;
        while self.nodes[index].link & LEAF == 0 {
            let [first, second] = self.probabilities(index, receiver)?.map(f64::sqrt);
            let first = first / (first + second);
            (*u, index) = if *u < first {
                (*u / first, index + 1)
            } else {
                ((*u - first) / (1.0 - first), self.nodes[index].link as usize)
            };
            *u = u.min(ONE_MINUS_ULP);
        }
        Some((self.nodes[index].link & !LEAF) as usize)
    }

    /// Returns the bounds of an emitter.
    pub(super) fn cluster_of(&self, emitter: usize) -> &Cluster {
        &self.nodes[self.leaves[emitter] as usize].cluster
    }

    /// Returns the probability with which [`Self::sample`] samples an emitter for this receiver.
    pub(super) fn probability(&self, root: usize, emitter: usize, receiver: &impl Receiver) -> f64 {
        let (mut index, mut probability, mut trail) = (root, 1.0, self.trails[emitter]);
        while self.nodes[index].link & LEAF == 0 {
            let Some(children) = self.probabilities(index, receiver) else { return 0.0 };
            probability *= children[(trail & 1) as usize];
            index = if trail & 1 == 0 { index + 1 } else { self.nodes[index].link as usize };
            trail >>= 1;
        }
        probability
    }

    /// Returns the probabilities of both children of an inner node. Returns `None` if the receiver
    /// gets no light from the children, although the bounds of the node do not exclude such light.
    #[inline]
    fn probabilities(&self, index: usize, receiver: &impl Receiver) -> Option<[f64; 2]> {
        let children = [index + 1, self.nodes[index].link as usize];
        let [first, second] = children.map(|child| receiver.importance(&self.nodes[child].cluster));
        let sum = first + second;
        (sum > 0.0).then(|| [first / sum, second / sum])
    }
}
