//! Reads a scene with mistakes, and prints each with its position in the text.
//!
//! ```text
//! cargo run --release -p abbe-format --example find_a_mistake
//! ```

use abbe_format::{parse, resolve::resolve};
use abbe_spectra::Result;
use std::path::Path;

const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "materials": {
    "grey": {"diffuse": {"reflectance": 1.5}},
    "glass": {"dielectric": {"ior": "N-BK8"}}
  },
  "objects": [{"name": "ball", "shape": {"sphere": {"radius": 1}}, "material": "glass"}],
  "lights": [{"point": {"at": [2, 5, 2], "intensity": 100, "spectrum": "D65"}}]
}"#;

/// Reads a scene, and returns the names of its objects.
fn objects(text: &str) -> Result<Vec<String>> {
    // `parse` checks the structure, and `resolve` looks up names and converts to SI units.
    let (file, source) = parse(text, Path::new("scene.json"), &[])?;
    let scene = resolve(&file, &source)?;
    Ok(scene.objects.into_iter().map(|object| object.name).collect())
}

fn main() -> Result<()> {
    let wrong_reflectance = SCENE.replace("N-BK8", "N-BK7");
    for text in [wrong_reflectance, SCENE.replace("1.5", "0.5")] {
        match objects(&text) {
            Ok(names) => println!("read the objects {names:?}"),
            Err(error) => println!("{error}"),
        }
    }
    println!("read the objects {:?}", objects(&SCENE.replace("1.5", "0.5").replace("N-BK8", "N-BK7"))?);
    Ok(())
}
