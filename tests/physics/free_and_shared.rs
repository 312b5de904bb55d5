//! Free photons (with wavelengths of their own) and shared photons (on the wavelengths of the pass)
//! converge to the same picture. Dispersive glass adds noise only to pixels that look through it.

use crate::common::compare::{Measured, assert_same};
use crate::common::{colour_blocks, diffuse, glass, job, mean_y, render, with_setting};
use crate::fluorescence::material;
use abbe_session::render::{Integrator, Job};
use abbe_transport::emit::LightSampler;
use glam::DVec2;
use serde_json::{Value, json};

/// The caustic of a ball of dense flint on a floor. The camera is below the ball and sees only
/// floor.
fn floor_only() -> Value {
    json!({
        "camera": { "from": [-0.6, 0.45, 2.0], "at": [-0.6, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 20 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "grey": diffuse(0.5), "black": "absorber", "flint": glass("SF10") },
        "objects": [
            { "shape": { "rectangle": { "width": 10, "height": 10 } }, "material": "grey" },
            { "shape": { "sphere": { "radius": 1, "center": [0, 1.6, 0] } }, "material": "flint" },
            { "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 1000 },
              "transform": [ { "rotate": { "axis": [0, 0, 1], "degrees": 158 } }, { "translate": [2, 6, 0] } ] }
        ],
        "render": { "photons": 20000 }
    })
}

#[test]
#[ignore = "slow: 20 seconds of CPU time"]
fn forced_shared_wavelengths_leave_a_floor_unchanged() {
    let take = colour_blocks(8);
    let scene = floor_only();
    let free = Measured::new(&scene, (Integrator::Photon, 16), 0..8, &take);
    let forced = with_setting(&scene, "force", json!(["shared"]));
    let [whole, half] = [0.1, 0.05].map(|radius| {
        Measured::new(&with_setting(&forced, "radius", radius), (Integrator::Photon, 32), 100..108, &take)
    });
    let shared = Measured::extrapolated(&whole, &half);
    assert_same("floor only, free against shared", &free, &shared, 1e-2);
}

/// A pane lets only photons excite a dye, whose light a floor reflects. A plate of flint disperses
/// it on the way to the camera, and a plate with one index does not.
#[test]
fn the_light_of_a_dye_is_as_bright_behind_dispersive_glass() {
    let behind = |ior: Value| {
        let lamp = json!({ "at": [0, 1.4, 0], "power": 1, "spectrum": { "lines": [{ "nm": 450, "power": 1 }] } });
        let plate = |name: &str, size: [f64; 3], at: [f64; 3]| json!({ "shape": { "box": { "size": size } }, "material": name, "transform": [{ "translate": at }] });
        let scene = json!({
            "camera": { "from": [0, 1, 2], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 12 } } },
            "film": { "width": 8, "height": 8 },
            "materials": { "dye": material("yellow phosphor"), "clear": glass(1.0), "glass": glass(ior),
                           "yellow": diffuse(json!({ "table": { "nm": [360, 490, 500, 830], "values": [0, 0, 0.6, 0.6] } })) },
            "objects": [
                { "shape": { "rectangle": { "width": 3, "height": 3 } }, "material": "yellow" },
                plate("dye", [2.0, 1.1, 0.02], [0.0, 0.56, -0.8]),
                plate("clear", [3.0, 0.02, 3.0], [0.0, 1.2, 0.0]),
                plate("glass", [1.0, 1.0, 0.05], [0.0, 0.6, 1.2])
            ],
            "lights": [{ "point": lamp }], "render": { "photons": 10000 }
        });
        Measured::new(&scene, (Integrator::Photon, 16), 0..4, mean_y)
    };
    let [plain, dispersed] = [json!(1.79), json!("N-SF11")].map(behind);
    let (ratio, error) = (dispersed.mean(0) / plain.mean(0), dispersed.error(0) / dispersed.mean(0));
    println!("a dye behind dispersive glass: {ratio:.4} ± {error:.4} of that behind plain glass");
    assert!(error < 0.05, "too noisy to tell");
    assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
}

