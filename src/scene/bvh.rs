//! The tree of boxes: finds the few primitives that a ray may hit.
//!
//! Rays and primitives are double precision, the boxes single. They meet in the tree's own frame: the scene's box
//! centred on the origin and scaled by a power of two to a half-extent of 2⁹ to 2¹⁰. A ray's origin is first
//! moved forward, in double precision, to where it enters that box. In this frame all rounding (of origin and
//! direction to single precision, of the slab tests, of the boxes' compression) moves a plane by less than
//! 2.3e-3; the boxes are padded by `PADDING`, more than that, so that no primitive is ever missed. The padding
//! also lifts every box that holds a ray's origin above the tree's built-in least distance of 1e-4, whatever the
//! scene's true size.

use std::mem::size_of;

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray as BoxRay, RayHit};

use super::geometry::Ray;
use crate::error::{Error, Result};

/// How far a box is widened on every side, in the tree's frame (2⁻⁸).
const PADDING: f64 = 0.003_906_25;

/// Up to this many primitives are simply all tried: cheaper than one node of the tree.
const FEW: usize = 4;

/// Deepest tree that the traversal's fixed stack holds.
const DEEPEST: u32 = 31;

/// The boxes of all primitives.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    low: DVec3,
    high: DVec3,
    middle: DVec3,
    scale: f64,
    boxes: Boxes,
}

#[derive(Debug, Clone)]
enum Boxes {
    /// All of 0..count are tried.
    Few(u32),
    Wide(CwBvh),
}

impl Tree {
    /// Builds the tree over the primitives' boxes (least and largest coordinates). Returns it with the order in
    /// which it refers to them: its primitive number i is the caller's `order[i]`.
    ///
    /// # Errors
    /// A box that is not finite, or more than 2³² of them.
    pub(crate) fn build(boxes: &[(DVec3, DVec3)]) -> Result<(Self, Vec<u32>)> {
        let nothing = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
        let (low, high) = boxes.iter().fold(nothing, |(low, high), b| (low.min(b.0), high.max(b.1)));
        let count = u32::try_from(boxes.len()).map_err(|_| Error::input("the scene has more than 2³² primitives"))?;
        if count == 0 {
            let tree = Self { low, high, middle: DVec3::ZERO, scale: 1.0, boxes: Boxes::Few(0) };
            return Ok((tree, Vec::new()));
        }
        let extent = (0.5 * (high - low)).max_element();
        if !(low.is_finite() && high.is_finite() && extent.is_finite()) {
            return Err(Error::input("an object reaches to infinity").expected("finite positions and sizes"));
        }
        let middle = low + 0.5 * (high - low);
        let scale = if extent > 0.0 { (9.0 - extent.log2().floor()).clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
        let mut tree = Self { low, high, middle, scale, boxes: Boxes::Few(count) };
        if boxes.len() <= FEW {
            return Ok((tree, (0..count).collect()));
        }
        let padded: Vec<Aabb> = boxes.iter().map(|&(low, high)| tree.padded(low, high)).collect();
        let mut wide = widened(&by_surface_area(&padded));
        if depth(&wide) > DEEPEST {
            wide = widened(&by_halves(&padded));
        }
        wide.nodes.shrink_to_fit();
        let order = std::mem::take(&mut wide.primitive_indices);
        tree.boxes = Boxes::Wide(wide);
        Ok((tree, order))
    }

    fn padded(&self, low: DVec3, high: DVec3) -> Aabb {
        let low = (low - self.middle) * self.scale - PADDING;
        let high = (high - self.middle) * self.scale + PADDING;
        Aabb::new(low.as_vec3a(), high.as_vec3a())
    }

    /// Least and largest coordinates of everything.
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Memory held, in bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        match &self.boxes {
            Boxes::Few(_) => 0,
            Boxes::Wide(wide) => wide.nodes.capacity() * size_of::<CwBvhNode>(),
        }
    }

