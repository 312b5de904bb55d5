//! A light tree: a binary tree of clusters of emitters, from which each point samples one emitter
//! (Conty Estévez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting").
//! The importance is a bound of the light that a point or a segment receives from a cluster
//! (`bounds`). The surface area orientation heuristic splits the clusters (`build`).
//!
//! Sampling descends from the root, and selects one of two children in proportion to their
//! importance. The probability of an emitter is the product of the probabilities of these
//! selections, along the trail of the emitter with one bit per node.
//!
//! **Differences from the paper.** The paper's importance takes the distance d and the cosines from
//! the bounding sphere of the cluster, which is inaccurate near long clusters, such as a row of
//! lamps or a luminous ceiling. This tree takes them from the box. d² is the product ab of its
//! smallest and largest distance, because the mean of 1/d² over the distances from a to b is 1/(ab)
//! (section 5.2 of the paper). cos θ'_i is h/√(ab), for the largest height h of the box above the
//! tangent plane of the surface. cos θ' is h'/√(ab), for the largest height h' of the point above a
//! plane through a point of the box and perpendicular to a normal of the emitters; for lights that
//! shine into cones, it is 1 inside the paper's bound θ' = 0, and 0 outside.
//!
//! The importance is still 0 only if no emitter of the cluster can illuminate the point. The tree
//! is never split, so a point samples one emitter of the tree.

mod bounds;
mod build;
mod emitters;
#[cfg(test)]
mod tests;
mod tree;

pub(in crate::gather) use bounds::{Receiver, ReceivingPoint, ReceivingSegment};
pub(super) use emitters::Emitters;
