//! Ultraviolet light that excites fluorophores: the two integrators agree, the energy ledger
//! balances and states the ultraviolet, and powers keep their meaning.

use crate::common::compare::{Measured, assert_same};
use crate::common::near::assert_near;
use crate::common::{colour_blocks, diffuse, glass, job, render};
use crate::fluorescence::{material, sphere, without_ultraviolet};
use crate::textures::assert_integrators_agree;
use abbe_session::render::Integrator;
use abbe_transport::plan::WavelengthPlan;
use serde_json::{Value, json};

const BRIGHTENER: &str = "optical brightener on paper";

/// A lamp with a visible continuum and two strong lines of mercury below 360 nm.
fn ultraviolet_lamp() -> Value {
    json!({ "mix": [
        { "spectrum": "D65", "weight": 1 },
        { "spectrum": { "lines": [{ "nm": 312.6, "power": 1 }, { "nm": 334.1, "power": 1 }] }, "weight": 4000 }
    ] })
}

fn lamp(at: [f64; 3], spectrum: Value) -> Value {
    json!({ "shape": { "disk": { "radius": 1 } }, "material": "black",
            "emission": { "spectrum": spectrum, "luminance": 100 },
            "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": at } ] })
}

/// Paper under the lamp, with a box of paper, a grey wall and a glass ball. The ball and the wall
/// pass ultraviolet on to the paper.
#[test]
#[ignore = "slow: 12 seconds of CPU time"]
fn photons_and_paths_agree_on_brightened_paper() {
    let scene = json!({
        "camera": { "from": [0, 2.2, 5], "at": [0.2, 0.6, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 32, "height": 32 },
        "materials": { "paper": material(BRIGHTENER), "wall": diffuse(0.6), "black": "absorber", "glass": glass(1.5) },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "paper" },
            { "shape": { "rectangle": { "width": 6, "height": 3 } }, "material": "wall",
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1.5, -1.5] } ] },
            { "shape": { "sphere": { "radius": 0.6, "center": [-0.7, 0.61, 0] } }, "material": "glass" },
            { "shape": { "box": { "size": [0.6, 0.8, 0.6] } }, "material": "paper",
              "transform": [ { "translate": [0.9, 0.4, 0] } ] },
            lamp([-0.4, 2.8, 0.0], ultraviolet_lamp())
        ],
        "render": { "photons": 8000 }
    });
    assert!(job(&scene).plan.ultraviolet);
    assert_integrators_agree("brightened paper", &scene);
}

/// Paper seen through a prism of flint glass. Photons of the shared set bring the light of the paper
/// to a grey box, and the ultraviolet excites it.
#[test]
#[ignore = "slow: 9 seconds of CPU time"]
fn brightened_paper_seen_through_a_prism_keeps_its_energy() {
    let scene = json!({
        "camera": { "from": [-3.2, 1.25, 0], "at": [-2.5, 1.5, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 12 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "grey": diffuse(0.5), "black": "absorber", "flint": glass("N-SF11"), "paper": material(BRIGHTENER) },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 6 } }, "material": "paper" },
            { "shape": { "prism": { "side": 1, "length": 1, "apex": 45 } }, "material": "flint",
              "transform": [ { "translate": [-2.5, 1.5, 0] } ] },
            { "shape": { "box": { "size": [0.5, 0.5, 0.5] } }, "material": "grey",
              "transform": [ { "translate": [1.6, 0.25, 0] } ] },
            lamp([1.6, 1.8, 0.0], json!({ "lines": [{ "nm": 450, "power": 1 }, { "nm": 340, "power": 20 }] }))
        ],
        "render": { "photons": 10000 }
    });
    let plan = job(&scene).plan;
    assert!(plan.ultraviolet && plan.wavelengths == WavelengthPlan::Both);
    let take = colour_blocks(8);
    let path = Measured::new(&scene, (Integrator::Path, 256), 100..108, &take);
    let photon = Measured::extrapolated_photons(&scene, 0.06, 32, &take);
    assert_same("paper through a prism, photon against path", &photon, &path, 1.4e-2);
}

/// A closed sphere of paper around a lamp of 1 W. The emitted power of the ledger exceeds 1 W by the
/// ultraviolet of D65, which the table of the illuminant states. Without ultraviolet it is 1 W.
#[test]
fn the_ledger_balances_and_states_the_ultraviolet() {
    let case = json!({ "walls": [{ "material": BRIGHTENER, "area_fraction": 1 }], "light": "D65" });
    let scene = sphere(&case, material);
    let d65 = abbe::spectrum_by_name("D65").expect("a lamp of the library");
    let integral = |from: u32, to: u32| {
        let ends = 0.5 * (d65.at(f64::from(from)) + d65.at(f64::from(to)));
        (from..=to).map(|nm| d65.at(f64::from(nm))).sum::<f64>() - ends
    };
    let known = integral(300, 360) / integral(360, 830);
    let ledger = render(&scene, Integrator::Photon, 8).ledger;
    assert!(ledger.balance().abs() < 1e-9 && ledger.sampling.abs() < 0.02, "{ledger:?}");
    assert_near("ultraviolet", ledger.ultraviolet, known, 0.01 * known);
    assert_near("emitted", ledger.emitted, 1.0 + known, 2e-3);
    let forbidden = render(&without_ultraviolet(&scene), Integrator::Photon, 8).ledger;
    assert!(forbidden.ultraviolet == 0.0 && forbidden.balance().abs() < 1e-9, "{forbidden:?}");
    assert_near("emitted without ultraviolet", forbidden.emitted, 1.0, 2e-3);
}
