//! Mouse, touch and sliders in a real browser.

use crate::browser::Browser;
use crate::client::View;
use crate::page::{DESKTOP, finished, is_clean, position};
use serde_json::Value;
use std::time::{Duration, Instant};

/// Returns the position of the camera that the page shows, and the point at which it looks.
fn camera(browser: &mut Browser) -> [Vec<f64>; 2] {
    let text = browser.run("$('camera').value");
    let camera: Value = serde_json::from_str(text.as_str().unwrap()).unwrap();
    ["from", "at"].map(|key| serde_json::from_value(camera[key].clone()).unwrap())
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Waits until the whole picture of the present camera is rendered.
fn settle(browser: &mut Browser, view: &View) {
    view.wait("the whole picture", |state| state["session"] == "finished" && state["draft"] == false);
    browser.wait("state.session === 'finished' && !state.draft && picture.passes === 12 && picture.number === state.picture.number");
}

#[test]
fn the_mouse_moves_the_camera() {
    let Some((_folder, view, mut browser)) = finished(DESKTOP, false) else { return };
    let [from, at] = camera(&mut browser);
    let drag = |browser: &mut Browser, shift: bool| {
        let [start, middle, end] = [(120, 80), (140, 84), (170, 88)].map(|pixel| position(browser, pixel));
        browser.mouse("mousePressed", start, shift);
        browser.mouse("mouseMoved", middle, shift);
        browser.mouse("mouseMoved", end, shift);
        browser.mouse("mouseReleased", end, shift);
    };
    browser.run("$('orbit').click()");
    drag(&mut browser, false);
    let [orbited, same] = camera(&mut browser);
    assert!(distance(&orbited, &from) > 0.2 && distance(&same, &at) < 1e-9, "{orbited:?}");
    assert!((distance(&orbited, &at) - distance(&from, &at)).abs() < 1e-4, "an orbit keeps the distance");
    drag(&mut browser, true);
    let [panned, target] = camera(&mut browser);
    assert!(distance(&target, &at) > 0.1, "{target:?}");
    assert!((distance(&panned, &target) - distance(&from, &at)).abs() < 1e-4);
    let middle = position(&mut browser, (120, 80));
    browser.wheel(middle, -200.0);
    let [near, _] = camera(&mut browser);
    assert!(distance(&near, &target) < 0.9 * distance(&panned, &target), "{near:?}");
    // The render has this camera, and so has the copied text.
    settle(&mut browser, &view);
    let known: Vec<f64> = serde_json::from_value(view.get("scene").json()["scene"]["camera"]["from"].clone()).unwrap();
    assert!(distance(&known, &near) < 1e-5, "{known:?} {near:?}");
    browser.run("window.copied = ''; navigator.clipboard.writeText = async text => { window.copied = text; }; $('copy').click()");
    browser.wait("window.copied");
    let copied: Value = serde_json::from_str(browser.run("window.copied").as_str().unwrap()).unwrap();
    assert_eq!(copied["lens"]["pinhole"]["fov"], 40);
    assert_eq!(serde_json::from_value::<Vec<f64>>(copied["from"].clone()).unwrap(), near);
    is_clean(&browser);
}

#[test]
fn touch_pins_pans_zooms_and_orbits() {
    let Some((_folder, view, mut browser)) = finished((390, 844), false) else { return };
    let [a, b, c, d] = [(60, 80), (100, 90), (150, 80), (210, 80)].map(|pixel| position(&mut browser, pixel));
    // A tap pins the pixel.
    browser.touch("touchStart", &[b]);
    browser.touch("touchEnd", &[]);
    browser.wait("pins.length === 1 && pins[0].area.x0 === 100 && pins[0].area.y0 === 90");
    // A drag pans.
    browser.touch("touchStart", &[a]);
    browser.touch("touchMove", &[b]);
    browser.touch("touchMove", &[c]);
    browser.touch("touchEnd", &[]);
    browser.wait("zoom > 0 && offset[0] > 20");
    // Two fingers zoom.
    let before = browser.run("zoom").as_f64().unwrap();
    browser.touch("touchStart", &[b, c]);
    browser.touch("touchMove", &[a, c]);
    browser.touch("touchMove", &[a, d]);
    browser.touch("touchEnd", &[]);
    let after = browser.run("zoom").as_f64().unwrap();
    assert!(after > 1.5 * before, "{after} {before}");
    // One finger orbits, and two fingers move the camera nearer.
    browser.run("fit(); $('orbit').click()");
    let [from, at] = camera(&mut browser);
    browser.touch("touchStart", &[b]);
    browser.touch("touchMove", &[c]);
    browser.touch("touchEnd", &[]);
    let [orbited, _] = camera(&mut browser);
    assert!(distance(&orbited, &from) > 0.2, "{orbited:?}");
    browser.touch("touchStart", &[b, c]);
    browser.touch("touchMove", &[a, c]);
    browser.touch("touchMove", &[a, d]);
    browser.touch("touchEnd", &[]);
    let [near, target] = camera(&mut browser);
    assert!(distance(&near, &target) < 0.8 * distance(&from, &at), "{near:?}");
    settle(&mut browser, &view);
    is_clean(&browser);
}

/// Both buttons save the files of the server.
#[test]
fn the_save_buttons_save_files() {
    let Some((folder, view, mut browser)) = finished(DESKTOP, false) else { return };
    browser.download_to(folder.path());
    for name in ["save.exr", "save.png"] {
        browser.run(&format!("$('{}').click()", name.replace('.', "-")));
        let path = folder.path().join(format!("ball.{}", &name[5..]));
        let known = view.get(name).body;
        let start = Instant::now();
        while !std::fs::read(&path).is_ok_and(|saved| saved == known) {
            assert!(start.elapsed() < Duration::from_secs(20), "{} is not saved", path.display());
            std::thread::sleep(Duration::from_millis(50));
        }
    }
    is_clean(&browser);
}

/// A paused render adds no passes, and continues where it stopped.
#[test]
fn a_pause_stops_the_passes() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let folder = crate::abbe_command::folder::with_ball(crate::client::SCENE);
    let view = View::start(folder.path(), &["ball.json", "--passes", "1000000"]);
    browser.open(&view.url);
    browser.wait("state.passes > 3");
    browser.run("$('pause').click()");
    browser.wait("state.paused && $('pause').textContent === 'Continue' && $('session').textContent === 'paused'");
    // The pass that was running may end.
    std::thread::sleep(Duration::from_millis(500));
    let passes = view.get("state").json()["passes"].as_u64().unwrap();
    std::thread::sleep(Duration::from_secs(1));
    assert_eq!(view.get("state").json()["passes"].as_u64(), Some(passes));
    browser.run("$('pause').click()");
    browser.wait(&format!("!state.paused && state.passes > {passes} + 3"));
    is_clean(&browser);
}

