//! Media with known answers: Beer's law, and non-absorbing fog in uniform surroundings.

use crate::common::compare::Measured;
use crate::common::{diffuse, mean_y, render, with_setting};
use crate::furnace::{self, surroundings};
use crate::golden::golden;
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// A slab of a medium, `thickness` m thick, in front of a bright wall that fills the picture.
fn slab(medium: Value, thickness: f64) -> Value {
    // The medium is forced, because the plan leaves out media that are too thin to be visible.
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 0.1 } } },
        "film": { "width": 16, "height": 16 },
        "media": { "it": medium },
        "materials": { "it": { "boundary": { "medium": "it" } }, "black": "absorber" },
        "objects": [
            { "shape": { "box": { "size": [10, 10, thickness] } }, "material": "it",
              "transform": [{ "translate": [0, 0, -1.0 - 0.5 * thickness] }] },
            { "shape": { "rectangle": { "width": 10, "height": 10 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 1 },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -2.0 - thickness] }] }
        ],
        "render": { "photons": 100, "force": ["media"] }
    })
}

fn absorbing(sigma: impl Into<Value>) -> Value {
    json!({ "homogeneous": { "absorption": sigma.into(), "scattering": 0, "phase": "isotropic" } })
}

/// A uniform density as a grid, with this method of computing its transmittance.
fn even_grid(sigma: f64, transmittance: &str) -> Value {
    json!({ "grid": { "bounds": [[-5, -5, -2], [5, 5, -1]], "density": { "constant": 1 }, "absorption": sigma,
                      "scattering": 0, "phase": "isotropic", "transmittance": transmittance } })
}

const PASSES: u64 = 16;

#[test]
fn a_slab_of_any_depth_passes_what_beers_law_says() {
    let luminance = |medium: Value, way| render(&slab(medium, 1.0), way, PASSES).picture.mean_y();
    let clear = luminance(absorbing(0.0), Integrator::Photon);
    for depth in [1e-8, 1e-4, 0.1, 1.0, 10.0, 50.0, 200.0] {
        for medium in [absorbing(depth), even_grid(depth, "exact"), even_grid(depth, "march")] {
            let passed = luminance(medium, Integrator::Photon) / clear;
            // Coefficients are stored to 1e-6. A relative error of 1e-6 in the depth changes the
            // transmittance by 1e-6 times the depth.
            let off = if depth < 1e-2 { (1.0 - passed) / -(-depth).exp_m1() } else { passed / (-depth).exp() } - 1.0;
            println!("Beer, optical depth {depth:e}: off by {off:.1e}");
            // The film's sums have a smallest step; at depth 50 the transmittance is below it.
            let exact = off.abs() < 1e-6 * depth.max(1.0) || (passed - (-depth).exp()).abs() < 1e-18;
            assert!(exact, "optical depth {depth}: {passed}");
        }
    }
    for way in [Integrator::Photon, Integrator::Path] {
        assert_eq!(luminance(absorbing(1e5), way), 0.0);
    }
}

#[test]
fn too_few_steps_through_a_medium_are_reported_as_bias() {
    let uneven = |transmittance: &str| {
        json!({ "grid": { "bounds": [[-5, -5, -2], [5, 5, -1]], "density": { "values": [0, 3, 0.5], "resolution": [1, 1, 3] },
                          "absorption": 0.6, "scattering": 0, "phase": "isotropic", "transmittance": transmittance } })
    };
    // A wall that emits, and a wall that a light beside the camera lights through the same slab.
    let glowing = |transmittance: &str| slab(uneven(transmittance), 1.0);
    let lit = |transmittance: &str| {
        let mut scene = glowing(transmittance);
        scene["materials"]["grey"] = diffuse(0.5);
        scene["objects"][1]["material"] = json!("grey");
        scene["objects"][1].as_object_mut().unwrap().remove("emission");
        scene["lights"] = json!([{ "point": { "at": [0.2, 0, 0], "spectrum": "E", "luminous_intensity": 1 } }]);
        scene
    };
    for (name, scene) in [("glowing", &glowing as &dyn Fn(&str) -> Value), ("lit", &lit)] {
        let picture = |transmittance: &str| {
            let scene = with_setting(&scene(transmittance), "march_steps", 2);
            render(&with_setting(&scene, "forbid", json!(["indirect"])), Integrator::Photon, PASSES).picture
        };
        let (marched, exact) = (picture("march"), picture("exact"));
        let (reported, apart) = (marched.error_means().bias, (marched.mean_y() - exact.mean_y()).abs());
        println!(
            "{name}: steps are off by {:.4} of Y; reported / true {:.4}",
            apart / exact.mean_y(),
            reported / apart
        );
        assert!(apart > 0.01 * exact.mean_y(), "the steps are coarse enough to tell");
        assert!((reported / apart - 1.0).abs() < 0.05, "{reported} for {apart}");
        assert_eq!(exact.error_means().bias, 0.0);
    }
}

