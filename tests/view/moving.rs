//! Objects that the reader moves in the picture.

use crate::page::{DESKTOP, finished, is_clean, position};
use serde_json::{Value, json};

#[test]
fn the_object_under_a_pixel_is_found() {
    let folder = crate::abbe_command::folder::with_ball(crate::client::SCENE);
    let view = crate::client::View::start(folder.path(), &["ball.json", "--size", "240x160"]);
    view.finished();
    let ball = view.get("pick?x=120&y=72").json();
    assert_eq!((&ball["object"], &ball["name"]), (&json!(1), &json!("ball")));
    let point: Vec<f64> = serde_json::from_value(ball["point_m"].clone()).unwrap();
    let from_centre = (point[0].powi(2) + (point[1] - 0.6).powi(2) + point[2].powi(2)).sqrt();
    assert!((from_centre - 0.5).abs() < 1e-9, "{point:?} is not on the sphere");
    // A picture of 160 pixels is 2 tan(20°) times as high as its distance.
    let distance = point.iter().zip([0.0, 2.0, 5.0]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let width = ball["pixel_width_m"].as_f64().unwrap() / (2.0 * 20_f64.to_radians().tan() * distance / 160.0);
    assert!((0.9..1.1).contains(&width), "{width}");
    assert_eq!(view.get("pick?x=1&y=1").json(), Value::Null);
    assert_eq!(view.get("pick?x=240&y=1").status, 400);
}

/// A drag moves the object parallel to the floor, the ring turns it, and Undo takes back one after
/// the other.
#[test]
fn an_object_follows_the_pointer_and_the_keys() {
    let Some((_folder, _view, mut browser)) = finished(DESKTOP, false) else { return };
    let transform = "changes.get('objects[1].transform')?.at(-1).translate";
    browser.run("stage.focus()");
    browser.key("o", "o");
    let press = position(&mut browser, (120, 72));
    browser.mouse("mousePressed", press, false);
    browser.wait("chosen?.name === 'ball'");
    browser.mouse("mouseReleased", press, false);
    assert_eq!(browser.run("changes.size"), 0, "a click only chooses");
    browser.mouse("mousePressed", press, false);
    let moved = position(&mut browser, (160, 72));
    browser.mouse("mouseMoved", moved, false);
    browser.mouse("mouseReleased", moved, false);
    let shift: Vec<f64> = serde_json::from_value(browser.run(transform)).unwrap();
    // 40 pixels of which 160 are 2 tan(20°) times the distance of about 4.8 m, to the right and not
    // up.
    let expected = 40.0 / 160.0 * 2.0 * 20_f64.to_radians().tan() * 4.8;
    assert!((shift[0] / expected - 1.0).abs() < 0.15 && shift[1].abs() < 1e-9, "{shift:?}, {expected}");
    browser.wait("state.session === 'finished' && !state.draft && scene.scene.objects[1].transform?.length === 1");
    browser.run("stage.focus()");
    browser.key("q", "q");
    browser.wait("changes.get('objects[1].transform').length === 3");
    assert_eq!(browser.run("changes.get('objects[1].transform')[1].rotate.degrees"), 1);
    browser.run("showTab('scene')");
    assert!(browser.run("document.querySelectorAll('#chosen .leaf').length").as_i64().unwrap() >= 6);
    assert_eq!(browser.run("document.querySelector('#chosen .choice input').value"), "SF10");
    browser.screenshot("moved.png");
    browser.run("undo()");
    assert_eq!(browser.run("changes.get('objects[1].transform').length"), 1);
    browser.run("undo()");
    assert_eq!(browser.run("changes.size"), 0);
    browser.wait("state.session === 'finished' && !state.draft && !scene.scene.objects[1].transform");
    is_clean(&browser);
}
