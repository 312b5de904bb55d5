//! Surfaces with thin films: golden colours, conservation of energy, Newton's rings, and the two
//! integrators.

use crate::common::near::{assert_near, number};
use crate::common::{diffuse, overhead_camera, render, with_setting};
use crate::furnace;
use crate::golden::golden;
use crate::textures::{assert_integrators_agree, assert_integrators_agree_after};
use abbe_session::render::Integrator;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// Returns the mean of XYZ over a picture.
fn mean(pixels: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|c| pixels.iter().map(|xyz| xyz[c]).sum::<f64>() / pixels.len() as f64)
}

/// A horizontal square of a material under a ceiling of 100 cd/m², seen at an angle of incidence.
fn under_a_ceiling(material: &Value, shape: &Value, degrees: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!({
        "camera": { "from": [-10.0 * sin, 10.0 * cos, 0], "at": [0, 0, 0], "up": [0, sin, 1],
                    "lens": { "pinhole": { "fov": 0.1 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "coated": material, "black": "absorber" },
        "objects": [
            { "shape": shape, "material": "coated", "transform": [{ "translate": [0, -0.5, 0] }] },
            { "shape": { "rectangle": { "width": 400, "height": 400 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 100 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 20, 0] } ] }
        ],
        "render": { "photons": 100 }
    })
}

/// The rendered reflection of a ceiling has the golden colour: xy within 0.002 and Y within 0.5 %.
#[test]
fn rendered_films_have_their_golden_colours() {
    let file = golden("thin_film.json");
    let glass = |stack: &Value| json!({ "dielectric": { "ior": "N-BK7", "absorption": 1e5, "coating": stack } });
    let soap = |nm: f64| json!({ "thin_film": { "layers": [{ "ior": "water", "thickness_nm": nm }] } });
    let mgf2 = json!({ "layers": [{ "ior": "MgF2", "thickness_nm": 99.7456873132 }] });
    let tio2 = json!({ "cauchy": { "a": 2.21, "b": 0.045 } });
    let titanium = json!({ "conductor": { "metal": "Ti", "coating": {
        "layers": [{ "ior": tio2, "thickness_nm": 40 }] } } });
    let (sheet, block) = (json!({ "rectangle": { "width": 9, "height": 9 } }), json!({ "box": { "size": [9, 1, 9] } }));
    let cases = [
        ("soap_film_in_air", "water 200 nm", 0.0, soap(200.0), &sheet),
        ("soap_film_in_air", "water 400 nm", 45.0, soap(400.0), &sheet),
        ("antireflection", "MgF2 (o) quarter wave at 550 nm on N-BK7", 60.0, glass(&mgf2), &block),
        ("oxide_on_metal", "TiO2 film (model) 40 nm on Ti", 60.0, titanium, &sheet),
    ];
    for (section, name, degrees, material, shape) in cases {
        let case = file[section].as_array().unwrap().iter().find(|case| case["case"] == name).unwrap();
        let colours = case["colour"].as_array().unwrap();
        let colour = colours.iter().find(|colour| colour["light"] == "D65" && number(&colour["angle_deg"]) == degrees);
        let known = &colour.unwrap()["reflected"];
        for integrator in [Integrator::Photon, Integrator::Path] {
            let scene = under_a_ceiling(&material, shape, degrees);
            let found = mean(&render(&scene, integrator, 96).picture.xyz).map(|value| value / 100.0);
            let (total, y) = (found.iter().sum::<f64>(), number(&known["XYZ"][1]));
            println!("{name}, {degrees}°, {integrator:?}: Y {:.5} for {y:.5}, {found:?}", found[1]);
            // The path tracer reflects few of its paths at a film that transmits most of the light.
            let tolerance = if integrator == Integrator::Photon { 1.0 } else { 6.0 };
            assert_near(name, [found[0] / total, found[1] / total], &known["xy"], 2e-3 * tolerance);
            assert_near(name, found[1], y, 5e-3 * tolerance * y);
        }
    }
}

/// Checks that a ball of a coated material reflects and transmits all light.
fn check_furnace(name: &str, material: &Value, [photons, paths]: [u64; 2]) {
    let scene = json!({
        "camera": { "from": [0, 0.4, 3], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "coated": material },
        "objects": [{ "shape": { "sphere": { "radius": 0.8 } }, "material": "coated" }],
        "lights": furnace::surroundings(),
        "render": { "photons": 100 }
    });
    furnace::check(name, &scene, (Integrator::Photon, photons));
    furnace::check(name, &scene, (Integrator::Path, paths));
}

/// A coated ball, a bubble and a coated pane reflect and transmit all light.
#[test]
#[ignore = "nightly: 19 seconds of CPU time"]
fn clear_films_are_furnaces() {
    let (indices, thicknesses) = ([2.35, 1.38], [58.5, 99.6]);
    let layer = |i: usize| json!({ "ior": indices[i % 2], "thickness_nm": thicknesses[i % 2] });
    let mirror: Vec<Value> = (0..8).map(layer).collect();
    let varied = json!({ "gradient": { "a": 50, "b": 1200, "power": 0.5 } });
    let bubble = json!({ "thin_film": { "layers": [{ "ior": "water", "thickness_nm": varied }] } });
    for (name, material) in [
        ("dichroic ball", json!({ "dielectric": { "ior": "F2", "coating": { "layers": mirror } } })),
        ("dichroic pane", json!({ "thin_dielectric": { "ior": 1.5, "coating": { "layers": mirror } } })),
        ("bubble", bubble),
    ] {
        check_furnace(name, &material, [16, 128]);
    }
}

#[test]
#[ignore = "slow: 6 seconds of CPU time"]
fn clear_films_on_frosted_glass_are_furnaces() {
    let layers = json!([{ "ior": 2.35, "thickness_nm": 60 }, { "ior": "MgF2", "thickness_nm": 100 }]);
    let frosted = json!({ "dielectric": { "ior": 1.5, "roughness": 0.4, "coating": { "layers": layers } } });
    check_furnace("frosted coated ball", &frosted, [48, 256]);
}

/// Light reaches the floor through and from coated balls, films and panes.
fn coated_still_life(coated: &Value, silvered: &Value) -> Value {
    let bubble = json!({ "thin_film": { "layers": [
        { "ior": "water", "thickness_nm": { "gradient": { "a": 100, "b": 900 } } } ] } });
    json!({
        "camera": { "from": [0, 2.2, 5], "at": [0.2, 0.6, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 32 } } },
        "film": { "width": 32, "height": 32 },
        "materials": { "grey": diffuse(0.6), "black": "absorber", "coated": coated, "silvered": silvered, "bubble": bubble },
        "objects": [
            { "shape": { "rectangle": { "width": 12, "height": 12 } }, "material": "grey" },
            { "shape": { "sphere": { "radius": 0.7, "center": [-0.75, 0.71, 0] } }, "material": "coated" },
            { "shape": { "sphere": { "radius": 0.7, "center": [0.85, 0.71, 0] } }, "material": "bubble" },
            { "shape": { "sphere": { "radius": 0.5, "center": [0.1, 0.51, 1.1] } }, "material": "silvered" },
            { "shape": { "disk": { "radius": 1.8 } }, "material": "black",
              "emission": { "spectrum": "D65", "luminance": 10 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [-0.4, 2.8, 0] } ] }
        ],
        "render": { "photons": 8000 }
    })
}

