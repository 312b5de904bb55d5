//! Diffraction: the first dark ring and the spikes of a point have the right positions, energy is
//! conserved, and the error bars hold.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::compare::Measured;
use crate::common::{diffuse, render, with_setting};
use abbe_session::render::{Integrator, Rendered};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

const FOCUS_M: f64 = 10.0;
const FOCAL_MM: f64 = 50.0;
const F_NUMBER: f64 = 16.0;
/// Odd, so that one pixel lies in the middle.
const FILM: usize = 121;

/// A point light in focus in the middle of the film. For 550 nm, λN covers `spread_px` pixels.
fn point(spectrum: &Value, spread_px: f64, lens: &Value) -> Value {
    let image_mm = FOCAL_MM * 1e3 * FOCUS_M / (1e3 * FOCUS_M - FOCAL_MM);
    let pixel_mm = 550e-6 * F_NUMBER * image_mm / FOCAL_MM / spread_px;
    let mut thin = json!({ "focal_length_mm": FOCAL_MM, "f_number": F_NUMBER, "focus_distance": FOCUS_M,
                           "sensor_height_mm": FILM as f64 * pixel_mm });
    thin.as_object_mut().unwrap().extend(lens.as_object().unwrap().clone());
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "lens": { "thin": thin } },
        "film": { "width": FILM, "height": FILM },
        "materials": { "black": diffuse(0.0) },
        "objects": [
            { "shape": { "sphere": { "radius": 0.3 * pixel_mm / image_mm * FOCUS_M, "center": [0, 0, -FOCUS_M] } },
              "material": "black", "emission": { "spectrum": spectrum, "luminance": 1000 } } ],
        "render": { "photons": 100 }
    })
}

/// Returns Y of all pixels with their positions relative to the middle, in pixels right and up.
fn places(rendered: &Rendered) -> impl Iterator<Item = ([f64; 2], f64)> {
    let middle = 0.5 * (FILM - 1) as f64;
    let place = move |i: usize| [(i % FILM) as f64 - middle, middle - (i / FILM) as f64];
    rendered.picture.xyz.iter().enumerate().map(move |(i, xyz)| (place(i), xyz[1]))
}

#[test]
fn the_first_dark_ring_has_radius_1_22_lambda_n() {
    const SPREAD_PX: f64 = 18.0;
    /// Bins per pixel.
    const BINS: f64 = 2.0;
    for nm in [450.0, 550.0, 650.0] {
        let line = json!({ "lines": [{ "nm": nm, "power": 1 }] });
        let rendered = render(&point(&line, SPREAD_PX, &json!({ "diffraction": true })), Integrator::Photon, 64);
        let mut bins = vec![(0.0, 0.0); 40 * BINS as usize];
        for ([x, up], y) in places(&rendered) {
            if let Some((sum, count)) = bins.get_mut((x.hypot(up) * BINS) as usize) {
                *sum += y;
                *count += 1.0;
            }
        }
        let profile: Vec<f64> = bins.iter().map(|(sum, count)| sum / f64::max(*count, 1.0)).collect();
        let expected = 1.2197 * SPREAD_PX * nm / 550.0;
        let near = |share: f64| (share * expected * BINS) as usize;
        let darkest = (near(0.7)..near(1.3)).min_by(|&i, &j| profile[i].total_cmp(&profile[j])).unwrap();
        // Takes the minimum of the parabola through this bin and the bins two to either side.
        let [before, here, after] = [darkest - 2, darkest, darkest + 2].map(|bin| profile[bin]);
        let shift = (before - after) / (before - 2.0 * here + after);
        let found = (darkest as f64 + 0.5 + shift) / BINS;
        println!(
            "dark ring of {nm} nm: {found:.3} pixels, {expected:.3} by the formula, {:.2e} of the middle",
            here / profile[0]
        );
        assert!((found / expected - 1.0).abs() < 0.02, "{nm} nm: {found} and {expected}");
        // The next bright ring has 1.7e-2 of the central value; the film's periodic images add
        // about 1e-3.
        assert!(here < 2e-3 * profile[0], "{nm} nm: the ring is not dark");
    }
}

#[test]
#[ignore = "nightly: 6 seconds of CPU time"]
fn blades_make_as_many_spikes_or_twice_as_many_if_they_are_odd() {
    const SPREAD_PX: f64 = 3.0;
    /// Sectors of the circle.
    const SECTORS: usize = 120;
    for (blades, spikes) in [(5, 10), (6, 6)] {
        let lens = json!({ "diffraction": true, "blades": blades });
        let lines = [500, 550, 605].map(|nm| json!({ "nm": nm, "power": 1 }));
        let lines = json!({ "lines": lines });
        let rendered = render(&point(&lines, SPREAD_PX, &lens), Integrator::Photon, 64);
        let mut sectors = vec![0.0; SECTORS];
        for ([x, up], y) in places(&rendered) {
            let radius = x.hypot(up);
            if (5.0 * SPREAD_PX..15.0 * SPREAD_PX).contains(&radius) {
                // The first corner lies to the right, and each edge has a spike at right angles.
                sectors[((up.atan2(x) + TAU) / TAU * SECTORS as f64 + 0.5) as usize % SECTORS] += y * radius;
            }
        }
        let mean = sectors.iter().sum::<f64>() / SECTORS as f64;
        let above = |i: usize| sectors[i % SECTORS] > 1.4 * mean;
        let found = (0..SECTORS).filter(|&i| above(i + 1) && !above(i)).count();
        println!("{blades} blades: {found} spikes");
        assert_eq!(found, spikes, "{blades} blades: {sectors:?}");
        let on_edge = ((0.5 / f64::from(blades)) * SECTORS as f64).round() as usize;
        assert!(above(on_edge), "{blades} blades: no spike across the first edge");
    }
}

