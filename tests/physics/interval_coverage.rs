//! Intervals of 95 % contain the truth about as often as they claim, or they are unknown.

use crate::common::{diffuse, job, render, with_setting};
use abbe_session::render::Integrator;
use abbe_transport::sensor::Picture;
use serde_json::{Value, json};

/// Fog over a grey floor under an even sky.
fn fog_under_sky() -> Value {
    json!({
        "camera": { "from": [0, 1, 4], "at": [0, 0.5, 0], "lens": { "pinhole": { "fov": 50 } } },
        "film": { "width": 12, "height": 8 },
        "media": { "fog": { "homogeneous": { "absorption": 0.01, "scattering": 0.8, "phase": "isotropic" } } },
        "materials": { "grey": diffuse(0.4), "fog": { "boundary": { "medium": "fog" } } },
        "objects": [
            { "name": "floor", "shape": { "rectangle": { "width": 20, "height": 20 } }, "material": "grey" },
            { "name": "fog", "shape": { "box": { "size": [3, 2, 3] } }, "material": "fog",
              "transform": [{ "translate": [0, 1.001, 0] }] }
        ],
        "lights": [{ "environment": { "spectrum": "D65", "illuminance": 1000 } }],
        "render": {}
    })
}

/// A lamp of 1 cm whose image a floor of rough metal shows.
fn lamp_in_rough_metal() -> Value {
    json!({
        "camera": { "from": [0, 0.6, 1.2], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 12, "height": 8 },
        "materials": { "rough": { "conductor": { "metal": "aluminium", "roughness": 0.05 } }, "black": "absorber",
                       "grey": diffuse(0.5) },
        "objects": [
            { "name": "floor", "shape": { "rectangle": { "width": 3, "height": 3 } }, "material": "rough" },
            { "name": "wall", "shape": { "rectangle": { "width": 3, "height": 2 } }, "material": "grey",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1, -1] }] },
            { "name": "lamp", "shape": { "sphere": { "radius": 0.005, "center": [0, 0.5, -0.5] } }, "material": "black",
              "emission": { "spectrum": "E", "luminance": 100000 } }
        ],
        "render": {}
    })
}

/// Returns the mean picture of several long renders, and the standard error of each pixel.
fn truth(scene: &Value, passes: u64) -> Vec<(f64, f64)> {
    const RUNS: u64 = 8;
    let runs: Vec<Picture> = (0..RUNS)
        .map(|seed| render(&with_setting(scene, "seed", 1000 + seed), Integrator::Path, passes).picture)
        .collect();
    let of = |pixel: usize| {
        let y = || runs.iter().map(|run| run.xyz[pixel][1]);
        let mean = y().sum::<f64>() / RUNS as f64;
        let variance = y().map(|y| (y - mean).powi(2)).sum::<f64>() / (RUNS * (RUNS - 1)) as f64;
        (mean, variance.sqrt())
    };
    (0..runs[0].xyz.len()).map(of).collect()
}

/// Returns the fraction of the intervals that contain the truth. All intervals must be known.
fn coverage(scene: &Value, (integrator, passes): (Integrator, u64), seeds: u64, truth: &[(f64, f64)]) -> f64 {
    let mut inside = 0;
    for seed in 0..seeds {
        let picture = render(&with_setting(scene, "seed", seed), integrator, passes).picture;
        for (pixel, &(mean, error)) in truth.iter().enumerate() {
            let half = picture.half_interval_95(pixel, error).expect("a known interval");
            inside += usize::from((picture.xyz[pixel][1] - mean).abs() <= half);
        }
    }
    inside as f64 / (seeds as usize * truth.len()) as f64
}

#[test]
#[ignore = "slow: minutes of CPU time"]
fn intervals_cover_fog_under_an_even_sky() {
    let scene = fog_under_sky();
    let truth = truth(&scene, 2000);
    for (integrator, most) in [(Integrator::Path, 64), (Integrator::Photon, 16)] {
        for passes in [2, 4, 8, 16, 64].into_iter().filter(|&passes| passes <= most) {
            let inside = coverage(&scene, (integrator, passes), 20, &truth);
            println!("fog, {integrator:?}, {passes} passes: {inside:.3} of the intervals contain the truth");
            assert!((0.92..0.98).contains(&inside), "{inside}");
        }
    }
}

/// The path tracer finds the lamp in the metal by way of the wall seldom: at 16,000 passes, it still
/// lacks a third of the light, and its noise is small.
#[test]
fn errors_are_unknown_where_paths_miss_rough_metal() {
    let scene = lamp_in_rough_metal();
    let rendered = render(&scene, Integrator::Path, 4);
    assert!((0..rendered.picture.xyz.len()).all(|pixel| rendered.picture.error(pixel).is_none()));
    assert_eq!((rendered.stats.warnings.len(), rendered.stats.error.typical), (1, None));
    assert_eq!(job(&scene).integrator_for_meters(), Integrator::Photon);
    let mut rough = scene;
    rough["materials"]["rough"]["conductor"]["roughness"] = json!(0.4);
    assert!(render(&rough, Integrator::Path, 4).stats.warnings.is_empty());
}
