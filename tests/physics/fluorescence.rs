//! Fluorescence: golden values, conservation of energy, and the two integrators.

use crate::common::compare::{Measured, assert_same};
use crate::common::near::{assert_near, number};
use crate::common::{colour_blocks, diffuse, glass, job, overhead_camera, render, with_setting};
use crate::golden::golden;
use crate::textures::assert_integrators_agree;
use abbe_optics::bsdf::Fluorescent;
use abbe_optics::donaldson::DonaldsonMatrix;
use abbe_optics::fluorophore::Fluorophore;
use abbe_session::render::Integrator;
use abbe_spectra::spectrum::{Observer, Outside, Spectrum};
use abbe_transport::plan::WavelengthPlan;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;

/// Returns the golden material of this name.
fn golden_material(name: &str) -> Value {
    let file = golden("fluorescence.json");
    let materials = file["materials"].as_array().expect("a list of materials");
    materials.iter().find(|material| material["name"] == name).expect("a golden material").clone()
}

/// Returns the table of a golden material as a spectrum of a scene file.
fn table(material: &Value, key: &str) -> Value {
    json!({ "table": { "nm": material[key]["nm"], "values": material[key]["values"] } })
}

/// Returns a golden material as a material of a scene file. The name `grey R` is a diffuse material
/// of reflectance R.
pub(crate) fn material(name: &str) -> Value {
    if let Some(reflectance) = name.strip_prefix("grey ") {
        return diffuse(reflectance.parse::<f64>().expect("a reflectance"));
    }
    let golden = golden_material(name);
    json!({ "fluorescent": {
        "reflectance": table(&golden, "substrate_reflectance"), "absorptance": table(&golden, "absorptance"),
        "emission": table(&golden, "emission_photons_per_nm"), "quantum_yield": golden["quantum_yield"]
    } })
}

/// Returns a golden material as a measured matrix. The files contain q a(λ_i) λ_i e(λ_o)/λ_o at the
/// wavelengths of the golden tables. A script computed them from the golden file.
fn matrix_material(name: &str) -> Value {
    let known = surface(name);
    let nm: Vec<f64> = (360..=830).map(f64::from).collect();
    let reflected: Vec<f64> = nm.iter().map(|nm| known.reflected_fraction(*nm)).collect();
    let matrix = format!("golden/{}", matrix_file(name));
    json!({ "bispectral": { "reflectance": { "table": { "nm": nm, "values": reflected } }, "matrix": matrix } })
}

fn matrix_file(name: &str) -> &'static str {
    match name {
        "yellow phosphor" => "bispectral_yellow_phosphor.csv",
        "red day-glow" => "bispectral_red_day_glow.csv",
        "optical brightener on paper" => "bispectral_brightener.csv",
        _ => panic!("{name} has no matrix"),
    }
}

/// Returns the light of a golden case as a spectrum of a scene file.
pub(crate) fn light(name: &str) -> Value {
    let line = |nm: f64, power: f64| json!({ "nm": nm, "power": power });
    if name.starts_with("low-pressure sodium") {
        return json!({ "lines": [line(588.995, 2.0), line(589.5924, 1.0)] });
    }
    match name.strip_prefix("line ") {
        Some(rest) => json!({ "lines": [line(rest.trim_end_matches(" nm").parse().expect("a wavelength"), 1.0)] }),
        None => json!(name),
    }
}

/// Returns the fluorescent surface of a golden material.
fn surface(name: &str) -> Fluorescent {
    let golden = golden_material(name);
    let spectrum = |key: &str, outside: Outside| {
        let list = |key: &Value| key.as_array().expect("a list").iter().map(number).collect::<Vec<f64>>();
        Spectrum::table(&list(&golden[key]["nm"]), &list(&golden[key]["values"]), outside).expect("a spectrum")
    };
    let emission = spectrum("emission_photons_per_nm", Outside::Zero);
    let absorptance = spectrum("absorptance", Outside::Zero);
    let fluorophore = Fluorophore::new(absorptance, &emission, number(&golden["quantum_yield"]));
    let substrate = spectrum("substrate_reflectance", Outside::Hold);
    Fluorescent::new(substrate, fluorophore.expect("a fluorophore")).expect("a surface")
}

