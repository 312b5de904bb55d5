//! The light that the surfaces of a camera lens reflect: losses and ghosts against closed forms,
//! and the two integrators.

use crate::common::compare::{Measured, assert_same};
use crate::common::{colour_blocks, diffuse, glass, render, with_setting};
use abbe_session::render::Integrator;
use serde_json::{Value, json};

const LINES_NM: [f64; 3] = [450.0, 550.0, 650.0];

/// The index of the plate.
const PLATE: f64 = 3.0;

/// Uniform light of a spectral line, seen through a plate in front of a lens. The lens has an index
/// near 1, so it reflects less than 10⁻⁵ of the light. `coating` covers both faces of the plate.
/// `keys` are added to the lens system.
fn plate(nm: f64, coating: Option<&Value>, keys: &Value) -> Value {
    let surface = |radius: f64, thickness: f64, ior: f64, semi: f64| json!({ "radius_mm": radius, "thickness_mm": thickness, "ior": ior, "semi_aperture_mm": semi });
    let mut surfaces = [
        surface(0.0, 3.0, PLATE, 30.0),
        surface(0.0, 2.0, 1.0, 30.0),
        surface(10.0, 1.0, 1.005, 2.0),
        surface(-10.0, 0.0, 1.0, 2.0),
    ];
    surfaces[3]["stop"] = json!(true);
    if let Some(coating) = coating {
        surfaces[..2].iter_mut().for_each(|surface| surface["coating"] = coating.clone());
    }
    let mut lens = json!({ "prescription": { "surfaces": surfaces }, "focus_distance": 100, "sensor_height_mm": 10 });
    keys.as_object().into_iter().flatten().for_each(|(key, value)| lens[key] = value.clone());
    json!({
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1], "lens": { "system": lens } },
        "film": { "width": 8, "height": 8 },
        "materials": { "grey": diffuse(0.5) },
        "objects": [ { "shape": { "sphere": { "radius": 0.1, "center": [0, 0, 5] } }, "material": "grey" } ],
        "lights": [ { "environment": { "spectrum": { "lines": [{ "nm": nm, "power": 1 }] }, "irradiance": 1 } } ],
        // The same samples with and without ghosts, so that their noise cancels.
        "render": { "photons": 100, "camera_samples": 1 }
    })
}

fn mean_y(scene: &Value, integrator: Integrator) -> f64 {
    let xyz = render(scene, integrator, 64).picture.xyz;
    xyz.iter().map(|xyz| xyz[1]).sum::<f64>() / xyz.len() as f64
}

/// Returns the reflectance of layers (index, thickness in nm) on the plate at normal incidence. The
/// first layer is outside. The characteristic matrices are those of Born & Wolf, §1.6.2.
fn reflectance(layers: &[(f64, f64)], nm: f64) -> f64 {
    // The diagonal of each matrix is real, and the other elements are imaginary.
    let (mut a, mut b, mut c, mut d) = (1.0, 0.0, 0.0, 1.0);
    for &(n, thickness_nm) in layers {
        let (sin, cos) = (std::f64::consts::TAU * n * thickness_nm / nm).sin_cos();
        (a, b) = (a * cos - b * n * sin, a * sin / n + b * cos);
        (c, d) = (c * cos + d * n * sin, d * cos - c * sin / n);
    }
    let (electric, magnetic) = ((a, b * PLATE), (d * PLATE, c));
    let modulus = |x: f64, y: f64| x * x + y * y;
    modulus(electric.0 - magnetic.0, electric.1 - magnetic.1)
        / modulus(electric.0 + magnetic.0, electric.1 + magnetic.1)
}

