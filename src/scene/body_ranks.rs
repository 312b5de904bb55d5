//! The ranks of bodies, which decide which body fills the space where bodies overlap.

use super::Scene;
use glam::DVec3;

impl Scene {
    /// Ranks the bodies by their priority, and bodies of equal priority by the volume of their
    /// bounding boxes. A smaller box has a higher rank.
    ///
    /// Of two nested bodies, the inner body therefore has the higher rank. Where two bodies overlap
    /// in part, the ranks give the same body for paths from all directions. Bodies of equal priority
    /// with boxes of equal volume have equal ranks.
    pub(super) fn rank_bodies(&mut self) {
        /// Volumes are equal if they differ by at most this fraction.
        const ROUNDING: f64 = 1e-9;
        let boxes = [&self.geometry, &self.boundaries].map(|geometry| geometry.object_bounds());
        let volume_m3 = |(low, high): (DVec3, DVec3)| (high - low).element_product();
        let bodies = boxes.into_iter().flatten().filter_map(|(object, corners)| {
            let priority = self.body_of(object)?.priority;
            Some((priority, volume_m3(corners), object))
        });
        let mut bodies: Vec<(i32, f64, u32)> = bodies.collect();
        bodies.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        self.body_ranks = vec![0; self.objects.len()];
        let mut rank = 0;
        for (i, &(priority, volume_m3, object)) in bodies.iter().enumerate() {
            let equals = |&(other, larger_m3, _): &(i32, f64, u32)| {
                priority == other && volume_m3 >= larger_m3 * (1.0 - ROUNDING)
            };
            rank += i32::from(i > 0 && !equals(&bodies[i - 1]));
            self.body_ranks[object as usize] = rank;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;
    use crate::scene::medium_stack::MediumStack;
    use crate::{format, format::resolve::resolve};

    /// Three boxes of equal priority and one of a higher priority. Each is filled with its own fog.
    fn scene() -> Scene {
        let text = r#"{
  "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "media": {"a": {"homogeneous": {"absorption": 0, "scattering": 1, "phase": "isotropic"}}, "b": {"homogeneous": {"absorption": 0, "scattering": 2, "phase": "isotropic"}},
    "c": {"homogeneous": {"absorption": 0, "scattering": 3, "phase": "isotropic"}}, "d": {"homogeneous": {"absorption": 0, "scattering": 4, "phase": "isotropic"}}},
  "materials": {"a": {"boundary": {"medium": "a"}}, "b": {"boundary": {"medium": "b"}}, "c": {"boundary": {"medium": "c"}},
    "d": {"boundary": {"medium": "d", "priority": 1}}},
  "objects": [{"shape": {"box": {"size": [1, 1, 1]}}, "material": "a"},
    {"shape": {"box": {"size": [0.9, 1, 1]}}, "material": "b", "transform": [{"translate": [0.5, 0, 0]}]},
    {"shape": {"box": {"size": [2, 2, 2]}}, "material": "c"},
    {"shape": {"box": {"size": [3, 3, 3]}}, "material": "d", "transform": [{"translate": [1, 1, 1]}]}],
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
        assert_eq!(medium_of(&[0, 2]), medium_of(&[2, 0]));
        assert_eq!(medium_of(&[3, 0, 1]).as_deref(), Some("d"), "the highest priority");
    }
}
