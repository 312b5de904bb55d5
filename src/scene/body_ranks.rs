//! The ranks of bodies, which decide which body fills the space where bodies overlap.

use super::Scene;
use glam::DVec3;

impl Scene {
    /// Ranks the bodies by their priority, and bodies of equal priority by the volume of their
    /// bounding boxes. A smaller box has a higher rank. Of boxes of equal volume, the box of the
    /// last object has the highest rank.
    ///
    /// Of two nested bodies, the inner body therefore has the higher rank. Where two bodies overlap
    /// in part, the ranks give the same body for paths from all directions. Only bodies in the same
    /// box have equal ranks, because the ranks do not show which of them is the inner body.
    pub(super) fn rank_bodies(&mut self) {
        let boxes = [&self.geometry, &self.boundaries].map(|geometry| geometry.object_bounds());
        let bodies = boxes.into_iter().flatten().filter_map(|(object, (low, high))| {
            let volume_m3 = (high - low).element_product();
            Some(RankedBody { priority: self.body_of(object)?.priority, volume_m3, object, corners: [low, high] })
        });
        let mut bodies: Vec<RankedBody> = bodies.collect();
        bodies.sort_by(|a, b| {
            let by_size = a.priority.cmp(&b.priority).then(b.volume_m3.total_cmp(&a.volume_m3));
            by_size.then(a.object.cmp(&b.object))
        });
        self.body_ranks = vec![0; self.objects.len()];
        let mut rank = 0;
        for (i, body) in bodies.iter().enumerate() {
            rank += i32::from(i > 0 && !body.has_rank_of(&bodies[i - 1]));
            self.body_ranks[body.object as usize] = rank;
        }
    }
}

/// The properties of a body that fix its rank.
struct RankedBody {
    priority: i32,
    /// The volume of the bounding box.
    volume_m3: f64,
    object: u32,
    /// The corners of the bounding box.
    corners: [DVec3; 2],
}

impl RankedBody {
    /// Returns true if both bodies have the same priority and the same bounding box.
    fn has_rank_of(&self, other: &Self) -> bool {
        /// Two corners are equal if their distance is at most this fraction of the box's diagonal.
        const ROUNDING: f64 = 1e-9;
        let limit_m = ROUNDING * self.corners[0].distance(self.corners[1]);
        let same_box = self.corners.iter().zip(&other.corners).all(|(a, b)| a.distance(*b) <= limit_m);
        self.priority == other.priority && same_box
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;
    use crate::scene::medium_stack::MediumStack;
    use crate::{format, format::resolve::resolve};

    /// Boxes of fog of equal priority, a box of a higher priority, and a ball inside the first box.
    fn scene() -> Scene {
        let text = r#"{
  "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "media": {"a": {"homogeneous": {"absorption": 0, "scattering": 1, "phase": "isotropic"}}, "b": {"homogeneous": {"absorption": 0, "scattering": 2, "phase": "isotropic"}},
    "c": {"homogeneous": {"absorption": 0, "scattering": 3, "phase": "isotropic"}}, "d": {"homogeneous": {"absorption": 0, "scattering": 4, "phase": "isotropic"}}},
  "materials": {"a": {"boundary": {"medium": "a"}}, "b": {"boundary": {"medium": "b"}}, "c": {"boundary": {"medium": "c"}},
    "d": {"dielectric": {"ior": 1, "medium": "d", "priority": 1}}, "d0": {"boundary": {"medium": "d"}}},
  "objects": [{"shape": {"box": {"size": [1, 1, 1]}}, "material": "a"},
    {"shape": {"box": {"size": [0.9, 1, 1]}}, "material": "b", "transform": [{"translate": [0.5, 0, 0]}]},
    {"shape": {"box": {"size": [2, 2, 2]}}, "material": "c"},
    {"shape": {"box": {"size": [3, 3, 3]}}, "material": "d", "transform": [{"translate": [1, 1, 1]}]},
    {"shape": {"box": {"size": [1, 1, 1]}}, "material": "c", "transform": [{"translate": [0, 0.5, 0]}]},
    {"shape": {"sphere": {"radius": 0.5}}, "material": "d0"}],
  "lights": [{"point": {"at": [3, 3, 3], "spectrum": "E", "power": 1}}]
}"#;
        let (written, source) = format::parse(text, "overlap.json".as_ref(), &[]).unwrap();
        resolve(&written, &source).unwrap()
    }

    /// The body that fills an overlap does not depend on the order in which a path enters the
    /// bodies.
    #[test]
    fn order_of_entry_does_not_decide_between_bodies() {
        let scene = scene();
        let medium_of = |order: &[u32]| {
            let stack = order.iter().fold(MediumStack::AIR, |stack, &object| stack.entered(object));
            scene.medium_in(&stack).map(|number| scene.media[number].name.clone())
        };
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            assert_eq!(medium_of(&order).as_deref(), Some("b"), "the smallest box");
        }
        for order in [[0, 4], [4, 0]] {
            assert_eq!(medium_of(&order).as_deref(), Some("c"), "the last of two equal boxes");
        }
        assert_eq!(medium_of(&[0, 5]).as_deref(), Some("d"), "a ball that touches the faces of its box");
        assert_eq!(medium_of(&[3, 0, 1]).as_deref(), Some("d"), "the highest priority");
    }
}