/// A small flint ball on a floor under a large light. The camera sees the caustic through a flint
/// prism that bends the view down.
fn through_a_prism() -> Value {
    json!({
        "camera": { "from": [-3.2, 1.25, 0], "at": [-2.5, 1.5, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 12 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "grey": diffuse(0.5), "black": "absorber", "flint": glass("N-SF11") },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 6 } }, "material": "grey" },
            { "shape": { "prism": { "side": 1, "length": 1, "apex": 45 } }, "material": "flint",
              "transform": [ { "translate": [-2.5, 1.5, 0] } ] },
            { "shape": { "sphere": { "radius": 0.3, "center": [1.6, 0.5, 0] } }, "material": "flint" },
            { "shape": { "disk": { "radius": 1 } }, "material": "black", "emission": { "spectrum": "D65", "luminance": 100 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [1.6, 1.8, 0] } ] }
        ],
        "render": { "photons": 10000 }
    })
}

#[test]
#[ignore = "slow: 4 seconds of CPU time"]
fn a_caustic_seen_through_a_dispersive_prism_keeps_its_energy() {
    let take = colour_blocks(8);
    let scene = through_a_prism();
    let path = Measured::new(&scene, (Integrator::Path, 160), 100..108, &take);
    let photon = Measured::extrapolated_photons(&scene, 0.06, 20, &take);
    assert_same("caustic through a prism, photon against path", &photon, &path, 1.4e-2);
}

/// The benchmark scene S1 near its caustic, with another index of the ball.
pub(crate) fn s1(ior: Value, force: &[&str]) -> Value {
    let mut scene: Value =
        serde_json::from_str(include_str!("../../benches/scenes/s1_ball.json")).expect("s1_ball.json");
    scene["camera"]["at"] = json!([-0.508, 0, 0.014]);
    scene["camera"]["lens"] = json!({ "pinhole": { "fov": 6.4 } });
    scene["film"] = json!({ "width": FILM, "height": FILM });
    scene["materials"]["bk7"]["dielectric"]["ior"] = ior;
    scene["render"] = json!({ "photons": 20000, "force": force });
    scene
}

/// Pixels along each side of the film of [`s1`].
const FILM: usize = 32;

/// Returns the pixels in which the ball is not visible.
pub(crate) fn beside_the_ball(scene: &Value) -> Vec<usize> {
    let job = job(scene);
    let camera = &job.scene.camera;
    let width = camera.width();
    let sees_floor = |film: DVec2| {
        let hit = job.scene.geometry.intersect(&camera.ray(film, [0.5; 2]), None, f64::INFINITY);
        hit.is_some_and(|hit| job.scene.objects[hit.object as usize].name == "floor")
    };
    let places = |pixel: usize| {
        let corner = DVec2::new((pixel % width) as f64, (pixel / width) as f64);
        (0..25).map(move |i| corner + DVec2::new(f64::from(i % 5), f64::from(i / 5)) * 0.25)
    };
    (0..camera.pixel_count()).filter(|&pixel| places(pixel).all(sees_floor)).collect()
}

/// The means and variances of pixels over runs.
type Moments = (Vec<[f64; 3]>, Vec<[f64; 3]>);

/// Returns the means over several runs of X, Y and Z for each pixel, and the variance of one run.
fn moments(scene: &Value) -> Moments {
    const RUNS: usize = 12;
    let runs: Vec<Vec<[f64; 3]>> = (0..RUNS as u64)
        .map(|seed| render(&with_setting(scene, "seed", seed), Integrator::Photon, 8).picture.xyz)
        .collect();
    let over_runs =
        |pixel: usize, c: usize, f: &dyn Fn(f64) -> f64| runs.iter().map(|run| f(run[pixel][c])).sum::<f64>();
    let mean = |p: usize| std::array::from_fn(|c| over_runs(p, c, &|v| v) / RUNS as f64);
    let means: Vec<[f64; 3]> = (0..FILM * FILM).map(mean).collect();
    let variance =
        |p: usize| std::array::from_fn(|c| over_runs(p, c, &|v| (v - means[p][c]).powi(2)) / (RUNS - 1) as f64);
    let variances = (0..FILM * FILM).map(variance).collect();
    (means, variances)
}

/// Returns, for X, Y and Z, the ratio of the mean square contribution of a photon with one
/// wavelength to that of a photon with four stratified wavelengths.
fn spread_of_colour(job: &Job) -> [f64; 3] {
    const STEPS: usize = 4000;
    let choice = LightSampler::new(&job.scene).expect("a light");
    let observer = job.scene.film.observer;
    let values: Vec<[f64; 3]> = (0..STEPS)
        .map(|i| {
            let (nm, pdf) = choice.wavelengths.sample((i as f64 + 0.5) / STEPS as f64);
            observer.xyz_bar(nm).map(|bar| bar * job.scene.lights[0].spectrum.at(nm) / pdf)
        })
        .collect();
    std::array::from_fn(|c| {
        let mean = |of: &[[f64; 3]]| of.iter().map(|value| value[c]).sum::<f64>() / of.len() as f64;
        let square = values.iter().map(|value| value[c].powi(2)).sum::<f64>() / STEPS as f64;
        let between: f64 = values.chunks(STEPS / 4).map(|quarter| mean(quarter).powi(2)).sum::<f64>() / 4.0;
        // One wavelength from each quarter of the distribution: the variances within the quarters,
        // divided by 4·4 for each of the four.
        let of_four = mean(&values).powi(2) + (square - between) / 4.0;
        square / of_four
    })
}

