//! Lights that replay the rays of a file, against the rays counted directly.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{diffuse, mean_y};
use abbe_format::resolve::{resolve, resolve_meters};
use abbe_format::{FileAccess, parse_with_access};
use abbe_session::render::{Integrator, Job, NoMonitor, StopRules, Value};
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use serde_json::{Value as Json, json};
use std::f64::consts::PI;

const RAYS: usize = 20_000;

/// A ray in mm, with its flux in W.
type Ray = [f64; 7];

/// A chip of 2 mm × 2 mm, twice as bright on one half, with a cosine distribution.
fn led() -> Vec<Ray> {
    let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
    let ray = |_| {
        let ([x, y], [u, v]) = (stream.pair(), stream.pair());
        let (radius, angle) = (u.sqrt(), 2.0 * PI * v);
        let direction = [radius * angle.cos(), radius * angle.sin(), (1.0 - u).max(1e-9).sqrt()];
        let flux = if x < 0.5 { 1e-4 } else { 2e-4 };
        [2.0 * x - 1.0, 2.0 * y - 1.0, 0.0, direction[0], direction[1], direction[2], flux]
    };
    (0..RAYS).map(ray).collect()
}

/// The flux that arrives on a square of the side 4 mm around (0.7, 0.3) at this distance in mm.
fn counted(rays: &[Ray], distance: f64) -> f64 {
    let arrives = |ray: &&Ray| {
        let t = distance / ray[5];
        (ray[0] + ray[3] * t - 0.7).abs() < 2.0 && (ray[1] + ray[4] * t - 0.3).abs() < 2.0
    };
    rays.iter().filter(arrives).map(|ray| ray[6]).sum()
}

/// Writes the file into a new folder.
fn folder(rays: &[Ray]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let lines = rays.iter().map(|ray| ray.map(|number| number.to_string()).join(" ") + "\n");
    let text = format!("{} 4\n{}", rays.len(), lines.collect::<String>());
    std::fs::write(folder.path().join("led.dat"), text).unwrap();
    folder
}

fn job(folder: &tempfile::TempDir, scene: &Json) -> Job {
    let (file, source) =
        parse_with_access(scene.to_string(), &folder.path().join("scene.json"), &[], FileAccess::default()).unwrap();
    let resolve = if scene["meters"].is_array() { resolve_meters } else { resolve };
    Job::new(resolve(&file, &source).unwrap()).unwrap()
}

/// The file's x, y and z axes are x, z and −y of this scene.
fn scene(distance: f64, light: &Json) -> Json {
    let mut rays = json!({"at": [0, distance, 0], "toward": [0, -1, 0], "path": "led.dat", "spectrum": "LED-B3"});
    rays.as_object_mut().unwrap().extend(light.as_object().unwrap().clone());
    json!({
        "unit": "mm",
        "materials": {"white": diffuse(0.5)},
        "objects": [{"name": "square", "shape": {"rectangle": {"width": 4, "height": 4}}, "material": "white",
            "transform": [{"translate": [0.7, 0, 0.3]}]}],
        "lights": [{"rays": rays}],
        "render": {"photons": 50_000}
    })
}

/// The value of the only reading, its noise and its bias.
fn reading(job: &Job, passes: u64) -> [f64; 3] {
    let stop = StopRules { passes: Some(passes), ..StopRules::default() };
    let (report, _) = job.measure(None, stop, &mut NoMonitor).unwrap();
    assert_eq!(report.integrator, "photon");
    let point = &report.meters[0].points[0];
    let number = |value: &Option<Value>| match value {
        Some(Value::Number(number)) => *number,
        Some(Value::Spectrum(_)) | None => 0.0,
    };
    [number(&Some(point.value.clone())), number(&point.noise), number(&point.bias)]
}

#[test]
fn flux_near_the_source_is_that_of_the_rays() {
    let rays = led();
    let folder = folder(&rays);
    for distance in [1.0, 5.0, 20.0] {
        let mut scene = scene(distance, &json!({}));
        scene["meters"] = json!([{"name": "square", "quantity": "radiant_flux", "surface": "square", "side": "front"}]);
        let [flux, noise, bias] = reading(&job(&folder, &scene), 8);
        let expected = counted(&rays, distance);
        assert!((flux - expected).abs() <= 4.0 * noise + bias, "{distance} mm: {flux} ± {noise} for {expected}");
        assert!(noise < 0.02 * expected, "{distance} mm: {flux} ± {noise}");
    }
}

/// Replaces the square by a black sphere around the light, with a meter of the flux inside.
fn inside_a_sphere(mut scene: Json) -> Json {
    scene["materials"] = json!({"black": "absorber"});
    scene["objects"] = json!([{"name": "sphere", "shape": {"sphere": {"radius": 50}}, "material": "black"}]);
    scene["meters"] = json!([{"name": "all", "quantity": "radiant_flux", "surface": "sphere", "side": "back"}]);
    scene
}

/// The inside of a sphere receives each photon once.
#[test]
fn all_light_of_the_file_arrives() {
    let rays = led();
    let total: f64 = rays.iter().map(|ray| ray[6]).sum();
    let folder = folder(&rays);
    // The wavelengths of a photon carry the same power only in a line.
    let line = json!({"spectrum": {"lines": [{"nm": 550, "power": 1}]}});
    let [flux, ..] = reading(&job(&folder, &inside_a_sphere(scene(0.0, &line))), 4);
    assert!((flux / total - 1.0).abs() < 1e-6, "{flux} for {total}");
}

/// Of rays with wavelengths from 300 to 900 nm, only those within 360–830 nm count.
#[test]
fn light_outside_of_the_band_is_left_out() {
    let rays = led();
    let total: f64 = rays.iter().map(|ray| ray[6]).sum();
    let folder = tempfile::tempdir().unwrap();
    let line = |(number, ray): (usize, &Ray)| {
        let um = 0.3 + 0.6 * (number as f64 + 0.5) / RAYS as f64;
        ray.map(|number| number.to_string()).join(" ") + &format!(" {um}\n")
    };
    // The two halves of the chip have other fluxes, so the rays are in a random order.
    let text = format!("{RAYS} 4\n{}", rays.iter().enumerate().map(line).collect::<String>());
    std::fs::write(folder.path().join("led.dat"), text).unwrap();
    let mut scene = inside_a_sphere(scene(0.0, &json!({})));
    scene["lights"][0]["rays"].as_object_mut().unwrap().remove("spectrum");
    let [flux, ..] = reading(&job(&folder, &scene), 4);
    let expected = total * 470.0 / 600.0;
    assert!((flux / expected - 1.0).abs() < 0.01, "{flux} for {expected}");
}

/// The camera sees the light of the rays on a diffuse square, and `luminous_flux` sets the scale.
#[test]
fn a_picture_shows_the_light_of_the_rays() {
    let rays = led();
    let folder = folder(&rays);
    let total: f64 = rays.iter().map(|ray| ray[6]).sum();
    let mut scene = scene(5.0, &json!({"luminous_flux": 100}));
    scene["camera"] = json!({"from": [0.7, 10, 0.3], "at": [0.7, 0, 0.3], "up": [0, 0, -1],
        "lens": {"orthographic": {"height": 4}}});
    scene["film"] = json!({"width": 16, "height": 16});
    let job = job(&folder, &scene);
    let rendered = crate::common::render_job(&job, Integrator::Photon, 16);
    let mean = mean_y(&rendered)[0];
    let expected = 100.0 * counted(&rays, 5.0) / total / 16e-6 * 0.5 / PI;
    assert!((mean / expected - 1.0).abs() < 0.01, "{mean} for {expected}");
}
