//! The bounding volume hierarchy (BVH), which finds the primitives that a ray may hit.
//!
//! Rays and primitives are in double precision; the boxes are in single precision. In the frame of
//! the traversal, the scene's box is centred on the origin, and a power of two scales its
//! half-extent to between 2⁹ and 2¹⁰. The ray's origin first moves forward, in double precision, to
//! the point where the ray enters this box. Rounding errors in this frame arise from the ray in
//! single precision, the slab tests and the compressed boxes. Together they move a plane of a box
//! by less than 2.3e-3. The boxes are padded by more (`PADDING`), so no primitive is missed at any
//! scale of the scene. `obvhs` ignores boxes that the ray leaves at a distance below 1e-4; the
//! padding also keeps this distance above 1e-4 for a box that contains the ray's origin.

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

use super::ray::Ray;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{exp2, log2};

/// Padding (2⁻⁸) of a box on every side, in the frame of the hierarchy.
const PADDING: f64 = 0.003_906_25;

/// Up to this number of primitives, testing all of them costs less than the test of one node.
const MAX_LISTED_PRIMITIVES: usize = 4;

/// Largest depth of a hierarchy for which the fixed traversal stack suffices.
const MAX_DEPTH: u32 = 31;

/// Largest depth of a binary hierarchy that `obvhs` converts, because it recurses: about 200 bytes
/// of the stack per level.
const MAX_BINARY_DEPTH: u32 = 2000;

/// Largest number of boxes with the same middle for which clustering is used: it merges only a few
/// of them in each of its passes, so that its time grows with the square of their number.
const MAX_AT_ONE_PLACE: usize = 1024;

#[derive(Debug, Clone)]
pub(crate) struct Bvh {
    low: DVec3,
    high: DVec3,
    middle: DVec3,
    scale: f64,
    nodes: BvhNodes,
}

#[derive(Debug, Clone)]
enum BvhNodes {
    /// Every ray is tested against the primitives 0..count.
    List(u32),
    Wide(CwBvh),
}

impl Bvh {
    /// Builds the hierarchy over boxes, and returns it with the list `order`: primitive i of the
    /// hierarchy is `boxes[order[i]]`. Returns an error if a box is not finite, or there are more
    /// than 2³² boxes.
    pub(crate) fn build(boxes: &[(DVec3, DVec3)]) -> Result<(Self, Vec<u32>)> {
        let nothing = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
        let (low, high) = boxes.iter().fold(nothing, |(low, high), b| (low.min(b.0), high.max(b.1)));
        let count = u32::try_from(boxes.len()).map_err(|_| Error::input("the scene has more than 2³² primitives"))?;
        if count == 0 {
            let bvh = Self { low, high, middle: DVec3::ZERO, scale: 1.0, nodes: BvhNodes::List(0) };
            return Ok((bvh, Vec::new()));
        }
        let extent = (0.5 * (high - low)).max_element();
        if !(low.is_finite() && high.is_finite() && extent.is_finite()) {
            return Err(Error::input("the bounds of an object are not finite").expected("finite positions and sizes"));
        }
        let middle = low + 0.5 * (high - low);
        let scale = if extent > 0.0 { exp2((9.0 - log2(extent).floor()).clamp(-1000.0, 1000.0)) } else { 1.0 };
        let mut bvh = Self { low, high, middle, scale, nodes: BvhNodes::List(count) };
        if boxes.len() <= MAX_LISTED_PRIMITIVES {
            return Ok((bvh, (0..count).collect()));
        }
        let padded: Vec<Aabb> = boxes.iter().map(|&(low, high)| bvh.padded(low, high)).collect();
        let by_surface_area = (most_at_one_place(&padded) <= MAX_AT_ONE_PLACE)
            .then(|| build_by_surface_area(&padded))
            .filter(|binary| binary_depth(binary) <= MAX_BINARY_DEPTH)
            .map(|binary| to_cwbvh(&binary))
            .filter(|wide| depth(wide) <= MAX_DEPTH);
        let mut wide = by_surface_area.unwrap_or_else(|| to_cwbvh(&build_by_median_splits(&padded)));
        wide.nodes.shrink_to_fit();
        let order = std::mem::take(&mut wide.primitive_indices);
        bvh.nodes = BvhNodes::Wide(wide);
        Ok((bvh, order))
    }

