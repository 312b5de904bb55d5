//! A light tree: a binary tree of clusters of emitters, from which one emitter is sampled for each
//! point (Conty Estévez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
//! Splitting").
//!
//! - `bounds`: the bounds of a cluster, and the bound of the light that a point or a segment
//!   receives from the cluster (the importance).
//! - `build`: the surface area orientation heuristic, which splits clusters.
//! - `emitters`: the emitters of a scene.
//! - `tree`: the nodes, and sampling.
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
mod tree;

pub(in crate::gather) use bounds::{Receiver, ReceivingPoint, ReceivingSegment};
pub(super) use emitters::Emitters;