    /// Calls `visit` with every primitive that the ray may meet between its origin and `t_max`, roughly near to
    /// far. `visit` returns the t beyond which nothing matters any more (never more than it returned before);
    /// a value below 0 ends the search.
    #[inline]
    pub(crate) fn visit(&self, ray: &Ray, t_max: f64, mut visit: impl FnMut(u32) -> f64) {
        let wide = match &self.boxes {
            Boxes::Few(count) => {
                for primitive in 0..*count {
                    if visit(primitive) < 0.0 {
                        return;
                    }
                }
                return;
            }
            Boxes::Wide(wide) => wide,
        };
        let Some(start) = self.entry(ray) else { return };
        let to_tree = |t: f64| (((t - start) * self.scale) as f32).next_up();
        let origin = (ray.origin + start * ray.direction - self.middle) * self.scale;
        let mut left = to_tree(t_max);
        if left < 0.0 {
            return;
        }
        // Adding 0 turns −0 into 0, whose sign the slab tests would read two ways.
        let direction = ray.direction.as_vec3a() + Vec3A::ZERO;
        let box_ray = BoxRay::new(origin.as_vec3a(), direction, 0.0, left);
        wide.ray_traverse(box_ray, &mut RayHit::none(), |_, primitive| {
            let t = visit(primitive as u32);
            left = left.min(to_tree(t));
            left
        });
    }

    /// Where the ray enters the scene's box: 0 inside it, `None` where it passes by.
    fn entry(&self, ray: &Ray) -> Option<f64> {
        let inside = ray.origin.cmpge(self.low) & ray.origin.cmple(self.high);
        if inside.all() {
            return Some(0.0);
        }
        let inverse = ray.direction.recip();
        // Widened by the padding: the slab test rounds too, and a flat scene's box has no thickness.
        let margin = PADDING / self.scale;
        let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let low = self.low[axis] - margin - ray.origin[axis];
            let high = self.high[axis] + margin - ray.origin[axis];
            if ray.direction[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (t_low, t_high) = (low * inverse[axis], high * inverse[axis]);
            enter = enter.max(t_low.min(t_high));
            exit = exit.min(t_low.max(t_high));
        }
        (enter <= exit).then_some(enter)
    }
}

/// A binary tree by the surface area heuristic (parallel locally-ordered clustering, then reinsertion).
///
/// The crate's own `build_cwbvh` checks, in debug builds, that boxes nest to an absolute 1e-5, which our frame's
/// numbers are too large for; so its steps are called one by one.
fn by_surface_area(boxes: &[Aabb]) -> Bvh2 {
    let indices = (0..boxes.len() as u32).collect();
    let search = PlocSearchDistance::Medium;
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(search, boxes, indices, SortPrecision::U64, 2);
    ReinsertionOptimizer::default().run(&mut binary, 0.1, None);
    binary
}

/// A binary tree that splits the boxes in halves along the axis in which their centres spread most: at most as
/// deep as the count has binary digits, whatever the boxes are. For scenes (hundreds of nested shells) in which
/// clustering makes one long chain.
fn by_halves(boxes: &[Aabb]) -> Bvh2 {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![(0_usize, 0..boxes.len())];
    while let Some((node, range)) = open.pop() {
        let part = &mut order[range.clone()];
        let around = part.iter().fold(Aabb::empty(), |around, &index| around.union(&boxes[index as usize]));
        if part.len() == 1 {
            nodes[node] = Bvh2Node::new(around, 1, range.start as u32);
            continue;
        }
        let centres = part.iter().fold(Aabb::empty(), |centres, &index| {
            let centre = boxes[index as usize].center();
            centres.union(&Aabb::new(centre, centre))
        });
        let axis = centres.largest_axis();
        let along = |index: u32| boxes[index as usize].center()[axis];
        let half = part.len() / 2;
        part.select_nth_unstable_by(half, |&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
        nodes[node] = Bvh2Node::new(around, 0, nodes.len() as u32);
        open.push((nodes.len(), range.start..range.start + half));
        open.push((nodes.len() + 1, range.start + half..range.end));
        nodes.extend([Bvh2Node::default(); 2]);
    }
    Bvh2 { nodes, primitive_indices: order, ..Bvh2::default() }
}

fn widened(binary: &Bvh2) -> CwBvh {
    bvh2_to_cwbvh(binary, 3, true, false)
}

/// Levels of nodes below the root.
fn depth(wide: &CwBvh) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0_u32, 0_u32)];
    while let Some((node_index, level)) = open.pop() {
        deepest = deepest.max(level);
        let Some(node) = wide.nodes.get(node_index as usize) else { continue };
        for child in (0..8).filter(|&child| !node.is_child_empty(child) && !node.is_leaf(child)) {
            open.push((node.child_node_index(child), level + 1));
        }
    }
    deepest
}
