//! The comparison of two pictures, by the server and on the page.

use crate::abbe_command::abbe;
use crate::abbe_command::folder::with_ball;
use crate::browser::Browser;
use crate::client::{SCENE, View};
use crate::page::{DESKTOP, is_clean, position};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Renders `a.exr`, and `b.exr` with a lamp of half the power.
fn two_pictures() -> TempDir {
    let folder = with_ball(SCENE);
    for (name, power) in [("a.exr", 20), ("b.exr", 10)] {
        let power = format!("lights[0].point.power={power}");
        let arguments =
            ["render", "ball.json", "--quiet", "--size", "240x160", "--spectral-bands", "47", "--set", &power];
        let said = abbe(folder.path(), &[&arguments[..], &["-o", name]].concat());
        assert_eq!(said.status, 0, "{}", said.err);
    }
    folder
}

#[test]
fn the_server_compares_like_the_command() {
    let folder = two_pictures();
    let view = View::start(folder.path(), &["a.exr", "b.exr"]);
    let state = view.finished();
    assert_eq!((&state["picture"]["name"], &state["reference"]["name"]), (&json!("a.exr"), &json!("b.exr")));
    assert_eq!(state["passes"], 12);
    let known = abbe(folder.path(), &["compare", "a.exr", "b.exr", "--json"]).json();
    assert_eq!(view.get("comparison").json(), known);
    let probe = "probe?x0=120&y0=110&x1=120&y1=110";
    let [a, b] = [probe.to_string(), format!("reference_{probe}")].map(|path| view.get(&path).json());
    let ratio = a["xyz"][1].as_f64().unwrap() / b["xyz"][1].as_f64().unwrap();
    assert!((1.2..3.0).contains(&ratio), "{ratio}");
    assert_eq!(view.get("reference").body.len(), 240 * 160 * 12);
    assert_eq!(view.get("delta_e").body.len(), 240 * 160 * 4);
    // The picture is read again when its file changes.
    std::fs::copy(folder.path().join("b.exr"), folder.path().join("a.exr")).unwrap();
    view.wait("the other picture", |state| state["picture"]["number"].as_u64() > Some(1));
    assert_eq!(view.get("comparison").json()["relative_mse"], 0.0);
}

#[test]
fn unequal_and_missing_pictures_are_refused() {
    let folder = two_pictures();
    let small = ["render", "ball.json", "--quiet", "--passes", "1", "-o", "small.exr"];
    assert_eq!(abbe(folder.path(), &small).status, 0);
    let view = |arguments: &[&str]| abbe(folder.path(), &[&["view", "--no-open"], arguments].concat());
    view(&["a.exr", "small.exr"]).is_error(2, &["240 × 160 and 48 × 32", "same size"]);
    view(&["a.exr", "none.exr"]).is_error(2, &["none.exr"]);
    // A scene is rendered, although its reference has another size. There is no comparison.
    let view = View::start(folder.path(), &["ball.json", "a.exr"]);
    view.finished();
    assert_eq!(view.get("comparison").status, 409);
    assert_eq!(view.get("delta_e").status, 409);
}

/// The published picture becomes the reference, and a later one is compared with it.
#[test]
fn a_view_keeps_a_picture_for_comparison() {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json"]);
    assert_eq!(view.finished()["reference"], Value::Null);
    assert_eq!(view.get("comparison").status, 404);
    view.post(&json!({"keep": true, "changes": ["lights[0].point.power=40"]}));
    let state = view.wait("another render", |state| {
        state["session"] == "finished" && state["picture"]["scene"].as_u64() == Some(2)
    });
    assert_eq!((&state["reference"]["name"], &state["reference"]["passes"]), (&json!("ball.json"), &json!(12)));
    let ratio = view.get("comparison").json()["mean_ratio"].as_f64().unwrap();
    assert!((ratio - 2.0).abs() < 1e-6, "{ratio}");
}

