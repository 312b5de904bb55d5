//! A spatial index of boxes, for searches along rays. A query finds all boxes touched by a narrow
//! cone around a ray.
//!
//! The index is a bounding volume hierarchy built by parallel locally-ordered clustering (PLOC,
//! Meister & Bittner 2018). A query widens the boxes by the cone's radius, so that each pixel can
//! use its own radius.

use super::query_cone::QueryCone;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use std::num::NonZeroU32;

/// A bounding volume hierarchy over boxes.
///
/// Queries need no stack. Each node stores a *skip link*: the number of the node at which the query
/// continues after the node's subtree (Smits 1998, "Efficiency Issues for Ray Tracing"). Therefore
/// the depth of the tree has no limit, and a query allocates nothing.
#[derive(Default)]
pub(super) struct BoxTree {
    /// The nodes, with their skip links in `meta1`.
    nodes: Vec<Bvh2Node>,
    /// The numbers of the boxes, in the order of the leaves.
    boxes: Vec<u32>,
}

impl std::fmt::Debug for BoxTree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BoxTree").field("boxes", &self.boxes.len()).finish()
    }
}

impl BoxTree {
    /// Builds the index. A box is a pair of corners: the least and the largest coordinates in m,
    /// relative to the scene's centre. Box number i is `boxes[i]`.
    pub(super) fn build(boxes: &[(Vec3, Vec3)]) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        let boxes: Vec<Aabb> = boxes.iter().map(|&(low, high)| Aabb::new(low.into(), high.into())).collect();
        let indices = (0..boxes.len() as u32).collect();
        let search = PlocSearchDistance::Low;
        let Bvh2 { nodes, primitive_indices, .. } =
            PlocBuilder::with_capacity(boxes.len()).build(search, &boxes, indices, SortPrecision::U64, 0);
        Self::new(nodes, primitive_indices)
    }

    /// Creates the index from the nodes of a tree, and computes their skip links from the root
    /// down.
    fn new(mut nodes: Vec<Bvh2Node>, boxes: Vec<u32>) -> Self {
        let mut open = vec![0];
        while let Some(parent) = open.pop() {
            let Bvh2Node { prim_count, first_index, meta1: skip_link, .. } = nodes[parent];
            if prim_count == 0 {
                let first = first_index as usize;
                nodes[first + 1].meta1 = first_index;
                nodes[first].meta1 = skip_link;
                open.extend([first, first + 1]);
            }
        }
        Self { nodes, boxes }
    }

    /// Calls `visit` with the number of each box that the cone may touch.
    #[inline]
    pub(super) fn visit(&self, cone: &QueryCone, mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let slabs = Slabs::new(cone);
        let mut next = 0;
        loop {
            let node = &self.nodes[next];
            let touched = slabs.touch(&node.aabb);
            if touched && node.prim_count == 0 {
                // The second child comes first; its skip link leads to the first child.
                next = node.first_index as usize + 1;
                continue;
            }
            if touched {
                let first = node.first_index as usize;
                self.boxes[first..first + node.prim_count as usize].iter().for_each(|&i| visit(i));
            }
            match skip_link(node) {
                Some(link) => next = link.get() as usize,
                None => return,
            }
        }
    }
}

/// Returns the next node outside a node's subtree; `None` ends the query. The root is node 0 and
/// never follows another node, so the value 0 means "no next node".
#[inline]
fn skip_link(node: &Bvh2Node) -> Option<NonZeroU32> {
    NonZeroU32::new(node.meta1)
}

/// The cone in single precision, prepared for tests against boxes.
struct Slabs {
    origin: Vec3A,
    inverse: Vec3A,
    length: f32,
    radius: f32,
    slope: f32,
}

impl Slabs {
    fn new(cone: &QueryCone) -> Self {
        let tiny = |x: f64| if x.abs() < 1e-12 { 1e-12_f64.copysign(x) } else { x };
        let direction = cone.ray.direction;
        let inverse = DVec3::new(tiny(direction.x), tiny(direction.y), tiny(direction.z)).recip();
        Self {
            origin: cone.ray.origin.as_vec3a(),
            inverse: inverse.as_vec3a(),
            length: cone.length_m as f32,
            radius: cone.radius_m as f32,
            slope: cone.slope as f32,
        }
    }

