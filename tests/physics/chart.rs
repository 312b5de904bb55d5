//! A rendered ColorChecker under five lamps has the colours that an independent program integrated
//! from the same tables.

use crate::common::{diffuse, overhead_camera, render};
use crate::golden::golden;
use abbe_session::render::Integrator;
use abbe_spectra::spectrum::library;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Patches per row and per column, and pixels along a patch's side.
const COLUMNS: usize = 6;
const ROWS: usize = 4;
const SIDE: usize = 8;

/// The library names of the chart's patches, and their titles in the golden file.
fn patches() -> Vec<(&'static str, &'static str)> {
    let of_chart = library::list().iter().filter(|entry| entry.name.starts_with("colorchecker/"));
    of_chart.map(|entry| (entry.name, entry.description.rsplit(": ").next().expect("a title"))).collect()
}

/// The chart alone, lit from directly above. A perfect diffuser would have 100 cd/m².
fn chart(lamp: &str) -> Value {
    let place = |i: usize| [(i % COLUMNS) as f64 - 2.5, 0.0, (i / COLUMNS) as f64 - 2.5];
    let patches = patches();
    let objects = patches.iter().enumerate().map(|(i, (name, _))| {
        json!({ "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": name, "transform": [ { "translate": place(i) } ] })
    });
    let objects: Vec<Value> = objects.collect();
    let materials: serde_json::Map<String, Value> =
        patches.iter().map(|&(name, _)| (name.to_owned(), diffuse(name))).collect();
    json!({
        "camera": overhead_camera([0.0, 0.0], 10.0, COLUMNS as f64),
        "film": { "width": COLUMNS * SIDE, "height": COLUMNS * SIDE },
        "materials": materials,
        "objects": objects,
        "lights": [ { "directional": { "toward": [0, -1, 0], "spectrum": lamp, "illuminance": 100.0 * PI } } ],
        "render": { "photons": 100 }
    })
}

/// Returns a patch's mean XYZ without its outermost pixels.
fn mean(picture: &[[f64; 3]], patch: usize) -> [f64; 3] {
    let (column, row) = (patch % COLUMNS, patch / COLUMNS);
    let mut sum = [0.0; 3];
    for (x, y) in (1..SIDE - 1).flat_map(|y| (1..SIDE - 1).map(move |x| (x, y))) {
        let pixel = picture[(row * SIDE + y) * COLUMNS * SIDE + column * SIDE + x];
        (0..3).for_each(|c| sum[c] += pixel[c] / (SIDE - 2).pow(2) as f64);
    }
    sum
}

#[test]
#[ignore = "nightly: 11 seconds of CPU time"]
fn a_rendered_colorchecker_has_the_integrated_colours() {
    let golden = golden("colorchecker.json");
    let lamps =
        [("D65", "D65"), ("A", "A"), ("FL11", "FL11"), ("lamp HPS", "lamp/hps"), ("LPS_D_thin", "sodium-low-pressure")];
    assert_eq!(patches().len(), COLUMNS * ROWS);
    for (title, lamp) in lamps {
        let picture = render(&chart(lamp), Integrator::Photon, 400).picture;
        let mut worst = 0.0_f64;
        for (i, (_, patch)) in patches().iter().enumerate() {
            let known = &golden["by_light"][title]["patches"][patch]["XYZ"];
            let found = mean(&picture.xyz, i);
            for c in 0..3 {
                let known = known[c].as_f64().unwrap_or_else(|| panic!("{patch} under {title}"));
                // Z is almost 0 under sodium light, so the tolerance has a floor.
                let off = (found[c] - known).abs() / known.max(1e-3);
                assert!(off < 0.005, "{patch} under {title}: {found:?}, integrated {known}");
                worst = worst.max(off);
            }
        }
        println!("ColorChecker under {title}: rendered and integrated XYZ within {:.3} %", 100.0 * worst);
    }
}
