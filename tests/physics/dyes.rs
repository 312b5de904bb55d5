//! Fluorescent dyes in media: golden slabs, a closed form, and the two integrators.

use crate::common::compare::{Measured, assert_same};
use crate::common::near::{assert_near, number};
use crate::common::{colour_blocks, diffuse, glass, job, mean_y, render, with_setting};
use crate::golden::golden;
use crate::textures::assert_integrators_agree_after;
use abbe_session::render::Integrator;
use abbe_spectra::spectrum::Observer;
use abbe_transport::plan::WavelengthPlan;
use abbe_transport::walk::ledger::Ledger;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// A dye that absorbs near one wavelength and emits near another one. `absorption` is in 1/m.
fn narrow_dye(absorption: f64, (from, to): (f64, f64), quantum_yield: f64) -> Value {
    json!({
        "absorption": { "table": { "nm": [from - 2.0, from - 1.0, from + 1.0, from + 2.0],
                                   "values": [0.0, absorption, absorption, 0.0] } },
        "emission": { "table": { "nm": [to - 1.0, to, to + 1.0], "values": [0, 1, 0] } },
        "quantum_yield": quantum_yield
    })
}

/// A clear medium with a dye.
fn solution(dye: &Value) -> Value {
    json!({ "homogeneous": { "absorption": 0, "scattering": 0, "phase": "isotropic", "dye": dye } })
}

/// A golden slab of 1 m thickness. A beam of 1 W arrives at right angles. Black walls in the glass
/// absorb the light that total reflection traps.
fn ledger_of_slab(n: f64, dye: &Value, excitation_nm: f64, passes: u64) -> Ledger {
    let wall = |size: [f64; 2], axis: [f64; 3], at: [f64; 3]| {
        json!({ "shape": { "rectangle": { "width": size[0], "height": size[1] } }, "material": "black",
                "transform": [{ "rotate": { "axis": axis, "degrees": 90 } }, { "translate": at }] })
    };
    let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let scene = json!({
        "camera": { "from": [0, 30, 60], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 30 } } },
        "film": { "width": 4, "height": 4 },
        "media": { "solution": solution(dye) },
        "materials": { "slab": { "dielectric": { "ior": n, "medium": "solution" } }, "black": "absorber" },
        "objects": [
            { "shape": { "box": { "size": [60, 1, 60] } }, "material": "slab" },
            wall([1.2, 60.0], z, [29.0, 0.0, 0.0]), wall([1.2, 60.0], z, [-29.0, 0.0, 0.0]),
            wall([60.0, 1.2], x, [0.0, 0.0, 29.0]), wall([60.0, 1.2], x, [0.0, 0.0, -29.0])
        ],
        "lights": [{ "beam": { "from": [0, 5, 0], "to": [0, 0, 0], "radius": 0.5, "power": 1,
                               "spectrum": { "lines": [{ "nm": excitation_nm, "power": 1 }] } } }],
        "render": { "photons": 20000 }
    });
    let mut ledger = render(&scene, Integrator::Photon, passes).ledger;
    assert!(ledger.balance().abs() < 1e-9, "{ledger:?}");
    ledger.scale(1.0 / ledger.emitted);
    ledger
}

#[test]
#[ignore = "nightly: 21 seconds of CPU time"]
fn luminescent_slabs_are_golden() {
    for slab in golden("fluorescence.json")["luminescent_slabs"].as_array().expect("a list") {
        let value = |key: &str| number(&slab[key]);
        let (from, to) = (value("excitation_nm"), value("mean_emission_nm"));
        let dye = narrow_dye(-value("internal_transmittance").ln(), (from, to), value("quantum_yield"));
        let ledger = ledger_of_slab(value("n"), &dye, from, 8);
        println!("{ledger:?} for {slab}");
        let trapped: f64 = ledger.absorbed.iter().sum();
        let escaping = 2.0 * value("photons_escaping_per_face") * from / to;
        for (name, found, known) in [
            ("heat", ledger.stokes_loss + ledger.quantum_loss, value("heat")),
            ("trapped", trapped, value("power_trapped")),
            ("escaped", ledger.escaped, value("reflected") + value("transmitted") + escaping),
        ] {
            assert_near(name, found, known, 3e-3);
        }
    }
}

