//! The functions of the page in a real browser.
//!
//! `ABBE_SCREENSHOTS=FOLDER` saves screenshots.

use crate::abbe_command::folder::with_ball;
use crate::browser::Browser;
use crate::client::{SCENE, View};
use std::time::Instant;

pub(crate) const DESKTOP: (u32, u32) = (1280, 800);

/// Opens the page of a finished view, whose picture is larger than the coarse picture.
pub(crate) fn finished(size: (u32, u32), is_dark: bool) -> Option<(tempfile::TempDir, View, Browser)> {
    finished_scene(SCENE, size, is_dark)
}

/// Does what [`finished`] does for another scene, which is saved as `ball.json`.
pub(crate) fn finished_scene(
    scene: &str,
    size: (u32, u32),
    is_dark: bool,
) -> Option<(tempfile::TempDir, View, Browser)> {
    let mut browser = Browser::start(size, is_dark)?;
    let folder = with_ball(scene);
    let view = View::start(folder.path(), &["ball.json", "--size", "240x160"]);
    view.finished();
    browser.open(&view.url);
    browser.wait("state.session === 'finished' && picture?.passes === 12 && image.width === picture.width");
    Some((folder, view, browser))
}

/// Returns the position of a pixel of the picture in the window.
pub(crate) fn position(browser: &mut Browser, pixel: (u32, u32)) -> (f64, f64) {
    let (x, y) = pixel;
    let place = browser.run(&format!(
        "(() => {{ const p = placement(), b = stage.getBoundingClientRect();
          return [b.left + p.left + ({x} + 0.5) * p.scale, b.top + p.top + ({y} + 0.5) * p.scale]; }})()"
    ));
    (place[0].as_f64().unwrap(), place[1].as_f64().unwrap())
}

pub(crate) fn is_clean(browser: &Browser) {
    assert!(browser.complaints().is_empty(), "{:?}", browser.complaints());
}

/// The canvas has the codes of the PNG file for each tone curve, gamut mapping and colour space.
#[test]
fn the_page_develops_like_the_png_file() {
    // A green line on the floor is far outside sRGB.
    let green = SCENE.replace(
        r#""lights": ["#,
        r#""lights": [{"point": {"at": [-2, 1, 0], "spectrum": {"lines": [{"nm": 520, "power": 1}]}, "power": 2}}, "#,
    );
    let Some((folder, view, mut browser)) = finished_scene(&green, DESKTOP, false) else { return };
    std::fs::write(folder.path().join("a.exr"), view.get("save.exr").body).unwrap();
    assert!(browser.run("picture.reaches.srgb").as_f64().unwrap() > 0.0, "some colours are outside sRGB");
    for (tone, gamut) in [
        ("roll_off", "desaturate"),
        ("clip", "clip"),
        ("pbr_neutral", "desaturate"),
        ("agx", "desaturate"),
        ("clip", "oklab"),
        ("roll_off", "compress"),
        ("clip", "compress"),
    ] {
        let arguments = ["develop", "a.exr", "-o", "a.png", "--tone", tone, "--gamut", gamut];
        let said = crate::abbe_command::abbe(folder.path(), &arguments);
        assert_eq!(said.status, 0, "{}", said.err);
        let known = image::open(folder.path().join("a.png")).unwrap().into_rgb8();
        let found = browser.run(&format!(
            "(async () => {{ const codes = new Uint8ClampedArray(picture.width * picture.height * 4);
              develop(await shownXyz(picture), codes, {{ space: spaces[0], tone: '{tone}', gamut: '{gamut}', factor: picture.exposure,
                reaches: picture.reaches }});
              return Array.from(codes.filter((_, i) => i % 4 < 3)); }})()"
        ));
        let found: Vec<i64> = found.as_array().unwrap().iter().map(|code| code.as_i64().unwrap()).collect();
        let worst = known.as_raw().iter().zip(&found).map(|(a, b)| (i64::from(*a) - b).abs()).max().unwrap();
        assert!(worst <= 1 && found.len() == known.as_raw().len(), "{tone}, {gamut}: {worst} codes");
    }
    is_clean(&browser);
}