/// Returns the colour of the canvas at a position in the window.
fn colour_at(browser: &mut Browser, (x, y): (f64, f64)) -> Vec<i64> {
    let found = browser.run(&format!(
        "(() => {{ const b = stage.getBoundingClientRect();
          return Array.from(context.getImageData(Math.round({x} - b.left), Math.round({y} - b.top), 1, 1).data); }})()"
    ));
    found.as_array().unwrap().iter().map(|code| code.as_i64().unwrap()).collect()
}

#[test]
fn the_page_compares_two_pictures() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let folder = two_pictures();
    let view = View::start(folder.path(), &["a.exr", "b.exr"]);
    browser.open(&view.url);
    browser.wait("comparison() === 'wipe' && imageB.width === 240");
    // Two points of the floor at the same distance from the lamp's axis: A is twice as bright as B.
    let (left, right) = (position(&mut browser, (60, 130)), position(&mut browser, (180, 130)));
    let show = |browser: &mut Browser, mode: &str| {
        browser.run(&format!("(async () => {{ setComparison('{mode}'); await draw(); }})()"));
        [left, right].map(|place| colour_at(browser, place))
    };
    let (a, b, wiped) = (show(&mut browser, "a"), show(&mut browser, "b"), show(&mut browser, "wipe"));
    assert!(a[0][1] > b[0][1] && a[1][1] > b[1][1], "{a:?} {b:?}");
    assert_eq!((&wiped[0], &wiped[1]), (&a[0], &b[1]));
    browser.screenshot("compare-wipe.png");
    // The line follows the mouse.
    let line = browser.run(
        "(() => { const b = stage.getBoundingClientRect(); return [b.left + b.width / 2, b.top + 60, b.width]; })()",
    );
    let [x, y, width] = [0, 1, 2].map(|i| line[i].as_f64().unwrap());
    browser.mouse("mousePressed", (x, y), false);
    browser.mouse("mouseMoved", (x + 0.4 * width, y), false);
    browser.mouse("mouseReleased", (x + 0.4 * width, y), false);
    let share = browser.run("Number($('wipe').value)").as_f64().unwrap();
    assert!((share - 90.0).abs() < 2.0, "{share}");
    assert_eq!(colour_at(&mut browser, right), a[1]);
    // A is brighter than B by more than half, so the difference has the full colour.
    assert_eq!(show(&mut browser, "difference")[0], [255, 0, 0, 255]);
    browser.screenshot("compare-difference.png");
    show(&mut browser, "delta_e");
    assert!(browser.run("$('legend').textContent").as_str().unwrap().contains("ΔE2000"));
    browser.screenshot("compare-delta-e.png");
    let known = abbe(folder.path(), &["compare", "a.exr", "b.exr", "--json"]).json();
    let mean =
        browser.run("[...$('figures').rows].find(row => row.textContent.startsWith('mean Y')).cells[1].textContent");
    let (mean, ratio) = (mean.as_str().unwrap().parse::<f64>().unwrap(), known["mean_ratio"].as_f64().unwrap());
    assert!((mean - ratio).abs() < 1e-3 * ratio, "{mean} {ratio}");
    // Flicker shows both pictures in turn.
    browser.run("setComparison('flicker')");
    for shows in ["showsB", "!showsB", "showsB"] {
        browser.wait(shows);
    }
    // The keyboard alone.
    browser.run("setComparison('a'); stage.focus()");
    browser.key("b", "b");
    browser.wait("comparison() === 'b'");
    browser.key("b", "b");
    browser.wait("comparison() === 'a'");
    browser.hover(left);
    browser.wait("hovered && hoveredB && hovered.xyz[1] > hoveredB.xyz[1]");
    browser.run("showTab('spectrum')");
    browser.screenshot("compare-spectrum.png");
    is_clean(&browser);
}

#[test]
fn the_comparison_fits_a_phone() {
    let Some(mut browser) = Browser::start((390, 844), true) else { return };
    let folder = two_pictures();
    let view = View::start(folder.path(), &["a.exr", "b.exr"]);
    browser.open(&view.url);
    browser.wait("comparison() === 'wipe' && imageB.width === 240 && $('figures').rows.length === 10");
    assert!(browser.run("document.documentElement.scrollWidth <= innerWidth").as_bool().unwrap());
    browser.screenshot("compare-phone.png");
    is_clean(&browser);
}
