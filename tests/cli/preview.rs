//! The preview: the output files are refreshed while a render runs.

use crate::abbe_command::command;
use crate::abbe_command::folder::{names_in, with_ball};
use abbe_session::output::exr;
use std::process::Stdio;
use std::time::{Duration, Instant};

const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 32, "height": 24},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
  "objects": [{"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"passes": 1000000, "photons": 100}
}"#;

#[test]
fn a_running_render_shows_whole_pictures() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    let mut child = command(at).args(["render", "ball.json", "--quiet"]).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while !at.join("ball.png").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no preview");
        std::thread::sleep(Duration::from_millis(20));
    }
    let first = start.elapsed();
    let file = exr::read(&at.join("ball.exr")).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(first >= Duration::from_millis(250), "{first:?}");
    assert!(file.picture.xyz.iter().any(|xyz| xyz[1] > 0.0));
    assert_eq!(file.metadata.get("abbe.preview"), Some("true"));
    assert!(file.metadata.get("abbe.passes").unwrap().parse::<u64>().unwrap() > 1);
    assert!(image::open(at.join("ball.png")).is_ok(), "a whole PNG");
    let names = names_in(at);
    assert!(["ball.exr", "ball.json", "ball.png"].iter().all(|name| names.contains(&(*name).to_string())), "{names:?}");
}

#[test]
fn a_finished_picture_is_no_preview() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    let said = crate::abbe_command::abbe(at, &["render", "ball.json", "--quiet", "--time", "1500ms"]);
    assert_eq!(said.status, 0, "{}", said.err);
    assert_eq!(exr::read(&at.join("ball.exr")).unwrap().metadata.get("abbe.preview"), None);
}

/// Before pass 0, the files contain a coarse picture.
#[test]
fn the_files_show_a_coarse_picture_before_pass_0() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    let arguments = ["render", "ball.json", "--quiet", "--size", "320x240", "--photons", "1000000"];
    let mut child = command(at).args(arguments).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while !at.join("ball.png").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no picture");
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let file = exr::read(&at.join("ball.exr")).unwrap();
    assert_eq!((file.picture.width, file.picture.height), (320, 240));
    assert_eq!([file.metadata.get("abbe.preview"), file.metadata.get("abbe.passes")], [Some("true"), Some("0")]);
    assert!(file.picture.xyz.iter().filter(|xyz| xyz[1] > 0.0).count() > 320 * 240 / 4, "the coarse picture shows it");
}