#[test]
#[ignore = "nightly: 19 seconds of CPU time"]
fn tracked_attenuation_is_exact_in_the_mean() {
    for way in [Integrator::Photon, Integrator::Path] {
        let thin = [1e-8_f64, 0.1].map(|depth| (depth, 16));
        for (depth, passes) in thin.into_iter().chain([(1.0, 64), (2.0, 128)]) {
            let clear = Measured::new(&slab(absorbing(0.0), 1.0), (way, passes), 0..8, mean_y);
            let medium = if way == Integrator::Photon { even_grid(depth, "ratio") } else { absorbing(depth) };
            let passed = Measured::new(&slab(medium, 1.0), (way, passes), 0..8, mean_y);
            let ratio = Measured::combine(&[&passed, &clear], |y| y[0] / y[1]);
            let (mean, error, truth) = (ratio.mean(0), ratio.error(0), (-depth).exp());
            println!("tracked, optical depth {depth:e}, {way:?}: {mean:.6} ± {error:.6} of {truth:.6}");
            assert!(error < 5e-3 * truth, "too noisy to tell");
            assert!((mean - truth).abs() < (4.0 * error).max(1e-7), "optical depth {depth}: {mean}");
        }
    }
}

#[test]
fn daylight_through_water_has_the_golden_colour() {
    let xyz = |medium: Value, thickness: f64| {
        let picture = render(&slab(medium, thickness), Integrator::Photon, 64).picture;
        [0, 1, 2].map(|c| picture.xyz.iter().map(|xyz| xyz[c]).sum::<f64>() / picture.xyz.len() as f64)
    };
    for row in golden("media.json")["water_beam"].as_array().expect("rows") {
        let path = row["path_m"].as_f64().expect("a length");
        let found = xyz(absorbing("water/absorption"), path);
        for (c, found) in found.into_iter().enumerate() {
            let truth = row["XYZ"][c].as_f64().expect("a number");
            println!("D65 through {path} m of water, {}: {:+.4} %", ["X", "Y", "Z"][c], 100.0 * (found / truth - 1.0));
            assert!((found / truth - 1.0).abs() < 5e-3, "{path} m: {found} for {truth}");
        }
    }
}

/// A ball of non-absorbing fog with this optical depth along its diameter.
fn white_ball(depth: f64, g: f64) -> Value {
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 16 } } },
        "film": { "width": 8, "height": 8 },
        "media": { "white": { "homogeneous": { "absorption": 0, "scattering": 0.5 * depth,
                                               "phase": { "henyey_greenstein": { "g": g } } } } },
        "materials": { "white": { "boundary": { "medium": "white" } } },
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "white" }],
        "lights": surroundings(), "render": { "photons": 10000, "radius": 0.15 }
    })
}

fn furnaces(depth: f64, way: (Integrator, u64)) {
    for g in [0.0, 0.8] {
        furnace::check(&format!("fog, g = {g}, optical depth {depth}"), &white_ball(depth, g), way);
    }
}

