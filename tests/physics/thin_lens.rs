//! A defocused point spreads uniformly over a disk of the diameter that the lens formula gives; a
//! bladed stop makes it a polygon.

use crate::common::{diffuse, render};
use abbe_session::render::Integrator;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

const FOCAL_MM: f64 = 50.0;
const F_NUMBER: f64 = 2.0;
const FOCUS_M: f64 = 1.0;
/// The distance of the point in m.
const DISTANCE_M: f64 = 2.0;
const SENSOR_MM: f64 = 1.2;
const FILM: usize = 64;
const PASSES: u64 = 512;
/// The radius of the emitting disk that represents a point, in m.
const TARGET_M: f64 = 0.003;

/// A lens that looks along −z at a small emitting disk behind the plane of focus.
fn defocused(lens: Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "lens": { "thin": lens } },
        "film": { "width": FILM, "height": FILM },
        "materials": { "black": diffuse(0.0) },
        "objects": [
            { "shape": { "disk": { "radius": TARGET_M } }, "material": "black",
              "emission": { "spectrum": "E", "luminance": 1000 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -DISTANCE_M] } ] }
        ],
        "render": { "photons": 100 }
    })
}

/// Returns Y of all pixels with their positions relative to the middle, in pixels right and up.
fn picture(scene: &Value) -> Vec<([f64; 2], f64)> {
    let picture = render(scene, Integrator::Photon, PASSES).picture;
    let place = |i: usize| {
        let middle = 0.5 * FILM as f64;
        [(i % FILM) as f64 + 0.5 - middle, middle - (i / FILM) as f64 - 0.5]
    };
    picture.xyz.iter().enumerate().map(|(i, xyz)| (place(i), xyz[1])).collect()
}

#[test]
fn a_defocused_point_is_a_uniform_disk_of_known_diameter() {
    let lens = json!({ "focal_length_mm": FOCAL_MM, "f_number": F_NUMBER, "focus_distance": FOCUS_M, "sensor_height_mm": SENSOR_MM });
    let pixels = picture(&defocused(lens));
    let pixel_mm = SENSOR_MM / FILM as f64;
    // The blur diameter is c = A·|u − u_f|/u · f/(u_f − f). The picture is the geometrical image of
    // the target convolved with the blur.
    let (focus, distance) = (1e3 * FOCUS_M, 1e3 * DISTANCE_M);
    let magnification = FOCAL_MM / (focus - FOCAL_MM);
    let expected = FOCAL_MM / F_NUMBER * (distance - focus).abs() / distance * magnification / pixel_mm;
    let target = 1e3 * TARGET_M * focus / distance * magnification / pixel_mm;
    // The mean square distance is c²/8 for a uniform disk of diameter c, and 1/6 for a pixel's
    // square.
    let all: f64 = pixels.iter().map(|(_, y)| y).sum();
    let square: f64 = pixels.iter().map(|([x, up], y)| y * (x * x + up * up)).sum::<f64>() / all;
    let found = (8.0 * (square + 1.0 / 6.0 - 0.5 * target * target)).sqrt();
    println!("circle of confusion: {found:.3} pixels, {expected:.3} by the formula");
    assert!((found / expected - 1.0).abs() < 0.01, "{found} and {expected}");

    // Uniformity: 3 rings of equal area × 4 quarters within the part that the whole target covers.
    let radius = 0.5 * expected - target - 1.0;
    let mut cells = [(0.0, 0.0); 12];
    for &([x, up], y) in &pixels {
        let ring = (3.0 * (x * x + up * up) / (radius * radius)) as usize;
        if ring < 3 {
            let quarter = ((up.atan2(x) + PI) / TAU * 4.0) as usize % 4;
            cells[4 * ring + quarter].0 += y;
            cells[4 * ring + quarter].1 += 1.0;
        }
    }
    // A sample that hits the target adds 1000 cd/m² / passes to its pixel.
    let mean = cells.iter().map(|c| c.0).sum::<f64>() / cells.iter().map(|c| c.1).sum::<f64>();
    let chi2: f64 = cells
        .iter()
        .map(|(sum, count)| {
            let [hits, even] = [sum, &(mean * count)].map(|light| light / (1000.0 / PASSES as f64));
            (hits - even).powi(2) / even
        })
        .sum();
    println!(
        "evenness: χ² {chi2:.1} of 11 degrees, {:.0} hits",
        mean * PASSES as f64 / 1000.0 * cells.iter().map(|c| c.1).sum::<f64>()
    );
    assert!(chi2 < 31.3, "χ² {chi2}: above the 0.1 % point of 11 degrees of freedom");
}

#[test]
#[ignore = "nightly: 4 seconds of CPU time"]
fn four_blades_make_the_disk_a_square_on_its_edge_or_its_corner() {
    let side = |rotation: f64| {
        let lens =
            json!({ "fov": 1.2, "focus_distance": FOCUS_M, "defocus_angle": 1.43, "blades": 4, "rotation": rotation });
        let pixels = picture(&defocused(lens));
        let all: f64 = pixels.iter().map(|(_, y)| y).sum();
        // Light near the corners of the upright square, which a square on its corner does not
        // reach.
        pixels.iter().filter(|([x, up], _)| x.abs().min(up.abs()) > 12.0).map(|(_, y)| y).sum::<f64>() / all
    };
    let (upright, on_its_corner) = (side(45.0), side(0.0));
    println!("light near the upright square's corners: upright {upright:.4}, on its corner {on_its_corner:.4}");
    assert!(upright > 4.0 * on_its_corner && upright > 0.01, "{upright} and {on_its_corner}");
}
