//! A flat spectrum gives equal values in all bands of the spectral film, for any number of bands.

use crate::common::compare::{Measured, compare_with};
use crate::common::{diffuse, glass, render, with_setting};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};

/// The numbers of bands: few, as many as an RGB film has channels, more, and numbers that share no
/// factor with the stratification of wavelengths.
const COUNTS: [usize; 5] = [4, 8, 16, 31, 63];

/// Pixels along each side of the square film.
const SIDE: usize = 12;

/// A light of 1 W/m²/sr/nm in the upper half of the picture, and a floor that it lights directly,
/// by way of a wall, and through a ball of glass without dispersion.
fn lamp_and_floor(bands: usize, force: &[&str]) -> Value {
    json!({
        "camera": { "from": [0, 1, 3], "at": [0, 1, 0], "lens": { "pinhole": { "fov": 50 } } },
        "film": { "width": SIDE, "height": SIDE, "spectral_bands": bands },
        "materials": { "grey": diffuse(0.5), "black": "absorber", "glass": glass(1.5) },
        "objects": [
            { "name": "floor", "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "grey" },
            { "name": "wall", "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "grey",
              "transform": [{ "rotate": { "axis": [0, 0, 1], "degrees": -90 } }, { "translate": [-3, 0, 0] }] },
            { "name": "ball", "shape": { "sphere": { "center": [0.4, 0.4, 0.8], "radius": 0.35 } }, "material": "glass" },
            { "name": "lamp", "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "black",
              "emission": { "spectrum": 1, "radiance": 470 },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 4, -2] }] }],
        "render": { "photons": 4000, "radius": 0.2, "force": force }
    })
}

/// Returns the means of the bands over the light (the two top rows), then over the floor (the four
/// bottom rows) relative to their own mean. Every other band gets `ripple` added. Two more numbers
/// per region follow: 1 + the mean difference between neighbouring bands. All of them should be 1.
fn lamp_and_floor_bands(rendered: &Rendered, ripple: f64) -> Vec<f64> {
    let bands = rendered.picture.bands.as_ref().expect("the film has bands");
    let count = bands.centres_nm.len();
    let mean = |rows: std::ops::Range<usize>| -> Vec<f64> {
        let pixels = rows.start * SIDE..rows.end * SIDE;
        let sum = |band: usize| pixels.clone().map(|pixel| f64::from(bands.values[pixel * count + band])).sum::<f64>();
        (0..count).map(|band| (1.0 + ripple * (band % 2) as f64) * sum(band) / pixels.len() as f64).collect()
    };
    let every_other = |bands: &[f64], from: usize| {
        let chosen: Vec<f64> = bands.iter().skip(from).step_by(2).copied().collect();
        chosen.iter().sum::<f64>() / chosen.len() as f64
    };
    let (lamp, mut floor) = (mean(0..2), mean(SIDE - 4..SIDE));
    let level = floor.iter().sum::<f64>() / count as f64;
    floor.iter_mut().for_each(|value| *value /= level);
    let ripples = [&lamp, &floor].map(|bands| 1.0 + every_other(bands, 0) - every_other(bands, 1));
    lamp.iter().chain(&floor).chain(&ripples).copied().collect()
}

/// Renders 16 seeds for each of these numbers of bands. Checks that all bands are equal, and that a
/// ripple of `mutant` would have been detected.
fn check(name: &str, counts: &[usize], (integrator, passes): (Integrator, u64), force: &[&str], mutant: f64) {
    for &count in counts {
        let known = vec![1.0; 2 * count + 2];
        let runs = |seed: u64| {
            let scene = with_setting(&lamp_and_floor(count, force), "seed", seed);
            let rendered = render(&scene, integrator, passes);
            [0.0, mutant].map(|ripple| lamp_and_floor_bands(&rendered, ripple))
        };
        let [flat, rippled]: [Vec<_>; 2] = {
            let all: Vec<[Vec<f64>; 2]> = (0..16).map(runs).collect();
            [0, 1].map(|which| all.iter().map(|run| run[which].clone()).collect())
        };
        let [flat, rippled] = [flat, rippled].map(Measured::from_runs);
        let found = compare_with(&flat, &known);
        let ripple = [2 * count, 2 * count + 1].map(|i| format!("{:+.4} ± {:.4}", flat.mean(i) - 1.0, flat.error(i)));
        let noise = (0..2 * count).map(|i| flat.error(i)).sum::<f64>() / (2 * count) as f64;
        println!("{name}, {count} bands: σ {noise:.4}, ripple {} and {}; {found}", ripple[0], ripple[1]);
        assert!(found.is_equal(), "{name}, {count} bands: {found}");
        let found = compare_with(&rippled, &known);
        assert!(!found.is_equal(), "{name}, {count} bands: a ripple of {mutant} passes: {found}");
    }
}

#[test]
#[ignore = "slow: a quarter of a minute of CPU time"]
fn photons_of_a_flat_spectrum_are_flat_in_any_number_of_bands() {
    check("photons", &COUNTS, (Integrator::Photon, 192), &[], 0.03);
}

#[test]
#[ignore = "slow: 8 seconds of CPU time"]
fn a_flat_spectrum_on_shared_wavelengths_is_flat_in_16_bands() {
    check("shared wavelengths", &[16], (Integrator::Photon, 128), &["shared"], 0.15);
}

#[test]
#[ignore = "slow: 40 seconds of CPU time; more numbers of bands than the version above"]
fn shared_wavelengths_are_flat_in_any_number_of_bands() {
    check("shared wavelengths", &COUNTS, (Integrator::Photon, 128), &["shared"], 0.15);
}

#[test]
#[ignore = "slow: half a minute of CPU time"]
fn paths_of_a_flat_spectrum_are_flat_in_any_number_of_bands() {
    check("paths", &COUNTS, (Integrator::Path, 768), &[], 0.015);
}
