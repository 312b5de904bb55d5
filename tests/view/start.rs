//! The first page of a view without a scene file: thumbnails of example scenes.

use crate::abbe_command::abbe;
use crate::browser::Browser;
use crate::client::{SCENE, View};
use crate::page::{DESKTOP, is_clean};
use serde_json::json;
use std::path::Path;

/// Small pictures, so that the examples render quickly.
const QUICK: [&str; 6] = ["--size", "96x54", "--passes", "3", "--set", "render.photons=2000"];

fn start(folder: &Path) -> View {
    View::start(folder, &QUICK)
}

/// The examples are in the program: the folder is empty.
#[test]
fn a_click_on_a_picture_opens_the_scene() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let folder = tempfile::tempdir().unwrap();
    let view = start(folder.path());
    browser.open(&view.url);
    browser.wait(
        "document.querySelectorAll('main img').length > 10 && [...document.images].every(i => i.naturalWidth === 320)",
    );
    browser.run("document.querySelector('a[href=\"view#prism\"]').click()");
    browser.wait("state.session === 'finished' && picture?.passes === 3 && scene.file === 'prism.json'");
    let title = browser.run("document.title");
    assert_eq!(title, "Abbe: prism.json");
    // A change of the scene, which the next example does not have.
    browser.run("changeScene('lights[0].beam.power', 3, false)");
    browser.wait("state.changes.length === 1 && state.session === 'finished' && scene.number === 2");
    browser.run("$('examples').click()");
    browser.wait("document.querySelector('a[href=\"view#prism\"]').getAttribute('aria-current') === 'true'");
    browser.screenshot("start-again.png");
    browser.run("document.querySelector('header a').click()");
    browser.wait("picture?.passes === 3 && scene.number === 2");
    browser.run("history.back()");
    browser.wait("document.querySelector('.cards')");
    browser.run("document.querySelector('a[href=\"view#grating\"]').click()");
    browser.wait("picture?.passes === 3 && scene.file === 'grating.json' && state.changes.length === 0");
    is_clean(&browser);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "the view leaves no files");
}

#[test]
fn the_start_page_works_with_the_keyboard_and_by_name() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let folder = tempfile::tempdir().unwrap();
    let view = start(folder.path());
    browser.open(&view.url);
    browser.wait("document.querySelector('footer')");
    let names: Vec<String> = browser.accessible("link").into_iter().filter(|name| !name.is_empty()).collect();
    assert!(names[0].starts_with("Newton's prism Sunlight through a slit"), "{names:?}");
    assert_eq!(browser.run("document.title"), "Abbe: choose a scene");
    assert_eq!(browser.run("document.querySelectorAll('main, h1').length"), 2);
    browser.run("document.querySelector('.cards a').focus()");
    browser.key("Enter", "\r");
    browser.wait("picture?.passes === 3 && scene.file === 'prism.json'");
    is_clean(&browser);
}

#[test]
fn the_start_page_fits_its_screen() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let folder = tempfile::tempdir().unwrap();
    let view = start(folder.path());
    for (size, is_dark, name) in [
        (DESKTOP, false, "start-light"),
        (DESKTOP, true, "start-dark"),
        ((390, 844), true, "start-phone-dark"),
        ((390, 844), false, "start-phone-light"),
    ] {
        browser.emulate(size, is_dark);
        browser.open("about:blank");
        browser.open(&view.url);
        browser.wait("document.querySelector('footer')");
        assert_eq!(browser.run("document.documentElement.scrollWidth <= innerWidth"), true, "{name}");
        browser.screenshot(&format!("{name}.png"));
    }
    is_clean(&browser);
}

/// The examples need the token, too, and only the page opens them.
#[test]
fn examples_are_as_safe_as_a_scene_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("here.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let view = start(folder.path());
    let page = view.get("");
    assert!(page.head.to_lowercase().contains("content-security-policy: default-src 'none'"), "{}", page.head);
    assert!(!String::from_utf8(page.body).unwrap().contains("<script"));
    for path in ["/", "/view", "/state"] {
        assert_eq!(view.send(&format!("GET {path} HTTP/1.1\r\nHost: {}", view.host), b"").unwrap().status, 404);
    }
    let of_other_site =
        format!("POST {}orders HTTP/1.1\r\nHost: {}\r\nOrigin: http://evil.example", view.path, view.host);
    let body = br#"{"open": "prism"}"#;
    let status = view.send(&format!("{of_other_site}\r\nContent-Length: {}", body.len()), body).unwrap().status;
    assert_eq!(status, 403);
    assert_eq!(view.get("state").json()["example"], json!(null));
    assert_eq!(view.get("scene").status, 404);
    assert_eq!(view.post(&json!({"open": "../prism"})).status, 404);
    assert_eq!(view.post(&json!({"open": "prism"})).status, 200);
    view.finished();
    // An example names no files, not even in the folder where the program runs.
    view.post(&json!({"changes": ["objects[0].shape={\"mesh\": {\"path\": \"here.obj\"}}"]}));
    let state = view.wait("a refusal", |state| state["session"] == "failed");
    assert!(state["error"].as_str().unwrap().contains("not a file"), "{}", state["error"]);
}

#[test]
fn a_view_of_a_scene_has_no_start_page() {
    let folder = crate::abbe_command::folder::with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json"]);
    let state = view.finished();
    assert_eq!((&state["has_examples"], &state["example"]), (&json!(false), &json!(null)));
    assert!(String::from_utf8(view.get("").body).unwrap().contains("<title>Abbe live view"));
    assert_eq!(view.get("view").status, 404);
    assert_eq!(view.post(&json!({"open": "prism"})).status, 404);
    let said = abbe(folder.path(), &["view", "--no-open", "--allow-outside"]);
    said.is_error(2, &["--allow-outside", "SCENE"]);
}