#[test]
#[ignore = "slow: 12 seconds of CPU time"]
fn photons_and_paths_agree_on_coated_glass_and_a_bubble() {
    let layers = json!([{ "ior": 2.35, "thickness_nm": 58.5 }, { "ior": 1.38, "thickness_nm": 99.6 },
                        { "ior": 2.35, "thickness_nm": 58.5 }]);
    let plain = json!({ "dielectric": { "ior": 1.5, "coating": { "layers": layers } } });
    let silvered =
        json!({ "dielectric": { "ior": "F2", "coating": { "layers": [{ "ior": "Ag", "thickness_nm": 15 }] } } });
    assert_integrators_agree(
        "coated glass, silvered dispersive glass and a bubble",
        &coated_still_life(&plain, &silvered),
    );
}

#[test]
#[ignore = "slow: 40 seconds of CPU time"]
fn photons_and_paths_agree_on_frosted_coated_glass() {
    let layers = json!([{ "ior": 2.35, "thickness_nm": 58.5 }, { "ior": 1.38, "thickness_nm": 99.6 },
                        { "ior": 2.35, "thickness_nm": 58.5 }]);
    let frosted = json!({ "dielectric": { "ior": 1.5, "roughness": 0.5, "coating": { "layers": layers } } });
    let silvered = json!({ "dielectric": { "ior": "F2", "roughness": 0.3,
                           "coating": { "layers": [{ "ior": "Ag", "thickness_nm": 15 }] } } });
    let scene = with_setting(&coated_still_life(&frosted, &silvered), "photons", 32000);
    assert_integrators_agree_after(16, "frosted coated glass", &scene, 1.5e-2);
}

