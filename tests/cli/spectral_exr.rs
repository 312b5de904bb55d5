//! The spectral layers of an EXR, read back by the OpenEXR project's own library through Python.
//!
//! Needs Python 3 with the package `OpenEXR`; `tests/run --external` installs it into
//! `target/python`. Without it, the test is skipped, unless `ABBE_REQUIRE_EXTERNAL` is set.

use abbe_session::output::exr;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A flat light that the camera sees beside a floor that it lights.
const SCENE: &str = r#"{
  "camera": {"from": [0, 1, 3], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 50}}},
  "film": {"width": 7, "height": 5},
  "materials": {"red": {"diffuse": {"reflectance": {"rgb": [0.7, 0.1, 0.1]}}}, "black": "absorber"},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "red"},
    {"name": "lamp", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "black",
     "emission": {"spectrum": 1, "radiance": 470},
     "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, 4, -2]}]}],
  "render": {"passes": 64, "photons": 50}
}"#;

/// Returns the Python to use: the one that `tests/run --external` prepared, or the system's.
fn python() -> PathBuf {
    let prepared = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/python/bin/python3");
    if prepared.exists() { prepared } else { "python3".into() }
}

/// Whether Python can import OpenEXR.
///
/// # Panics
/// If it cannot, under `ABBE_REQUIRE_EXTERNAL`.
fn has_openexr() -> bool {
    let imported = Command::new(python()).args(["-c", "import OpenEXR"]).output();
    let found = imported.is_ok_and(|output| output.status.success());
    assert!(
        found || std::env::var_os("ABBE_REQUIRE_EXTERNAL").is_none(),
        "Python has no OpenEXR package; tests/run --external installs it"
    );
    found
}

/// Reads a picture with Python's OpenEXR.
fn read_by_python(picture: &Path) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/read_spectral_exr.py");
    let output = Command::new(python()).arg(script).arg(picture).output();
    let output = output.expect("Python 3 starts");
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn python_reads_the_bands_that_were_written() {
    if !has_openexr() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.json"), SCENE).unwrap();
    // Seven bands have centres with long fractions; 47 bands have centres at whole numbers.
    for count in [4, 7, 47] {
        let mut render = Command::new(env!("CARGO_BIN_EXE_abbe"));
        render.args(["render", "lamp.json", "--quiet", "--spectral-bands", &count.to_string()]);
        assert!(render.current_dir(folder.path()).status().unwrap().success());
        let path = folder.path().join("lamp.exr");
        let known = exr::read(&path).unwrap().picture;
        let bands = known.bands.unwrap();
        let found = read_by_python(&path);
        assert_eq!(found["size"], serde_json::json!([7, 5]));
        assert_eq!(found["attributes"]["spectralLayoutVersion"], "1.0");
        assert_eq!(found["attributes"]["emissiveUnits"], "W.m^-2.sr^-1");
        let channels = found["channels"].as_array().unwrap();
        assert!(
            ["R", "G", "B", "xyz.X", "xyz.Y", "xyz.Z", "error.noise"]
                .iter()
                .all(|name| channels.contains(&(*name).into()))
        );
        let read = found["bands"].as_array().unwrap();
        assert_eq!((read.len(), bands.centres_nm.len()), (count, count));
        for (i, band) in read.iter().enumerate() {
            let nm = 360.0 + 470.0 * (i as f64 + 0.5) / count as f64;
            assert!((band["nm"].as_f64().unwrap() - nm).abs() < 1e-9, "{} for {nm}", band["channel"]);
            let values: Vec<f32> =
                band["values"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap() as f32).collect();
            let known: Vec<f32> = bands.values.iter().skip(i).step_by(count).copied().collect();
            assert_eq!(values, known, "{}", band["channel"]);
        }
        // The middle of the top row sees the light of 1 W/m²/sr/nm.
        let lamp = read.iter().flat_map(|band| &band["values"].as_array().unwrap()[1..6]);
        let mean = lamp.map(|value| value.as_f64().unwrap()).sum::<f64>() / (5 * count) as f64;
        assert!((mean - 1.0).abs() < 0.05, "{mean}");
    }
}
