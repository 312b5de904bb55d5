//! Ribbons against single photons and against paths: a photon that paints its whole spectrum gives
//! the light of photons that paint one point each, with less noise.

use crate::common::compare::{Measured, assert_same};
use crate::common::{block_means, colour_blocks, diffuse, glass, render};
use abbe_session::render::{Integrator, Rendered};
use glam::DVec2;
use serde_json::{Value, json};

/// Pixels per side of the film, and per side of the compared blocks.
const FILM: usize = 24;
const BLOCK: usize = 4;

/// A point on the way of the beam, on the first face of the prism, and the direction of the beam
/// there, at which its middle wavelength has the least deviation.
const ENTRY: DVec2 = DVec2::new(-0.075, 0.043);
const INTO: DVec2 = DVec2::new(0.839, 0.545);

/// A beam of white or other light throws a spectrum on a white screen, at the distance 0.8 m from
/// the dispersive object in the direction `towards`.
fn spectrum_on_a_screen(mut object: Value, material: Value, [entry, into]: [DVec2; 2], towards: DVec2) -> Value {
    object["material"] = json!("dispersive");
    let at = |v: DVec2, z: f64| json!([v.x, v.y, z]);
    let middle = 0.8 * towards;
    // The screen's +y faces the object.
    let turn = (-towards).to_angle().to_degrees() - 90.0;
    json!({
        "camera": { "from": at(middle - 0.4 * towards, 0.35), "at": at(middle, 0.0), "up": [0, 0, 1],
                    "lens": { "pinhole": { "fov": 24 } } },
        "film": { "width": FILM, "height": FILM },
        "materials": { "dispersive": material, "white": diffuse(0.8), "black": "absorber" },
        "objects": [
            object,
            { "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": "white",
              "transform": [ { "rotate": { "axis": [0, 0, 1], "degrees": turn } }, { "translate": at(middle, 0.0) } ] }
        ],
        "lights": [ { "beam": { "from": at(entry - 0.9 * into, 0.0), "to": at(entry, 0.0), "radius": 0.03, "power": 1,
                                "spectrum": "D65" } } ],
        "render": { "photons": 3000, "forbid": ["aim"] }
    })
}

/// The spectrum of a prism of flint.
fn prism_scene(spectrum: Value) -> Value {
    let towards = DVec2::new(0.83, -0.46).normalize();
    let mut scene = spectrum_on_a_screen(prism(), glass("N-SF11"), [ENTRY, INTO], towards);
    scene["lights"][0]["beam"]["spectrum"] = spectrum;
    scene
}

fn prism() -> Value {
    json!({ "shape": { "prism": { "side": 0.3, "length": 0.3, "apex": 60 } } })
}

/// Returns the mean of X, Y and Z in blocks of pixels.
fn blocks(rendered: &Rendered) -> Vec<f64> {
    colour_blocks(BLOCK)(rendered)
}

fn without_ribbons(scene: &Value) -> Value {
    let mut points = scene.clone();
    points["render"]["forbid"] = json!(["aim", "ribbons"]);
    points
}

/// Checks that ribbons give the light of single photons, block by block.
fn agree(name: &str, scene: &Value) {
    let points = Measured::new(&without_ribbons(scene), (Integrator::Photon, 8), 0..8, blocks);
    let ribbons = Measured::new(scene, (Integrator::Photon, 2), 0..8, blocks);
    assert_same(name, &ribbons, &points, 0.05);
}

#[test]
fn a_prism_paints_what_single_photons_give() {
    agree("prism", &prism_scene(json!("D65")));
}

/// A lamp of lines throws its images apart. Their places and powers are those of single photons.
#[test]
fn lines_have_their_power_and_their_place() {
    let lines =
        json!({ "lines": [{ "nm": 435.8, "power": 1 }, { "nm": 546.1, "power": 2 }, { "nm": 578, "power": 0.5 }] });
    agree("lines", &prism_scene(lines));
}

