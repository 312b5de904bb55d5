//! A spatial index of boxes: a query finds all boxes touched by a narrow cone around a ray.
//!
//! It is a bounding volume hierarchy built by parallel locally-ordered clustering (PLOC, Meister &
//! Bittner 2018), with up to eight boxes in a leaf for SIMD tests. A query widens the boxes by the
//! cone's radius, so that each pixel can use its own radius.

use super::query_cone::QueryCone;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

pub(super) const LEAF: usize = 8;

/// A bounding volume hierarchy over boxes.
///
/// The nodes are in preorder, so the first child follows its parent. Each node knows where the
/// query continues after its subtree (a skip link; Smits 1998, "Efficiency Issues for Ray
/// Tracing"), so queries need no stack, allocate nothing, and the depth has no limit.
#[derive(Debug, Default)]
pub(super) struct BoxTree {
    nodes: Vec<BoxNode>,
}

#[derive(Debug, Clone, Copy)]
struct BoxNode {
    /// The centre, in m relative to the scene's centre.
    centre: Vec3,
    half: Vec3,
    /// The number of the first node after this node's subtree.
    next: u32,
    /// The number of the leaf, or [`INNER`].
    leaf: u32,
}

const INNER: u32 = u32::MAX;

#[derive(Debug, Default)]
pub(super) struct Leaves {
    /// The numbers of the boxes, in the order of the leaves.
    pub(super) boxes: Vec<u32>,
    /// The place in `boxes` at which each leaf begins, and the number of boxes.
    pub(super) starts: Vec<u32>,
}

impl Leaves {
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|range| &self.boxes[range[0] as usize..range[1] as usize])
    }
}

impl BoxTree {
    /// Takes boxes as pairs of corners, in m relative to the scene's centre.
    pub(super) fn build(boxes: &[(Vec3, Vec3)]) -> (Self, Leaves) {
        if boxes.is_empty() {
            return Default::default();
        }
        let boxes: Vec<Aabb> = boxes.iter().map(|&(low, high)| Aabb::new(low.into(), high.into())).collect();
        let indices = (0..boxes.len() as u32).collect();
        let search = PlocSearchDistance::Low;
        let tree = PlocBuilder::with_capacity(boxes.len()).build(search, &boxes, indices, SortPrecision::U64, 0);
        Self::new(&tree)
    }

    /// Converts a binary tree: the largest subtrees of at most [`LEAF`] boxes become leaves.
    fn new(Bvh2 { nodes: binary, primitive_indices, .. }: &Bvh2) -> (Self, Leaves) {
        let counts = box_counts(binary);
        let mut nodes: Vec<BoxNode> = Vec::with_capacity(binary.len() / 4);
        let mut leaves = Leaves { boxes: Vec::with_capacity(primitive_indices.len()), starts: vec![0] };
        // The subtrees that are not in the index yet. `Err` holds a node whose subtree is complete.
        let mut open = vec![Ok(0)];
        while let Some(next) = open.pop() {
            let number = match next {
                Ok(number) => number,
                Err(done) => {
                    let end = nodes.len() as u32;
                    let node: &mut BoxNode = &mut nodes[done];
                    node.next = end;
                    continue;
                }
            };
            let node: &Bvh2Node = &binary[number];
            let is_leaf = counts[number] as usize <= LEAF;
            let Aabb { min, max } = node.aabb;
            nodes.push(BoxNode {
                centre: (0.5 * (min + max)).into(),
                half: (0.5 * (max - min)).into(),
                next: nodes.len() as u32 + 1,
                leaf: if is_leaf { leaves.starts.len() as u32 - 1 } else { INNER },
            });
            if is_leaf {
                add_boxes_below(binary, number, &mut leaves.boxes);
                leaves.starts.push(leaves.boxes.len() as u32);
            } else {
                let first = node.first_index as usize;
                open.extend([Err(nodes.len() - 1), Ok(first + 1), Ok(first)]);
            }
        }
        leaves.boxes.iter_mut().for_each(|place| *place = primitive_indices[*place as usize]);
        (Self { nodes }, leaves)
    }

    /// Calls `visit` with the number of each leaf that the cone may touch.
    #[inline]
    pub(super) fn visit(&self, cone: &QueryCone, mut visit: impl FnMut(usize)) {
        let slabs = Slabs::new(cone);
        let mut next = 0;
        while let Some(node) = self.nodes.get(next) {
            if !slabs.touch(node) {
                next = node.next as usize;
                continue;
            }
            if node.leaf != INNER {
                visit(node.leaf as usize);
            }
            next += 1;
        }
    }
}

