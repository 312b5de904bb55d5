//! What scenes say about crystals that cannot be simulated.

use abbe_format::{self as format, resolve::resolve};
use abbe_spectra::error::Error;

/// Resolves a scene with these objects, which may use a crystal, a mix with it, and an absorber.
fn resolved(name: &str, objects: &str) -> Result<(), Error> {
    let mixed =
        if objects.contains("mixed") { r#", "mixed": {"mix": [{"material": "calcite", "weight": 1}]}"# } else { "" };
    let text = format!(
        r#"{{"camera": {{"from": [0, 1, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 35}}}},
                        "shutter": {{"open": 0, "close": 1}}}},
            "film": {{"width": 4, "height": 4}},
            "materials": {{"black": "absorber", "calcite": {{"crystal": {{"name": "{name}", "axis": [0, 1, 0]}}}}{mixed}}},
            "objects": [{objects}],
            "lights": [{{"point": {{"at": [0, 3, 0], "spectrum": 1, "power": 1}}}}]}}"#
    );
    let (written, source) = format::parse(&text, "crystal.json".as_ref(), &[])?;
    resolve(&written, &source).map(|_| ())
}

const BOX: &str = r#"{"name": "block", "shape": {"box": {"size": [1, 1, 1]}}, "material": "calcite"}"#;

#[test]
fn crystals_that_cannot_be_simulated_are_refused() {
    let with = |object: &str| format!("{BOX}, {object}");
    for (name, objects, words) in [
        ("kalcite", BOX, "did you mean \"calcite\"?"),
        ("calcite", r#"{"shape": {"disk": {"radius": 1}}, "material": "calcite"}"#, "a flat shape of a crystal"),
        (
            "calcite",
            r#"{"shape": {"sphere": {"radius": 1}}, "material": "calcite",
                "motion": [{"time": 0, "transform": []}, {"time": 1, "transform": [{"translate": [1, 0, 0]}]}]}"#,
            "the object moves and is a crystal",
        ),
        ("calcite", r#"{"shape": {"sphere": {"radius": 1}}, "material": "mixed"}"#, "found a crystal inside a mix"),
        (
            "calcite",
            &with(r#"{"name": "core", "shape": {"sphere": {"radius": 0.3}}, "material": "black"}"#),
            "the object \"core\" reaches into the crystal \"block\"; expected crystals that contain no surfaces",
        ),
        (
            "calcite",
            &with(
                r#"{"name": "floor", "shape": {"rectangle": {"width": 9, "height": 9}}, "material": "black",
                    "transform": [{"translate": [0, -0.4, 0]}]}"#,
            ),
            "the object \"floor\" reaches into",
        ),
        (
            "calcite",
            &with(
                r#"{"name": "twin", "shape": {"box": {"size": [1, 1, 1]}}, "material": "calcite",
                    "transform": [{"translate": [0.9, 0, 0]}]}"#,
            ),
            "reaches into the crystal",
        ),
    ] {
        let message = resolved(name, objects).expect_err(words).to_string();
        assert!(message.contains(words), "{message}");
    }
}

/// What only touches a crystal is outside of it.
#[test]
fn crystals_may_rest_on_a_floor() {
    let floor = r#"{"name": "floor", "shape": {"rectangle": {"width": 9, "height": 9}}, "material": "black",
                    "transform": [{"translate": [0, -0.5, 0]}]}"#;
    let neighbour = r#"{"name": "twin", "shape": {"box": {"size": [1, 1, 1]}}, "material": "calcite",
                        "transform": [{"translate": [1, 0, 0]}]}"#;
    resolved("calcite", &format!("{BOX}, {floor}, {neighbour}")).unwrap();
}
