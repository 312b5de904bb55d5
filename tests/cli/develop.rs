//! `abbe develop`: a picture is shown with other settings without rendering it again.

use crate::abbe_command::folder::{names_in, with_ball};
use crate::abbe_command::{Said, abbe};
use abbe_session::output::exr;
use std::path::Path;
use tempfile::TempDir;

/// A grey ball on a floor in daylight.
const SCENE: &str = r##"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 16, "height": 12, "exposure": {"ev": -3}},
  "spectra": {"candle": {"blackbody": {"temperature": 1900}}},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "grey"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "A", "power": 20}}],
  "render": {"passes": 8, "photons": 200}
}"##;

fn scene() -> TempDir {
    let folder = with_ball(SCENE);
    done(&render(folder.path(), &["--keep-checkpoint"]));
    folder
}

fn render(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["render", "ball.json"], more].concat())
}

fn develop(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["develop", "ball.exr", "-o", "new.png"], more].concat())
}

#[track_caller]
fn done(said: &Said) {
    assert_eq!(said.status, 0, "{}", said.err);
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

#[test]
fn developing_gives_the_png_of_a_render_with_these_settings() {
    let folder = scene();
    let at = folder.path();
    let said = develop(at, &[]);
    done(&said);
    assert!(said.err.contains("new.png: exposure EV -3.00"), "{}", said.err);
    assert!(bytes(at, "new.png") == bytes(at, "ball.png"), "the scene's settings are the default");
    let cases: [(&[&str], &[&str]); 8] = [
        (&["--exposure", "auto"], &[r#"film.exposure="auto""#]),
        (&["--exposure", "-4.5", "--tone", "clip"], &[r#"film.exposure={"ev": -4.5}"#, r#"film.tone="clip""#]),
        (
            &["--white-balance", "scene", "--gamut", "oklab"],
            &[r#"film.white_balance="scene""#, r#"film.gamut="oklab""#],
        ),
        (&["--gamut", "clip", "--tone", "clip"], &[r#"film.gamut="clip""#, r#"film.tone="clip""#]),
        (&["--bloom", "40"], &[r#"film.bloom={"fov": 40}"#]),
        (&["--output-space", "rec2100-pq"], &[r#"film.output_space="rec2100-pq""#]),
        (&["--white-balance", "candle"], &[r#"film.white_balance="candle""#]),
        (
            &["--white-balance", "A", "--output-space", "rec2020"],
            &[r#"film.white_balance="A""#, r#"film.output_space="rec2020""#],
        ),
    ];
    for (options, sets) in cases {
        done(&develop(at, options));
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        done(&render(at, &[&["--quiet", "-o", "known.exr"], &sets[..]].concat()));
        assert!(bytes(at, "new.png") == bytes(at, "known.png"), "{options:?}");
        assert!(bytes(at, "new.png") != bytes(at, "ball.png"), "{options:?} changes the picture");
    }
    done(&abbe(at, &["develop", "ball.checkpoint.exr", "-o", "new.png"]));
    assert!(bytes(at, "new.png") == bytes(at, "ball.png"), "a checkpoint is a picture");
}

#[test]
fn wrong_settings_are_refused_by_name() {
    let folder = scene();
    let at = folder.path();
    develop(at, &["--gamut", "clips"]).is_error(2, &["clips", "desaturate"]);
    develop(at, &["--tone", "filmic"]).is_error(2, &["filmic", "roll_off"]);
    develop(at, &["--output-space", "cmyk"]).is_error(2, &["cmyk", "display-p3"]);
    develop(at, &["--bloom", "180"]).is_error(2, &["--bloom", "0.1 to 120 degrees"]);
    develop(at, &["--exposure", "bright"]).is_error(2, &["--exposure", "number of stops"]);
    develop(at, &["--white-balance", "sodium-low-pressure"]).is_error(2, &["sodium-low-pressure", "too saturated"]);
    abbe(at, &["develop", "ball.exr", "-o", "new.jpg"]).is_error(2, &["new.jpg", ".png"]);
    abbe(at, &["develop", "ball.json", "-o", "new.png"]).is_error(2, &["ball.json", "not a valid EXR"]);
    assert!(!names_in(at).contains(&"new.png".to_string()));
}

#[test]
fn settings_of_the_png_do_not_make_another_scene() {
    let folder = scene();
    let at = folder.path();
    let sets =
        ["--set", r#"film.exposure="auto""#, "--set", r#"film.white_balance="A""#, "--set", r#"film.tone="clip""#];
    done(&render(at, &[&["--quiet", "--passes", "12", "-o", "known.exr"], &sets[..]].concat()));
    done(&render(at, &[&["--quiet", "--passes", "12", "--resume"], &sets[..]].concat()));
    assert!(bytes(at, "ball.png") == bytes(at, "known.png"), "a resumed render takes the new settings");
    for (part, more) in [("0/2", &[][..]), ("1/2", &sets)] {
        let name = format!("part{}.exr", &part[..1]);
        done(&render(at, &[&["--quiet", "--passes", "12", "--part", part, "-o", &name], more].concat()));
    }
    done(&abbe(at, &["merge", "part1.exr", "part0.exr", "-o", "merged.exr", "--quiet"]));
    assert!(bytes(at, "merged.png") == bytes(at, "known.png"), "a merged picture has the settings of the first part");
}

#[test]
fn finished_frames_are_developed_again() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    let frames = ["--frames", "1..1", "-o", "f#.exr", "--resume"];
    done(&render(at, &frames));
    let before = (exr::read(&at.join("f1.exr")).unwrap().picture.xyz, bytes(at, "f1.png"));
    let darker = [&frames[..], &["--set", r#"film.exposure={"ev": -5}"#]].concat();
    let said = render(at, &darker);
    assert!(said.err.contains("f1.exr is already finished; its PNG was developed again"), "{}", said.err);
    assert!(exr::read(&at.join("f1.exr")).unwrap().picture.xyz == before.0 && bytes(at, "f1.png") != before.1);
    let said = render(at, &darker);
    assert!(said.err.contains("finished") && !said.err.contains("again"), "{}", said.err);
}