fn box_counts(nodes: &[Bvh2Node]) -> Vec<u32> {
    let mut parents_first = Vec::with_capacity(nodes.len());
    let mut open = vec![0];
    while let Some(number) = open.pop() {
        parents_first.push(number);
        if nodes[number].prim_count == 0 {
            let first = nodes[number].first_index as usize;
            open.extend([first, first + 1]);
        }
    }
    let mut counts = vec![0; nodes.len()];
    for &number in parents_first.iter().rev() {
        let Bvh2Node { prim_count, first_index, .. } = nodes[number];
        let first = first_index as usize;
        counts[number] = if prim_count == 0 { counts[first] + counts[first + 1] } else { prim_count };
    }
    counts
}

/// Adds the places of the at most [`LEAF`] boxes below a node, so the recursion is shallow.
fn add_boxes_below(nodes: &[Bvh2Node], number: usize, places: &mut Vec<u32>) {
    let Bvh2Node { prim_count, first_index, .. } = nodes[number];
    if prim_count > 0 {
        places.extend(first_index..first_index + prim_count);
    } else {
        (0..2).for_each(|child| add_boxes_below(nodes, first_index as usize + child, places));
    }
}

/// The cone in single precision, prepared for tests against boxes.
struct Slabs {
    origin: Vec3A,
    direction: Vec3A,
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
            direction: direction.as_vec3a(),
            inverse: inverse.as_vec3a(),
            length: cone.length_m as f32,
            radius: cone.radius_m as f32,
            slope: cone.slope as f32,
        }
    }

    /// Returns true if the cone may touch the box. Rounding may accept a box that the cone misses,
    /// but never reject one that it touches.
    #[inline]
    fn touch(&self, node: &BoxNode) -> bool {
        let (centre, half) = (Vec3A::from(node.centre), Vec3A::from(node.half));
        let offset = centre - self.origin;
        let rounding = 4.0 * f32::EPSILON * (centre.abs() + self.origin.abs() + half).max_element();
        // No point of the box is farther along the ray.
        let far = (self.direction * offset + self.direction.abs() * half).element_sum() + 4.0 * rounding;
        let far = self.length.min(far.max(0.0));
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
    use abbe_scene::geometry::Ray;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};
    use abbe_spectra::math::warp;

    #[test]
    fn cone_query_finds_every_touched_box() {
        let mut stream = Stream::new(Seed::new(3), Purpose::SurveyPhoton, 0, 0);
        let mut point = || DVec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 0.5;
        let places: Vec<DVec3> = (0..3000).map(|_| point()).collect();
        let boxes: Vec<(Vec3, Vec3)> = places.iter().map(|p| (p.as_vec3(), p.as_vec3())).collect();
        let (index, leaves) = BoxTree::build(&boxes);
        let leaves: Vec<&[u32]> = leaves.iter().collect();
        let mut stream = Stream::new(Seed::new(4), Purpose::SurveyPhoton, 0, 0);
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
            index.visit(&cone, |leaf| found.extend(leaves[leaf].iter().map(|&i| i as usize)));
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

    /// A query finds all boxes, even if every inner node has a leaf as a child.
    #[test]
    fn a_very_deep_tree_loses_no_box() {
        const INNER_NODES: u32 = 1000;
        let aabb = Aabb::new(Vec3A::splat(-1.0), Vec3A::splat(1.0));
        for deep_child in [1, 2] {
            let inner = |first_index| Bvh2Node::new(aabb, 0, first_index);
            let leaf = |i| Bvh2Node::new(aabb, 1, i);
            let mut nodes = vec![inner(1)];
            for i in 1..INNER_NODES {
                let next = inner(2 * i + 1);
                nodes.extend(if deep_child == 1 { [next, leaf(i)] } else { [leaf(i), next] });
            }
            nodes.extend([leaf(0), leaf(INNER_NODES)]);
            let primitive_indices = (0..=INNER_NODES).collect();
            let (tree, leaves) = BoxTree::new(&Bvh2 { nodes, primitive_indices, ..Bvh2::default() });
            let leaves: Vec<&[u32]> = leaves.iter().collect();
            assert!(leaves.iter().all(|boxes| (1..=LEAF).contains(&boxes.len())));
            let ray = Ray::new(DVec3::ZERO, DVec3::X);
            let mut found = Vec::new();
            let cone = QueryCone { ray, length_m: 1.0, radius_m: 0.1, slope: 0.0 };
            tree.visit(&cone, |leaf| found.extend_from_slice(leaves[leaf]));
            found.sort_unstable();
            assert_eq!(found, (0..=INNER_NODES).collect::<Vec<_>>());
        }
    }
}
