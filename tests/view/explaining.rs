//! The panel of the plan in a real browser.

use crate::client::SCENE;
use crate::page::{DESKTOP, finished, finished_scene, is_clean};

/// `Difference` renders without an effect, compares, and measures what the effect contributes.
#[test]
fn the_page_shows_the_difference_of_an_effect() {
    let Some((_folder, view, mut browser)) = finished(DESKTOP, false) else { return };
    browser.run("showTab('plan')");
    let button = |name: &str| format!("document.querySelector('#plan button[aria-label*=\" {name} \"]')");
    browser.run(&format!("{}.click()", button("caustics")));
    view.wait("a render without caustics", |state| {
        state["session"] == "finished"
            && state["picture"]["without"][0] == "caustics"
            && state["picture"]["passes"] == 12
    });
    browser.wait("comparison() === 'difference' && reference && picture.passes === 12 && measured.has('caustics')");
    let light = browser.run("measured.get('caustics').light / measured.get('caustics').y").as_f64().unwrap();
    assert!((0.001..0.5).contains(&light), "the caustic is a part of the light: {light}");
    let cells = browser.run("[...document.querySelectorAll('[data-effect=caustics]')].map(cell => cell.textContent)");
    assert!(cells[1].as_str().unwrap().ends_with(" %") && cells[2].as_str().unwrap().ends_with(" %"), "{cells}");
    assert_eq!(browser.run(&format!("{}.getAttribute('aria-pressed')", button("caustics"))), "true");
    // Where the caustic was, the picture is darker: blue pixels.
    let blue = "(() => { const d = context.getImageData(0, 0, canvas.width, canvas.height).data;
        let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i + 2] > d[i] + 100; return n; })()";
    browser.run("draw()");
    assert!(browser.run(blue).as_i64().unwrap() > 200);
    browser.screenshot("difference-of-caustics.png");
    // The next effect is compared with the same reference.
    browser.run(&format!("{}.click()", button("dispersion")));
    browser.wait("measured.has('dispersion') && picture.passes === 12 && state.picture.without[0] === 'dispersion'");
    assert_eq!(browser.run("state.reference.without.length"), 0);
    browser.run(&format!("{}.click()", button("dispersion")));
    browser.wait("comparison() === 'off' && state.session === 'finished' && !state.picture.without.length");
    is_clean(&browser);
}

/// The layers `paths` and `samples` become false colours and shares of the light.
#[test]
fn the_page_separates_the_light_by_paths() {
    let Some((_folder, _view, mut browser)) = finished(DESKTOP, true) else { return };
    browser.run("showTab('plan')");
    assert_eq!(browser.run("$('class-shares').rows[1].cells[1].textContent"), "–");
    browser.run("$('separate').click()");
    browser.wait("state.picture.samples && picture.passes === 12 && state.session === 'finished'");
    assert!(browser.run("$('class-shares').rows[1].cells[1].textContent").as_str().unwrap().ends_with(" %"));
    let at = |browser: &mut crate::browser::Browser, mode: &str| {
        let script = format!(
            "(async () => {{ $('mode').value = '{mode}'; await draw();
              return Array.from(image.getContext('2d').getImageData(40, 130, 1, 1).data); }})()"
        );
        browser.run(&script)
    };
    // The floor beside the ball is lit straight from the lamp.
    let classes = at(&mut browser, "classes");
    assert!(classes[2].as_i64().unwrap() > classes[0].as_i64().unwrap() + 100, "{classes}");
    browser.screenshot("path-classes.png");
    at(&mut browser, "samples");
    assert!(browser.run("$('legend').textContent").as_str().unwrap().starts_with("camera samples"));
    browser.run("$('separate').click()");
    browser.wait("!state.picture.samples && picture.passes === 12");
    is_clean(&browser);
}

/// Behind a horizontal filter, all light passes the page's polariser at 0°, none at 90°, and half
/// at 45°, without a new render. Away from the middle, rays cross the filter obliquely, which turns
/// their polarisation a little.
#[test]
fn the_page_turns_a_polariser() {
    let filtered = SCENE.replace(r#""lens": {"#, r#""filter": {"polariser": {}}, "lens": {"#);
    let Some((_folder, _view, mut browser)) = finished_scene(&filtered, DESKTOP, true) else { return };
    assert_eq!(browser.run("$('analyser').disabled"), true);
    browser.run("showTab('plan'); $('record').click()");
    browser.wait("state.picture.stokes && picture.passes === 12 && state.session === 'finished' && picture.number === state.picture.number");
    let number = browser.run("picture.number");
    let at = |browser: &mut crate::browser::Browser, degrees: u32| {
        let script = format!(
            "(async () => {{ $('analyser').value = {degrees}; $('analyser').oninput(); const xyz = await analysedXyz(picture);
              await draw(); let sum = 0; for (let i = 1; i < xyz.length; i += 3) sum += xyz[i]; return sum; }})()"
        );
        browser.run(&script).as_f64().unwrap()
    };
    let [along, half, across] = [0, 45, 90].map(|degrees| at(&mut browser, degrees));
    let all = browser.run(
        "(async () => { const xyz = await shownXyz(picture); let sum = 0; for (let i = 1; i < xyz.length; i += 3) sum += xyz[i]; return sum; })()",
    );
    let all = all.as_f64().unwrap();
    assert!(
        (along / all - 1.0).abs() < 0.01 && (half / all - 0.5).abs() < 0.02 && across < 0.01 * all,
        "{along} {half} {across} {all}"
    );
    assert!(browser.run("$('legend').textContent").as_str().unwrap().starts_with("through a polariser at 90°"));
    browser.run("(async () => { $('mode').value = 'degree'; await draw(); })()");
    assert!(browser.run("$('legend').textContent").as_str().unwrap().starts_with("degree of polarisation"));
    browser.screenshot("polarisation.png");
    assert_eq!(browser.run("picture.number"), number, "the polariser renders nothing");
    browser.run("$('record').click()");
    browser.wait("!state.picture.stokes && picture.passes === 12");
    is_clean(&browser);
}
