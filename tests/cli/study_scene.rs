//! A glass ball over a floor, small enough for a quick study.

/// The scene. Its light is a point, which no path of the path tracer can hit.
pub(crate) const SCENE: &str = r#"{
  "title": "A ball & its <caustic>",
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 48, "height": 32},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "N-BK7"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "wall", "shape": {"box": {"size": [6, 3, 0.2]}}, "material": "grey", "transform": [{"translate": [0, 1.5, -2]}]},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"passes": 4, "photons": 500}
}"#;