/// A gap of air between a lens of radius 10 m and a plate, in the light of a line. The phase of the
/// fringes grows with r²/(λR), so the radii follow from the frequency with which the reflection
/// varies over r².
#[test]
fn newton_s_rings_have_their_radii() {
    let line = &golden("thin_film.json")["newton_rings"][0]["lines"][0];
    let (nm, known_mm) = (number(&line["wavelength_nm"]), number(&line["dark_radius_mm"][9]));
    let (pixels, side_mm) = (160, 16.0);
    // The gap is 3.2 µm wide at the rim of the disk, at a radius of 8 mm.
    let gap = json!({ "gradient": { "a": 0, "b": 3200, "power": 2, "radial": true } });
    let scene = json!({
        "unit": "mm",
        "camera": overhead_camera([0.0, 0.0], 4000.0, side_mm),
        "film": { "width": pixels, "height": pixels },
        "materials": { "glass": { "dielectric": { "ior": "N-BK7" } }, "black": "absorber",
                       "gap": { "thin_film": { "layers": [{ "ior": "air", "thickness_nm": gap }] } } },
        "objects": [
            { "shape": { "box": { "size": [30, 8, 30] } }, "material": "glass" },
            { "shape": { "disk": { "radius": 8 } }, "material": "gap" },
            { "shape": { "rectangle": { "width": 1000, "height": 1000 } }, "material": "black",
              "emission": { "spectrum": { "lines": [{ "nm": nm, "power": 1, "fwhm_nm": 0.001 }] }, "luminance": 100 },
              "transform": [ { "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 5000, 0] } ] }
        ],
        "render": { "photons": 100 }
    });
    let picture = render(&scene, Integrator::Photon, 4).picture;
    let samples: Vec<(f64, f64)> = (0..pixels * pixels)
        .map(|i| {
            let place = |index: usize| ((index as f64 + 0.5) / pixels as f64 - 0.5) * side_mm;
            let (x, y) = (place(i % pixels), place(i / pixels));
            (x * x + y * y, picture.xyz[i][1])
        })
        .filter(|(squared, _)| *squared < 7.5 * 7.5)
        .collect();
    let level = samples.iter().map(|(_, y)| y).sum::<f64>() / samples.len() as f64;
    let strength = |radius_mm: f64| {
        let (mut sin, mut cos) = (0.0, 0.0);
        for (squared, y) in &samples {
            let phase = TAU * 10.0 * squared / (radius_mm * radius_mm);
            sin += (y - level) * phase.sin();
            cos += (y - level) * phase.cos();
        }
        sin.hypot(cos)
    };
    let candidates = (0..400).map(|i| known_mm * (0.96 + 2e-4 * f64::from(i)));
    let found = candidates.max_by(|a, b| strength(*a).total_cmp(&strength(*b))).unwrap();
    println!("radius of the tenth dark ring: {found:.4} mm for {known_mm:.4} mm");
    assert_near("radius", found, known_mm, 5e-3 * known_mm);
}