#[test]
#[ignore = "nightly: 8 seconds of CPU time"]
fn light_is_spread_and_neither_lost_nor_made() {
    let sum = |rendered: &Rendered| -> [f64; 3] {
        rendered.picture.xyz.iter().fold([0.0; 3], |sum, xyz| std::array::from_fn(|c| sum[c] + xyz[c]))
    };
    let line = json!({ "lines": [{ "nm": 589, "power": 1 }] });
    let openings = [(0.05, &line, json!({})), (2.0, &json!("D65"), json!({ "blades": 6 })), (8.0, &line, json!({}))];
    for (spread, spectrum, lens) in openings {
        let scene = point(spectrum, spread, &lens);
        let mut diffracting = scene.clone();
        diffracting["camera"]["lens"]["thin"]["diffraction"] = true.into();
        let [plain, spread_out] = [&scene, &diffracting].map(|scene| render(scene, Integrator::Photon, 32));
        let [whole, found] = [&plain, &spread_out].map(sum);
        let worst = whole.iter().zip(found).map(|(whole, found)| (found / whole - 1.0).abs()).fold(0.0, f64::max);
        println!("λN of {spread} pixels: energy differs by {worst:.1e}");
        assert!(worst < 1e-6, "{whole:?} {found:?}");
        let peak = |rendered: &Rendered| rendered.picture.xyz.iter().map(|xyz| xyz[1]).fold(0.0, f64::max);
        assert!((peak(&spread_out) / peak(&plain) > 0.9) == (spread < 0.1), "a wide pattern lowers the peak");
        assert!(spread_out.picture.xyz.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
    }
}

/// A uniform bright wall, or a floor with noise.
fn surroundings(diffraction: bool, floor: bool) -> Value {
    // A single wavelength has no colour noise and one diffraction kernel.
    let spectrum = if floor { json!({ "lines": [{ "nm": 550, "power": 1 }] }) } else { json!("E") };
    let mut scene = json!({
        "camera": { "from": [0, 1, 0], "at": [0, 0, -3],
                    "lens": { "thin": { "fov": 0.2, "focus_distance": 3, "defocus_angle": 0.02, "diffraction": diffraction } } },
        "film": { "width": 24, "height": 16, "spectral_bands": 4 },
        "materials": { "grey": diffuse(0.5) },
        "objects": [ { "shape": { "rectangle": { "width": 20, "height": 20 } }, "material": "grey", "transform": [] } ],
        "lights": [ { "environment": { "spectrum": spectrum, "illuminance": 100 } } ],
        "render": { "photons": 2000 }
    });
    if !floor {
        scene["objects"][0]["transform"] = json!([{ "translate": [0, 50, 0] }]);
    }
    scene
}

#[test]
fn an_even_picture_stays_even_to_its_edges() {
    let rendered = render(&surroundings(true, false), Integrator::Photon, 256);
    let wall = 100.0 / PI;
    let bands = rendered.picture.bands.as_ref().unwrap();
    let mean = bands.values.iter().sum::<f32>() / bands.values.len() as f32;
    assert!(rendered.picture.xyz.iter().all(|xyz| (xyz[1] / wall - 1.0).abs() < 0.02));
    assert!((rendered.picture.mean_y() / wall - 1.0).abs() < 1e-3, "{}", rendered.picture.mean_y());
    assert!(bands.values.iter().all(|value| (value / mean - 1.0).abs() < 0.3), "{:?}", bands.values);
}

#[test]
fn the_error_bars_of_a_diffracted_picture_are_its_spread() {
    let scene = surroundings(true, true);
    let runs: Vec<Rendered> =
        (0..10_u64).map(|seed| render(&with_setting(&scene, "seed", seed), Integrator::Path, 32)).collect();
    let pixels = |rendered: &Rendered| rendered.picture.xyz.iter().map(|xyz| xyz[1]).collect::<Vec<f64>>();
    let measured = Measured::from_runs(runs.iter().map(pixels).collect());
    let count = runs[0].picture.xyz.len();
    // The standard error of the mean over the runs, times √runs, is the standard deviation of one
    // run.
    let spread = ((0..count).map(|i| measured.error(i).powi(2)).sum::<f64>() / count as f64 * runs.len() as f64).sqrt();
    let squares =
        |rendered: &Rendered| rendered.picture.noise.iter().flatten().map(|&n| f64::from(n).powi(2)).sum::<f64>();
    let stated = (runs.iter().map(squares).sum::<f64>() / (count * runs.len()) as f64).sqrt();
    let undiffracted = render(&surroundings(false, true), Integrator::Path, 32);
    let before = (squares(&undiffracted) / count as f64).sqrt();
    println!(
        "noise of a diffracted pixel: stated {stated:.4}, found {spread:.4}; without diffraction {before:.4} cd/m²"
    );
    assert!((stated / spread - 1.0).abs() < 0.1, "{stated} {spread}");
    assert!(stated < 0.7 * before, "neighbours share their noise");
}
