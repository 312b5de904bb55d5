//! Crystals that split each ray: the places and the polarisation of double images against golden
//! values, furnaces, and photons against paths.

use crate::common::near::number;
use crate::common::{all_y, render};
use crate::furnace;
use crate::golden::golden;
use crate::polarised_light::polariser;
use crate::textures::assert_integrators_agree_after;
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// The width of the picture in mm and in pixels.
const WIDTH_MM: f64 = 8.0;
const COLUMNS: usize = 200;

/// A narrow glowing line below a plate of 10 mm, seen in parallel rays with the incidence of a
/// golden row, in the plane of the optic axis.
fn plate(row: &Value) -> Value {
    let angle = |key: &str| number(&row[key]).to_radians();
    let (axis_sin, axis_cos) = angle("axis_from_normal_deg").sin_cos();
    let (sin, cos) = angle("incidence_deg").sin_cos();
    let exits = ["o_exit_mm", "e_exit_mm"].map(|key| number(&row[key][0]) * 10.0 / number(&row["thickness_mm"]));
    let between = 0.5 * (exits[0] + exits[1]);
    let crystal = json!({ "crystal": { "name": row["crystal"], "axis": [axis_sin, axis_cos, 0] } });
    json!({
        "unit": "mm",
        "camera": { "from": [-100.0 * sin, 100.0 * cos, 0], "at": [0, 0, 0], "up": [0, 0, -1],
                    "lens": { "orthographic": { "height": WIDTH_MM * 2.0 / COLUMNS as f64 } } },
        "film": { "width": COLUMNS, "height": 2 },
        "materials": { "crystal": crystal, "black": "absorber" },
        "objects": [
            { "shape": { "rectangle": { "width": 0.1, "height": 10 } }, "material": "black",
              "emission": { "spectrum": { "lines": [{ "nm": row["wavelength_nm"], "power": 1 }] }, "luminance": 1 },
              "transform": [{ "translate": [between - 5.0 * sin / cos, -5.001, 0] }] },
            { "shape": { "box": { "size": [40, 10, 20] } }, "material": "crystal" }
        ],
        "lights": [],
        "render": { "photons": 100 }
    })
}

/// Returns the mean place of the light in mm, and its sum.
fn centroid(scene: &Value, integrator: Integrator) -> (f64, f64) {
    let values = all_y(&render(scene, integrator, 16));
    let sum: f64 = values.iter().sum();
    let moment: f64 = values.iter().enumerate().map(|(i, y)| ((i % COLUMNS) as f64 + 0.5) * y).sum();
    (moment / sum * WIDTH_MM / COLUMNS as f64, sum)
}

/// The two images of a line are as far apart as the golden values say, and each is polarised
/// completely: a filter along the plane of the axis shows the extraordinary one alone.
#[test]
fn double_images_have_their_golden_places_and_polarisations() {
    let rows = golden("birefringence.json")["double_image"].as_array().expect("rows").clone();
    let in_plane = rows.iter().filter(|row| number(&row["azimuth_deg"]) == 0.0);
    let mut count = 0;
    for (i, row) in in_plane.enumerate() {
        let cos = number(&row["incidence_deg"]).to_radians().cos();
        let known = -number(&row["displacement_mm"][0]) * cos * 10.0 / number(&row["thickness_mm"]);
        // The path tracer takes longer, so it renders two of the rows.
        let integrators = [Integrator::Photon, Integrator::Path];
        for integrator in integrators.into_iter().take(if [1, 6].contains(&i) { 2 } else { 1 }) {
            let seen = |axis: Option<f64>| {
                let mut scene = plate(row);
                if let Some(axis) = axis {
                    scene["camera"]["filter"] = polariser(axis);
                }
                centroid(&scene, integrator)
            };
            let [extraordinary, ordinary] = [0.0, 90.0].map(|axis| seen(Some(axis)));
            let shift = extraordinary.0 - ordinary.0;
            println!("{integrator:?}, {row}: {shift:.4} mm for {known:.4}");
            assert!((shift - known).abs() < 0.01, "{row}: {shift} mm for {known}");
            if i == 0 {
                let sum = (extraordinary.1 + ordinary.1) / seen(None).1;
                assert!((sum - 1.0).abs() < 0.06, "the filters show {sum} of the light");
            }
        }
        count += 1;
    }
    assert!(count >= 7, "{count}");
}

