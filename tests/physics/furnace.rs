//! White furnaces: in uniform surroundings of radiance 1 without absorption, every pixel has
//! radiance 1.

use crate::common::compare::{Measured, compare_with};
use crate::common::{all_y, block_means, diffuse, glass, mean_y, render, with_setting};
use abbe_session::render::Integrator;
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer, planck};
use serde_json::{Value, json};

/// Renders, and checks that the mean luminance is 1 within 0.5 %, and that the four quarters of the
/// picture equal 1 within their noise.
pub(crate) fn check(name: &str, scene: &Value, (integrator, passes): (Integrator, u64)) {
    let width = scene["film"]["width"].as_u64().expect("a width") as usize;
    let whole_and_quarters = |rendered: &abbe_session::render::Rendered| {
        let mut values = vec![rendered.picture.mean_y()];
        values.extend(block_means(&all_y(rendered), width, width / 2, &vec![true; width * width]));
        values
    };
    let measured = Measured::new(scene, (integrator, passes), 0..8, whole_and_quarters);
    let found = compare_with(&measured, &[1.0; 5]);
    let (mean, error) = (measured.mean(0), measured.error(0));
    println!("furnace, {name}, {integrator:?}: {mean:.5} ± {error:.5}, {found}");
    assert!(error < 2e-3, "too noisy to tell");
    assert!((mean - 1.0).abs() < 5e-3, "{name}: {mean}");
    assert!(found.is_equal(), "{name}: {found}");
}

/// Renders with a few photons or passes, and checks that the mean luminance is 1 within
/// `tolerance`.
fn check_within(name: &str, scene: &Value, (integrator, passes): (Integrator, u64), tolerance: f64) {
    let measured = Measured::new(scene, (integrator, passes), 0..4, mean_y);
    let (mean, error) = (measured.mean(0), measured.error(0));
    println!("furnace, {name}, {integrator:?}: {mean:.4} ± {error:.4}");
    assert!(error < 0.4 * tolerance, "too noisy to tell");
    assert!((mean - 1.0).abs() < tolerance, "{name}: {mean}");
}

/// Uniform surroundings of luminance 1.
pub(crate) fn surroundings() -> Value {
    json!([{ "environment": { "spectrum": "E", "illuminance": std::f64::consts::PI } }])
}

/// Six walls that face inwards, with reflectance 0.5 and an emission of half the furnace's
/// radiance.
fn closed_box() -> Value {
    let turns = [
        json!([{ "translate": [0, -1, 0] }]),
        json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 1, 0] }]),
        json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -1] }]),
        json!([{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }, { "translate": [0, 0, 1] }]),
        json!([{ "rotate": { "axis": [0, 0, 1], "degrees": -90 } }, { "translate": [-1, 0, 0] }]),
        json!([{ "rotate": { "axis": [0, 0, 1], "degrees": 90 } }, { "translate": [1, 0, 0] }]),
    ];
    let walls: Vec<Value> = turns
        .into_iter()
        .map(|transform| {
            json!({ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "half", "transform": transform,
                    "emission": { "spectrum": "E", "luminance": 0.5 } })
        })
        .collect();
    json!({
        "camera": { "from": [0.1, 0.2, 0.6], "at": [0.2, -0.1, -1], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "half": diffuse(0.5) }, "objects": walls,
        "render": { "photons": 20000, "radius": 0.1 }
    })
}

#[test]
#[ignore = "nightly: 3 seconds of CPU time"]
fn a_closed_box_that_reflects_half_and_emits_half() {
    check("box", &closed_box(), (Integrator::Photon, 12));
    check("box", &closed_box(), (Integrator::Path, 64));
}

/// The closed box with four panels on each side. A point samples one of the 24 lights.
#[test]
fn a_closed_box_of_24_panels_is_a_furnace() {
    let mut scene = closed_box();
    let panels = |wall: &Value| {
        [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]].map(|[x, z]| {
            let mut panel = wall.clone();
            panel["shape"] = json!({ "rectangle": { "width": 1, "height": 1 } });
            let place = json!({ "translate": [x, 0, z] });
            panel["transform"].as_array_mut().expect("a list").insert(0, place);
            panel
        })
    };
    let all: Vec<Value> = scene["objects"].as_array().expect("walls").iter().flat_map(panels).collect();
    assert_eq!(all.len(), 24);
    scene["objects"] = json!(all);
    check_within("box of 24 panels", &with_setting(&scene, "photons", 5000), (Integrator::Photon, 16), 0.015);
    check_within("box of 24 panels", &scene, (Integrator::Path, 64), 0.015);
}

/// White fog in the closed box. Fog that scatters forward finds the glowing walls by scattered rays
/// and by shadow rays.
#[test]
#[ignore = "nightly: 3 seconds of CPU time"]
fn forward_scattering_fog_in_a_closed_box_is_a_furnace() {
    let mut scene = closed_box();
    scene["media"] = json!({ "fog": { "homogeneous": { "absorption": 0, "scattering": 0.7,
                                                       "phase": { "henyey_greenstein": { "g": 0.8 } } } } });
    scene["materials"]["fog"] = json!({ "boundary": { "medium": "fog" } });
    let fog = json!({ "shape": { "box": { "size": [1.8, 1.8, 1.8] } }, "material": "fog" });
    scene["objects"].as_array_mut().expect("walls").push(fog);
    check_within("box of fog", &scene, (Integrator::Path, 96), 0.015);
}

