//! Scale and position: a scene gives the same picture in any unit and at any place.

use serde_json::{Value, json};

use abbe_session::render::Integrator;

use super::common::compare::{Measured, compare};
use super::common::{all_y, block_means, diffuse, glass, render};
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "Scenes scaled by 1e-6, 1e-3, 1e3 and 1e6: shading",
        naive: "an epsilon of 1e-4 m is far too large at one scale and too small at another",
        here: "no fixed lengths: faces have identifiers, and tolerances are relative to rounding",
        measured: "relative difference of any pixel in direct light",
        bound: Bound::AtMost(1e-6),
        pace: Pace::Fast,
        measure: || SCALES.iter().map(|&scale| shading_difference(scale, 0.0)).fold(0.0, f64::max),
    },
    Case {
        name: "Scenes moved by 1e6 of their size: shading",
        naive: "single-precision positions are 0.06 apart",
        here: "positions are relative to the scene's centre, in double precision",
        measured: "relative difference of any pixel in direct light",
        bound: Bound::AtMost(1e-6),
        pace: Pace::Fast,
        measure: || shading_difference(1.0, 1e6),
    },
    Case {
        name: "The same with a glass ball, its caustic and indirect light",
        naive: "kernel radii and offsets fixed in metres",
        here: "radii derive from photon distances and pixel sizes",
        measured: "probability, over all blocks, scales and the move, that the pictures are equal",
        bound: Bound::AtLeast(1e-3),
        pace: Pace::Fast,
        measure: || {
            let here = caustic(1.0, 0.0, 0);
            let places = SCALES.iter().map(|&scale| (scale, 0.0)).chain([(1.0, 1e6)]);
            let least = places.zip(1..).map(|((scale, shift), run)| compare(&caustic(scale, shift, run), &here).p);
            1.0 - (1.0 - least.fold(1.0, f64::min)).powi(5)
        },
    },
    Case {
        name: "Lights of 1e-30, 1e-15, 1e-9, 1e12 and 1e25 W",
        naive: "single-precision sums, thresholds on power",
        here: "exact 128-bit sums with a unit that follows the power of the lights",
        measured: "relative difference of any pixel, scaled back",
        bound: Bound::AtMost(1e-5),
        pace: Pace::Fast,
        measure: || {
            let y = |power: f64| {
                let mut scene = shaded(1.0, 0.0);
                scene["lights"][0]["point"]["power"] = power.into();
                all_y(&render(&scene, Integrator::Photon, 2)).iter().map(|y| y / power).collect::<Vec<_>>()
            };
            let here = y(1.0);
            [1e-30, 1e-15, 1e-9, 1e12, 1e25]
                .iter()
                .map(|&power| largest_difference(&y(power), &here))
                .fold(0.0, f64::max)
        },
    },
];

const SCALES: [f64; 4] = [1e-6, 1e-3, 1e3, 1e6];

/// Scales all lengths of a scene by `scale`, moves its centre along (1, 1, 1) by `shift` times its
/// size, and changes the light's power so that radiance stays equal.
fn placed(mut scene: Value, scale: f64, shift: f64) -> Value {
    let point = |value: &mut Value| {
        let old: Vec<f64> = value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        *value = old.iter().map(|x| (x + shift) * scale).collect::<Vec<_>>().into();
    };
    point(&mut scene["camera"]["from"]);
    point(&mut scene["camera"]["at"]);
    point(&mut scene["lights"][0]["point"]["at"]);
    scene["lights"][0]["point"]["power"] = (50.0 * scale * scale).into();
    for object in scene["objects"].as_array_mut().unwrap() {
        let steps = object["transform"].as_array_mut().unwrap();
        point(&mut steps.last_mut().unwrap()["translate"]);
        steps.insert(0, json!({ "scale": scale }));
    }
    scene
}

/// Diffuse objects under a light; only direct light.
fn shaded(scale: f64, shift: f64) -> Value {
    let scene = json!({
        "camera": { "from": [0, 2, 5], "at": [0, 0.5, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 48, "height": 36 },
        "materials": { "grey": diffuse(0.6) },
        "objects": [
            { "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "grey", "transform": [{ "translate": [0, 0, 0] }] },
            { "shape": { "sphere": { "radius": 0.5 } }, "material": "grey", "transform": [{ "translate": [-0.8, 0.5, 0] }] },
            { "shape": { "cylinder": { "radius": 0.3, "height": 1 } }, "material": "grey", "transform": [{ "translate": [0.9, 0.5, -0.5] }] },
            { "shape": { "box": { "size": [0.6, 0.8, 0.5] } }, "material": "grey",
              "transform": [{ "rotate": { "axis": [0, 1, 0], "degrees": 30 } }, { "translate": [0.3, 0.4, 0.9] }] }
        ],
        "lights": [{ "point": { "at": [1, 4, 2], "spectrum": 1, "power": 50 } }],
        "render": { "photons": 100, "camera_samples": 2, "forbid": ["indirect"] }
    });
    placed(scene, scale, shift)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let mean = b.iter().sum::<f64>() / b.len() as f64;
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.max(0.01 * mean)).fold(0.0, f64::max)
}

fn shading_difference(scale: f64, shift: f64) -> f64 {
    let picture = |scale: f64, shift: f64| all_y(&render(&shaded(scale, shift), Integrator::Photon, 2));
    largest_difference(&picture(scale, shift), &picture(1.0, 0.0))
}

/// Returns block means of a floor with a caustic, with seeds that no other scale or position uses.
fn caustic(scale: f64, shift: f64, run: u64) -> Measured {
    let scene = json!({
        "camera": { "from": [0, 2.5, 3], "at": [0, 0.2, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 24, "height": 16 },
        "materials": { "grey": diffuse(0.6), "glass": glass("N-BK7") },
        "objects": [
            { "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey", "transform": [{ "translate": [0, 0, 0] }] },
            { "shape": { "rectangle": { "width": 4, "height": 2 } }, "material": "grey",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1, -1.2] }] },
            { "shape": { "sphere": { "radius": 0.5 } }, "material": "glass", "transform": [{ "translate": [0, 0.6, 0] }] }
        ],
        "lights": [{ "point": { "at": [1.5, 3, 1], "spectrum": "D65", "power": 50 } }],
        "render": { "photons": 3000 }
    });
    let scene = placed(scene, scale, shift);
    let whole = vec![true; 24 * 16];
    Measured::new(&scene, (Integrator::Photon, 6), 10 * run..10 * run + 5, |rendered| {
        block_means(&all_y(rendered), 24, 8, &whole)
    })
}
