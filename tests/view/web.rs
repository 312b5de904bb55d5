//! The page without a server. `tests/run --web` builds it, and runs these tests.

use crate::browser::Browser;
use crate::page::{DESKTOP, position};
use abbe::page::PageEngine;
use abbe_session::render::PassPart;
use base64::Engine;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scene(name: &str) -> PathBuf {
    root().join("scenes").join(name).with_extension("json")
}

fn page() -> String {
    format!("file://{}", root().join("target/page/index.html").display())
}

/// Returns the fraction of the time in which the cores of the machine work, over a second.
fn load_of_machine() -> f64 {
    let times = || -> [f64; 2] {
        let stat = std::fs::read_to_string("/proc/stat").unwrap();
        let fields: Vec<f64> =
            stat.lines().next().unwrap().split_whitespace().skip(1).map(|field| field.parse().unwrap()).collect();
        // The fourth and the fifth count the time without work.
        [fields.iter().sum(), fields[3] + fields[4]]
    };
    let before = times();
    std::thread::sleep(Duration::from_secs(1));
    let after = times();
    1.0 - (after[1] - before[1]) / (after[0] - before[0])
}

/// Presses the left button on the prism.
fn press_prism(browser: &mut Browser) {
    browser.run("stage.focus()");
    browser.key("o", "o");
    let press = position(browser, (95, 130));
    browser.mouse("mousePressed", press, false);
    browser.wait("chosen?.name === 'prism' && dragging?.ready");
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
        let run = pool.install(|| engine.render(PassPart::WHOLE, PASSES, 0, None, &mut |_| true)).unwrap();
        let native_s = start.elapsed().as_secs_f64();
        println!("{name}: {hash}, {native_s:.2} s native, {web_s:.2} s in Node: {:.2}", native_s / web_s);
        assert_eq!(run.hash_of_sums(), hash, "{name}");
    }
}

/// The page renders the prism from a file, follows a drag, and keeps its picture when the scene has
/// an error.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn the_page_renders_without_a_server() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let start = Instant::now();
    browser.open(&page());
    browser.wait("picture !== null");
    println!("first picture after {:.2} s", start.elapsed().as_secs_f64());
    browser.wait("state.passes > 0");
    println!("first pass after {:.2} s", start.elapsed().as_secs_f64());
    browser.wait("state.typical_error !== null && state.typical_error < 0.2");
    println!("error of 20 % after {:.2} s", start.elapsed().as_secs_f64());
    press_prism(&mut browser);
    let end = position(&mut browser, (115, 130));
    browser.mouse("mouseMoved", end, false);
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

/// While an object follows the pointer, five pictures come each second, the first one within 0.3 s,
/// if nothing else uses the machine.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn a_drag_keeps_five_pictures_a_second() {
    let load = load_of_machine();
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    browser.open(&page());
    browser.wait("state.passes > 0 && picture?.passes > 0");
    press_prism(&mut browser);
    let seen = browser.run(&format!("({})(4)", include_str!("drag.js")));
    let numbers = |key: &str| -> Vec<f64> { serde_json::from_value(seen[key].clone()).unwrap() };
    let (times, columns) = (numbers("times"), numbers("columns"));
    let per_second = 1e3 * (times.len() - 1) as f64 / (times[times.len() - 1] - times[0]);
    println!("load of the machine {load:.2}; first picture after {:.0} ms, {per_second:.1} a second", times[0]);
    println!("columns of the pictures: {columns:?}");
    if load < 0.1 {
        assert!(times[0] <= 300.0 && per_second >= 5.0, "{times:?}");
    }
    let end = position(&mut browser, (95, 130));
    browser.mouse("mouseReleased", end, false);
    browser.wait("!state.draft && picture.passes > 0 && picture.number === state.picture.number");
    uses_only_itself(&browser);
}

/// The page contains the compressed module, whose size decides how long a page takes to arrive.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn the_compressed_module_has_less_than_2_mb() {
    const START: &str = "<script type=\"text/plain\" id=\"abbe-module\">";
    let text = std::fs::read_to_string(root().join("target/page/index.html")).unwrap();
    let module = text.split_once(START).and_then(|(_, rest)| rest.split_once('<')).unwrap().0;
    let bytes = base64::engine::general_purpose::STANDARD.decode(module).unwrap().len();
    println!("the compressed module has {:.3} MB", 1e-6 * bytes as f64);
    assert!(bytes < 2_000_000, "{bytes}");
}

/// While two workers render the prism for twelve seconds, the memory of the process of the page that
/// it does not share with other processes stays below 400 MB.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn the_page_needs_less_than_400_mb() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    browser.have_cores(2);
    browser.open(&page());
    browser.wait("picture?.passes > 0");
    let (mut most, begin) = (0, Instant::now());
    while begin.elapsed() < Duration::from_secs(12) {
        let Some(bytes) = browser.memory_of_page() else { return };
        most = most.max(bytes);
        std::thread::sleep(Duration::from_millis(50));
    }
    let passes = browser.run("picture.passes");
    println!("the page needs {:.0} MB, after {passes} passes", 1e-6 * most as f64);
    assert!(most < 400_000_000, "{most}");
}

/// Before the first pass, the picture becomes finer, and says that it is coarse.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn coarse_pictures_become_finer() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    browser.open(&(page() + "#prism_in_fog"));
    browser.wait("picture?.coarse?.size[0] === 160 && $('legend').textContent.includes('160 × 90')");
    assert_eq!(browser.run("$('legend').hidden"), false);
    assert_eq!(browser.run("$('error').textContent"), "not known yet");
    browser.wait("picture.passes > 0");
    assert_eq!(browser.run("picture.coarse"), serde_json::Value::Null);
}

/// The workers end when the reader leaves the page.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn the_workers_end_with_the_page() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    browser.watch_workers();
    browser.open(&page());
    browser.wait("state.passes > 0");
    assert!(browser.workers() >= 2, "the one that shows pictures, and at least one that renders");
    browser.open("about:blank");
    let start = Instant::now();
    while browser.workers() > 0 {
        assert!(start.elapsed() < Duration::from_secs(10), "{} workers", browser.workers());
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// A shared address opens the same scene.
#[test]
#[ignore = "web: tests/run --web builds the page and runs this"]
fn an_address_contains_the_scene() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    browser.open(&(page() + "#soap_film"));
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
