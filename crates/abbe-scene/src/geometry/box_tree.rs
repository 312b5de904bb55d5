//! A hierarchy of bounding boxes in double precision, for queries with a box instead of a ray.

use glam::DVec3;

/// The smallest and the largest coordinates of a box, in m.
pub type BoxCorners = (DVec3, DVec3);

/// A binary hierarchy over numbered boxes by median splits, whose depth is at most ⌈log₂ n⌉ even if
/// all boxes coincide.
#[derive(Debug, Clone, Default)]
pub struct BoxTree {
    nodes: Vec<Node>,
}

/// A node, with the union of the boxes below it.
#[derive(Debug, Clone, Copy)]
struct Node {
    around: BoxCorners,
    /// The largest extent below the node; see [`BoxTree::new`].
    extent: f64,
    /// The lowest number of a box below the node.
    least: u32,
    /// The first of two consecutive children; `None` for a leaf.
    children: Option<u32>,
}

impl BoxTree {
    /// Builds the hierarchy over boxes, each with an extent for which [`Self::first_around`] can
    /// prune. The number of a box is its position in the list.
    pub fn new(boxes: &[(BoxCorners, f64)]) -> Self {
        let leaf = |number: u32| {
            let (around, extent) = boxes[number as usize];
            Node { around, extent, least: number, children: None }
        };
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut nodes: Vec<Node> = order.first().map(|&first| leaf(first)).into_iter().collect();
        let mut open = vec![(0_usize, 0..boxes.len())];
        while let Some((index, range)) = open.pop() {
            let part = &mut order[range.clone()];
            if part.len() <= 1 {
                if let Some(&number) = part.first() {
                    nodes[index] = leaf(number);
                }
                continue;
            }
            nodes[index] = part.iter().map(|&number| leaf(number)).reduce(Node::with).unwrap_or(nodes[index]);
            let middle = |number: u32| {
                let (low, high) = boxes[number as usize].0;
                0.5 * low + 0.5 * high
            };
            let (low, high) = part.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &number| {
                (low.min(middle(number)), high.max(middle(number)))
            });
            let spread = high - low;
            let axis = (0..3).fold(0, |best, axis| if spread[axis] > spread[best] { axis } else { best });
            let half = part.len() / 2;
            let along = |number: u32| middle(number)[axis];
            part.select_nth_unstable_by(half, |&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
            let first = nodes.len();
            nodes[index].children = Some(first as u32);
            nodes.extend([nodes[index]; 2]);
            let split = range.start + half;
            open.extend([(first, range.start..split), (first + 1, split..range.end)]);
        }
        Self { nodes }
    }

    /// Returns true if `holds` is true for a box that overlaps or touches the given box.
    pub fn any_touching(&self, (low, high): BoxCorners, mut holds: impl FnMut(u32) -> bool) -> bool {
        let touches = |(from, to): BoxCorners| from.cmple(high).all() && to.cmpge(low).all();
        let mut open = vec![0];
        while let Some(node) = open.pop().and_then(|index: u32| self.nodes.get(index as usize)) {
            match node.children {
                _ if !touches(node.around) => {}
                Some(first) => open.extend([first, first + 1]),
                None if holds(node.least) => return true,
                None => {}
            }
        }
        false
    }

    /// Returns the lowest number of a box that contains the given box, has at least `extent`, and
    /// for which `holds` is true.
    pub fn first_around(
        &self,
        (low, high): BoxCorners,
        extent: f64,
        mut holds: impl FnMut(u32) -> bool,
    ) -> Option<u32> {
        let contains = |(from, to): BoxCorners| from.cmple(low).all() && to.cmpge(high).all();
        let mut best: Option<u32> = None;
        let mut open = vec![0];
        while let Some(node) = open.pop().and_then(|index: u32| self.nodes.get(index as usize)) {
            let can_improve = best.is_none_or(|best| node.least < best);
            if !can_improve || node.extent < extent || !contains(node.around) {
                continue;
            }
            match node.children {
                // The child with the lower number is on top of the stack.
                Some(first) if self.nodes[first as usize].least < self.nodes[first as usize + 1].least => {
                    open.extend([first + 1, first]);
                }
                Some(first) => open.extend([first, first + 1]),
                None if holds(node.least) => best = Some(node.least),
                None => {}
            }
        }
        best
    }
}

impl Node {
    fn with(self, other: Self) -> Self {
        let around = (self.around.0.min(other.around.0), self.around.1.max(other.around.1));
        Self {
            around,
            extent: self.extent.max(other.extent),
            least: self.least.min(other.least),
            children: self.children,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Random boxes of very different sizes, some of which coincide.
    fn random_boxes(count: usize) -> Vec<(BoxCorners, f64)> {
        let mut random = Pcg64::seed_from_u64(1);
        let mut point = || DVec3::from_array(random.random());
        (0..count)
            .map(|i| {
                let (middle, size) = if i % 5 == 0 { (DVec3::splat(0.5), 0.2) } else { (point(), point().x.powi(3)) };
                let half = 0.5 * size * if i % 5 == 0 { DVec3::ONE } else { point() };
                ((middle - half, middle + half), 2.0 * half.length())
            })
            .collect()
    }

    #[test]
    fn queries_agree_with_a_search_of_all_boxes() {
        for count in [0, 1, 2, 3, 500] {
            let boxes = random_boxes(count);
            let tree = BoxTree::new(&boxes);
            for &((low, high), extent) in &random_boxes(200) {
                let touches = |((from, to), _): &(BoxCorners, f64)| from.cmple(high).all() && to.cmpge(low).all();
                let odd = |number: u32| number % 2 == 1;
                let any = (0..).zip(&boxes).any(|(number, item)| touches(item) && odd(number));
                assert_eq!(tree.any_touching((low, high), odd), any);
                let around = |(number, ((from, to), larger)): &(u32, &(BoxCorners, f64))| {
                    from.cmple(low).all() && to.cmpge(high).all() && *larger >= extent && odd(*number)
                };
                let first = (0..).zip(&boxes).find(around).map(|(number, _)| number);
                assert_eq!(tree.first_around((low, high), extent, odd), first);
            }
        }
    }
}
