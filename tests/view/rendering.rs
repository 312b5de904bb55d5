//! The picture of the view, and its files.

use crate::abbe_command::abbe;
use crate::abbe_command::folder::{names_in, with_ball};
use crate::abbe_command::signal::signal;
use crate::client::{SCENE, View};
use serde_json::json;
use std::path::Path;

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

/// Renders the picture with which the view must agree.
fn render(folder: &Path, more: &[&str]) {
    let arguments = [&["render", "ball.json", "--quiet", "--spectral-bands", "47", "--reproducible"], more].concat();
    let said = abbe(folder, &arguments);
    assert_eq!(said.status, 0, "{}", said.err);
}

/// The saved files equal those of a render byte for byte, also after a pause.
#[test]
fn saved_files_equal_those_of_a_render() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    render(at, &["--passes", "9", "--size", "40x30"]);
    let view = View::start(at, &["ball.json", "--passes", "9", "--size", "40x30"]);
    assert_eq!(view.post(&json!({"paused": true})).status, 200);
    assert_eq!(view.post(&json!({"paused": false})).status, 200);
    let state = view.finished();
    assert_eq!((&state["passes"], &state["picture"]["passes"]), (&json!(9), &json!(9)));
    assert!(view.get("save.exr").body == bytes(at, "ball.exr"), "the EXR files differ");
    assert!(view.get("save.png").body == bytes(at, "ball.png"), "the PNG files differ");
}

/// A finished view continues to twice the passes, with the picture of a single render.
#[test]
fn a_finished_view_renders_more_passes() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    render(at, &["--passes", "6"]);
    let view = View::start(at, &["ball.json", "--passes", "3"]);
    view.finished();
    view.post(&json!({"extend": true}));
    view.wait("6 passes", |state| state["session"] == "finished" && state["passes"] == 6);
    assert!(view.get("save.exr").body == bytes(at, "ball.exr"));
}

/// Ctrl-C saves a checkpoint, from which `abbe render --resume` continues.
#[test]
fn an_interrupted_view_leaves_a_checkpoint_for_a_render() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    render(at, &["--passes", "300", "-o", "whole.exr"]);
    let view = View::start(at, &["ball.json", "--passes", "300", "-o", "part.exr"]);
    view.wait("some passes", |state| state["passes"].as_u64().unwrap() >= 2);
    signal(&view.child, "-INT");
    let (status, said) = view.end();
    assert_eq!(status, 130, "{said}");
    assert!(said.contains("part.checkpoint.exr"), "{said}");
    render(at, &["--passes", "300", "-o", "part.exr", "--resume"]);
    assert!(bytes(at, "part.exr") == bytes(at, "whole.exr"));
}

#[test]
fn an_interrupted_finished_view_saves_its_picture() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    render(at, &[]);
    let view = View::start(at, &["ball.json", "-o", "ball.view.exr"]);
    view.finished();
    signal(&view.child, "-INT");
    assert_eq!(view.end().0, 0);
    assert!(bytes(at, "ball.view.exr") == bytes(at, "ball.exr"));
    let names = names_in(at);
    assert!(names.contains(&"ball.view.png".to_string()) && !names.iter().any(|name| name.contains("checkpoint")));
}

#[test]
fn a_view_leaves_no_files_unless_asked() {
    let folder = with_ball(SCENE);
    let before = names_in(folder.path());
    let view = View::start(folder.path(), &["ball.json"]);
    view.finished();
    signal(&view.child, "-INT");
    let (status, said) = view.end();
    assert_eq!(status, 0, "{said}");
    assert!(said.contains("ended after 12 passes; -o OUT.exr"), "{said}");
    assert_eq!(names_in(folder.path()), before);
}

/// The page receives the pixels, errors and bands of the saved picture.
#[test]
fn probes_have_the_values_of_the_picture() {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json"]);
    view.finished();
    std::fs::write(folder.path().join("saved.exr"), view.get("save.exr").body).unwrap();
    let saved = abbe(folder.path(), &["probe", "saved.exr", "20", "21", "--json"]).json();
    let found = view.get("probe?x0=20&y0=21&x1=20&y1=21").json();
    let close = |a: &serde_json::Value, b: &serde_json::Value| {
        let [a, b] = [a, b].map(|value| value.as_f64().unwrap());
        assert!((a - b).abs() <= 1e-6 * a.abs().max(1e-9), "{a} {b}");
    };
    (0..3).for_each(|c| close(&found["xyz"][c], &saved["xyz"][c]));
    ["noise", "bias"].iter().for_each(|key| close(&found[*key], &saved[*key]));
    (0..2).for_each(|end| close(&found["interval_95"][end], &saved["interval_95"][end]));
    (0..47).for_each(|band| close(&found["values"][band], &saved["spectrum"]["values"][band]));
    let pixel = (21 * 48 + 20) * 4;
    let plane = |name: &str, offset: usize| {
        let body = view.get(name).body;
        f64::from(f32::from_le_bytes(body[offset..offset + 4].try_into().unwrap()))
    };
    close(&json!(plane("picture", 3 * pixel + 4)), &saved["xyz"][1]);
    close(&json!(plane("errors", 2 * pixel)), &saved["noise"]);
    close(&json!(plane("band?band=20", pixel)), &saved["spectrum"]["values"][20]);
    // The mean of an area.
    let both = view.get("probe?x0=20&y0=21&x1=21&y1=21").json();
    let other = view.get("probe?x0=21&y0=21&x1=21&y1=21").json();
    let mean = 0.5 * (found["values"][20].as_f64().unwrap() + other["values"][20].as_f64().unwrap());
    close(&both["values"][20], &json!(mean));
}