#[test]
#[ignore = "slow: 20 seconds of CPU time"]
fn dispersion_adds_only_colour_noise_to_a_caustic() {
    let cauchy = json!({ "cauchy": { "a": 1.5046, "b": 0.0042 } });
    let n_550 = 1.5046 + 0.0042 / 0.55_f64.powi(2);
    let dispersive_scene = s1(cauchy.clone(), &[]);
    let beside = beside_the_ball(&dispersive_scene);
    let (mean, dispersive) = moments(&dispersive_scene);
    let (fixed_mean, fixed) = moments(&s1(json!(n_550), &[]));
    let (_, shared) = moments(&s1(cauchy, &["shared"]));
    // The core of the caustic: pixels where both balls make the floor brighter than 0.5.
    let core: Vec<usize> = beside.into_iter().filter(|&p| mean[p][1].min(fixed_mean[p][1]) > 0.5).collect();
    // Photons arrive at random, so the variance is proportional to the light. Variance per unit of
    // light measures how unequal the photons are.
    let per_light = |means: &[[f64; 3]], variances: &[[f64; 3]], c: usize| {
        core.iter().map(|&p| variances[p][c]).sum::<f64>() / core.iter().map(|&p| means[p][c]).sum::<f64>()
    };
    assert!(core.len() > 30, "{} pixels", core.len());
    let stats = render(&dispersive_scene, Integrator::Photon, 1).stats;
    let free = 1.0 - stats.photons_shared as f64 / stats.photons_emitted as f64;
    let spread = spread_of_colour(&job(&dispersive_scene));
    println!(
        "S1 core, {} pixels, variance per unit of light with the ball dispersive over that with n(550 nm):",
        core.len()
    );
    for (c, channel) in ["X", "Y", "Z"].iter().enumerate() {
        let of_fixed = per_light(&fixed_mean, &fixed, c);
        let (ratio, all_shared) =
            (per_light(&mean, &dispersive, c) / of_fixed, per_light(&mean, &shared, c) / of_fixed);
        let explained = spread[c] / free;
        println!(
            "{channel}: {ratio:.2}, {explained:.2} explained; with every path on shared wavelengths {all_shared:.1}"
        );
        // The ratio exceeds the part explained by colour, because the stratified origins of the
        // photons lose some of their effect where each wavelength has its own path.
        assert!(ratio < 2.0 * explained, "{channel}: {ratio}, {explained} explained");
        assert!(all_shared > 3.0 * ratio, "{channel}: {all_shared} and {ratio}");
    }
}

/// Lamps with different lines share the wavelengths of camera paths behind dispersive glass. With
/// many such lamps, a note says how few of the wavelengths suit one of them.
#[test]
fn a_note_names_spectra_that_few_wavelengths_suit() {
    let notes = |lamps: u32, width_nm: f64| {
        let lamp = |i: u32| {
            let line =
                json!({ "nm": 450.0 + 180.0 * f64::from(i) / f64::from(lamps), "power": 1, "fwhm_nm": width_nm });
            json!({ "point": { "at": [f64::from(i), 4, 0], "spectrum": { "lines": [line] }, "power": 1 } })
        };
        let mut scene = through_a_prism();
        scene["lights"] = (0..lamps).map(lamp).collect();
        scene["objects"].as_array_mut().unwrap().pop();
        render(&scene, Integrator::Photon, 1).stats.notes
    };
    let notes_of_30 = notes(30, 0.1);
    // Half of the wavelengths are divided equally among the lamps, and the other half by power.
    let number: f64 = notes_of_30[0].split("one in ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(notes_of_30.len() == 2 && (30.0..=60.0).contains(&number), "{notes_of_30:?}");
    assert!(notes_of_30[1].contains("no pass has sampled the spectrum of"), "{notes_of_30:?}");
    assert!(notes(2, 0.1).is_empty());
    assert!(notes(30, 100.0).is_empty(), "wide lines overlap");
}
