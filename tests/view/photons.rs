//! Photon paths over the picture.

use crate::abbe_command::folder::with_ball;
use crate::browser::Browser;
use crate::client::{SCENE, View};
use crate::page::{DESKTOP, finished, is_clean, position};

#[test]
fn the_server_returns_lines() {
    let folder = with_ball(SCENE);
    let view = View::start(folder.path(), &["ball.json"]);
    view.finished();
    let all = view.get("photons?count=200&light=0").json();
    assert_eq!((all["paths"].as_u64(), all["traced"].as_u64()), (Some(200), Some(200)));
    assert_eq!(all, view.get("photons?count=200&light=0").json());
    let lines =
        |answer: &serde_json::Value| -> Vec<Vec<f64>> { serde_json::from_value(answer["lines"].clone()).unwrap() };
    assert!(lines(&all).iter().all(|line| line.len() == 7 && line[4..].iter().fold(0.0, |a, b| b.max(a)) == 1.0));
    // Paths that reach a point of the floor.
    let some = view.get("photons?count=50&x=14&y=26").json();
    assert_eq!(some["paths"], 50);
    let ends = lines(&some).iter().filter(|line| (line[2] - 14.5).hypot(line[3] - 26.5) < 6.0).count();
    assert!(ends >= 50, "{ends}");
    assert!(some["point"][1].as_f64().unwrap().abs() < 1e-6, "{}", some["point"]);
    // The sky.
    let none = view.get("photons?count=50&x=0&y=0").json();
    assert_eq!((&none["paths"], &none["point"]), (&serde_json::json!(0), &serde_json::Value::Null));
    for query in ["", "?count=5000", "?count=10&light=1", "?count=10&x=3", "?count=10&x=48&y=0", "?count=-1"] {
        assert_eq!(view.get(&format!("photons{query}")).status, 400, "{query}");
    }
}

/// Returns the colour of the canvas at a position of the picture.
fn colour_at(browser: &mut Browser, pixel: (f64, f64)) -> [i64; 3] {
    let (x, y) = pixel;
    let found = browser.run(&format!(
        "(() => {{ const p = placement();
          return Array.from(context.getImageData(Math.floor(p.left + {x} * p.scale), Math.floor(p.top + {y} * p.scale), 1, 1).data); }})()"
    ));
    [0, 1, 2].map(|i| found[i].as_i64().unwrap())
}

#[test]
fn the_page_draws_photon_paths() {
    let Some((_folder, _view, mut browser)) = finished(DESKTOP, true) else { return };
    // The sky is black, so all light there belongs to a line.
    let sky = "(() => { const p = placement(), d = context.getImageData(0, Math.ceil(p.top), canvas.width, Math.floor(20 * p.scale)).data;
        let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] + d[i + 1] + d[i + 2] > 60; return n; })()";
    assert_eq!(browser.run(sky), 0);
    let coloured = "(() => { const d = context.getImageData(0, 0, canvas.width, canvas.height).data;
        let n = 0; for (let i = 0; i < d.length; i += 4) n += Math.max(d[i], d[i + 1], d[i + 2]) - Math.min(d[i], d[i + 1], d[i + 2]) > 60; return n; })()";
    let white = browser.run(coloured).as_i64().unwrap();
    let before = colour_at(&mut browser, (40.0, 130.0));
    browser.run("stage.focus()");
    browser.key("p", "p");
    browser.wait("photons?.strokes && photons.scene === scene.number");
    assert!(browser.run(sky).as_i64().unwrap() > 200, "lines in the sky");
    assert!(browser.run(coloured).as_i64().unwrap() > white + 300, "coloured lines");
    browser.run("showTab('photons')");
    browser.screenshot("photons.png");
    // Only the paths to a clicked point.
    browser.run("$('photon-reach').click()");
    let point = position(&mut browser, (70, 130));
    browser.hover(point);
    browser.mouse("mousePressed", point, false);
    browser.mouse("mouseReleased", point, false);
    browser.wait("photons?.pixel?.join() === '70,130' && photons.paths > 30");
    assert!(browser.run("$('photon-text').textContent").as_str().unwrap().contains("paths reach"));
    browser.screenshot("photons-reach.png");
    // Lines lie on top of a zoomed picture, too.
    browser.run("setZoom(8)");
    browser.run("fit()");
    browser.run("$('photon-show').click()");
    browser.wait("photons === null");
    assert_eq!(colour_at(&mut browser, (40.0, 130.0)), before);
    is_clean(&browser);
}

/// The example of a lesson, for the eye.
#[test]
fn the_prism_spreads_its_paths() {
    let Some(mut browser) = Browser::start((390, 844), false) else { return };
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let view = View::start(std::path::Path::new(scenes), &["prism.json", "--size", "480x270"]);
    browser.open(&view.url);
    browser.wait("picture?.passes > 0");
    browser.run("showTab('photons'); togglePhotons()");
    browser.wait("photons?.strokes?.size > 20");
    browser.screenshot("photons-prism.png");
    assert!(browser.run("document.documentElement.scrollWidth <= innerWidth").as_bool().unwrap());
    is_clean(&browser);
}
