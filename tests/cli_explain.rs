//! What `abbe explain` says of the camera.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod cli_common;

use cli_common::abbe;
use serde_json::Value;

/// The explanation, as JSON and in words, of a floor seen through a lens.
fn explain(lens: &str) -> (Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let scene = format!(
        r#"{{
  "camera": {{"from": [0, 2, 5], "at": [0, 0, 0], "lens": {lens}}},
  "film": {{"width": 300, "height": 200}},
  "materials": {{"grey": {{"diffuse": {{"reflectance": 0.5}}}}}},
  "objects": [{{"shape": {{"rectangle": {{"width": 6, "height": 6}}}}, "material": "grey"}}],
  "lights": [{{"point": {{"at": [1, 4, 1], "spectrum": "D65", "power": 20}}}}]
}}"#
    );
    std::fs::write(folder.path().join("floor.json"), scene).unwrap();
    let json = abbe(folder.path(), &["explain", "floor.json", "--json"]).json();
    (json, abbe(folder.path(), &["explain", "floor.json"]).out)
}

fn near(value: &Value, expected: f64) -> bool {
    (value.as_f64().unwrap() / expected - 1.0).abs() < 1e-9
}

#[test]
fn a_lens_is_explained_by_what_it_keeps_sharp() {
    let (json, words) =
        explain(r#"{"thin": {"focal_length_mm": 50, "f_number": 2, "focus_distance": 5, "sensor_height_mm": 24}}"#);
    let depth = &json["camera"]["depth_of_field"];
    // The image lies 50·5000/4950 mm behind the lens; a pixel is 0.12 mm there; the opening is 25 mm wide.
    let image_mm = 50.0 * 5000.0 / 4950.0;
    let pixel_at_focus_m = 0.12 / image_mm * 5.0;
    assert!(near(&depth["near_m"], 5.0 * 0.025 / (0.025 + pixel_at_focus_m)), "{depth}");
    assert!(near(&depth["far_m"], 5.0 * 0.025 / (0.025 - pixel_at_focus_m)), "{depth}");
    assert!(near(&depth["blur_at_infinity_px"], 0.025 / pixel_at_focus_m), "{depth}");
    assert!(near(&depth["hyperfocal_m"], 0.025 / (0.12 / image_mm)), "{depth}");
    assert!(near(&json["camera"]["field_of_view_degrees"][1], 2.0 * (12.0 / image_mm).atan().to_degrees()));
    assert!(words.contains("focused at 5.0000 m") && words.contains("hyperfocal distance"), "{words}");
    assert!(!words.contains("Note:"), "{words}");
}

#[test]
fn a_pinhole_keeps_everything_sharp_and_a_small_lens_everything_far() {
    let (json, words) = explain(r#"{"pinhole": {"fov": 40}}"#);
    assert!(json["camera"]["depth_of_field"].is_null() && words.contains("a pinhole: everything is sharp"), "{words}");
    let (json, words) = explain(r#"{"thin": {"fov": 40, "focus_distance": 5, "defocus_angle": 0.001}}"#);
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
    assert!(odd(50.0, 0.05, 24.0).contains("Note: camera: a lens opening of 1000 mm"));
}

#[test]
fn diffraction_is_measured_and_named_where_it_would_show() {
    // f/32 on pixels of 6 µm: 2.44 · 550 nm · 32.3 is 7.2 of them.
    let lens = |diffraction: bool| {
        explain(&format!(
            r#"{{"thin": {{"focal_length_mm": 50, "f_number": 32, "focus_distance": 5, "sensor_height_mm": 1.2, "diffraction": {diffraction}}}}}"#
        ))
    };
    let (json, words) = lens(false);
    let report = &json["camera"]["diffraction"];
    let expected = 2.44 * 550e-6 * 32.0 * (5000.0 / 4950.0) / 0.006;
    assert!(near(&report["airy_diameter_px"], expected), "{report} {expected}");
    assert!(report["matters"] == true && report["simulated"] == false && report["slices"] == 0);
    assert!(words.contains("Note: camera: diffraction at the opening would spread a point over 7.2 pixels"), "{words}");
    let plain_bytes = json["memory_bytes"].as_u64().unwrap();
    let (json, words) = lens(true);
    let report = &json["camera"]["diffraction"];
    assert!(report["simulated"] == true && !words.contains("would spread"), "{words}");
    // The sums of a slice take 48 bytes a pixel, and are counted three times (saving copies them).
    let more = 3 * 48 * 300 * 200 * report["slices"].as_u64().unwrap();
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
