//! Scenes with several faults: one run reports all of them, in the order of their positions, and
//! reports nothing that only follows from another fault.

use std::path::Path;

use abbe_format::{self as format, FileAccess};
use abbe_spectra::error::MAX_FAULTS;

/// Returns the lines of the error of a scene, without the file name.
fn faults(text: &str) -> Vec<String> {
    let error = match format::parse_with_access(text, Path::new("s.json"), &[], FileAccess::default()) {
        Err(error) => error,
        Ok((scene, source)) => format::resolve::resolve(&scene, &source).unwrap_err(),
    };
    error.to_string().lines().map(|line| line.trim_start_matches("s.json:").to_string()).collect()
}

/// Checks that there is one fault for each pair, which states the start of the line (line and
/// path) and a part of the message.
fn assert_faults(text: &str, expected: &[(&str, &str)]) {
    let found = faults(text);
    let list = found.join("\n");
    assert_eq!(found.len(), expected.len(), "{list}");
    for (fault, (line, part)) in found.iter().zip(expected) {
        assert!(fault.starts_with(line) && fault.contains(part), "expected {line} {part} in\n{list}");
    }
}

/// The reader and the geometry both check the sizes of a shape.
#[test]
fn a_wrong_size_of_a_shape_is_told_once() {
    for (shape, path) in [
        (r#"{"prism": {"side": -1, "length": 2}}"#, "prism.side: found -1"),
        (r#"{"sphere": {"radius": -1}}"#, "sphere.radius: found -1"),
        (r#"{"cylinder": {"radius": 1, "height": 0}}"#, "cylinder.height: found 0"),
        (r#"{"box": {"size": [1, -1, 1]}}"#, "box.size[1]: found -1"),
    ] {
        let scene = format!(
            r#"{{"camera": {{"from": [0, 1, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
            "film": {{"width": 8, "height": 6}}, "materials": {{"paint": {{"diffuse": {{"reflectance": 0.5}}}}}},
            "objects": [{{"shape": {shape}, "material": "paint"}}],
            "lights": [{{"environment": {{"spectrum": 1, "luminance": 1}}}}]}}"#
        );
        assert_faults(&scene, &[("3:", &format!("objects[0].shape.{path}"))]);
    }
}

#[test]
fn all_faults_of_all_kinds_are_reported_together() {
    assert_faults(
        r#"{
          "camera": {"from": [0, 1, 5], "at": [0, 1], "lens": {"pinhole": {"fov": 400}}},
          "film": {"width": 0, "height": "tall"},
          "spectra": {"warm": {"blackbody": {"temperature": -1}}},
          "materials": {
            "crown": {"dielectric": {"ior": "BK7", "roughness": 2}},
            "flint": {"glass": {"ior": "N-SF10"}},
            "paint": {"diffuse": {"reflectance": "D666"}}
          },
          "objects": [
            {"shape": {"sphere": {"radus": 1}}, "material": "crown"},
            {"shape": {"box": {"size": [1, 0, -1]}}, "material": "flinnt"}
          ],
          "lights": [{"point": {"at": [0, 3, 0], "spectrum": "D65", "power": 1, "luminous_flux": 2}}],
          "lihgts": []
        }"#,
        &[
            ("2:", "camera.at: found an array of 2"),
            ("2:", "camera.lens.pinhole.fov: found 400"),
            ("3:", "film.width: found 0"),
            ("3:", "film.height: found \"tall\""),
            ("4:", "spectra.warm.blackbody.temperature: found -1"),
            ("6:", "materials.crown.dielectric.roughness: found 2"),
            ("7:", "unknown key \"glass\""),
            ("11:", "unknown key \"radus\""),
            ("12:", "objects[1].shape.box.size[1]: found 0"),
            ("12:", "objects[1].shape.box.size[2]: found -1"),
            ("14:", "found together with `power`"),
            ("15:", "unknown key \"lihgts\""),
        ],
    );
}

#[test]
fn unknown_names_are_reported_beside_other_faults() {
    assert_faults(
        r#"{
          "camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
          "film": {"width": 8, "height": 8},
          "materials": {
            "crown": {"dielectric": {"ior": "BK7", "absorption": "D666"}},
            "paint": {"diffuse": {"reflectance": "red paint"}}
          },
          "objects": [
            {"shape": {"sphere": {"radius": 1}}, "material": "crown"},
            {"shape": {"sphere": {"radius": 2}}, "material": "crown"},
            {"shape": {"sphere": {"radius": 2}, "material": "paint"}},
            {"shape": {"mesh": {"path": "missing.obj"}}, "material": "flinnt"}
          ],
          "lights": [{"point": {"at": [0, 3, 0], "spectrum": "D666", "power": 1}}],
          "atmosphere": "mist"
        }"#,
        &[
            ("missing.obj:", "objects[3].shape.mesh.path: cannot read the mesh"),
            ("5:", "unknown glass \"BK7\""),
            ("5:", "materials.crown.dielectric.absorption: unknown spectrum \"D666\""),
            ("6:", "unknown spectrum \"red paint\""),
            ("11:", "found a second key"),
            ("12:", "unknown material \"flinnt\""),
            ("14:", "lights[0].point.spectrum: unknown spectrum \"D666\""),
            ("15:", "atmosphere: unknown medium \"mist\""),
        ],
    );
}

