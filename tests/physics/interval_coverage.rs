//! Intervals of 95 % contain the truth about as often as they claim, or they are unknown.

use crate::common::{diffuse, render, with_setting};
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

/// Returns the fraction of the known intervals that contain the truth, and of the known ones.
fn coverage(scene: &Value, (integrator, passes): (Integrator, u64), seeds: u64, truth: &[(f64, f64)]) -> [f64; 4] {
    let (mut inside, mut known, mut all) = (0.0, 0.0, 0.0);
    let (mut square, mut claimed) = (0.0, 0.0);
    for seed in 0..seeds {
        let picture = render(&with_setting(scene, "seed", seed), integrator, passes).picture;
        for (pixel, &(mean, error)) in truth.iter().enumerate() {
            all += 1.0;
            if let Some(half) = picture.half_interval_95(pixel, error) {
                known += 1.0;
                let off = (picture.xyz[pixel][1] - mean).abs();
                inside += f64::from(u8::from(off <= half));
                square += off * off;
                claimed += picture.error(pixel).unwrap_or(0.0).powi(2);
            }
        }
    }
    [inside / known, known / all, (square / all).sqrt(), (claimed / all).sqrt()]
}

#[test]
#[ignore = "slow: explore"]
fn explore_coverage() {
    for (name, scene, long) in [("fog", fog_under_sky(), 2000), ("metal", lamp_in_rough_metal(), 4000)] {
        let truth = truth(&scene, long);
        let mean = truth.iter().map(|(y, _)| y).sum::<f64>() / truth.len() as f64;
        let error = (truth.iter().map(|(_, e)| e * e).sum::<f64>() / truth.len() as f64).sqrt();
        println!("{name}: mean {mean:.4}, error of the truth {error:.4}");
        for integrator in [Integrator::Path, Integrator::Photon] {
            for passes in [2, 4, 8, 16, 64] {
                if integrator == Integrator::Photon && passes > 16 {
                    continue;
                }
                let [inside, known, rms, claimed] = coverage(&scene, (integrator, passes), 10, &truth);
                println!(
                    "{name} {integrator:?} {passes}: {inside:.3} of {known:.2}, true {rms:.4}, claimed {claimed:.4}"
                );
            }
        }
    }
}