/// The first dispersive surface may follow a mirror, and absorbing glass and fog lie on the way.
#[test]
fn ribbons_pass_mirrors_filters_and_fog() {
    let mut scene = prism_scene(json!("E"));
    scene["materials"]["gold"] = json!({ "conductor": { "metal": "gold" } });
    // The mirror turns the beam from downwards to the direction of the prism.
    let mirror = ENTRY - 0.6 * INTO;
    let turn = (INTO + DVec2::Y).to_angle().to_degrees() - 90.0;
    scene["lights"][0]["beam"]["from"] = json!([mirror.x, 0.6, 0]);
    scene["lights"][0]["beam"]["to"] = json!([mirror.x, mirror.y, 0]);
    let object = json!({ "shape": { "rectangle": { "width": 0.3, "height": 0.3 } }, "material": "gold",
        "transform": [ { "rotate": { "axis": [0, 0, 1], "degrees": turn } }, { "translate": [mirror.x, mirror.y, 0] } ] });
    scene["objects"].as_array_mut().expect("objects").push(object);
    agree("after a mirror", &scene);

    let mut scene = prism_scene(json!("E"));
    scene["materials"]["dispersive"] = json!({ "dielectric": { "ior": "N-SF11",
        "absorption": { "table": { "nm": [360, 480, 560, 640, 830], "values": [0.5, 1, 9, 2, 0.5] } } } });
    agree("in coloured glass", &scene);
}

#[test]
fn gratings_paint_their_orders() {
    let grating = json!({ "shape": { "rectangle": { "width": 0.3, "height": 0.3 } },
        "transform": [ { "rotate": { "axis": [0, 0, 1], "degrees": 90 } } ] });
    let material = json!({ "grating": { "lines_per_mm": 300, "profile": { "sinusoidal": { "amplitude": 1.84, "nm": 520 } },
                                        "transmittance": 1 } });
    let towards = DVec2::new(1.0, 0.165).normalize();
    agree("grating", &spectrum_on_a_screen(grating, material, [DVec2::ZERO, DVec2::X], towards));
}

/// The path tracer finds the same light of a lamp with extent.
#[test]
fn ribbons_agree_with_paths() {
    let mut scene = prism_scene(json!("E"));
    scene["lights"] = json!([]);
    let centre = ENTRY - 0.5 * INTO;
    let lamp = json!({ "shape": { "sphere": { "radius": 0.15, "center": [centre.x, centre.y, 0] } }, "material": "black",
                       "emission": { "spectrum": "E", "power": 1 } });
    scene["objects"].as_array_mut().expect("objects").push(lamp);
    scene["render"] = json!({ "photons": 20_000 });
    let paths = Measured::new(&scene, (Integrator::Path, 192), 100..108, blocks);
    let ribbons = Measured::new(&scene, (Integrator::Photon, 3), 0..8, blocks);
    assert_same("ribbons against paths", &ribbons, &paths, 0.05);
}

/// With as many photons, the noise of a pixel in the spectrum is less than a third of that of
/// single photons.
#[test]
fn ribbons_have_less_noise() {
    let scene = prism_scene(json!("D65"));
    let of_pixels = |scene: &Value| {
        let y = |rendered: &Rendered| {
            let y: Vec<f64> = rendered.picture.xyz.iter().map(|xyz| xyz[1]).collect();
            block_means(&y, FILM, 1, &[true; FILM * FILM])
        };
        Measured::new(scene, (Integrator::Photon, 2), 0..8, y)
    };
    let [ribbons, points] = [scene.clone(), without_ribbons(&scene)].map(|scene| of_pixels(&scene).relative_error());
    assert!(ribbons < 0.34 * points, "{ribbons} against {points}");
}

/// Ribbons are reported, and do not exist without dispersion or for meters.
#[test]
fn ribbons_are_planned_for_dispersive_glass_only() {
    let count = |scene: &Value| render(scene, Integrator::Photon, 1).stats.effects["ribbons"].events;
    let scene = prism_scene(json!("D65"));
    assert!(count(&scene) > 0);
    assert_eq!(count(&without_ribbons(&scene)), 0);
    let mut plain = scene.clone();
    plain["materials"]["dispersive"] = glass(1.5);
    assert_eq!(count(&plain), 0);
}