/// With a misspelt key at the top, names are unknown only because of that key.
#[test]
fn a_misspelt_section_is_one_fault() {
    assert_faults(
        r#"{
          "camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
          "film": {"width": 8, "height": 8},
          "material": {"paint": {"diffuse": {"reflectance": 0.5}}},
          "objects": [{"shape": {"sphere": {"radius": 1}}, "material": "paint"}]
        }"#,
        &[("4:", "unknown key \"material\"")],
    );
}

#[test]
fn suggestions_name_the_glass_and_the_material() {
    let scene = |ior: &str, material: &str| {
        let head = r#"{"camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
          "film": {"width": 8, "height": 8}, "objects": [{"shape": {"sphere": {"radius": 1}}, "material": "m"}],"#;
        format!("{head} \"materials\": {{\"m\": {{\"{material}\": {{\"ior\": \"{ior}\"}}}}}}}}")
    };
    let glass = faults(&scene("BK7", "dielectric")).join("\n");
    assert!(glass.ends_with("did you mean \"N-BK7\"?"), "{glass}");
    let material = faults(&scene("N-BK7", "glass")).join("\n");
    assert!(material.ends_with("did you mean \"dielectric\"?"), "{material}");
}

#[test]
fn at_most_twenty_faults_are_reported() {
    let lights = vec![r#"{"point": {"at": [0, 3, 0], "spectrum": "D65", "power": -1}}"#; 50].join(",\n");
    let text = format!(
        r#"{{"camera": {{"from": [0, 1, 5], "at": [0, 1, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
          "film": {{"width": 8, "height": 8}}, "objects": [], "lights": [{lights}]}}"#
    );
    let found = faults(&text);
    assert_eq!(found.len(), MAX_FAULTS);
    assert!(found[MAX_FAULTS - 1].contains("lights[19].point.power: found -1"), "{found:?}");
}

/// The resolver checks the largest value of a spectrum, and `validate` checks each value.
#[test]
fn a_wrong_absorptance_is_reported_once() {
    for absorptance in ["1.5", r#"{"table": {"nm": [400, 500], "values": [0, 1.5]}}"#] {
        let text = format!(
            r#"{{
              "camera": {{"from": [0, 1, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
              "film": {{"width": 4, "height": 4}},
              "materials": {{"dye": {{"fluorescent": {{
                "reflectance": 0.9, "emission": 1, "quantum_yield": 1, "absorptance": {absorptance}}}}}}},
              "objects": [{{"shape": {{"sphere": {{"radius": 1}}}}, "material": "dye"}}],
              "lights": [{{"point": {{"at": [0, 3, 0], "spectrum": 1, "power": 1}}}}]
            }}"#
        );
        assert_faults(&text, &[("5", "found 1.5; expected a number from 0 to 1")]);
    }
}
