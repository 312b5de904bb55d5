//! Gates for continuous integration: limits on comparisons and spectra, and reproducible files.

use crate::abbe_command::abbe;
use crate::abbe_command::folder::with_ball;
use abbe_session::output::{Metadata, exr, png};
use abbe_transport::sensor::{DisplayImage, Picture};
use std::path::Path;
use tempfile::TempDir;

/// A folder with `a.exr` (Y = 1.1 in the left half, 1 in the right) and `b.exr` (Y = 1).
fn pictures() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, left) in [("a.exr", 1.1), ("b.exr", 1.0)] {
        let mut picture = Picture::black(16, 8);
        for (i, xyz) in picture.xyz.iter_mut().enumerate() {
            let y = if i % 16 < 8 { left } else { 1.0 };
            *xyz = [0.95 * y, y, 1.09 * y];
        }
        (picture.noise, picture.bias) = (vec![Some(0.005); 128], vec![Some(0.0); 128]);
        exr::write(&folder.path().join(name), &picture, &Metadata::new()).unwrap();
    }
    folder
}

#[test]
fn any_figure_can_be_a_gate() {
    let folder = pictures();
    let status = |options: &[&str]| abbe(folder.path(), &[&["compare", "a.exr", "b.exr"], options].concat()).status;
    let cases: [(&[&str], i32); 9] = [
        (&["--fail-above", "relative_mse=1%"], 0),
        (&["--fail-above", "relative_mse=0.1%"], 3),
        (&["--fail-above", "delta_e_2000.p95=9"], 0),
        (&["--fail-above", "delta_e_2000.p95=1"], 3),
        (&["--fail-below", "z.p=0.01"], 3),
        (&["--fail-below", "z.p=0.01", "--region", "8,0,16,8"], 0),
        (&["--fail-below", "covered=40%"], 0),
        (&["--fail-below", "covered=90%"], 3),
        (&["--fail-above", "1", "--fail-below", "covered=90%"], 3),
    ];
    for (options, expected) in cases {
        assert_eq!(status(options), expected, "{options:?}");
    }
    let said = abbe(folder.path(), &["compare", "a.exr", "b.exr", "--fail-below", "covered=90%"]);
    assert!(said.err.contains("failed: covered is 0.500000, which is below the limit 0.9"), "{}", said.err);
    abbe(folder.path(), &["compare", "a.exr", "b.exr", "--fail-above", "delta_e=1"])
        .is_error(2, &["delta_e", "delta_e_2000.p95"]);
}

#[test]
fn png_files_are_compared_as_they_are() {
    let folder = pictures();
    let at = folder.path();
    let write = |name: &str, code: u8| {
        let rgb = (0..32).map(|i| if i == 0 { [code; 3] } else { [100, 150, 200] }).collect();
        png::write(&at.join(name), &DisplayImage::of_srgb(8, 4, rgb)).unwrap();
    };
    write("a.png", 120);
    write("b.png", 128);
    let same = abbe(at, &["compare", "a.png", "a.png", "--json"]).json();
    assert_eq!((same["relative_mse"].as_f64(), same["exposure_ev"].as_f64()), (Some(0.0), Some(0.0)), "{same}");
    let pixel = abbe(at, &["compare", "a.png", "b.png", "--json", "--region", "0,0,1,1"]).json();
    // L* of the codes 120 and 128 is 50.43 and 53.59. ΔE2000 is their difference over S_L.
    assert!((pixel["delta_e_2000"]["mean"].as_f64().unwrap() - 3.1).abs() < 0.15, "{pixel}");
    let rest = ["compare", "a.png", "b.png", "--fail-above", "0", "--region", "1,0,8,4"];
    assert_eq!(abbe(at, &rest).status, 0);
    assert_eq!(abbe(at, &["compare", "a.png", "b.png", "--fail-above", "0"]).status, 3);
    abbe(at, &["compare", "a.png", "b.exr"]).is_error(2, &["cannot be compared", "abbe develop"]);
    abbe(at, &["compare", "a.png", "b.png", "--fail-below", "z.p=0.01"]).is_error(2, &["z.p", "error layers"]);
}

#[test]
fn a_spectrum_is_checked_against_expected_values() {
    let folder = tempfile::tempdir().unwrap();
    let run = |expect: &str| abbe(folder.path(), &["spectrum", "D65", "--expect", expect]);
    assert_eq!(run("xy=0.3127,0.3290").status, 0);
    assert_eq!(run("cct_k=6504:5").status, 0);
    let said = run("cct_k=6600:0.5%");
    assert!(said.status == 3 && said.err.contains("failed: cct_k is 650") && said.out.contains("xy"), "{}", said.err);
    run("cct=6504").is_error(2, &["cct", "cct_k"]);
    run("xy=0.3").is_error(2, &["xy has 2 values"]);
}

#[test]
fn reproducible_renders_are_equal_files() {
    const SCENE: &str = r#"{
      "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
      "film": {"width": 16, "height": 12},
      "materials": {"glass": {"dielectric": {"ior": "SF10"}}, "grey": {"diffuse": {"reflectance": 0.5}}},
      "objects": [
        {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
        {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
      "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
      "render": {"passes": 4, "photons": 400}
    }"#;
    let folder = with_ball(SCENE);
    let render = |name: &str, more: &[&str]| {
        let said = abbe(folder.path(), &[&["render", "ball.json", "--quiet", "-o", name], more].concat());
        assert_eq!(said.status, 0, "{}", said.err);
        let bytes = |path: &Path| std::fs::read(path).unwrap();
        let path = folder.path().join(name);
        (bytes(&path), bytes(&path.with_extension("png")))
    };
    let one = render("one.exr", &["--reproducible", "--threads", "1"]);
    assert!(one == render("three.exr", &["--reproducible", "--threads", "3"]), "equal files on any threads");
    assert!(one.0 != render("usual.exr", &["--threads", "1"]).0, "other files state their time");
    let metadata = exr::read(&folder.path().join("one.exr")).unwrap().metadata;
    assert!(metadata.get("abbe.seconds").is_none() && !metadata.get("abbe.scene").unwrap().contains("threads"));
}
