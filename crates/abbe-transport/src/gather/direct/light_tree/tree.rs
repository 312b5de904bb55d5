//! The nodes of light trees, and the sampling of emitters.

use super::bounds::{Cluster, Receiver, ReceivingPoint};
use abbe_spectra::math::random::ONE_MINUS_ULP;

/// The bit of [`LightNode::link`] that marks a leaf.
pub(super) const LEAF: u32 = 1 << 31;

/// A node of the tree. The first child of an inner node follows the node in the list.
#[derive(Debug, Clone, Copy)]
pub(super) struct LightNode {
    pub(super) cluster: Cluster,
    /// The position of an inner node's second child, or the emitter of a leaf and [`LEAF`].
    pub(super) link: u32,
}

/// Light trees over disjoint sets of emitters.
#[derive(Debug, Clone, Default)]
pub(in crate::gather::direct) struct LightTree {
    pub(super) nodes: Vec<LightNode>,
    /// The path from the root to each emitter, lowest bit first: 1 for the second child.
    pub(super) trails: Vec<u64>,
    /// For each emitter, the position of its leaf in the list.
    pub(super) leaves: Vec<u32>,
}

impl LightTree {
    /// Samples an emitter for a receiver, or `None` if it gets no light. Returns the number of the
    /// emitter and its probability, and replaces `u` by a new uniform number.
    pub(in crate::gather::direct) fn sample(
        &self,
        root: usize,
        receiver: &impl Receiver,
        u: &mut f64,
    ) -> Option<(usize, f64)> {
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

    /// Like [`Self::sample`], but selects children in proportion to the square roots of their
    /// importance, so that trials find weak emitters in front of strong emitters behind a wall.
    pub(in crate::gather::direct) fn sample_for_trial(
        &self,
        root: usize,
        receiver: &ReceivingPoint,
        u: &mut f64,
    ) -> Option<usize> {
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

    pub(in crate::gather::direct) fn cluster_of(&self, emitter: usize) -> &Cluster {
        &self.nodes[self.leaves[emitter] as usize].cluster
    }

    /// Returns the probability with which [`Self::sample`] samples an emitter for this receiver.
    pub(in crate::gather::direct) fn probability(&self, root: usize, emitter: usize, receiver: &impl Receiver) -> f64 {
        let (mut index, mut probability, mut trail) = (root, 1.0, self.trails[emitter]);
        while self.nodes[index].link & LEAF == 0 {
            let Some(children) = self.probabilities(index, receiver) else { return 0.0 };
            probability *= children[(trail & 1) as usize];
            index = if trail & 1 == 0 { index + 1 } else { self.nodes[index].link as usize };
            trail >>= 1;
        }
        probability
    }

    /// Returns the probabilities of both children of an inner node, or `None` if neither lights the
    /// receiver, although the bounds of the node do not exclude it.
    #[inline]
    fn probabilities(&self, index: usize, receiver: &impl Receiver) -> Option<[f64; 2]> {
        let children = [index + 1, self.nodes[index].link as usize];
        let [first, second] = children.map(|child| receiver.importance(&self.nodes[child].cluster));
        let sum = first + second;
        (sum > 0.0).then(|| [first / sum, second / sum])
    }
}