/// While a slider of the prism moves, coarse pictures follow. The figures depend on the machine.
#[test]
#[ignore = "nightly: measures pictures per second, 40 seconds of CPU time"]
fn sliders_update_the_picture() {
    let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let view = View::start(std::path::Path::new(scenes), &["prism.json", "--threads", "2"]);
    browser.open(&view.url);
    browser.wait("picture?.passes > 0");
    browser.run("showTab('scene')");
    for path in ["objects[3].shape.prism.apex", "objects[3].shape.prism.side"] {
        // The slider moves at each frame of the screen, as under a mouse: for 5 s, or until four
        // pictures have followed. The first second does not count.
        let seen = browser.run(&format!(
            "(async () => {{ const slider = document.querySelector('input[type=range][aria-label=\"{path}\"]');
              const middle = Number(slider.value), begin = performance.now(), seen = new Set();
              for (;;) {{
                const t = (performance.now() - begin) / 1000;
                if (t > 5 || seen.size >= 4) return [seen.size, t - 1];
                slider.value = middle * (1 - 0.1 * Math.abs(Math.sin(t)));
                slider.dispatchEvent(new Event('input'));
                if (t > 1 && image.width === picture.width && picture.passes === 0) seen.add(picture.number);
                await new Promise(done => setTimeout(done, 16));
              }} }})()"
        ));
        let [count, seconds] = [0, 1].map(|i| seen[i].as_f64().unwrap());
        println!("{path}: {:.1} pictures per second", count / seconds);
        assert!(count >= 4.0, "{path}: {count} pictures");
        browser.wait("!state.draft && picture.passes > 0");
    }
    browser.screenshot("slider.png");
    is_clean(&browser);
}
