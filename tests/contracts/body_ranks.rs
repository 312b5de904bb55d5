//! Where bodies overlap, one of them fills the overlap, in any order of entry.

use abbe_format::{self as format, resolve::resolve};
use abbe_scene::Scene;
use abbe_scene::medium_stack::MediumStack;

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