/// The share of the emitted light that total reflection traps, for each golden index of
/// refraction with air on both sides.
#[test]
#[ignore = "slow: 10 seconds of CPU time"]
fn golden_escape_cones_trap_the_emission() {
    let mut compared = 0;
    for cone in golden("fluorescence.json")["escape_cones"].as_array().expect("a list") {
        if cone["n_above"] != 1.0 || cone["n_below"] != 1.0 {
            continue;
        }
        let ledger = ledger_of_slab(number(&cone["n"]), &narrow_dye(3.0, (450.0, 600.0), 1.0), 450.0, 3);
        let emitted = ledger.stokes_loss / (1.0 - 450.0 / 600.0) * (450.0 / 600.0);
        let trapped = ledger.absorbed.iter().sum::<f64>() / emitted;
        println!("n = {}: {trapped} for {}", cone["n"], cone["trapped"]);
        assert_near("trapped", trapped, number(&cone["trapped"]), 5e-3);
        compared += 1;
    }
    assert!(compared > 2, "{compared}");
}

/// A layer of a solution, seen at right angles. The light arrives along the layer. At the
/// middle of the picture, the radiance is q μ E d/(4π) · λ_i/λ_o. E is the attenuated irradiance.
#[test]
#[ignore = "nightly: 6 seconds of CPU time"]
fn a_layer_of_a_solution_has_its_luminance() {
    const NM: f64 = 450.0;
    const TO: f64 = 600.0;
    const THICKNESS: f64 = 0.5;
    const ABSORPTION: f64 = 1.0;
    let dye = narrow_dye(ABSORPTION, (NM, TO), 0.8);
    let scene = json!({
        "camera": { "from": [0, 0, 3], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 1 } } },
        "film": { "width": 4, "height": 4 },
        "media": { "solution": solution(&dye) },
        "materials": { "solution": { "boundary": { "medium": "solution" } } },
        "objects": [{ "shape": { "box": { "size": [6, 6, THICKNESS] } }, "material": "solution" }],
        "lights": [{ "point": { "at": [0, 40, 0], "power": 1, "spectrum": { "lines": [{ "nm": NM, "power": 1 }] } } }],
        "render": { "photons": 1000 }
    });
    // The light arrives along the layer, so it passes 3 m of the solution.
    let irradiance = 1.0 / (4.0 * PI * 40.0 * 40.0) * (-3.0 * ABSORPTION).exp();
    let radiance = 0.8 * ABSORPTION * THICKNESS * irradiance * NM / TO / (4.0 * PI);
    let known = 683.0 * Observer::cie1931().xyz_bar(TO)[1] * radiance;
    // The standard error of the path tracer is 0.8 %, because few of its wavelengths are in the
    // narrow emission.
    for (integrator, passes, tolerance) in [(Integrator::Photon, 64, 5e-3), (Integrator::Path, 16384, 3e-2)] {
        let measured = Measured::new(&scene, (integrator, passes), 0..4, mean_y);
        println!("{integrator:?}: {} for {known}", measured.mean(0));
        assert_near(&format!("{integrator:?}"), measured.mean(0), known, tolerance * known);
    }
}

/// A tank of a solution above a grey floor, under a disk lamp.
fn tank(scattering: f64, lamp: &Value) -> Value {
    let dye = json!({
        "absorption": { "table": { "nm": [400, 455, 515], "values": [0, 1.5, 0] } },
        "emission": { "gaussian": { "peak_nm": 560, "fwhm_nm": 90 } }, "quantum_yield": 0.9
    });
    json!({
        "camera": { "from": [0, 0.3, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 28 } } },
        "film": { "width": 32, "height": 32 },
        "media": { "solution": { "homogeneous": { "absorption": 0.1, "scattering": scattering,
                                                  "phase": { "henyey_greenstein": { "g": 0.3 } }, "dye": dye } } },
        "materials": { "solution": { "boundary": { "medium": "solution" } }, "grey": diffuse(0.6), "black": "absorber" },
        "objects": [
            { "shape": { "box": { "size": [2, 1.6, 1] } }, "material": "solution" },
            { "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "grey", "transform": [{ "translate": [0, -1, 0] }] },
            { "shape": { "disk": { "radius": 0.8 } }, "material": "black", "emission": { "spectrum": lamp, "luminance": 10 },
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.2, 0] }] }
        ],
        "render": { "photons": 6000 }
    })
}