    fn padded(&self, low: DVec3, high: DVec3) -> Aabb {
        let low = (low - self.middle) * self.scale - PADDING;
        let high = (high - self.middle) * self.scale + PADDING;
        Aabb::new(low.as_vec3a(), high.as_vec3a())
    }

    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        match &self.nodes {
            BvhNodes::List(_) => 0,
            BvhNodes::Wide(wide) => wide.nodes.capacity() * size_of::<CwBvhNode>(),
        }
    }

    /// Calls `visit` with every primitive that the ray may hit between its origin and `t_max`,
    /// approximately in order of distance. `visit` returns a new upper limit of t, which must not
    /// exceed the limit before the call. A negative limit ends the traversal.
    #[inline]
    pub(crate) fn traverse(&self, ray: &Ray, t_max: f64, mut visit: impl FnMut(u32) -> f64) {
        let wide = match &self.nodes {
            BvhNodes::List(count) => {
                for primitive in 0..*count {
                    if visit(primitive) < 0.0 {
                        return;
                    }
                }
                return;
            }
            BvhNodes::Wide(wide) => wide,
        };
        let Some(start) = self.entry_t(ray) else { return };
        let to_tree = |t: f64| (((t - start) * self.scale) as f32).next_up();
        let origin = (ray.origin + start * ray.direction - self.middle) * self.scale;
        let mut left = to_tree(t_max);
        if left < 0.0 {
            return;
        }
        // Changes −0 to 0, because the slab tests would interpret the sign of −0 inconsistently.
        let direction = ray.direction.as_vec3a() + Vec3A::ZERO;
        let box_ray = BoxRay::new(origin.as_vec3a(), direction, 0.0, left);
        wide.ray_traverse(box_ray, &mut RayHit::none(), |_, primitive| {
            let t = visit(primitive as u32);
            left = left.min(to_tree(t));
            left
        });
    }

    /// Returns the t at which the ray enters the scene's box (0 from inside), or `None`.
    fn entry_t(&self, ray: &Ray) -> Option<f64> {
        let inside = ray.origin.cmpge(self.low) & ray.origin.cmple(self.high);
        if inside.all() {
            return Some(0.0);
        }
        let inverse = ray.direction.recip();
        // The padding covers rounding of the slab test, and flat scenes.
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

/// Builds a binary hierarchy by the surface area heuristic: parallel locally-ordered clustering
/// (PLOC), then reinsertion.
///
/// The steps are called one by one, because `build_cwbvh` of `obvhs` asserts in debug builds that
/// each box lies inside its parent box within 1e-5, which is too strict for the large coordinates
/// of this frame.
fn build_by_surface_area(boxes: &[Aabb]) -> Bvh2 {
    let indices = (0..boxes.len() as u32).collect();
    let search = PlocSearchDistance::Medium;
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(search, boxes, indices, SortPrecision::U64, 2);
    ReinsertionOptimizer::default().run(&mut binary, 0.1, None);
    binary
}

/// Builds a binary hierarchy by median splits along the axis with the largest spread of box
/// centres. For n boxes, its depth is at most ⌈log₂ n⌉. For scenes in which clustering gives a very
/// deep tree, such as hundreds of nested shells.
fn build_by_median_splits(boxes: &[Aabb]) -> Bvh2 {
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

fn to_cwbvh(binary: &Bvh2) -> CwBvh {
    bvh2_to_cwbvh(binary, 3, true, false)
}

/// Returns the largest number of boxes whose middles agree to 2⁻²¹ of the frame's width, to which
/// clustering sorts them.
fn most_at_one_place(boxes: &[Aabb]) -> usize {
    if boxes.len() <= MAX_AT_ONE_PLACE {
        return boxes.len();
    }
    let mut cells: Vec<[i32; 3]> =
        boxes.iter().map(|around| (around.center() * 1024.0).to_array().map(|x| x as i32)).collect();
    cells.sort_unstable();
    cells.chunk_by(|a, b| a == b).map(<[_]>::len).max().unwrap_or(0)
}

/// Returns the number of levels of a binary hierarchy below the root.
fn binary_depth(binary: &Bvh2) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0_u32, 0_u32)];
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        if let Some(node) = binary.nodes.get(index as usize).filter(|node| !node.is_leaf()) {
            open.extend([(node.first_index, level + 1), (node.first_index + 1, level + 1)]);
        }
    }
    deepest
}

/// Returns the number of levels below the root.
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
