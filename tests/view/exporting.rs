//! Pages that the reader takes along, and saved scenes.

use crate::abbe_command::abbe;
use crate::abbe_command::folder::with_ball;
use crate::browser::Browser;
use crate::client::{PATIENCE, SCENE, View};
use crate::page::{DESKTOP, finished, is_clean};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Saves a file by a function of the page, and returns its path.
fn saved(browser: &mut Browser, folder: &Path, name: &str, script: &str) -> PathBuf {
    browser.download_to(folder);
    browser.run(script);
    let (path, start) = (folder.join(name), Instant::now());
    // The browser reserves the name with an empty file.
    while path.metadata().map_or(0, |found| found.len()) == 0 {
        assert!(start.elapsed() < PATIENCE, "no file {name}");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    path
}

fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks(4).map(|value| f64::from(f32::from_le_bytes(value.try_into().unwrap()))).collect()
}

/// Requires that numbers agree within a fraction of the largest of them.
fn agree(found: &Value, expected: &Value, fraction: f64) {
    let numbers = |value: &Value| -> Vec<f64> { serde_json::from_value(value.clone()).unwrap() };
    let (found, expected) = (numbers(found), numbers(expected));
    let most = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(found.len() == expected.len() && most > 0.0);
    let worst = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst <= fraction * most, "{worst} of {most}");
}

#[test]
fn cells_have_the_values_of_probes() {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json"]);
    view.finished();
    let answer = view.get("cells?size=5");
    assert!(answer.head.contains("x-abbe-width: 48"), "{}", answer.head);
    let cells = floats(&answer.body);
    // 10 columns, 7 rows, 47 bands.
    assert_eq!(cells.len(), 10 * 7 * (6 + 2 * 47));
    // The last cell of the fourth row has three columns.
    let (cell, probe) = (&cells[39 * 100..40 * 100], view.get("probe?x0=45&y0=15&x1=47&y1=19").json());
    for (i, name) in [(1, &probe["xyz"][1]), (3, &probe["noise"]), (4, &probe["bias"]), (5, &probe["interval_95"][1])] {
        let is_same = |expected: f64| (cell[i] - expected).abs() <= 1e-6 * expected;
        assert!(name.as_f64().map_or(cell[i].is_nan(), is_same), "{i}: {} {name}", cell[i]);
    }
    agree(&Value::from(cell[6..53].to_vec()), &probe["values"], 1e-6);
    for wrong in ["cells", "cells?size=0", "cells?size=-1", "cells?size=x"] {
        assert_eq!(view.get(wrong).status, 400, "{wrong}");
    }
    assert_eq!(view.get("cells?size=1").status, 200);
}

/// The page works from disk, after the end of the program: it has the picture, the spectra with
/// their errors, the pins and the photon paths, and asks for nothing.
#[test]
fn an_exported_page_works_without_the_program() {
    let Some((folder, view, mut browser)) = finished(DESKTOP, false) else { return };
    // The errors of the bands are known after three pictures.
    for passes in [24, 48] {
        view.post(&json!({"extend": true}));
        browser.wait(&format!("state.session === 'finished' && picture.passes === {passes}"));
    }
    browser.run("select(areaOf([60, 120]))");
    browser.wait("hovered?.area[0] === 60 && hovered.errors");
    browser.run("pinArea()");
    browser.run("togglePhotons()");
    browser.wait("hasPhotons()");
    let lines = browser.run("photons.lines.length").as_i64().unwrap();
    let path = saved(&mut browser, folder.path(), "ball.html", "exportPage()");
    let size = path.metadata().unwrap().len();
    assert!((100_000..4_000_000).contains(&size), "{size} bytes");
    // The picture has 240 × 160 pixels, so a cell has 2 × 2.
    let probe = view.get("probe?x0=120&y0=110&x1=121&y1=111").json();
    drop(view);
    browser.open("about:blank");
    browser.forget();
    browser.open(&format!("file://{}", path.display()));
    browser.wait("cells !== null && data.size === 2 && $('spectrum').querySelector('path')");
    assert_eq!(browser.run("document.title"), "Abbe: A ball");
    assert_eq!(browser.run("data.paths.byColour.reduce((sum, [, numbers]) => sum + numbers.length / 4, 0)"), lines);
    let found = browser.run("report([60, 55])");
    assert_eq!(found["area"], probe["area"]);
    agree(&found["xyz"], &probe["xyz"], 1e-6);
    // The roots of the values have eight bits.
    agree(&found["values"], &probe["values"], 0.004);
    agree(&found["errors"], &probe["errors"], 0.1);
    agree(&found["interval_95"], &probe["interval_95"], 1e-5);
    browser.run("stage.focus()");
    browser.key("ArrowRight", "");
    browser.wait("cell?.join() === '61,40' && $('values').textContent.includes('122–123, 80–81')");
    browser.key("Enter", "\r");
    browser.wait("pins.length === 2 && $('spectrum').querySelectorAll('path.band').length === 3");
    for (size, is_dark, name) in [
        (DESKTOP, false, "export-light"),
        (DESKTOP, true, "export-dark"),
        ((390, 844), true, "export-phone-dark"),
        ((390, 844), false, "export-phone-light"),
    ] {
        browser.emulate(size, is_dark);
        browser.wait(&format!("document.documentElement.clientWidth === {}", size.0));
        assert_eq!(browser.run("document.documentElement.scrollWidth <= innerWidth"), true, "{name}");
        browser.screenshot(&format!("{name}.png"));
    }
    let others: Vec<String> = browser.complaints().into_iter().filter(|it| !it.starts_with("file://")).collect();
    assert!(others.is_empty(), "{others:?}");
    // The policy of the page forbids requests.
    let asked = browser.run("fetch('http://127.0.0.1:9/').then(() => 'answered', () => 'refused')");
    assert_eq!(asked, "refused");
    assert!(browser.complaints().iter().any(|it| it.contains("Content Security Policy")));
}

/// The saved scene contains the changes, and is a scene file.
#[test]
fn a_saved_scene_contains_the_changes() {
    let Some((folder, _view, mut browser)) = finished(DESKTOP, false) else { return };
    browser.run("changeScene('objects[1].shape.sphere.radius', 0.4, false)");
    browser.wait("state.session === 'finished' && scene.number === 2");
    let path = saved(&mut browser, folder.path(), "scene.json", "$('save-scene').click()");
    let scene: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(scene["objects"][1]["shape"]["sphere"]["radius"], 0.4);
    let said = abbe(folder.path(), &["check", "scene.json"]);
    assert_eq!(said.status, 0, "{}", said.err);
    is_clean(&browser);
}