/// A closed box of glowing mirrors. Roulette ends most paths after 8 events (reflectance 0.7), or
/// after 32 events (reflectance 0.97).
#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn a_closed_box_of_mirrors_is_a_furnace() {
    for (reflectance, tolerance) in [(0.7, 0.03), (0.97, 0.06)] {
        let mut scene = closed_box();
        scene["materials"]["half"] = json!({ "mirror": { "reflectance": reflectance } });
        for wall in scene["objects"].as_array_mut().expect("walls") {
            wall["emission"]["luminance"] = json!(1.0 - reflectance);
        }
        scene["render"] = json!({ "photons": 100 });
        let name = format!("box of mirrors, {reflectance}");
        check_within(&name, &scene, (Integrator::Photon, 32), tolerance);
        check_within(&name, &scene, (Integrator::Path, 32), tolerance);
    }
}

/// A ball of glass and a white diffuse ball (albedo 1) beside it.
fn ball(ior: Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 26 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "glass": glass(ior) },
        "objects": [ { "shape": { "sphere": { "radius": 1 } }, "material": "glass" } ],
        "lights": surroundings(), "render": { "photons": 1000 }
    })
}

#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn a_ball_of_glass_in_uniform_surroundings() {
    check("ball, n = 1.5", &ball(json!(1.5)), (Integrator::Photon, 64));
    check("ball, n = 1.5", &ball(json!(1.5)), (Integrator::Path, 64));
}

#[test]
#[ignore = "nightly: 17 seconds of CPU time"]
fn a_dispersive_ball_of_glass_in_uniform_surroundings() {
    check("ball, SF10", &ball(json!("SF10")), (Integrator::Photon, 32));
    check("ball, SF10", &ball(json!("SF10")), (Integrator::Path, 512));
}

/// Camera paths pass a dark filter before they meet the glass. Their weight is then so small that
/// each path selects reflection or refraction.
#[test]
fn a_dispersive_block_behind_a_dark_filter_is_a_furnace() {
    let (mut scene, dark) = (ball(json!("SF10")), 0.005);
    scene["materials"]["filter"] =
        json!({ "thin_dielectric": { "ior": 1, "transmittance": { "cosine_polynomial": [dark] } } });
    scene["objects"] = json!([
        { "shape": { "box": { "size": [4, 4, 1] } }, "material": "glass",
          "transform": [{ "translate": [0, -0.5, 0] }, { "rotate": { "axis": [0, 1, 0], "degrees": 35 } }] },
        { "shape": { "rectangle": { "width": 0.1, "height": 0.1 } }, "material": "filter",
          "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, 4.9] }] }]);
    scene["lights"][0]["environment"]["illuminance"] = json!(std::f64::consts::PI / dark);
    scene["camera"]["lens"]["pinhole"]["fov"] = json!(16);
    check_within("block behind a filter, SF10", &scene, (Integrator::Photon, 96), 0.01);
}

/// The camera is inside a ball of rough glass. A shell with index 1 around the ball makes photons
/// carry the light. Inside glass of index n, a furnace of radiance 1/n² has the radiance 1.
#[test]
fn a_camera_in_rough_glass_sees_photons_from_outside() {
    let mut scene = ball(json!(1.5));
    scene["materials"]["glass"]["dielectric"]["roughness"] = json!(0.9);
    scene["materials"]["shell"] = glass(1.0);
    scene["objects"].as_array_mut().expect("objects").push(json!({
        "shape": { "sphere": { "radius": 1.3 } }, "material": "shell" }));
    scene["camera"] =
        json!({ "from": [0.1, 0.2, 0], "at": [1, 0.3, 0.2], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 60 } } });
    scene["lights"][0]["environment"]["illuminance"] = json!(std::f64::consts::PI / 2.25);
    scene["film"] = json!({ "width": 4, "height": 4 });
    scene["render"]["photons"] = json!(5000);
    check_within("inside a frosted ball", &scene, (Integrator::Photon, 16), 0.08);
}

/// A rough ball loses no light by scattering between its facets.
fn check_frosted(ior: f64, roughness: f64, photon_passes: u64, path_passes: u64) {
    let mut scene = ball(json!(ior));
    scene["materials"]["glass"]["dielectric"]["roughness"] = json!(roughness);
    check(&format!("frosted ball, n = {ior}"), &scene, (Integrator::Photon, photon_passes));
    check(&format!("frosted ball, n = {ior}"), &scene, (Integrator::Path, path_passes));
}

#[test]
#[ignore = "nightly: 13 seconds of CPU time"]
fn frosted_glass_in_uniform_surroundings_loses_no_light() {
    check_frosted(1.5, 0.6, 24, 96);
}

#[test]
#[ignore = "slow: light is reflected many times inside, so 8,000 passes are needed: 10 minutes"]
fn frosted_diamond_in_uniform_surroundings_loses_no_light() {
    check_frosted(2.4, 1.0, 8192, 8192);
}

/// A white diffuse core in a shell of glass, with or without an air gap. The core fills the
/// picture.
fn core_in_a_shell(ior: Value, core_radius: f64, gap: bool, fov: f64) -> Value {
    let mut objects = vec![
        json!({ "name": "shell", "shape": { "sphere": { "radius": 1 } }, "material": "glass" }),
        json!({ "name": "core", "shape": { "sphere": { "radius": core_radius } }, "material": "white" }),
    ];
    if gap {
        objects
            .push(json!({ "name": "gap", "shape": { "sphere": { "radius": core_radius + 0.1 } }, "material": "air" }));
    }
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": fov } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "glass": glass(ior), "white": diffuse(1), "air": { "dielectric": { "ior": 1, "priority": 1 } } },
        "objects": objects, "lights": surroundings(), "render": { "photons": 20000, "radius": 0.1 }
    })
}