/// Returns the wavelengths and powers of a golden light: samples at whole nanometres from
/// `from_nm`, or lines.
fn samples(name: &str, from_nm: u32) -> Vec<(f64, f64)> {
    let spectrum = light(name);
    match spectrum["lines"].as_array() {
        Some(lines) => lines.iter().map(|line| (number(&line["nm"]), number(&line["power"]))).collect(),
        None => {
            let spectrum = abbe::spectrum_by_name(name).expect("a lamp of the library");
            (from_nm..=830).map(|nm| (f64::from(nm), spectrum.at(f64::from(nm)))).collect()
        }
    }
}

/// Returns the golden cases of a section.
pub(crate) fn all_cases(section: &str) -> Vec<Value> {
    golden("fluorescence.json")[section].as_array().expect("a list of cases").clone()
}

/// Returns the golden cases of a section whose band begins at 360 nm.
pub(crate) fn cases(section: &str) -> Vec<Value> {
    all_cases(section).into_iter().filter(|case| case["band_from_nm"] == 360).collect()
}

/// Forbids ultraviolet light, which a golden case with a band from 360 nm does not contain.
pub(crate) fn without_ultraviolet(scene: &Value) -> Value {
    with_setting(scene, "forbid", json!(["ultraviolet"]))
}

pub(crate) fn text(value: &Value) -> &str {
    value.as_str().expect("a text")
}

