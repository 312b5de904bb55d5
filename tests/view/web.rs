//! The page without a server. `tests/run --web` builds it, and runs these tests.

use crate::browser::Browser;
use crate::page::{DESKTOP, position};
use abbe::page::PageEngine;
use abbe_session::render::PassPart;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scene(name: &str) -> PathBuf {
    root().join("scenes").join(name).with_extension("json")
}

/// The page asks for nothing but itself and its own workers, and reports no error.
fn uses_only_itself(browser: &Browser) {
    let others: Vec<String> = browser.complaints().into_iter().filter(|it| !it.starts_with("blob:")).collect();
    assert!(others.iter().all(|it| it.starts_with("file://") && it.contains("target/page/index.html")), "{others:?}");
}

/// The sums of 8 passes are the same in WebAssembly and in the native program.
#[test]
#[ignore = "web: tests/run --web builds the module and runs this"]
fn node_has_the_bits_of_the_program() {
    const SCENES: [&str; 6] = ["glass_ball", "prism", "soap_film", "prism_in_fog", "sodium", "quinine"];
    const CHANGES: [&str; 2] = ["film.width=64", "film.height=36"];
    const PASSES: u64 = 8;
    let changes = CHANGES.map(str::to_string);
    let said = Command::new("node")
        .arg(root().join("tests/view/web_sums.js"))
        .args([root().join("target/page").as_os_str(), PASSES.to_string().as_ref()])
        .arg(serde_json::to_string(&changes).unwrap())
        .args(SCENES.map(scene))
        .output()
        .unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let said = String::from_utf8(said.stdout).unwrap();
    let lines: Vec<(&str, f64)> =
        said.lines().map(|line| line.split_once(' ').map(|(hash, s)| (hash, s.parse().unwrap())).unwrap()).collect();
    assert_eq!(lines.len(), SCENES.len());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    for (name, (hash, web_s)) in SCENES.into_iter().zip(lines) {
        let mut engine = PageEngine::default();
        engine.load(&std::fs::read_to_string(scene(name)).unwrap(), &changes, &[]).unwrap();
        let start = cpu_time::ThreadTime::now();
        let bytes = pool.install(|| engine.render(PassPart::WHOLE, PASSES, None, &mut |_| true)).unwrap();
        let native_s = start.elapsed().as_secs_f64();
        println!("{name}: {hash}, {native_s:.2} s native, {web_s:.2} s in Node: {:.2}", native_s / web_s);
        assert_eq!(engine.hash_of_sums(&[bytes]).unwrap(), hash, "{name}");
    }
}

/// The page renders the prism from a file, follows a drag, and keeps its picture when the scene has
/// an error.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn the_page_renders_without_a_server() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let start = Instant::now();
    browser.open(&format!("file://{}", root().join("target/page/index.html").display()));
    browser.wait("picture !== null");
    println!("first picture after {:.2} s", start.elapsed().as_secs_f64());
    browser.wait("state.passes > 0");
    println!("first pass after {:.2} s", start.elapsed().as_secs_f64());
    browser.wait("state.typical_error !== null && state.typical_error < 0.2");
    println!("error of 20 % after {:.2} s", start.elapsed().as_secs_f64());
    browser.run("stage.focus()");
    browser.key("o", "o");
    let press = position(&mut browser, (95, 130));
    browser.mouse("mousePressed", press, false);
    browser.wait("chosen?.name === 'prism'");
    browser.run("globalThis.firstNumber = picture.number; globalThis.dragStart = performance.now()");
    for step in 1..=20 {
        let at = position(&mut browser, (95 + step, 130));
        browser.mouse("mouseMoved", at, false);
    }
    browser.wait("picture.number > firstNumber");
    println!("the picture followed after {} ms", browser.run("performance.now() - dragStart"));
    let end = position(&mut browser, (115, 130));
    browser.mouse("mouseReleased", end, false);
    browser.wait("!state.draft && state.passes > 0 && scene.scene.objects[3].transform.length === 4");
    browser.screenshot("web.png");
    browser.run("changeScene('materials.flint.dielectric.ior', 'N-NONE', false)");
    browser.wait("state.error !== null");
    assert!(browser.run("state.error").as_str().unwrap().contains("N-NONE"), "{}", browser.run("state.error"));
    assert!(browser.run("picture.passes").as_i64().unwrap() > 0, "the last picture stays");
    browser.run("undo()");
    browser.wait("state.error === null && state.passes > 0");
    uses_only_itself(&browser);
}

/// A shared address opens the same scene.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn an_address_contains_the_scene() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let page = format!("file://{}", root().join("target/page/index.html").display());
    browser.open(&(page.clone() + "#soap_film"));
    browser.wait("picture !== null && scene.scene.title.includes('oap')");
    browser.run("$('share').click()");
    browser.wait("location.hash.startsWith('#scene=')");
    let address = browser.run("location.href").as_str().unwrap().to_string();
    browser.open("about:blank");
    browser.open(&address);
    browser.wait("picture !== null && scene.scene.title.includes('oap')");
    let pixels = browser.run("scene.scene.film.width * scene.scene.film.height").as_f64().unwrap();
    assert!((pixels / (320.0 * 180.0) - 1.0).abs() < 0.02, "{pixels}");
    uses_only_itself(&browser);
}
