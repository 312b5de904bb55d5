//! `abbe measure`: the target error of one meter, the uniformity of a grid, and the page.

use crate::abbe_command::abbe;
use crate::browser::{Scheme, Seen, open};
use serde_json::{Value, json};
use std::path::Path;

/// A point lamp over a grid and beside a wall. A meter in a shadow is much noisier than the grid.
fn write_scene(folder: &Path) {
    let scene = json!({
        "materials": {"grey": {"diffuse": {"reflectance": 0.6}}},
        "objects": [
            {"name": "floor", "shape": {"rectangle": {"width": 4, "height": 4}}, "material": "grey"},
            {"name": "wall", "shape": {"rectangle": {"width": 4, "height": 3}}, "material": "grey",
             "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, 1.5, -2]}]},
            {"name": "shade", "shape": {"disk": {"radius": 0.5}}, "material": "grey",
             "transform": [{"translate": [0, 0.4, 0]}]}
        ],
        "lights": [{"point": {"at": [0, 2, 0], "spectrum": "D65", "luminous_intensity": 400}}],
        "meters": [
            {"name": "desk", "grid": {"origin": [-1, 0.5, -1], "u": [2, 0, 0], "v": [0, 0, 2], "count": [5, 4]}},
            {"name": "shadow", "points": [[0, 0.2, 0]]},
            {"name": "spectrum", "quantity": "spectral_irradiance", "points": [[0, 1, 0]]}
        ]
    });
    std::fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
}

fn measured(folder: &Path, arguments: &[&str]) -> Value {
    let arguments = [&["measure", "scene.json", "--json", "--quiet"], arguments].concat();
    abbe(folder, &arguments).json()
}

/// The relative noise of the least exact reading of a meter.
fn noise(meter: &Value) -> f64 {
    let number = |value: &Value| value.as_f64().unwrap();
    let points = meter["points"].as_array().unwrap();
    points.iter().map(|point| number(&point["noise"]) / number(&point["value"])).fold(0.0, f64::max)
}

#[test]
fn a_target_error_may_name_a_meter() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let arguments = ["--meter", "desk", "--meter", "shadow", "--passes", "4096", "--target-error"];
    let of_shadow = measured(folder.path(), &[&arguments[..], &["shadow=0.3%"]].concat());
    let of_desk = measured(folder.path(), &[&arguments[..], &["desk=0.3%"]].concat());
    // The grid receives the light of the lamp directly, so it needs fewer passes.
    let passes = |report: &Value| report["passes"].as_u64().unwrap();
    assert!(passes(&of_desk) < passes(&of_shadow) && passes(&of_shadow) < 4096, "{of_desk} {of_shadow}");
    assert!(noise(&of_shadow["meters"][1]) <= 0.003 && noise(&of_desk["meters"][1]) > 0.003, "{of_desk} {of_shadow}");
    let unknown = abbe(folder.path(), &["measure", "scene.json", "--target-error", "shado=2%"]);
    unknown.is_error(2, &["unknown meter \"shado\"", "did you mean \"shadow\"?"]);
    let zero = abbe(folder.path(), &["measure", "scene.json", "--target-error", "desk=0"]);
    assert!(zero.status == 2 && zero.err.contains("expected a ratio above 0"), "{}", zero.err);
}

/// A meter under one lamp has the colour rendition of the lamp. The meter knows the wavelengths of
/// lines. It sums a reference illuminant in steps of 1 nm, while the indices of a lamp are sums in
/// steps of 5 nm, which changes Ra by about 0.1.
#[test]
fn a_meter_has_the_colour_rendition_of_its_lamp() {
    let folder = tempfile::tempdir().unwrap();
    let line = |nm: f64, power: f64| json!({"nm": nm, "power": power});
    let lines = json!({"lines": [line(435.8, 1.0), line(546.1, 1.5), line(611.6, 1.5)]});
    for (lamp, tolerance) in [(json!("LED-B1"), 0.12), (json!("FL2"), 0.12), (lines, 0.01)] {
        let at = |name: &str| json!({"name": name, "quantity": name, "points": [[0, 0, 0]]});
        let scene = json!({
            "objects": [],
            "lights": [{"point": {"at": [0, 2, 0], "spectrum": lamp, "luminous_intensity": 400}}],
            "meters": [at("tm30_rf"), at("tm30_rg"), at("colour_rendering")]
        });
        std::fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
        let report = measured(folder.path(), &["--passes", "64"]);
        let name = lamp.as_str().map_or_else(|| lamp.to_string(), String::from);
        let known = abbe(folder.path(), &["spectrum", &name, "--json"]).json();
        let known = [(&known["tm30"]["rf"], 0.0), (&known["tm30"]["rg"], 0.0), (&known["ra"], 0.1)];
        for (meter, (known, of_steps)) in report["meters"].as_array().unwrap().iter().zip(known) {
            let point = &meter["points"][0];
            let [value, noise] = [&point["value"], &point["noise"]].map(|number| number.as_f64().unwrap());
            let difference = (value - known.as_f64().unwrap()).abs();
            assert!(difference < tolerance + of_steps + 4.0 * noise && noise < 0.1, "{lamp}: {known} {meter}");
            assert!(point["interval_95"][0].as_f64().unwrap() <= value - point["bias"].as_f64().unwrap(), "{meter}");
        }
    }
}

