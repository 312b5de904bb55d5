//! Light between two large parallel plates, one of them fluorescent: golden colours.

use crate::common::near::{assert_near, number};
use crate::common::{diffuse, render};
use crate::fluorescence::{cases, light, material, text, without_ultraviolet};
use abbe_session::render::Integrator;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// The luminous efficacy of 1 W of Y.
const LUMENS_PER_WATT: f64 = 683.0;

/// Two large parallel plates at a distance of 1 m. The upper plate is grey and emits 1 W/m². The
/// camera between the plates sees the middle of the upper plate if `upwards` is true, and of the
/// lower plate otherwise.
fn plates(case: &Value, upwards: bool) -> Value {
    const RADIUS: f64 = 200.0;
    let y0 = number(&case["grey_plate_Y_by_round_trips"]["0"]);
    let towards = if upwards { 1.0 } else { 0.0 };
    json!({
        "camera": { "from": [0, 0.5, 0], "at": [0, towards, 0], "up": [0, 0, -1], "lens": { "pinhole": { "fov": 60 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "sample": material(text(&case["material"])), "grey": diffuse(number(&case["grey_reflectance"])) },
        "objects": [
            { "shape": { "disk": { "radius": RADIUS } }, "material": "sample" },
            { "shape": { "disk": { "radius": RADIUS } }, "material": "grey",
              "emission": { "spectrum": light(text(&case["light"])), "luminance": LUMENS_PER_WATT * y0 / PI },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 1, 0] } ] }
        ],
        "render": { "photons": 100_000, "radius": 100 }
    })
}

/// Renders golden plates. The tolerance is 0.5 % of the largest component.
fn check_plates(chosen: impl Fn(usize) -> bool, passes: u64) {
    for (i, case) in cases("parallel_plates").iter().enumerate().filter(|(i, _)| chosen(*i)) {
        for (plate, upwards) in [("grey", true), ("fluorescent", false)] {
            for integrator in [Integrator::Photon, Integrator::Path] {
                let scale = if integrator == Integrator::Path { 256 } else { 1 };
                let xyz = render(&without_ultraviolet(&plates(case, upwards)), integrator, scale * passes).picture.xyz;
                let found: [f64; 3] = std::array::from_fn(|c| {
                    xyz.iter().map(|pixel| pixel[c]).sum::<f64>() / xyz.len() as f64 * PI / LUMENS_PER_WATT
                });
                let known = &case["XYZ"][plate];
                println!("plates {i}, {plate}, {integrator:?}: {found:?} for {known:?}");
                let largest = known.as_array().expect("a colour").iter().map(number).fold(0.0, f64::max);
                assert_near(&format!("plates {i}, {plate}, {integrator:?}"), found, known, 5e-3 * largest);
            }
        }
    }
}

#[test]
#[ignore = "slow: 8 seconds of CPU time; golden spheres are compared by default"]
fn golden_parallel_plates_have_their_colours() {
    check_plates(|i| i == 0, 16);
}

#[test]
#[ignore = "slow: all golden plates, 10 minutes"]
fn all_golden_parallel_plates_have_their_colours() {
    check_plates(|_| true, 128);
}