#[test]
#[ignore = "nightly: 8 seconds of CPU time"]
fn thin_white_fog_in_uniform_surroundings() {
    furnaces(0.1, (Integrator::Photon, 32));
    furnaces(0.1, (Integrator::Path, 32));
}

#[test]
#[ignore = "nightly: 11 seconds of CPU time"]
fn white_fog_in_uniform_surroundings() {
    // The photons are more than the largest number of beams, so only a part of them is stored.
    furnace::check("fog, g = 0, optical depth 2", &white_ball(2.0, 0.0), (Integrator::Photon, 64));
    furnaces(2.0, (Integrator::Path, 128));
}

#[test]
#[ignore = "nightly: 12 seconds of CPU time"]
fn dense_white_fog_in_uniform_surroundings() {
    furnaces(20.0, (Integrator::Path, 128));
}

#[test]
#[ignore = "slow: a minute of CPU time; photons of the second and later scatterings are few"]
fn white_fog_in_uniform_surroundings_by_photons() {
    furnace::check("fog, g = 0, optical depth 2", &white_ball(2.0, 0.0), (Integrator::Photon, 640));
}

/// White smoke that is dense in the middle, in uniform surroundings. Beams of scattered light cross
/// places of different density.
#[test]
fn white_smoke_by_beams_is_a_furnace_in_the_mean() {
    let mut scene = white_ball(1.0, 0.0);
    scene["media"]["white"] = json!({ "grid": { "bounds": [[-1, -1, -1], [1, 1, 1]],
        "density": { "sphere": { "value": 1, "center": [0, 0, 0], "radius": 1, "falloff": 1 } },
        "absorption": 0, "scattering": 2, "phase": "isotropic" } });
    scene["render"]["force"] = json!(["photon-beams"]);
    let seen = Measured::new(&scene, (Integrator::Photon, 32), 0..4, mean_y);
    println!("white smoke by beams: {:.4} ± {:.4}", seen.mean(0), seen.error(0));
    assert!(seen.error(0) < 0.01, "too noisy to tell");
    assert!((seen.mean(0) - 1.0).abs() < 0.03, "{}", seen.mean(0));
}

#[test]
fn the_ledger_of_fog_balances() {
    for (depth, g, absorption) in [(0.1, 0.8, 0.0), (2.0, 0.0, 0.5), (20.0, 0.8, 0.5)] {
        let mut scene = white_ball(depth, g);
        let coefficients = &mut scene["media"]["white"]["homogeneous"];
        coefficients["absorption"] =
            json!({ "table": { "nm": [360, 830], "values": [4.0 * absorption, 0.04 * absorption] } });
        let runs = Measured::new(&scene, (Integrator::Photon, 1), 0..16, |rendered| {
            let ledger = &rendered.stats.ledger_w;
            assert!(ledger.balance.abs() < 1e-9, "out of balance by {}", ledger.balance);
            vec![ledger.sampling / ledger.emitted]
        });
        println!("ledger, optical depth {depth}: sampling {:+.2e} ± {:.1e}", runs.mean(0), runs.error(0));
        assert!(runs.mean(0).abs() <= (4.0 * runs.error(0)).max(1e-12), "sampling gains or loses");
    }
}

/// Beams that run along a camera ray are rare and bright, so the mean is only known to within their
/// noise.
#[test]
#[ignore = "slow: a minute of CPU time; beams that run along a ray are few and bright"]
fn forward_scattering_white_fog_by_beams_is_a_furnace() {
    let mut scene = white_ball(2.0, 0.8);
    scene["render"] = json!({ "photons": 500, "radius": 0.05 });
    let seen = Measured::new(&scene, (Integrator::Photon, 4096), 0..8, mean_y);
    let (mean, error) = (seen.mean(0), seen.error(0));
    println!("furnace, fog by beams, g = 0.8, optical depth 2: {mean:.4} ± {error:.4}");
    assert!(error < 5e-3, "too noisy to tell");
    assert!((mean - 1.0).abs() < 4.0 * error);
}
