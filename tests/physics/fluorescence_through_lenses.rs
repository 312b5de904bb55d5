//! Fluorescent objects in front of a camera with a lens of real glass.

use crate::common::compare::{Measured, assert_same};
use crate::common::near::{assert_near, number};
use crate::common::{colour_blocks, with_setting};
use crate::fluorescence::{cases, material, still_life, text, under_a_sky, without_ultraviolet};
use crate::textures::assert_integrators_agree_after;
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// A camera lens of real glass. `sensor_mm` is the height of the sensor.
fn double_gauss(focus_distance: f64, sensor_mm: f64) -> Value {
    json!({ "system": { "prescription": "double-gauss", "focus_distance": focus_distance,
                        "f_number": 4, "sensor_height_mm": sensor_mm } })
}

/// All paths of a camera with a lens of real glass carry shared wavelengths. Free photons excite
/// the fluorophore. The golden colour holds without a lens: through this lens, a white surface
/// under D65 has 0.5 % less Y and 1.2 % more Z.
#[test]
#[ignore = "nightly: 13 seconds of CPU time"]
fn a_lens_of_real_glass_sees_golden_colours() {
    let mut cases = cases("single_reflection").into_iter();
    let case = cases.find(|case| (text(&case["material"]), text(&case["light"])) == ("red day-glow", "D65"));
    let case = case.expect("a golden case");
    let mut scene = without_ultraviolet(&under_a_sky(&material("red day-glow"), "D65"));
    scene["camera"]["lens"] = double_gauss(4.0, 1.0);
    // All pixels of a pass have the same wavelengths, so passes count more than pixels.
    scene["film"] = json!({ "width": 4, "height": 4 });
    let measured = |integrator, passes, seeds| Measured::new(&scene, (integrator, passes), seeds, colour_blocks(4));
    let (photon, path) = (measured(Integrator::Photon, 256, 0..6), measured(Integrator::Path, 1024, 10..16));
    assert_same("red day-glow through a lens", &photon, &path, 0.01);
    let found: Vec<f64> = (0..3).map(|c| photon.mean(c)).collect();
    println!("{found:?} for {:?}", case["XYZ"]);
    assert_near("red day-glow through a lens", &found, &case["XYZ"], 0.012 * number(&case["XYZ"][0]));
}

#[test]
#[ignore = "slow: 20 seconds of CPU time"]
fn photons_and_paths_agree_on_fluorescent_surfaces_through_a_lens() {
    let mut scene = still_life("N-SF11", json!("D65"));
    scene["camera"]["lens"] = double_gauss(5.0, 30.0);
    let scene = with_setting(&scene, "photons", 16000);
    assert_integrators_agree_after(16, "fluorescent surfaces through a lens", &scene, 3e-2);
}
