//! Diffraction with resume and parts: merged and resumed pictures equal a single run.

use crate::abbe_command::abbe;

/// A round source of two spectral lines, seen through a stop with five blades.
pub(crate) const SCENE: &str = r#"{
  "camera": {"from": [0, 0, 0], "at": [0, 0, -1],
             "lens": {"thin": {"focal_length_mm": 50, "f_number": 22, "focus_distance": 10, "sensor_height_mm": 0.1, "blades": 5, "diffraction": true}}},
  "film": {"width": 48, "height": 32, "spectral_bands": 3},
  "materials": {"black": "absorber"},
  "objects": [{"shape": {"sphere": {"radius": 0.0005, "center": [0.003, 0.001, -10]}}, "material": "black",
               "emission": {"spectrum": {"lines": [{"nm": 480, "power": 1}, {"nm": 620, "power": 1}]}, "luminance": 1000}}],
  "render": {"photons": 100, "passes": 16}
}"#;

#[test]
fn diffracted_parts_merge_and_resume_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("star.json"), SCENE).unwrap();
    let run = |arguments: &[&str]| {
        let done = abbe(folder.path(), arguments);
        assert_eq!(done.status, 0, "{}", done.err);
        done
    };
    run(&["render", "star.json", "-o", "whole.exr", "--quiet"]);
    run(&["render", "star.json", "-o", "a.exr", "--part", "0/2", "--quiet"]);
    run(&["render", "star.json", "-o", "b.exr", "--part", "1/2", "--quiet"]);
    run(&["merge", "a.exr", "b.exr", "-o", "merged.exr"]);
    run(&["render", "star.json", "-o", "resumed.exr", "--passes", "5", "--keep-checkpoint", "--quiet"]);
    run(&["render", "star.json", "-o", "resumed.exr", "--resume", "--quiet"]);
    for other in ["merged.exr", "resumed.exr"] {
        let compared = run(&["compare", other, "whole.exr", "--json"]).json();
        assert_eq!(compared["relative_mse"], 0.0, "{other}");
        let bands = |file| abbe(folder.path(), &["probe", file, "30", "12", "--json"]).json()["spectrum"].clone();
        assert_eq!(bands(other), bands("whole.exr"));
    }
    // Without diffraction, the image of the sphere leaves most of the film dark.
    run(&["render", "star.json", "-o", "sharp.exr", "--forbid", "diffraction", "--quiet"]);
    let probe = |file| abbe(folder.path(), &["probe", file, "5", "5", "--json"]).json()["xyz"][1].as_f64().unwrap();
    assert!(probe("whole.exr") > 0.0 && probe("sharp.exr") == 0.0);
    run(&[
        "render",
        "star.json",
        "--force",
        "diffraction",
        "--set",
        "camera.lens.thin.diffraction=false",
        "-o",
        "forced.exr",
        "--quiet",
    ]);
    assert_eq!(probe("forced.exr"), probe("whole.exr"));
    let pinhole = r#"camera.lens={"pinhole": {"fov": 5}}"#;
    abbe(folder.path(), &["render", "star.json", "--force", "diffraction", "--set", pinhole])
        .is_error(2, &["the camera has no aperture", "a lens with an aperture"]);
}
