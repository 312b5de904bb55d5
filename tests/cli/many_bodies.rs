//! Scenes with very many closed bodies, whose checks must take about n log n.

use crate::abbe_command::{Said, abbe};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Checks a scene of balls, each with a centre and a radius. Returns the time and the output.
fn check(material: Value, balls: impl Iterator<Item = ([f64; 3], f64)>) -> (Duration, Said) {
    let ball = |(center, radius): ([f64; 3], f64)| json!({"shape": {"sphere": {"radius": radius, "center": center}}, "material": "paint"});
    let scene = json!({
        "objects": balls.map(ball).collect::<Vec<Value>>(),
        "materials": {"paint": material},
        "lights": [{"environment": {"spectrum": 1, "luminance": 1}}],
        "camera": {"from": [0, 3, 3], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
        "film": {"width": 8, "height": 8},
    });
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("balls.json"), scene.to_string()).unwrap();
    let start = Instant::now();
    let said = abbe(folder.path(), &["check", "balls.json"]);
    (start.elapsed(), said)
}

/// Checks a scene of balls that is right. Returns the time.
fn time_of_check(material: Value, balls: impl Iterator<Item = ([f64; 3], f64)>) -> Duration {
    let (time, said) = check(material, balls);
    assert_eq!((said.status, said.out.as_str()), (0, "balls.json: ok\n"), "{}", said.err);
    time
}

/// The check of 40,000 balls took half a minute when it compared each ball with all others.
#[test]
fn many_opaque_bodies_are_checked_in_seconds() {
    let place = |i: u32| ([f64::from(i % 200) * 0.01, 0.0, f64::from(i / 200) * 0.01], 0.004);
    let time = time_of_check(json!({"diffuse": {"reflectance": 0.5}}), (0..40_000).map(place));
    assert!(time < Duration::from_secs(10), "{time:?}");
}

/// Balls at one place overflowed the stack: the hierarchy of their boxes was a chain. Now so many
/// copies are refused, because each ray meets all of them.
#[test]
fn bodies_at_one_place_do_not_overflow_the_stack() {
    for material in [json!({"diffuse": {"reflectance": 0.5}}), json!({"dielectric": {"ior": 1.5}})] {
        let same = |count: u32| (0..count).map(|_| ([0.0; 3], 0.1));
        let (time, said) = check(material.clone(), same(40_000));
        assert!(time < Duration::from_secs(10), "{time:?}");
        assert!(said.status == 2 && said.err.contains("39999 other objects have the same place"), "{}", said.err);
        time_of_check(material.clone(), same(1000));
        let nested = (1..=20_000).map(|i| ([0.0; 3], 0.1 + 1e-5 * f64::from(i)));
        let time = time_of_check(material, nested);
        assert!(time < Duration::from_secs(10), "{time:?}");
    }
}