#[test]
fn bispectral_factors_are_golden() {
    let file = golden("fluorescence.json");
    let mut compared = 0;
    for case in file["bispectral_samples"].as_array().expect("a list of cases") {
        let surface = surface(text(&case["material"]));
        let list = |key: &str| case[key].as_array().expect("a list").iter().map(number).collect::<Vec<f64>>();
        for (i, &from) in list("excitation_nm").iter().enumerate() {
            for (j, &to) in list("emission_nm").iter().enumerate() {
                let known = number(&case["phi_per_nm"][i][j]);
                let found = surface.fluorophore.bispectral_factor(from, to);
                assert!((found - known).abs() <= 1e-6 * known.max(1e-3), "{from} to {to} nm: {found} for {known}");
                compared += usize::from(known > 0.0);
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

/// The file with the matrix of a golden material describes the same fluorophore.
#[test]
fn a_matrix_equals_its_factorised_material() {
    for name in ["yellow phosphor", "red day-glow", "optical brightener on paper"] {
        let known = surface(name).fluorophore;
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(matrix_file(name));
        let matrix = DonaldsonMatrix::read(&path).expect("a matrix");
        let found = Fluorophore::of_matrix(&matrix).expect("a fluorophore");
        let mut largest = 0.0_f64;
        for from in 300..=620 {
            let from = f64::from(from);
            for to in (380..=820).step_by(7).map(f64::from) {
                let factors = [&found, &known].map(|fluorophore| fluorophore.bispectral_factor(from, to));
                assert!((factors[0] - factors[1]).abs() < 1e-7, "{name}, {from} to {to} nm: {factors:?}");
                largest = largest.max(factors[1]);
            }
            let [emitted, expected] = [&found, &known].map(|fluorophore| fluorophore.emitted_fraction(from));
            assert!((emitted - expected).abs() < 1e-6, "{name}, {from} nm: {emitted} for {expected}");
            let [stokes, expected] = [&found, &known].map(|fluorophore| fluorophore.losses(from).stokes);
            assert!((stokes - expected).abs() < 1e-6, "{name}, {from} nm: {stokes} for {expected}");
        }
        assert!(largest > 1e-3, "{name}: {largest}");
    }
}

/// The model on the grid of the golden file: colours and energies of one reflection.
#[test]
fn one_reflection_is_golden() {
    let observer = Observer::cie1931();
    for case in all_cases("single_reflection") {
        let (name, lamp) = (text(&case["material"]), text(&case["light"]));
        let from_nm = case["band_from_nm"].as_u64().expect("a whole number") as u32;
        let (surface, light) = (surface(name), samples(lamp, from_nm));
        let incident: f64 = light.iter().map(|(_, power)| power).sum();
        let sum = |of: &dyn Fn(f64) -> f64| light.iter().map(|(nm, power)| power * of(*nm)).sum::<f64>();
        let [emission] = surface.fluorophore.emissions() else { panic!("one emission") };
        let excitation = sum(&|nm| emission.excitation(nm));
        let white = sum(&|nm| observer.xyz_bar(nm)[1]);
        let xyz: [f64; 3] = std::array::from_fn(|c| {
            let reflected = sum(&|nm| surface.reflected_fraction(nm) * observer.xyz_bar(nm)[c]);
            let grid = (360..=830).map(f64::from);
            let emitted: f64 = grid.map(|nm| emission.emitted(nm) * observer.xyz_bar(nm)[c]).sum();
            (reflected + excitation * emitted) / white
        });
        let label = format!("{name} under {lamp} from {from_nm} nm");
        // The golden file divides by all light. Abbe's powers are those of the band from 360 nm.
        let stated: f64 = light.iter().filter(|(nm, _)| *nm >= 360.0).map(|(_, power)| power).sum();
        let per_watt: [f64; 3] = std::array::from_fn(|c| xyz[c] * white / stated);
        let known = case["XYZ_per_incident_watt"].as_array().expect("a colour");
        let known: Vec<f64> = known.iter().map(|value| number(value) * incident / stated).collect();
        assert_near(&label, per_watt, &known, 3e-6 * known[1].max(1.0));
        assert_near(&label, xyz, &case["XYZ"], 3e-6 * number(&case["XYZ"][1]).max(1.0));
        let losses = |of: &dyn Fn(f64) -> f64| sum(of) / incident;
        for (key, found) in [
            ("reflected", losses(&|nm| surface.reflected_fraction(nm))),
            ("absorbed_by_fluorophore", losses(&|nm| surface.fluorophore.absorptance(nm))),
            ("reemitted", losses(&|nm| surface.fluorophore.emitted_fraction(nm))),
            ("stokes_loss", losses(&|nm| surface.fluorophore.losses(nm).stokes)),
            ("quantum_loss", losses(&|nm| surface.fluorophore.losses(nm).quantum)),
            ("absorbed_by_substrate", losses(&|nm| surface.absorbed_by_substrate(nm))),
        ] {
            // The sum over e(λ)/λ of the golden file has steps of 1 nm; here, it is an integral.
            assert_near(&format!("{label}: {key}"), found, number(&case["energy"][key]), 2e-6);
        }
    }
}

/// A horizontal square of a golden material under a uniform sky of this spectrum, seen from above.
/// A perfect diffuser would have the luminance 1.
pub(crate) fn under_a_sky(material: &Value, lamp: &str) -> Value {
    json!({
        "camera": overhead_camera([0.0, 0.0], 4.0, 1.0),
        "film": { "width": 16, "height": 16 },
        "materials": { "sample": material },
        "objects": [{ "shape": { "rectangle": { "width": 9, "height": 9 } }, "material": "sample" }],
        "lights": [{ "environment": { "spectrum": light(lamp), "illuminance": PI } }],
        "render": { "photons": 100 }
    })
}

/// Renders single reflections and compares XYZ with the golden values.
fn check_rendered_colours(material: impl Fn(&str) -> Value, chosen: impl Fn(&str, &str, u64) -> bool) {
    for case in all_cases("single_reflection") {
        let (name, lamp) = (text(&case["material"]), text(&case["light"]));
        let from_nm = case["band_from_nm"].as_u64().expect("a whole number");
        if !chosen(name, lamp, from_nm) {
            continue;
        }
        let mut scene = under_a_sky(&material(name), lamp);
        if from_nm == 360 {
            scene = without_ultraviolet(&scene);
        }
        for integrator in [Integrator::Photon, Integrator::Path] {
            let take = |rendered: &abbe_session::render::Rendered| {
                let xyz = &rendered.picture.xyz;
                (0..3).map(|c| xyz.iter().map(|pixel| pixel[c]).sum::<f64>() / xyz.len() as f64).collect::<Vec<_>>()
            };
            let passes = if integrator == Integrator::Path { 256 } else { 32 };
            let measured = Measured::new(&scene, (integrator, passes), 0..4, take);
            let found: Vec<f64> = (0..3).map(|c| measured.mean(c)).collect();
            println!("{name} under {lamp} from {from_nm} nm, {integrator:?}: {found:?} for {:?}", case["XYZ"]);
            let largest = case["XYZ"].as_array().expect("a colour").iter().map(number).fold(0.0, f64::max);
            assert_near(name, &found, &case["XYZ"], 5e-3 * largest);
        }
    }
}

#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn rendered_fluorescence_has_golden_colours() {
    check_rendered_colours(material, |name, lamp, from_nm| {
        matches!(
            (name, lamp, from_nm),
            ("red day-glow", "D65", 360)
                | ("yellow phosphor", "line 450 nm", 360)
                | ("optical brightener on paper", "line 405 nm", 360)
                | ("optical brightener on paper", "D65", 300)
        )
    });
}

#[test]
#[ignore = "slow: all golden lights"]
fn rendered_fluorescence_has_golden_colours_in_all_lights() {
    check_rendered_colours(material, |_, _, _| true);
}

#[test]
#[ignore = "nightly: 13 seconds of CPU time"]
fn a_rendered_matrix_has_golden_colours() {
    check_rendered_colours(matrix_material, |name, lamp, _| {
        matches!((name, lamp), ("red day-glow", "D65") | ("optical brightener on paper", "line 405 nm"))
    });
}

#[test]
#[ignore = "slow: all golden lights"]
fn a_rendered_matrix_has_golden_colours_in_all_lights() {
    // The matrix files begin at 360 nm.
    check_rendered_colours(matrix_material, |_, _, from_nm| from_nm == 360);
}

/// A sphere with an isotropic point light of 1 W in its centre. Its wall is a mixture of the
/// materials of a golden case.
pub(crate) fn sphere(case: &Value, material: impl Fn(&str) -> Value) -> Value {
    let walls = case["walls"].as_array().expect("a list of walls");
    let mut materials = serde_json::Map::new();
    let mut parts = Vec::new();
    for (i, wall) in walls.iter().enumerate() {
        materials.insert(format!("m{i}"), material(text(&wall["material"])));
        parts.push(json!({ "material": format!("m{i}"), "weight": wall["area_fraction"] }));
    }
    materials.insert("wall".into(), json!({ "mix": parts }));
    json!({
        "camera": { "from": [0.3, 0.2, 0.1], "at": [-1, -0.3, 0.2], "lens": { "pinhole": { "fov": 60 } } },
        "film": { "width": 16, "height": 16 },
        "materials": materials,
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "wall" }],
        "lights": [{ "point": { "at": [0, 0, 0], "spectrum": light(text(&case["light"])), "power": 1 } }],
        "render": { "photons": 20000, "radius": 0.1 }
    })
}

/// Returns the mean XYZ of the walls of a golden sphere, in cd/m².
fn xyz_of_walls(case: &Value) -> [f64; 3] {
    let mut mean = [0.0; 3];
    let walls = case["walls"].as_array().expect("a list of walls");
    for (wall, seen) in walls.iter().zip(case["wall_radiance"].as_array().expect("a list of radiances")) {
        let (share, y) = (number(&wall["area_fraction"]), number(&seen["luminance_cd_m2"]));
        if y > 0.0 {
            let (x, big_y) = (number(&seen["xy"][0]), number(&seen["xy"][1]));
            let xyz = [x / big_y * y, y, (1.0 - x - big_y) / big_y * y];
            (0..3).for_each(|c| mean[c] += share * xyz[c]);
        }
    }
    mean
}

/// Renders golden spheres. Light is reflected and emitted many times there. A matrix does not
/// contain the quantum yield, so its ledger has no quantum loss.
fn check_spheres(material: fn(&str) -> Value, chosen: &[usize], passes: u64) {
    for (i, case) in cases("integrating_spheres").iter().enumerate().filter(|(i, _)| chosen.contains(i)) {
        let known = xyz_of_walls(case);
        for integrator in [Integrator::Photon, Integrator::Path] {
            let scale = if integrator == Integrator::Path { 16 } else { 1 };
            let rendered = render(&without_ultraviolet(&sphere(case, material)), integrator, scale * passes);
            let xyz = &rendered.picture.xyz;
            let found: [f64; 3] =
                std::array::from_fn(|c| xyz.iter().map(|pixel| pixel[c]).sum::<f64>() / xyz.len() as f64);
            println!("sphere {i}, {integrator:?}: {found:?} for {known:?}");
            let largest = known.into_iter().fold(0.0, f64::max);
            assert_near(&format!("sphere {i}, {integrator:?}"), found, known, 1.5e-2 * largest);
            if integrator == Integrator::Photon {
                let ledger = &rendered.ledger;
                assert!(ledger.balance().abs() < 1e-9, "{ledger:?}");
                assert!(ledger.sampling.abs() < 0.02, "{ledger:?}");
                let is_matrix = std::ptr::fn_addr_eq(material, matrix_material as fn(&str) -> Value);
                assert!(ledger.stokes_loss > 0.01 && (ledger.quantum_loss > 0.01) != is_matrix, "{ledger:?}");
            }
        }
    }
}

#[test]
fn golden_spheres_have_their_colours() {
    check_spheres(material, &[0, 3], 12);
}

/// A photon selects one of the emissions of a matrix.
#[test]
#[ignore = "nightly: 6 seconds of CPU time"]
fn golden_spheres_of_matrices_have_their_colours() {
    check_spheres(matrix_material, &[0], 12);
}

#[test]
#[ignore = "slow: all golden spheres"]
fn all_golden_spheres_have_their_colours() {
    check_spheres(material, &[0, 1, 2, 3, 4, 5, 6], 128);
}

/// All light of a beam meets a fluorescent floor once. The ledger contains the golden fractions of
/// the energy.
#[test]
fn the_ledger_contains_stokes_loss_and_quantum_loss() {
    let case = cases("single_reflection")
        .into_iter()
        .find(|case| text(&case["material"]) == "yellow phosphor" && text(&case["light"]) == "D65");
    let case = case.expect("a golden case");
    let scene = json!({
        "camera": overhead_camera([0.0, 0.0], 4.0, 1.0),
        "film": { "width": 8, "height": 8 },
        "materials": { "sample": material("yellow phosphor") },
        "objects": [{ "shape": { "rectangle": { "width": 9, "height": 9 } }, "material": "sample" }],
        "lights": [{ "spot": { "at": [0, 3, 0], "to": [0, 0, 0], "half_angle": 20, "spectrum": "D65", "power": 1 } }],
        "render": { "photons": 20000 }
    });
    let ledger = render(&scene, Integrator::Photon, 8).ledger;
    assert!(ledger.balance().abs() < 1e-9, "{ledger:?}");
    let energy = |key: &str| number(&case["energy"][key]);
    for (name, found, known) in [
        ("Stokes loss", ledger.stokes_loss, energy("stokes_loss")),
        ("quantum loss", ledger.quantum_loss, energy("quantum_loss")),
        ("substrate", ledger.absorbed.iter().sum(), energy("absorbed_by_substrate")),
    ] {
        assert_near(name, found, known, 1e-2 * known);
    }
    assert_near("escaped", ledger.escaped, energy("reflected") + energy("reemitted"), 5e-3);
}

/// A still life of fluorescent surfaces: a glass ball focuses light on one of them, and their light
/// reaches a grey wall.
pub(crate) fn still_life(ior: &str, lamp: Value) -> Value {
    json!({
        "camera": { "from": [0, 2.2, 5], "at": [0.2, 0.6, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 32, "height": 32 },
        "materials": { "floor": material("yellow phosphor"), "wall": diffuse(0.6), "black": "absorber",
                       "dye": material("red day-glow"), "glass": glass(ior) },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "floor" },
            { "shape": { "rectangle": { "width": 6, "height": 3 } }, "material": "wall",
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1.5, -1.5] } ] },
            { "shape": { "sphere": { "radius": 0.6, "center": [-0.7, 0.61, 0] } }, "material": "glass" },
            { "shape": { "box": { "size": [0.6, 0.8, 0.6] } }, "material": "dye",
              "transform": [ { "translate": [0.9, 0.4, 0] } ] },
            { "shape": { "disk": { "radius": 1.8 } }, "material": "black",
              "emission": { "spectrum": lamp, "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.8, 0] } ] }
        ],
        "render": { "photons": 8000 }
    })
}