fn lamp() -> Value {
    json!({ "mix": [{ "spectrum": "D65", "weight": 1 },
                    { "spectrum": { "lines": [{ "nm": 450, "power": 1 }] }, "weight": 20 }] })
}

#[test]
#[ignore = "nightly: 12 seconds of CPU time"]
fn photons_and_paths_agree_in_a_dye() {
    assert_integrators_agree_after(8, "clear dye", &tank(0.0, &lamp()), 1e-2);
}

/// Photon points and photon beams carry the same light.
#[test]
#[ignore = "slow: 3 minutes of CPU time"]
fn points_and_beams_agree_with_paths_in_a_scattering_dye() {
    for (stored, left_out) in [("volume-photons", "photon-beams"), ("photon-beams", "volume-photons")] {
        let scene = with_setting(&tank(0.5, &lamp()), "force", json!([stored]));
        let scene = with_setting(&scene, "forbid", json!([left_out]));
        let take = colour_blocks(8);
        let photon = Measured::extrapolated_photons(&scene, 0.1, 32, &take);
        let path = Measured::new(&scene, (Integrator::Path, 512), 100..108, &take);
        assert_same(&format!("{stored}, photon against path"), &photon, &path, 1e-2);
    }
}

/// A dye under a blue line, seen through a prism of flint glass: free photons excite the dye, and
/// camera paths on shared wavelengths see it.
#[test]
#[ignore = "slow: 12 seconds of CPU time"]
fn photons_and_paths_agree_on_a_dye_behind_a_prism() {
    let mut scene = tank(0.0, &json!({ "lines": [{ "nm": 450, "power": 1 }] }));
    scene["camera"] = json!({ "from": [0, 0.2, 5], "at": [0, 0.05, 2.5], "lens": { "pinhole": { "fov": 12 } } });
    scene["materials"]["flint"] = glass("N-SF11");
    let prism = json!({ "shape": { "prism": { "side": 1.2, "length": 2, "apex": 30 } }, "material": "flint",
                        "transform": [{ "translate": [0, 0.1, 2.5] }] });
    scene["objects"].as_array_mut().expect("a list").push(prism);
    scene["film"] = json!({ "width": 16, "height": 16 });
    assert_eq!(job(&scene).plan.wavelengths, WavelengthPlan::Both);
    let take = colour_blocks(8);
    let path = Measured::new(&scene, (Integrator::Path, 512), 100..108, &take);
    let photon = Measured::extrapolated_photons(&scene, 0.06, 32, &take);
    assert_same("dye behind a prism, photon against path", &photon, &path, 2e-2);
}

/// Without fluorescence, the dye absorbs light and emits nothing.
#[test]
fn a_forbidden_dye_absorbs_without_emission() {
    let mut scene = tank(0.0, &lamp());
    scene["objects"].as_array_mut().expect("a list").remove(1);
    assert!(render(&scene, Integrator::Photon, 2).picture.mean_y() > 0.0);
    let dark = render(&with_setting(&scene, "forbid", json!(["fluorescence"])), Integrator::Photon, 2);
    assert_eq!(dark.picture.mean_y(), 0.0);
    assert!(dark.ledger.absorbed_inside > 0.0 && dark.ledger.stokes_loss == 0.0, "{:?}", dark.ledger);
}

/// A picture with a dye does not depend on the number of threads.
#[test]
fn a_dye_is_the_same_on_any_number_of_threads() {
    let scene = tank(0.3, &lamp());
    let xyz = |threads: u64| render(&with_setting(&scene, "threads", threads), Integrator::Photon, 2).picture.xyz;
    assert_eq!(xyz(1), xyz(3));
}