#[test]
fn hovering_shows_a_spectrum_and_a_click_pins_it() {
    let Some((_folder, view, mut browser)) = finished(DESKTOP, false) else { return };
    let first = position(&mut browser, (120, 110));
    browser.hover(first);
    browser.wait("hovered && hovered.area[0] === 120 && hovered.area[1] === 110");
    assert!(browser.run("$('values').textContent").as_str().unwrap().contains("120, 110"));
    assert_eq!(browser.run("hovered.values.length"), 47);
    let delays: Vec<f64> = (0..10)
        .map(|i| {
            let next = position(&mut browser, (60 + 10 * i, 80));
            browser.hover(next);
            browser.wait(&format!("hovered?.area[0] === {} && hovered.delay_ms", 60 + 10 * i));
            browser.run("hovered.delay_ms").as_f64().unwrap()
        })
        .collect();
    println!("hover delays in ms: {delays:?}");
    browser.mouse("mousePressed", first, false);
    browser.mouse("mouseReleased", first, false);
    browser.wait("pins.length === 1");
    // A rectangle.
    let second = position(&mut browser, (140, 120));
    browser.mouse("mousePressed", first, true);
    browser.mouse("mouseMoved", second, true);
    browser.mouse("mouseReleased", second, true);
    browser.wait("hovered?.area.join() === '120,110,140,120'");
    // Pins survive a new render.
    let before = browser.run("pins[0].report.xyz[1]").as_f64().unwrap();
    view.post(&serde_json::json!({"changes": ["lights[0].point.power=40"]}));
    browser.wait(
        "state.session === 'finished' && picture.passes === 12 && pins[0].report.passes === 12 && scene.number === 2",
    );
    browser.wait(&format!("pins[0].report.xyz[1] > {}", 1.5 * before));
    browser.screenshot("hover.png");
    is_clean(&browser);
}

/// A pin has a row and a number, and its line has the colour of its light with enough contrast to
/// the paper.
#[test]
fn pins_have_rows_numbers_and_the_colours_of_their_light() {
    let Some((_folder, _view, mut browser)) = finished(DESKTOP, false) else { return };
    for pixel in ["[60, 120]", "[180, 120]"] {
        browser.run(&format!("select(areaOf({pixel}))"));
        browser.wait(&format!("hovered?.area.slice(0, 2).join() === {pixel}.join()"));
        browser.run("pinArea()");
    }
    browser.wait("$('pins').querySelectorAll('tbody tr').length === 2");
    let rows = browser.run("$('pins').textContent").as_str().unwrap().to_string();
    assert!(rows.contains("160, 120") && rows.contains("2180, 120"), "{rows}");
    assert_eq!(browser.run("$('spectrum').querySelectorAll('text[fill]').length"), 2);
    browser.screenshot("pins.png");
    // Red, green, blue and white light, and the green of 520 nm, which is outside sRGB.
    for (xyz, strongest) in [
        ("[41, 21, 2]", Some(0)),
        ("[36, 72, 12]", Some(1)),
        ("[18, 7, 95]", Some(2)),
        ("[95, 100, 109]", None),
        ("[63, 710, 78]", Some(1)),
    ] {
        for (is_dark, paper) in [(false, 1.0_f64), (true, 0.009)] {
            let found = browser.run(&format!(
                "lineColour({xyz}, spaces[0], {is_dark}).match(/\\d+/g).map(code => {{ const v = code / 255;
                  return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }})"
            ));
            let rgb: Vec<f64> = serde_json::from_value(found).unwrap();
            let light = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
            let contrast = (paper.max(light) + 0.05) / (paper.min(light) + 0.05);
            assert!(contrast > 3.0, "{xyz} {is_dark}: {contrast}");
            let most = (0..3).max_by(|&a, &b| rgb[a].total_cmp(&rgb[b])).unwrap();
            assert!(strongest.is_none_or(|strongest| most == strongest), "{xyz} {is_dark}: {rgb:?}");
        }
    }
    is_clean(&browser);
}

#[test]
fn exposure_zoom_and_modes_change_the_canvas() {
    let Some((_folder, _view, mut browser)) = finished(DESKTOP, true) else { return };
    let sum = "(() => { const d = context.getImageData(0, 0, canvas.width, canvas.height).data; let s = 0; for (const v of d) s += v; return s; })()";
    let mut before = browser.run(sum).as_f64().unwrap();
    let mut changed = |browser: &mut Browser, script: &str| {
        browser.run(&format!(
            "(async () => {{ {script}; await draw(); await new Promise(done => setTimeout(done, 50)); }})()"
        ));
        let now = browser.run(sum).as_f64().unwrap();
        assert!(now != before, "{script}");
        before = now;
    };
    changed(&mut browser, "nudge('ev', 10)");
    changed(&mut browser, "setZoom(6)");
    changed(&mut browser, "fit()");
    changed(&mut browser, "nudge('band', 3)");
    browser.screenshot("band.png");
    for mode in ["luminance", "noise", "bias", "error"] {
        changed(&mut browser, &format!("$('mode').value = '{mode}'"));
        assert!(!browser.run("$('legend').textContent").as_str().unwrap().contains("not known"), "{mode}");
    }
    browser.screenshot("error.png");
    browser.run("play()");
    let band = browser.run("Number($('band').value)").as_f64().unwrap();
    browser.wait(&format!("Number($('band').value) !== {band}"));
    browser.run("play()");
    is_clean(&browser);
}

