//! What `abbe explain` reports about effects, the camera and motion.

use crate::abbe_command::abbe;
use crate::common::near::assert_near_relative;
use serde_json::Value;

/// Returns the explanation, as JSON and as text, of a floor seen through a lens.
fn explain(lens: &str) -> (Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let scene = format!(
        r#"{{
  "camera": {{"from": [0, 2, 5], "at": [0, 0, 0], "lens": {lens}}},
  "film": {{"width": 300, "height": 200, "denoise": false}},
  "materials": {{"grey": {{"diffuse": {{"reflectance": 0.5}}}}}},
  "objects": [{{"shape": {{"rectangle": {{"width": 6, "height": 6}}}}, "material": "grey"}}],
  "lights": [{{"point": {{"at": [1, 4, 1], "spectrum": "D65", "power": 20}}}}]
}}"#
    );
    std::fs::write(folder.path().join("floor.json"), scene).unwrap();
    let json = abbe(folder.path(), &["explain", "floor.json", "--json"]).json();
    (json, abbe(folder.path(), &["explain", "floor.json"]).out)
}

#[test]
fn a_lens_is_explained_by_what_it_keeps_sharp() {
    let (json, words) =
        explain(r#"{"thin": {"focal_length_mm": 50, "f_number": 2, "focus_distance": 5, "sensor_height_mm": 24}}"#);
    let depth = &json["camera"]["depth_of_field"];
    // The image is 50·5000/4950 mm behind the lens, a pixel is 0.12 mm there, and the aperture is
    // 25 mm wide.
    let image_mm = 50.0 * 5000.0 / 4950.0;
    let pixel_at_focus_m = 0.12 / image_mm * 5.0;
    assert_near_relative("near limit", &depth["near_m"], 5.0 * 0.025 / (0.025 + pixel_at_focus_m), 1e-9);
    assert_near_relative("far limit", &depth["far_m"], 5.0 * 0.025 / (0.025 - pixel_at_focus_m), 1e-9);
    assert_near_relative("blur at infinity", &depth["blur_at_infinity_px"], 0.025 / pixel_at_focus_m, 1e-9);
    assert_near_relative("hyperfocal distance", &depth["hyperfocal_m"], 0.025 / (0.12 / image_mm), 1e-9);
    assert_near_relative(
        "vertical field of view",
        &json["camera"]["field_of_view_degrees"][1],
        2.0 * (12.0 / image_mm).atan().to_degrees(),
        1e-9,
    );
    assert!(words.contains("focused at 5.0000 m") && words.contains("hyperfocal distance"), "{words}");
    assert!(!words.contains("Note:"), "{words}");
}

#[test]
fn depth_of_field_of_pinhole_and_small_lens_is_explained() {
    let (json, words) = explain(r#"{"pinhole": {"fov": 40}}"#);
    assert!(
        json["camera"]["depth_of_field"].is_null() && words.contains("a pinhole: all distances are sharp"),
        "{words}"
    );
    let (json, words) = explain(r#"{"thin": {"fov": 40, "focus_distance": 5, "defocus_angle": 0.15}}"#);
    assert!(json["camera"]["depth_of_field"]["far_m"].is_null() && words.contains("to infinity"), "{words}");
}

#[test]
fn a_slip_of_units_is_remarked() {
    let odd = |focal: f64, f_number: f64, sensor: f64| {
        explain(&format!(
            r#"{{"thin": {{"focal_length_mm": {focal}, "f_number": {f_number}, "focus_distance": 5, "sensor_height_mm": {sensor}}}}}"#
        ))
        .1
    };
    assert!(odd(50.0, 2.0, 0.024).contains("Note: camera: a sensor height of 0.024 mm"));
    assert!(odd(50.0, 0.05, 24.0).contains("Note: camera: an aperture diameter of 1000 mm"));
}

#[test]
fn diffraction_is_measured_and_named_where_it_would_show() {
    // At f/32 with pixels of 6 µm, 2.44 · 550 nm · 32.3 is 7.2 pixels.
    let lens = |diffraction: bool| {
        explain(&format!(
            r#"{{"thin": {{"focal_length_mm": 50, "f_number": 32, "focus_distance": 5, "sensor_height_mm": 1.2, "diffraction": {diffraction}}}}}"#
        ))
    };
    let (json, words) = lens(false);
    let report = &json["camera"]["diffraction"];
    let expected = 2.44 * 550e-6 * 32.0 * (5000.0 / 4950.0) / 0.006;
    assert_near_relative("Airy disk", &report["airy_diameter_px"], expected, 1e-9);
    assert!(report["matters"] == true && report["simulated"] == false && report["slices"] == 0);
    assert!(words.contains("Note: camera: diffraction at the opening would spread a point over 7.2 pixels"), "{words}");
    let plain_bytes = json["memory_bytes"].as_u64().unwrap();
    let (json, words) = lens(true);
    let report = &json["camera"]["diffraction"];
    assert!(report["simulated"] == true && !words.contains("would spread"), "{words}");
    // The sums of a slice take 48 bytes per pixel and the light of a pass 24, and a picture takes up
    // to a quarter of the film. The convolution needs 320 bytes per pixel.
    let more = (90 * report["slices"].as_u64().unwrap() + 320) * 300 * 200;
    assert_eq!(json["memory_bytes"].as_u64().unwrap(), plain_bytes + more);
    let (json, words) =
        explain(r#"{"thin": {"focal_length_mm": 50, "f_number": 2, "focus_distance": 5, "sensor_height_mm": 24}}"#);
    assert!(json["camera"]["diffraction"]["matters"] == false && !words.contains("Note:"), "{words}");
    assert!(explain(r#"{"pinhole": {"fov": 40}}"#).0["camera"]["diffraction"].is_null());
}

#[test]
fn a_scene_that_is_not_there_is_told() {
    let folder = tempfile::tempdir().unwrap();
    abbe(folder.path(), &["explain", "missing.json"]).is_error(2, &["missing.json"]);
}

#[test]
fn effects_that_are_off_take_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 30, "height": 20},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "flint": {"dielectric": {"ior": "N-SF10"}}},
  "objects": [{"shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
              {"shape": {"sphere": {"radius": 0.5}}, "material": "flint", "transform": [{"translate": [0, 1, 0]}]}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"forbid": ["caustics"]}
}"#;
    std::fs::write(folder.path().join("ball.json"), scene).unwrap();
    let explain = |options: &[&str]| {
        let said = abbe(folder.path(), &[&["explain", "ball.json"], options].concat());
        assert_eq!(said.status, 0, "{}", said.err);
        said.out
    };
    let brief = explain(&[]);
    let off: Vec<&str> = brief.lines().filter(|line| line.contains(" off")).collect();
    assert_eq!(off.len(), 1, "{brief}");
    assert!(off[0].starts_with("  off, because the scene has nothing that needs them: shared, "), "{brief}");
    assert!(off[0].ends_with("; forbidden or negligible: polarisation, caustics"), "{brief}");
    let all = explain(&["--all"]);
    assert!(all.contains("  caustics        forbidden ") && all.contains("  motion          off "), "{all}");

    // The note about the forbidden effect remains, and nobody can see the range of the glass.
    let notes = |text: &str| text.lines().filter(|line| line.starts_with("Note: ")).count();
    let verbose = explain(&["--verbose"]);
    assert_eq!((notes(&brief), notes(&verbose)), (1, 2), "{verbose}");
    assert!(verbose.contains("N-SF10 is known from 380") && !brief.contains("N-SF10"), "{brief}");
    let json: Value = serde_json::from_str(&explain(&["--json"])).unwrap();
    assert_eq!(json["notes"].as_array().unwrap().len(), 2);
    let check = abbe(folder.path(), &["check", "ball.json"]);
    assert!(check.err.contains("caustics") && !check.err.contains("N-SF10"), "{}", check.err);
}

#[test]
fn motion_is_explained_by_how_far_it_goes_over_the_picture() {
    let explain = |shutter: &str, render: &str| {
        let folder = tempfile::tempdir().unwrap();
        let scene = format!(
            r#"{{
  "camera": {{"from": [0, 5, 0], "at": [0, 0, 0], "up": [0, 0, -1], "lens": {{"pinhole": {{"fov": 90}}}}, "shutter": {shutter}}},
  "film": {{"width": 300, "height": 200}},
  "materials": {{"grey": {{"diffuse": {{"reflectance": 0.5}}}}}},
  "objects": [{{"name": "card", "shape": {{"rectangle": {{"width": 1, "height": 1}}}}, "material": "grey",
               "motion": [{{"time": 0, "transform": []}}, {{"time": 1, "transform": [{{"translate": [2, 0, 0]}}]}}]}}],
  "lights": [{{"point": {{"at": [1, 4, 1], "spectrum": "D65", "power": 20}}}}],
  "render": {render}
}}"#
        );
        std::fs::write(folder.path().join("card.json"), scene).unwrap();
        let json = abbe(folder.path(), &["explain", "card.json", "--json"]).json();
        let brief = abbe(folder.path(), &["explain", "card.json"]).out;
        // An effect without a cause in the scene is only listed.
        assert!(brief.contains("off, because the scene has nothing that needs them: dispersion, "), "{brief}");
        assert!(!brief.contains("no surface and no medium is fluorescent"), "{brief}");
        (json, abbe(folder.path(), &["explain", "card.json", "--all"]).out)
    };
    let effect = |json: &Value| {
        let effects = json["effects"].as_array().unwrap().clone();
        effects.into_iter().find(|effect| effect["name"] == "motion").unwrap()
    };
    // Half the picture's height is 5 m on the floor, so a metre is 20 pixels. The card moves by 2
    // m.
    let (json, words) = explain(r#"{"open": 0, "close": 1}"#, "{}");
    assert_near_relative("motion in pixels", &json["motion_px"], 40.0, 1e-9);
    assert_eq!((effect(&json)["state"].as_str(), json["passes"].as_u64()), (Some("on"), Some(80)));
    assert_eq!(json["photons"].as_u64(), Some(200_000 * 64 / 80), "as many in all");
    assert!(words.contains("up to 40.0 pixels from 0 s to 1 s; at least two passes per pixel"), "{words}");
    let (json, words) = explain(r#"{"open": 0.25, "close": 0.5}"#, r#"{"passes": 4}"#);
    assert_near_relative("motion in pixels", &json["motion_px"], 10.0, 1e-9);
    assert_eq!(json["passes"], 4);
    assert!(words.contains("fewer than two passes per pixel"), "{words}");
    let (json, words) = explain(r#"{"open": 2, "close": 3}"#, "{}");
    assert_eq!((effect(&json)["state"].as_str(), &json["motion_px"]), (Some("off"), &Value::Null));
    assert!(words.contains("nothing moves while the shutter is open"), "{words}");
    assert!(
        words.contains("the scene has keyframes, but nothing moves: the shutter is open from 2 s to 3 s"),
        "{words}"
    );
}

/// Returns the keys of a JSON object in order.
fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn the_json_object_has_the_keys_that_are_documented() {
    let (json, _) = explain(r#"{"thin": {"fov": 40, "focus_distance": 5, "defocus_angle": 2}}"#);
    let of_effect = ["name", "state", "because", "field", "consequence"];
    let of_camera = ["field_of_view_degrees", "depth_of_field", "diffraction"];
    let of_depth = ["focus_m", "near_m", "far_m", "hyperfocal_m", "blur_at_infinity_px"];
    let of_diffraction = ["airy_diameter_px", "matters", "simulated", "slices"];
    let top = [
        "effects",
        "wavelengths",
        "passes",
        "photons",
        "nearest",
        "radius_m",
        "memory_bytes",
        "motion_px",
        "camera",
        "guessed_colours",
        "notes",
    ];
    assert_eq!(keys(&json), top);
    assert_eq!(keys(&json["camera"]), of_camera);
    assert_eq!(keys(&json["camera"]["depth_of_field"]), of_depth);
    assert_eq!(keys(&json["camera"]["diffraction"]), of_diffraction);
    let effects = json["effects"].as_array().unwrap();
    assert!(effects.iter().all(|effect| keys(effect) == of_effect));
    let names: Vec<&str> = effects.iter().map(|effect| effect["name"].as_str().unwrap()).collect();
    assert_eq!(names, abbe_transport::plan::EFFECTS.map(|effect| effect.name));
    let docs = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/reference/files.md")).unwrap();
    let documented = [&top[..], &of_effect, &of_camera, &of_depth, &of_diffraction].concat();
    assert!(
        documented.iter().all(|key| docs.contains(&format!("`{key}`"))),
        "docs/reference/files.md lacks one of {documented:?}"
    );
    let again = abbe(std::path::Path::new(env!("CARGO_MANIFEST_DIR")), &["explain", "scenes/prism.json", "--json"]);
    let once_more = abbe(std::path::Path::new(env!("CARGO_MANIFEST_DIR")), &["explain", "scenes/prism.json", "--json"]);
    assert_eq!(again.out, once_more.out);
}