#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn a_white_core_in_glass_lit_through_the_photon_map_only() {
    let scene = core_in_a_shell(json!(1.5), 0.5, false, 12.0);
    check("core in glass, n = 1.5", &scene, (Integrator::Photon, 4));
    check("core in glass, n = 1.5", &scene, (Integrator::Path, 16));
}

#[test]
#[ignore = "nightly: 7 seconds of CPU time"]
fn a_large_white_core_in_glass_whose_light_is_partly_shut_in() {
    // Beyond a core radius of 1/n, part of the light from the core is totally reflected back to it.
    let scene = core_in_a_shell(json!(1.5), 0.85, false, 16.0);
    check("large core in glass, n = 1.5", &scene, (Integrator::Photon, 9));
    check("large core in glass, n = 1.5", &scene, (Integrator::Path, 16));
}

#[test]
#[ignore = "slow: 8 seconds of CPU time"]
fn a_white_core_in_dispersive_glass_keeps_its_radiance() {
    let scene = core_in_a_shell(json!("SF10"), 0.5, false, 14.0);
    check("core in SF10", &with_setting(&scene, "photons", 10000), (Integrator::Photon, 64));
    check("core in SF10", &scene, (Integrator::Path, 512));
}

#[test]
#[ignore = "slow: 10 seconds of CPU time"]
fn a_white_core_behind_glass_and_air() {
    let scene = core_in_a_shell(json!(1.5), 0.5, true, 8.0);
    check("core behind glass and air", &scene, (Integrator::Photon, 10));
    check("core behind glass and air", &scene, (Integrator::Path, 16));
}

#[test]
#[ignore = "nightly: 16 seconds of CPU time"]
fn a_white_ball_and_a_ball_of_glass_in_uniform_surroundings() {
    // Shadow rays, connected photons (the caustic on the white ball) and the photon map (light
    // between the balls) add up to 1.
    let mut scene = ball(json!("N-BK7"));
    scene["materials"]["white"] = diffuse(1);
    scene["objects"] = json!([
        { "shape": { "sphere": { "radius": 1 } }, "material": "glass" },
        { "shape": { "sphere": { "radius": 1, "center": [1.4, 0, -1.6] } }, "material": "white" }
    ]);
    scene["render"] = json!({ "photons": 20000, "radius": 0.1 });
    check("white ball beside BK7", &scene, (Integrator::Photon, 24));
    check("white ball beside BK7", &scene, (Integrator::Path, 512));
}

/// A ball of glass that glows at the temperature of its surroundings vanishes: inside of the ball,
/// the radiance of a black body is n² B.
#[test]
fn glass_that_glows_like_its_surroundings_vanishes() {
    const KELVIN: f64 = 2000.0;
    let observer = Observer::cie1931();
    let per_nm = |nm: f64| planck(nm, KELVIN) * 1e-9 * observer.xyz_bar(nm)[1];
    let luminance = LUMENS_PER_WATT * (360..=830).map(f64::from).map(per_nm).sum::<f64>();
    let black_body = json!({ "blackbody": { "temperature": KELVIN } });
    for index in [1.0, 1.5, 2.0] {
        let scene = json!({
            "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 22 } } },
            "film": { "width": 8, "height": 8 },
            "media": { "hot": { "homogeneous": { "absorption": 2, "scattering": 0, "phase": "isotropic", "emission": black_body } } },
            "materials": { "hot": { "dielectric": { "ior": index, "medium": "hot" } } },
            "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "hot" }],
            "lights": [{ "environment": { "spectrum": black_body, "luminance": luminance } }],
            "render": { "photons": 1000 }
        });
        for (integrator, passes) in [(Integrator::Photon, 16), (Integrator::Path, 256)] {
            let mean = render(&scene, integrator, passes).picture.mean_y() / luminance;
            println!("glowing glass of index {index}, {integrator:?}: {mean:.4}");
            assert!((mean - 1.0).abs() < 0.02, "index {index}, {integrator:?}: {mean}");
        }
    }
}