#[test]
fn the_page_works_with_the_keyboard() {
    let Some((_folder, _view, mut browser)) = finished(DESKTOP, false) else { return };
    browser.run("stage.focus()");
    for key in ["ArrowRight", "ArrowDown"] {
        browser.key(key, "");
    }
    browser.wait("hovered?.area.join() === '121,81,121,81'");
    browser.key("Enter", "\r");
    browser.wait("pins.length === 1");
    browser.key("+", "+");
    assert!(browser.run("zoom").as_f64().unwrap() > 1.0);
    browser.key("0", "0");
    assert_eq!(browser.run("zoom"), 0);
    browser.key(" ", " ");
    browser.wait("state.paused");
    browser.key(" ", " ");
    browser.wait("!state.paused");
    browser.key("c", "c");
    browser.key("ArrowLeft", "");
    browser.wait("state.changes.length === 2 && state.session === 'finished' && scene.number >= 2");
    assert!(browser.run("$('camera').value").as_str().unwrap().contains("\"from\""));
    // Every control can be reached.
    let unreachable = "[...document.querySelectorAll('button, select, input')].filter(e => e.tabIndex < 0).length";
    assert_eq!(browser.run(unreachable), 0);
    is_clean(&browser);
}

/// The page shows all functions on wide and narrow screens, in both colour schemes.
#[test]
fn the_page_fits_its_screen() {
    let Some((_folder, view, mut browser)) = finished(DESKTOP, false) else { return };
    for (size, is_dark, name) in [
        (DESKTOP, false, "desktop-light"),
        (DESKTOP, true, "desktop-dark"),
        ((390, 844), true, "phone-dark"),
        ((390, 844), false, "phone-light"),
    ] {
        browser.emulate(size, is_dark);
        browser.open("about:blank");
        browser.open(&view.url);
        browser.wait("state.session === 'finished' && picture?.passes === 12");
        browser.run("select(areaOf([120, 110]))");
        browser.wait("hovered");
        browser.run("pinArea()");
        assert!(browser.run("document.documentElement.scrollWidth <= innerWidth").as_bool().unwrap(), "{name}");
        browser.screenshot(&format!("{name}.png"));
        for tab in ["plan", "scene"] {
            browser.run(&format!("showTab('{tab}')"));
            browser.screenshot(&format!("{name}-{tab}.png"));
        }
        is_clean(&browser);
    }
}

/// While the page shows a fault, the last picture stays, and nothing moves.
#[test]
fn a_fault_does_not_move_the_page() {
    let Some((folder, view, mut browser)) = finished(DESKTOP, false) else { return };
    let layout =
        "JSON.stringify([...document.querySelectorAll('#stage, #status, aside')].map(e => e.getBoundingClientRect()))";
    let before = browser.run(layout);
    std::fs::write(folder.path().join("ball.json"), SCENE.replace("SF10", "SF01")).unwrap();
    view.wait("a fault", |state| state["session"] == "failed");
    browser.wait("!$('fault').hidden && $('fault').textContent.includes('^')");
    assert_eq!(browser.run(layout), before);
    browser.screenshot("fault.png");
    is_clean(&browser);
}

/// Measures the time from the command to the first picture on the page. The figures depend on the
/// machine.
#[test]
#[ignore = "nightly: measures times, 35 seconds of CPU time"]
fn the_first_picture_comes_soon() {
    for scene in ["prism", "cornell", "glass_ball"] {
        let Some(mut browser) = Browser::start(DESKTOP, false) else { return };
        let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
        let view = View::start(std::path::Path::new(scenes), &[&format!("{scene}.json"), "--threads", "2"]);
        browser.open(&view.url);
        browser.wait("picture && image.width === picture.width");
        println!("{scene}: first picture after {:.2} s", view.start.elapsed().as_secs_f64());
        let start = Instant::now();
        browser.wait("picture.passes > 0");
        println!("{scene}: first pass {:.2} s later", start.elapsed().as_secs_f64());
        browser.screenshot(&format!("{scene}.png"));
    }
}
