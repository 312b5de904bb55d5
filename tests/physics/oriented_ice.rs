//! Ice crystals that prefer an orientation: photons against paths, uniform surroundings, and the
//! places of sundogs in a picture.

use crate::common::compare::{Measured, assert_differs, assert_same};
use crate::common::{all_y, block_means, example, render};
use crate::furnace::{self, surroundings};
use abbe_optics::glass::RefractiveIndex;
use abbe_session::render::{Integrator, Rendered};
use glam::DVec3;
use serde_json::{Value, json};

const FILM: usize = 16;
const BLOCK: usize = 8;

fn plates(tilt: f64) -> Value {
    json!({ "ice_crystals": [{ "orientation": "plates", "tilt": tilt }] })
}

/// A ball of crystals in the light of a lamp beside it, or in uniform surroundings.
fn ball(phase: &Value, scattering: f64, lights: &Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 4], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 24 } } },
        "film": { "width": FILM, "height": FILM },
        "media": { "dust": { "homogeneous": { "absorption": 0, "scattering": scattering, "phase": phase } } },
        "materials": { "dust": { "boundary": { "medium": "dust" } } },
        "objects": [{ "shape": { "sphere": { "radius": 0.8 } }, "material": "dust" }],
        "lights": lights,
        "render": { "photons": 20000, "radius": 0.1 }
    })
}

fn lamp() -> Value {
    json!([{ "point": { "at": [1.4, 0.9, 0.3], "spectrum": "E", "luminous_intensity": 1 } }])
}

fn blocks(rendered: &Rendered) -> Vec<f64> {
    block_means(&all_y(rendered), FILM, BLOCK, &[true; FILM * FILM])
}

/// Light of a lamp at a finite distance, scattered once and more often, by photons and by paths. No
/// light is in the forward peak at the camera, where single photons are bright.
#[test]
#[ignore = "slow: three minutes of CPU time"]
fn photons_and_paths_agree_in_level_plates() {
    let scene = ball(&plates(4.0), 0.4, &lamp());
    let path = Measured::new(&scene, (Integrator::Path, 256), 100..108, blocks);
    let photon = Measured::extrapolated_photons(&scene, 0.1, 96, blocks);
    assert_same("level plates, photons against paths", &photon, &path, 3e-2);
    let random = ball(&json!("ice"), 0.4, &lamp());
    let random = Measured::new(&random, (Integrator::Path, 256), 100..108, blocks);
    assert_differs("level plates, mutant", &photon, &random);
}

/// No light is lost, and uniform light stays uniform, although the cross-sections of plates and
/// columns depend on the direction.
#[test]
#[ignore = "nightly: 20 seconds of CPU time"]
fn uniform_light_stays_uniform_in_oriented_crystals() {
    let phase = json!({ "ice_crystals": [{ "orientation": "plates" }, { "orientation": "columns" },
                                         { "orientation": "random" }] });
    furnace::check("oriented crystals", &ball(&phase, 1.0, &surroundings()), (Integrator::Path, 192));
}

/// Renders the sky of the example scene beside the sun, along a strip of constant elevation, at one
/// wavelength. Returns the azimuth from the sun at which the sundog has half its luminance.
fn inner_edge(nm: f64, height_deg: f64, around_deg: f64) -> f64 {
    const COLUMNS: usize = 120;
    const ROWS: usize = 3;
    const WIDTH_DEG: f64 = 6.0;
    let mut scene = example("sundogs");
    let from = DVec3::new(0.0, 2.0, 0.0);
    let towards = |elevation: f64, azimuth: f64| {
        let (up, level) = elevation.to_radians().sin_cos();
        let (x, z) = azimuth.to_radians().sin_cos();
        DVec3::new(level * x, up, -level * z)
    };
    let sun = -towards(height_deg, 0.0);
    scene["lights"] = json!([{ "directional": { "toward": sun.to_array(), "irradiance": 1,
                                                "spectrum": { "lines": [{ "nm": nm, "power": 1 }] } } }]);
    let at = from + towards(height_deg, around_deg);
    scene["camera"] = json!({ "from": from.to_array(), "at": at.to_array(),
                              "lens": { "pinhole": { "fov": WIDTH_DEG * height_deg.to_radians().cos() / 40.0 } } });
    scene["film"] = json!({ "width": COLUMNS, "height": ROWS });
    scene["objects"].as_array_mut().expect("objects").retain(|object| object["name"] == "dust");
    let grid = scene["media"].as_object_mut().expect("media").values_mut().next().expect("a medium");
    grid["grid"]["phase"] = plates(0.02);
    scene["render"] = json!({ "photons": 100, "forbid": ["photon-beams", "indirect"] });
    let rendered = render(&scene, Integrator::Photon, 16);
    let values = all_y(&rendered);
    let camera = &crate::common::job(&scene).scene.camera;
    let mut columns: Vec<(f64, f64)> = (0..COLUMNS)
        .map(|column| {
            let ray = camera.ray(glam::DVec2::new(column as f64 + 0.5, 0.5 * ROWS as f64), [0.5; 2]).direction;
            let azimuth = ray.x.atan2(-ray.z).to_degrees();
            (azimuth, (0..ROWS).map(|row| values[row * COLUMNS + column]).sum())
        })
        .collect();
    columns.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * columns.iter().map(|column| column.1).fold(0.0, f64::max);
    let after = columns.iter().position(|column| column.1 > half).expect("a sundog").max(1);
    let ((a, low), (b, high)) = (columns[after - 1], columns[after]);
    a + (b - a) * (half - low) / (high - low)
}

/// Bravais' law (1847), in the picture of the sky.
#[test]
#[ignore = "nightly: 10 seconds of CPU time"]
fn sundogs_are_beside_the_sun_where_bravais_law_has_them() {
    let ice = RefractiveIndex::catalogue("ice -7C").expect("ice is in the catalogue");
    let nm = 530.0;
    for height in [0.5_f64, 10.0, 20.0, 30.0, 45.0] {
        let (sin, cos) = height.to_radians().sin_cos();
        let effective = (ice.n(nm).powi(2) - sin * sin).sqrt() / cos;
        let known = 2.0 * (0.5 * effective).asin().to_degrees() - 60.0;
        let edge = inner_edge(nm, height, known + 0.5);
        println!("sundog, sun at {height}°: the edge is at {edge:.3}°, Bravais {known:.3}°");
        assert!((edge - known).abs() < 0.075, "{edge}° for {known}°");
    }
}