/// Relative to the lens without losses, the image has the irradiance T². The ghost of the plate has
/// R² times the irradiance of the image, for each colour, without and with a coating.
#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn a_plate_has_the_image_and_the_ghost_of_a_closed_form() {
    let layers = [(1.5, 120.0), (2.4, 50.0)];
    let films = json!({ "layers": layers.map(|(n, nm)| json!({ "ior": n, "thickness_nm": nm })) });
    for (integrator, lines_nm) in [(Integrator::Photon, &LINES_NM[..]), (Integrator::Path, &LINES_NM[1..2])] {
        for &nm in lines_nm {
            let ideal = mean_y(&plate(nm, None, &json!({})), integrator);
            for (name, coating, layers) in [("bare", None, &[][..]), ("coated", Some(&films), &layers)] {
                let keys = |ghosts: bool| json!({ "transmission": "fresnel", "ghosts": ghosts });
                let image = mean_y(&plate(nm, coating, &keys(false)), integrator);
                let ghost = mean_y(&plate(nm, coating, &keys(true)), integrator) - image;
                let r = reflectance(layers, nm);
                let (t2, ratio) = (image / ideal, ghost / image);
                println!(
                    "{name} plate at {nm} nm, {integrator:?}: T² {t2:.6}, ghost/image {ratio:.6}, R² {:.6}",
                    r * r
                );
                assert!((t2 / ((1.0 - r) * (1.0 - r)) - 1.0).abs() < 1e-4, "{name}, {nm} nm: {t2}");
                assert!((ratio / (r * r) - 1.0).abs() < 0.01, "{name}, {nm} nm: {ratio}");
            }
        }
    }
}

/// Both integrators agree through a lens with ghosts, with a lamp in the field and a diffuse floor.
#[test]
#[ignore = "slow: a minute of CPU time"]
fn photons_and_paths_agree_through_a_lens_with_ghosts() {
    let films = json!({ "layers": [{ "ior": "MgF2", "thickness_nm": 100 }] });
    let lens = json!({ "system": { "prescription": "double-gauss", "focus_distance": 3, "f_number": 2,
                                   "sensor_height_mm": 24, "coating": films, "ghosts": true } });
    let scene = json!({
        "camera": { "from": [0, 0.5, 3], "at": [0, 0, 0], "lens": lens },
        "film": { "width": 24, "height": 16 },
        "materials": { "grey": diffuse(0.5), "flint": glass("SF10"), "black": "absorber" },
        "objects": [
            { "shape": { "rectangle": { "width": 6, "height": 6 } }, "material": "grey", "transform": [ { "translate": [0, -0.3, 0] } ] },
            { "shape": { "sphere": { "radius": 0.08, "center": [-0.05, -0.1, 0] } }, "material": "flint" },
            { "shape": { "sphere": { "radius": 0.1, "center": [0.2, 0.2, 0] } }, "material": "black", "emission": { "spectrum": "D65", "luminance": 1000 } }
        ],
        "render": { "photons": 20000 }
    });
    let take = colour_blocks(8);
    let path = Measured::new(&scene, (Integrator::Path, 512), 100..108, &take);
    let photon = Measured::new(&scene, (Integrator::Photon, 128), 0..8, &take);
    assert_same("through a lens with ghosts, photon against path", &photon, &path, 0.02);
}

/// The plan contains ghosts only if the scene asks for them. Forbidden effects leave the picture of
/// a lens without them.
#[test]
fn ghosts_and_coatings_of_a_lens_are_planned() {
    let films = json!({ "layers": [{ "ior": 2.2, "thickness_nm": 90 }] });
    let fresnel = json!({ "transmission": "fresnel" });
    let ghosts = json!({ "ghosts": true });
    let coated = plate(550.0, Some(&films), &ghosts);
    let run = |scene: &Value| render(scene, Integrator::Photon, 2);
    let (found, absent) = (run(&coated), run(&plate(550.0, None, &fresnel)));
    for name in ["ghosts", "thin-films"] {
        let [on, off] = [&found, &absent].map(|rendered| &rendered.stats.effects[name]);
        assert!(on.state == "on" && on.events > 0, "{name}");
        assert!(off.state == "off" && off.events == 0, "{name}");
    }
    let forbidden = |names: &[&str]| run(&with_setting(&coated, "forbid", names)).picture.xyz;
    assert_eq!(run(&plate(550.0, Some(&films), &json!({}))).picture.xyz, forbidden(&["ghosts"]));
    assert_eq!(run(&plate(550.0, None, &ghosts)).picture.xyz, forbidden(&["thin-films"]));
    assert_eq!(absent.picture.xyz, forbidden(&["ghosts", "thin-films"]));
    assert_ne!(run(&plate(550.0, None, &json!({}))).picture.xyz, absent.picture.xyz);
}
