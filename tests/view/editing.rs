//! Changes of the scene, by its file and by the page.

use crate::abbe_command::folder::with_ball;
use crate::client::{SCENE, View};
use serde_json::{Value, json};

#[test]
fn the_view_follows_the_scene_file() {
    let folder = with_ball(SCENE);
    let path = folder.path().join("ball.json");
    let view = View::start(folder.path(), &["ball.json"]);
    let first = view.finished();
    std::fs::write(&path, SCENE.replace("\"photons\": 500", "\"photons\": many")).unwrap();
    let failed = view.wait("a fault", |state| state["session"] == "failed");
    let error = failed["error"].as_str().unwrap();
    let lines: Vec<&str> = error.lines().collect();
    assert!(lines[0].contains("ball.json:10:"), "{error}");
    assert!(lines[1].starts_with("10 |   \"render\"") && lines[2].trim() == "^", "{error}");
    let caret = lines[2].chars().count() - 1;
    assert!(lines[1].chars().skip(caret).collect::<String>().starts_with("many"), "{error}");
    assert_eq!(failed["picture"], first["picture"], "the last picture stays");
    std::fs::write(&path, SCENE.replace("\"photons\": 500", "\"photons\": 700")).unwrap();
    let next = view.wait("a new render", |state| state["session"] == "finished" && state["scene"] != first["scene"]);
    assert_eq!(next["error"], Value::Null);
    assert_eq!(view.get("scene").json()["scene"]["render"]["photons"], 700);
}

/// While a slider moves, coarse pictures come. When it rests, the whole picture is rendered.
#[test]
fn changes_of_the_page_render_again() {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json", "--size", "480x320"]);
    let first = view.finished();
    let changes = ["objects[name=ball].shape.sphere.radius=0.4"];
    view.post(&json!({"changes": changes, "draft": true}));
    let next = |state: &Value| state["picture"]["scene"].as_u64() > first["picture"]["scene"].as_u64();
    let draft = view.wait("a coarse picture", next);
    assert_eq!(draft["picture"]["passes"], 0);
    let coarse = &draft["picture"]["coarse"];
    assert!(coarse["size"][0].as_u64() < Some(480) && coarse["photons"].as_u64() <= Some(500), "{coarse}");
    // The reader releases the slider.
    view.post(&json!({"changes": changes, "draft": false}));
    assert_eq!(view.get("state").json()["draft"], false);
    assert_eq!(view.get("scene").json()["scene"]["objects"][1]["shape"]["sphere"]["radius"], 0.4);
    let last = view.wait("the whole picture", |state| state["session"] == "finished" && next(state));
    assert_eq!((&last["draft"], &last["picture"]["passes"]), (&json!(false), &json!(12)));
    assert_eq!(last["picture"]["coarse"], Value::Null);
    assert!(std::fs::read_to_string(folder.path().join("ball.json")).unwrap() == SCENE, "the file does not change");
}

#[test]
fn the_page_forbids_an_effect() {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json"]);
    let first = view.finished();
    assert!(first["picture"]["events"]["dispersion"].as_u64().unwrap() > 0, "{}", first["picture"]["events"]);
    view.post(&json!({"forbidden": ["dispersion"]}));
    view.wait("a render without it", |state| {
        state["session"] == "finished" && state["picture"]["events"]["dispersion"].as_u64() == Some(0)
    });
    let plan = view.get("scene").json()["plan"]["effects"].clone();
    let row = plan.as_array().unwrap().iter().find(|row| row["name"] == "dispersion").unwrap().clone();
    assert_eq!(row["state"], "forbidden");
}

/// A view that separates the light by paths serves the shares of the classes and the samples.
#[test]
fn path_classes_and_samples_are_served() {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json"]);
    let plain = view.finished();
    assert_eq!((&plain["picture"]["classes"], &plain["picture"]["samples"]), (&json!([]), &json!(false)));
    for plane in ["classes", "samples"] {
        let answer = view.get(plane);
        assert_eq!((answer.status, answer.body.len()), (200, 0), "{plane}");
    }
    assert!(plain["picture"]["pass_seconds"].as_f64().unwrap() > 0.0);
    view.post(&json!({"changes": ["film.layers=[\"paths\", \"samples\"]"]}));
    let state = view.wait("layers", |state| state["session"] == "finished" && state["picture"]["samples"] == true);
    let means: Vec<f64> = serde_json::from_value(state["picture"]["classes"].clone()).unwrap();
    let (sum, whole) = (means.iter().sum::<f64>(), state["picture"]["mean_y"].as_f64().unwrap());
    assert!((sum - whole).abs() < 1e-4 * whole, "{means:?} {whole}");
    // The floor is lit straight from the lamp, and by the caustic of the ball. There is no medium.
    assert!(means[1] > means[2] && means[2] > 0.0 && means[4] == 0.0, "{means:?}");
    assert_eq!(view.get("classes").body.len(), 5 * 4 * 48 * 32);
    let samples = view.get("samples").body;
    assert!(samples.chunks(4).all(|value| f32::from_le_bytes(value.try_into().unwrap()) >= 12.0));
}
