//! The halo of the example scene at single wavelengths: its inner edge is at the least deviation of
//! an ice prism of 60°.

use crate::common::{all_y, example, render};
use abbe_optics::glass::RefractiveIndex;
use abbe_session::render::Integrator;
use serde_json::json;

/// The part of the sky above the sun that the strip shows, in degrees from the sun.
const FROM_DEG: f64 = 19.0;
const TO_DEG: f64 = 26.0;
const ROWS: usize = 140;
const COLUMNS: usize = 4;

/// Returns the angle from the sun at the middle of a row.
fn angle_of(row: usize) -> f64 {
    let up = 1.0 - (2 * row + 1) as f64 / ROWS as f64;
    let half = (0.5 * (TO_DEG - FROM_DEG)).to_radians();
    0.5 * (FROM_DEG + TO_DEG) + (up * half.tan()).atan().to_degrees()
}

/// Returns the angle at which the luminance is half of that of the halo, seen from the sun, and the
/// luminance inside as a fraction of that of the halo.
fn inner_edge(nm: f64) -> (f64, f64) {
    let mut scene = example("halo");
    let toward: [f64; 3] =
        serde_json::from_value(scene["lights"][0]["directional"]["toward"].clone()).expect("numbers");
    let (sin, cos) = ((-toward[1]).atan2(toward[2]) + (0.5 * (FROM_DEG + TO_DEG)).to_radians()).sin_cos();
    scene["lights"] = json!([{ "directional": { "toward": toward, "angular_diameter": 0.53, "irradiance": 1,
                                                 "spectrum": { "lines": [{ "nm": nm, "power": 1 }] } } }]);
    scene["camera"] = json!({ "from": [0, 2, 0], "at": [0, 2.0 + sin, -cos],
                              "lens": { "pinhole": { "fov": TO_DEG - FROM_DEG } } });
    scene["film"] = json!({ "width": COLUMNS, "height": ROWS });
    scene["objects"].as_array_mut().expect("objects").retain(|object| object["name"] == "dust");
    scene["render"] = json!({ "photons": 100, "forbid": ["photon-beams", "indirect"] });
    let values = all_y(&render(&scene, Integrator::Photon, 64));
    // From the sun outwards.
    let rows: Vec<(f64, f64)> = (0..ROWS)
        .rev()
        .map(|row| (angle_of(row), values[row * COLUMNS..][..COLUMNS].iter().sum::<f64>() / COLUMNS as f64))
        .collect();
    let mean = |from: f64, to: f64| {
        let inside: Vec<f64> = rows.iter().filter(|row| (from..to).contains(&row.0)).map(|row| row.1).collect();
        inside.iter().sum::<f64>() / inside.len() as f64
    };
    let (dark, bright) = (mean(FROM_DEG, 21.0), mean(22.4, 22.7));
    let half = 0.5 * (dark + bright);
    let after = rows.iter().position(|row| row.1 > half).expect("the halo is in the strip");
    let ((a, low), (b, high)) = (rows[after - 1], rows[after]);
    (a + (b - a) * (half - low) / (high - low), dark / bright)
}

/// The sun is as wide as the sky's, so its blurred edge is at the least deviation.
#[test]
fn the_halo_begins_at_the_least_deviation() {
    let ice = RefractiveIndex::catalogue("ice -7C").expect("ice is in the catalogue");
    let edges = [455.0, 555.0, 655.0].map(|nm| {
        let least = 2.0 * (0.5 * ice.n(nm)).asin().to_degrees() - 60.0;
        let (edge, inside) = inner_edge(nm);
        println!("halo, {nm} nm: the edge is at {edge:.3}°, the least deviation {least:.3}°; inside {inside:.2} of it");
        assert!((edge - least).abs() < 0.15, "{nm} nm: {edge}° for {least}°");
        assert!(inside < 0.35, "{nm} nm: the sky inside has {inside} of the halo");
        edge
    });
    assert!(edges.is_sorted_by(|blue, red| blue > red), "red is not inside: {edges:?}");
}