#[test]
fn a_grid_has_its_mean_and_its_uniformity() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let report = measured(folder.path(), &["--passes", "8", "--meter", "desk"]);
    let desk = &report["meters"][0];
    let values: Vec<f64> =
        desk["points"].as_array().unwrap().iter().map(|point| point["value"].as_f64().unwrap()).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(0.0, f64::max);
    let near = |key: &str, expected: f64| (desk[key].as_f64().unwrap() / expected - 1.0).abs() < 1e-12;
    assert!(values.len() == 20 && near("mean", mean), "{desk}");
    assert!(near("uniformity", least / mean) && near("least_to_largest", least / largest), "{desk}");
    assert_eq!(
        desk["grid"],
        json!({"origin": [-1.0, 0.5, -1.0], "u": [2.0, 0.0, 0.0], "v": [0.0, 0.0, 2.0], "count": [5, 4]})
    );
}

/// Each requirement is judged by the intervals, in the text, in the JSON and on the page.
#[test]
fn requirements_are_judged() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let mut scene: Value = serde_json::from_slice(&std::fs::read(folder.path().join("scene.json")).unwrap()).unwrap();
    scene["title"] = json!("Room 12");
    scene["requirements"] = json!([
        {"meter": "desk", "mean_at_least": 10, "mean_at_most": 20, "uniformity_at_least": 0.01, "source": "clause 3"},
        {"meter": "desk", "at_least": 1e4},
        {"meter": "shadow", "at_most": 1e4}
    ]);
    std::fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let found = measured(folder.path(), &["--passes", "8", "--html", "page.html"]);
    let judged = found["requirements"].as_array().unwrap();
    let verdicts: Vec<&str> = judged.iter().map(|judged| judged["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["met", "not_met", "met", "not_met", "met"], "{judged:?}");
    let mean = &found["meters"][0]["mean"];
    assert_eq!((&judged[0]["value"], &judged[0]["source"]), (mean, &json!("clause 3")));
    let [low, high] = [0, 1].map(|end| judged[0]["interval_95"][end].as_f64().unwrap());
    assert!(low < mean.as_f64().unwrap() && mean.as_f64().unwrap() < high, "{low} to {high}");
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    for text in ["<h1>Room 12</h1>", "each reading at least 10000 lx", "not met", "clause 3", "point 0", "Lights"] {
        assert!(page.contains(text), "{text}");
    }
    let text = abbe(folder.path(), &["measure", "scene.json", "--passes", "8", "--quiet", "--meter", "desk"]).out;
    assert!(text.contains("mean at most 20 lx") && !text.contains("shadow"), "{text}");
}

#[test]
fn the_page_shows_plans_and_readings() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    measured(folder.path(), &["--passes", "8", "--html", "page.html"]);
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 1);
    // One cell for each of 20 readings and the outline; each isoline has two strokes.
    assert_eq!(page.matches("<polygon").count(), 21);
    let isolines = page.matches("class=\"isoline\"").count();
    assert!(isolines >= 4 && isolines.is_multiple_of(2), "{isolines}");
    for text in ["desk: illuminance (lx)", "least/mean (U0)", "95 % interval", "94 readings", "wavelength in nm"] {
        assert!(page.contains(text), "{text}");
    }
    let Some(browser) = crate::browser::find() else { return };
    let size = (1000, 1600);
    let Seen { picture, console, requests } = open(browser, &page, size, Scheme::Light);
    assert_eq!((picture.dimensions(), console, requests), (size, Vec::new(), Vec::new()));
}
