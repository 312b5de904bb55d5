//! The tabulated responses of the sensor to photons at diffuse surfaces.

use super::common::{job_with, render_job};
use abbe_session::render::{Integrator, Rendered};

/// Coloured walls, a curved surface, and two lights of different spectra. Fog is absent, so the
/// tables apply to all pixels.
const ROOM: &str = r#"{
  "camera": {"from": [0, 1, 3.8], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 24, "height": 20},
  "materials": {
    "white": {"diffuse": {"reflectance": 0.8}},
    "red": {"diffuse": {"reflectance": {"rgb": [0.7, 0.05, 0.1]}}},
    "leaf": {"diffuse": {"reflectance": {"table": {"nm": [400, 520, 545, 580, 830], "values": [0.02, 0.1, 0.6, 0.1, 0.3]}}}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 4, "height": 4}}, "material": "white"},
    {"name": "left", "shape": {"box": {"size": [0.2, 3, 4]}}, "material": "red", "transform": [{"translate": [-1.3, 1.5, 0]}]},
    {"name": "back", "shape": {"box": {"size": [4, 3, 0.2]}}, "material": "leaf", "transform": [{"translate": [0, 1.5, -1.5]}]},
    {"name": "ball", "shape": {"sphere": {"center": [0.4, 0.51, 0], "radius": 0.5}}, "material": "leaf"}],
  "lights": [
    {"point": {"at": [0.8, 2, 1], "spectrum": "FL11", "power": 5}},
    {"point": {"at": [-0.6, 1.5, 0.5], "spectrum": "A", "power": 5}}],
  "render": {"photons": 6000, "camera_samples": 1}}"#;

fn room(sets: &[&str]) -> Rendered {
    render_job(&job_with(ROOM, sets), Integrator::Photon, 2)
}

/// A film with spectral bands evaluates each wavelength of each photon. A film without bands reads
/// the tables. Both use the same random numbers, so their pictures may differ only by the
/// resolution of the tables. The scene states the numbers of photons and of camera samples, because
/// the pilot would choose them by the work that tables save.
#[test]
fn tabulated_responses_agree_with_single_wavelengths() {
    let (tabulated, exact) = (room(&[]).picture, room(&["film.spectral_bands=4"]).picture);
    let (mut largest, mut means) = (0.0_f64, [[0.0; 3]; 2]);
    for (pixel, (a, b)) in tabulated.xyz.iter().zip(&exact.xyz).enumerate() {
        for c in 0..3 {
            largest = largest.max((a[c] - b[c]).abs() / b[1].max(b[c]));
            means[0][c] += a[c];
            means[1][c] += b[c];
        }
        let [bias, other] = [&tabulated, &exact].map(|picture| f64::from(picture.bias[pixel].unwrap_or(0.0)));
        largest = largest.max((bias - other).abs() / b[1]);
    }
    println!("largest difference {largest:.1e}, means {means:?}");
    assert!(largest > 0.0, "the tables are in use");
    assert!(largest < 0.01, "{largest}");
    (0..3).for_each(|c| assert!((means[0][c] / means[1][c] - 1.0).abs() < 5e-4, "{means:?}"));
}

/// Scenes with very many tables would need too much memory. They use no tables.
#[test]
fn very_many_materials_use_no_tables() {
    let materials: Vec<String> =
        (0..300).map(|i| format!("\"grey{i}\": {{\"diffuse\": {{\"reflectance\": 0.{:03}}}}}", i + 1)).collect();
    let objects: Vec<String> = (0..300)
        .map(|i| {
            format!(
                "{{\"shape\": {{\"sphere\": {{\"center\": [9, {i}, 0], \"radius\": 0.1}}}}, \"material\": \"grey{i}\"}}"
            )
        })
        .collect();
    let text = ROOM
        .replace("\"white\":", &format!("{}, \"white\":", materials.join(", ")))
        .replace("{\"name\": \"floor\"", &format!("{}, {{\"name\": \"floor\"", objects.join(", ")));
    let render = |sets: &[&str]| render_job(&job_with(&text, sets), Integrator::Photon, 1).picture;
    assert_eq!(render(&[]).xyz, render(&["film.spectral_bands=4"]).xyz);
}