#[test]
#[ignore = "slow: 7 seconds of CPU time; paper in ultraviolet light is compared by default"]
fn photons_and_paths_agree_on_fluorescent_surfaces() {
    let lamp = json!({ "mix": [{ "spectrum": "D65", "weight": 1 },
                               { "spectrum": { "lines": [{ "nm": 450, "power": 1 }] }, "weight": 20 }] });
    let plain = json!(1.5);
    let mut scene = still_life("N-BK7", lamp);
    scene["materials"]["glass"] = glass(plain);
    assert_integrators_agree("fluorescent surfaces", &scene);
}

/// The same surfaces with dispersive glass: a dye is seen through a ball of flint, and the ball
/// focuses the light of the dye. Photons of the shared set carry that light.
#[test]
#[ignore = "slow: 30 seconds of CPU time"]
fn photons_and_paths_agree_on_dyes_behind_dispersive_glass() {
    let scene = with_setting(&still_life("N-SF11", json!("D65")), "photons", 16000);
    assert_integrators_agree("dyes behind dispersive glass", &scene);
}

/// A grey floor in the light of a dye under a blue line, seen through a prism of flint glass. The
/// shared wavelengths of the emission differ from the wavelength of the lamp.
#[test]
#[ignore = "nightly: 18 seconds of CPU time"]
fn a_dye_seen_through_a_prism_keeps_its_energy() {
    let scene = json!({
        "camera": { "from": [-3.2, 1.25, 0], "at": [-2.5, 1.5, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 12 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "grey": diffuse(0.5), "black": "absorber", "flint": glass("N-SF11"),
                       "dye": material("yellow phosphor") },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 6 } }, "material": "dye" },
            { "shape": { "prism": { "side": 1, "length": 1, "apex": 45 } }, "material": "flint",
              "transform": [ { "translate": [-2.5, 1.5, 0] } ] },
            { "shape": { "box": { "size": [0.5, 0.5, 0.5] } }, "material": "grey",
              "transform": [ { "translate": [1.6, 0.25, 0] } ] },
            { "shape": { "disk": { "radius": 1 } }, "material": "black",
              "emission": { "spectrum": { "lines": [{ "nm": 450, "power": 1 }] }, "luminance": 100 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [1.6, 1.8, 0] } ] }
        ],
        "render": { "photons": 10000 }
    });
    // The lamp emits a single line, but the prism disperses the light of the dye.
    assert_eq!(job(&scene).plan.wavelengths, WavelengthPlan::Both);
    let take = colour_blocks(8);
    let path = Measured::new(&scene, (Integrator::Path, 256), 100..108, &take);
    let photon = Measured::extrapolated_photons(&scene, 0.06, 32, &take);
    assert_same("dye through a prism, photon against path", &photon, &path, 1.4e-2);
}