/// A polariser between the line and the plate leaves one image, and a filter across it none.
#[test]
fn polarised_light_makes_one_image() {
    let row = &golden("birefringence.json")["double_image"][0];
    for integrator in [Integrator::Photon, Integrator::Path] {
        let seen = |below: f64, filter: Option<f64>| {
            let mut scene = plate(row);
            scene["materials"]["sheet"] = polariser(below);
            let sheet = json!({ "shape": { "rectangle": { "width": 40, "height": 20 } }, "material": "sheet",
                                "transform": [{ "translate": [0, -5.0005, 0] }] });
            scene["objects"].as_array_mut().expect("objects").push(sheet);
            if let Some(axis) = filter {
                scene["camera"]["filter"] = polariser(axis);
            }
            centroid(&scene, integrator)
        };
        let [extraordinary, ordinary] = [0.0, 90.0].map(|below| seen(below, None));
        let known = -number(&row["displacement_mm"][0]);
        assert!((extraordinary.0 - ordinary.0 - known).abs() < 0.01, "{extraordinary:?} {ordinary:?} {known}");
        let across = seen(0.0, Some(90.0)).1;
        assert!(across < 1e-6 * extraordinary.1, "{across} of {}", extraordinary.1);
    }
}

/// Crystals keep no light and add none, whatever waves it takes inside.
fn furnace_of(name: &str, (integrator, passes): (Integrator, u64)) {
    let scene = json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 20 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "crystal": { "crystal": { "name": name, "axis": [1, 2, 3] } } },
        "objects": [{ "shape": { "sphere": { "radius": 0.8 } }, "material": "crystal" }],
        "lights": furnace::surroundings(), "render": { "photons": 100 }
    });
    furnace::check(&format!("{name} ball"), &scene, (integrator, passes));
}

#[test]
fn a_ball_of_calcite_is_a_furnace() {
    furnace_of("calcite", (Integrator::Photon, 64));
}

#[test]
#[ignore = "nightly: 20 seconds of CPU time"]
fn balls_of_crystals_are_furnaces() {
    furnace_of("calcite", (Integrator::Path, 1024));
    furnace_of("rutile", (Integrator::Photon, 128));
}

/// Photons that pass a crystal light a floor as camera paths find it, also between two crystals and
/// behind a filter.
#[test]
#[ignore = "nightly: 40 seconds of CPU time"]
fn photons_and_paths_agree_on_crystals() {
    let calcite = |axis: [f64; 3]| json!({ "crystal": { "name": "calcite", "axis": axis } });
    let materials = json!({ "a": calcite([1.0, 1.0, 0.0]), "b": calcite([0.3, 0.0, 1.0]), "p": polariser(20.0),
                            "grey": { "diffuse": { "reflectance": 0.3 } }, "black": "absorber" });
    let block = |height: f64, material: &str| {
        json!({ "shape": { "box": { "size": [0.5, 0.3, 0.5] } }, "material": material,
                "transform": [{ "rotate": { "axis": [1, 0, 2], "degrees": 12 } }, { "translate": [0.1, height, 0] }] })
    };
    let sheet = json!({ "shape": { "rectangle": { "width": 3, "height": 3 } }, "material": "p",
                        "transform": [{ "translate": [0, 1.2, 0] }] });
    let lamp = json!({ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "black",
                       "emission": { "spectrum": "E", "luminance": 100 },
                       "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 180 } }, { "translate": [0, 1.6, 0] }] });
    let floor = json!({ "shape": { "rectangle": { "width": 2, "height": 2 } }, "material": "grey" });
    for (name, objects) in [
        ("a block of calcite", vec![block(0.8, "a")]),
        ("two blocks behind a filter", vec![sheet, block(0.95, "a"), block(0.6, "b")]),
    ] {
        let scene = json!({
            "camera": { "from": [0, 0.4, 0], "at": [0, 0, 0], "up": [0, 0, 1], "lens": { "pinhole": { "fov": 60 } } },
            "film": { "width": 16, "height": 16 },
            "materials": materials,
            "objects": objects.into_iter().chain([floor.clone(), lamp.clone()]).collect::<Vec<_>>(),
            "render": { "photons": 20000 }
        });
        assert_integrators_agree_after(16, name, &scene, 2e-2);
    }
}