    /// Returns true if the cone may touch the box. Because of rounding, the test may accept a box
    /// that the cone misses, but it never rejects a box that the cone touches.
    #[inline]
    fn touch(&self, aabb: &Aabb) -> bool {
        let (centre, half) = (0.5 * (aabb.min + aabb.max), 0.5 * (aabb.max - aabb.min));
        let offset = centre - self.origin;
        let far = self.length.min(offset.length() + half.length());
        let rounding = 4.0 * f32::EPSILON * (offset.abs() + half).max_element();
        let wide = half + Vec3A::splat(1.01 * (self.radius + self.slope * far) + rounding);
        let (a, b) = ((offset - wide) * self.inverse, (offset + wide) * self.inverse);
        let enter = a.min(b).max_element().max(0.0);
        let exit = a.max(b).min_element().min(self.length * (1.0 + 1e-6));
        enter <= exit * (1.0 + 1e-6) + f32::MIN_POSITIVE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::math::random::{Purpose, Stream};
    use crate::math::warp;

    /// Compares the result of a query with a brute-force search.
    #[test]
    fn cone_query_finds_every_touched_box() {
        let mut stream = Stream::new(3, Purpose::Pilot, 0, 0);
        let mut point = || DVec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 0.5;
        let places: Vec<DVec3> = (0..3000).map(|_| point()).collect();
        let boxes: Vec<(Vec3, Vec3)> = places.iter().map(|p| (p.as_vec3(), p.as_vec3())).collect();
        let index = BoxTree::build(&boxes);
        let mut stream = Stream::new(4, Purpose::Pilot, 0, 0);
        let mut found_any = 0;
        for i in 0..200 {
            let direction = if i % 4 == 0 { DVec3::X } else { warp::sphere(stream.pair()) };
            let cone = QueryCone {
                ray: Ray::new(point_of(&mut stream), direction),
                length_m: 0.8,
                radius_m: 0.02,
                slope: 0.02,
            };
            let mut found = Vec::new();
            index.visit(&cone, |i| found.push(i as usize));
            for (i, place) in places.iter().enumerate() {
                let offset = *place - cone.ray.origin;
                let t = offset.dot(direction);
                let near = (offset - t * direction).length() <= cone.radius_at(t);
                if near && t > 0.0 && t < cone.length_m {
                    found_any += 1;
                    assert!(found.contains(&i), "{place}");
                }
            }
        }
        assert!(found_any > 200);
    }

    fn point_of(stream: &mut Stream) -> DVec3 {
        DVec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 0.5
    }

    /// A query finds all boxes, even in a tree where every inner node has a leaf as one of its
    /// children.
    #[test]
    fn a_very_deep_tree_loses_no_box() {
        const INNER: u32 = 1000;
        let aabb = Aabb::new(Vec3A::splat(-1.0), Vec3A::splat(1.0));
        for deep_child in [1, 2] {
            let inner = |first_index| Bvh2Node::new(aabb, 0, first_index);
            let leaf = |i| Bvh2Node::new(aabb, 1, i);
            let mut nodes = vec![inner(1)];
            for i in 1..INNER {
                let next = inner(2 * i + 1);
                nodes.extend(if deep_child == 1 { [next, leaf(i)] } else { [leaf(i), next] });
            }
            nodes.extend([leaf(0), leaf(INNER)]);
            let tree = BoxTree::new(nodes, (0..=INNER).collect());
            let ray = Ray::new(DVec3::ZERO, DVec3::X);
            let mut found = Vec::new();
            tree.visit(&QueryCone { ray, length_m: 1.0, radius_m: 0.1, slope: 0.0 }, |i| found.push(i));
            found.sort_unstable();
            assert_eq!(found, (0..=INNER).collect::<Vec<_>>());
        }
    }
}