/// Fluorescence is an effect of the plan. If it is forbidden, the surfaces reflect without
/// emission.
#[test]
fn forbidden_fluorescence_leaves_the_reflection() {
    let case = cases("single_reflection")
        .into_iter()
        .find(|case| text(&case["material"]) == "red day-glow" && text(&case["light"]) == "D65");
    let scene = with_setting(&under_a_sky(&material("red day-glow"), "D65"), "forbid", json!(["fluorescence"]));
    let found = render(&scene, Integrator::Photon, 32).picture.mean_y();
    let known = number(&case.expect("a golden case")["XYZ_reflected_only"][1]);
    assert_near("reflected only", found, known, 5e-3 * known);
}

/// With spectral bands, each wavelength of each photon is evaluated. Without bands, the responses
/// of the sensor are tabulated. Both give the same picture, on any number of threads.
#[test]
#[ignore = "slow: 6 seconds of CPU time"]
fn bands_and_tables_see_the_same_fluorescence() {
    let case = &cases("integrating_spheres")[3];
    let tabulated = Measured::new(&sphere(case, material), (Integrator::Photon, 4), 0..4, colour_blocks(16));
    let mut with_bands = sphere(case, material);
    with_bands["film"]["spectral_bands"] = json!(12);
    let evaluated = Measured::new(&with_bands, (Integrator::Photon, 4), 100..104, colour_blocks(16));
    assert_same("bands against tables", &tabulated, &evaluated, 1.5e-2);
    let xyz = |threads: u64| render(&with_setting(&with_bands, "threads", threads), Integrator::Photon, 2).picture.xyz;
    assert_eq!(xyz(1), xyz(3));
}
