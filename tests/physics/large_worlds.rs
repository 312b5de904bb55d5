//! Small glass in a large world: the picture does not depend on the size of the world around it, or
//! on the position of the glass in it.

use crate::common::compare::{Measured, assert_same};
use crate::common::{diffuse, glass, mean_y, render, with_setting};
use crate::furnace::surroundings;
use abbe_session::render::Integrator;
use serde_json::{Value, json};

/// A glass ball of radius 1 m above a square ground, seen from above. The picture shows 6 m × 6 m
/// of the ground around the ball. `world_m` is the side of the ground, and the ball is at (x, z).
fn ball(light: &Value, world_m: f64, [x, z]: [f64; 2]) -> Value {
    json!({
        "camera": { "from": [x, 20, z], "at": [x, 0, z], "up": [0, 0, -1], "lens": { "pinhole": { "fov": 17.06 } } },
        "film": { "width": 16, "height": 16 },
        "materials": { "glass": glass(1.5), "ground": diffuse(0.5) },
        "objects": [
            { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "material": "glass",
              "transform": [{ "translate": [x, 1.2, z] }] },
            { "name": "ground", "shape": { "rectangle": { "width": world_m, "height": world_m } }, "material": "ground" }
        ],
        "lights": [light], "render": { "photons": 10000 }
    })
}

/// The world is up to 10⁶ times as large as the ball, and the ball may be far from its centre. The
/// path tracer, whose paths start at the camera, is the reference. The median over several seeds
/// does not contain rare bright pixels from many reflections inside the ball.
#[test]
#[ignore = "nightly: 20 seconds of CPU time"]
fn a_caustic_does_not_depend_on_the_world_around_it() {
    let sun = json!({ "directional": { "toward": [0.6, -1, 0], "spectrum": "E", "illuminance": 1000,
                                       "angular_diameter": 9 } });
    let truth = mean_y(&render(&ball(&sun, 200.0, [0.0, 0.0]), Integrator::Path, 4096))[0];
    for (world_m, at) in [(200.0, [0.0, 0.0]), (20e3, [7000.0, -5000.0]), (2e6, [3e5, -1e5])] {
        let scene = ball(&sun, world_m, at);
        let of_seed = |seed: u64| mean_y(&render(&with_setting(&scene, "seed", seed), Integrator::Photon, 16))[0];
        let mut means: Vec<f64> = (0..3).map(of_seed).collect();
        means.sort_by(f64::total_cmp);
        let ratio = means[1] / truth;
        println!("world of {world_m} m, ball at {at:?}: photon/path {ratio:.4}");
        assert!((ratio - 1.0).abs() < 0.015, "{world_m} m, {at:?}: {ratio}");
    }
}

/// A lamp in the world of a bright sun still gets its share of the photons.
#[test]
#[ignore = "nightly: 7 seconds of CPU time"]
fn a_lamp_beside_the_sun_keeps_its_caustic() {
    let lamp = json!({ "point": { "at": [0, 4, 0], "spectrum": "E", "luminous_flux": 5000 } });
    let lit = |world_m, lights: &[&Value]| {
        let mut scene = ball(&lamp, world_m, [0.0, 0.0]);
        scene["lights"] = json!(lights);
        mean_y(&render(&scene, Integrator::Photon, 8))[0]
    };
    let alone = lit(12.0, &[&lamp]);
    // This sun lights the far side of the ground from below, where no camera looks.
    let sun = json!({ "directional": { "toward": [0, 1, 0.2], "spectrum": "E", "illuminance": 1000 } });
    let both = lit(20e3, &[&lamp, &sun]);
    println!("lamp beside the sun: {:.4} of the lamp alone", both / alone);
    assert!((both / alone - 1.0).abs() < 0.015, "{both} and {alone}");
}

/// A specular object that no light reaches is named.
#[test]
fn glass_without_light_is_named() {
    let lamp = json!({ "point": { "at": [0, 4, 0], "spectrum": "E", "luminous_flux": 5000 } });
    let mut scene = ball(&lamp, 12.0, [0.0, 0.0]);
    scene["materials"]["black"] = diffuse(0.0);
    for (name, y) in [("hidden glass", -2.0), ("cover", -3.0)] {
        let (shape, material) = match name {
            "cover" => (json!({ "rectangle": { "width": 50, "height": 50 } }), "black"),
            _ => (json!({ "sphere": { "radius": 0.5 } }), "glass"),
        };
        let object =
            json!({ "name": name, "shape": shape, "material": material, "transform": [{ "translate": [0, y, 0] }] });
        scene["objects"].as_array_mut().unwrap().push(object);
    }
    let notes = render(&scene, Integrator::Photon, 1).stats.notes;
    assert!(notes.len() == 1 && notes[0].contains("\"hidden glass\""), "{notes:?}");
}

/// The camera sees 1 cm of a wall of 200 m. No photon of a pass lands there.
#[test]
fn indirect_light_is_seen_on_a_wall_close_to_the_camera() {
    let scene = json!({
        "camera": { "from": [3, 5, 99.98], "at": [3, 5, 100], "lens": { "pinhole": { "fov": 30 } } },
        "film": { "width": 4, "height": 4 },
        "materials": { "white": diffuse(0.6) },
        "objects": [{ "shape": { "box": { "size": [200, 200, 200] } }, "material": "white" }],
        "lights": [{ "point": { "at": [20, 40, -30], "spectrum": "E", "luminous_flux": 1e8 } }],
        "render": { "photons": 20000 }
    });
    let photon = Measured::new(&scene, (Integrator::Photon, 24), 0..6, mean_y);
    let path = Measured::new(&scene, (Integrator::Path, 256), 10..16, mean_y);
    assert_same("a wall close to the camera", &photon, &path, 0.06);
}

/// White fog above white ground in uniform surroundings of radiance 1. The camera is in the fog,
/// and it sees a small part of the ground. Few photons come near the camera.
#[test]
#[ignore = "slow: 5 seconds of CPU time"]
fn a_camera_in_the_fog_of_a_large_world_sees_a_furnace() {
    let scene = json!({
        "camera": { "from": [0, 1, 0], "at": [0, 0, 0], "up": [0, 0, 1], "lens": { "pinhole": { "fov": 10 } } },
        "film": { "width": 2, "height": 2 },
        "media": { "fog": { "homogeneous": { "scattering": 0.3, "absorption": 0, "phase": "isotropic" } } },
        "materials": { "ground": diffuse(1) },
        "objects": [{ "shape": { "rectangle": { "width": 20, "height": 20 } }, "material": "ground" }],
        "lights": surroundings(), "atmosphere": "fog", "render": { "photons": 5000 }
    });
    let measured = Measured::new(&scene, (Integrator::Photon, 32), 0..8, mean_y);
    let (mean, error) = (measured.mean(0), measured.error(0));
    println!("furnace of fog in a large world: {mean:.3} ± {error:.3}");
    assert!(error < 0.1, "too noisy to tell");
    assert!((mean - 1.0).abs() < 0.2, "{mean}");
}

/// The camera sees the lower half of a white sphere above a white ground of 1 km, under a sky. Most
/// of the light comes from the ground below the sphere. Of the photons that arrive far away, few
/// are scattered to the sphere, and they must not carry most of the power.
#[test]
#[ignore = "nightly: 8 seconds of CPU time"]
fn ground_around_the_view_lights_a_sphere() {
    let scene = json!({
        "camera": { "from": [0, 0.1, 1], "at": [0, 0.8, 0], "lens": { "pinhole": { "fov": 20 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "white": diffuse(0.7) },
        "objects": [
            { "shape": { "sphere": { "center": [0, 0.8, 0], "radius": 0.3 } }, "material": "white" },
            { "shape": { "rectangle": { "width": 1000, "height": 1000 } }, "material": "white" }
        ],
        "lights": [{ "environment": { "spectrum": "E", "illuminance": 1000 } }],
        "render": { "photons": 5000 }
    });
    let photon = Measured::new(&scene, (Integrator::Photon, 8), 0..12, mean_y);
    let path = Measured::new(&scene, (Integrator::Path, 256), 20..28, mean_y);
    assert_same("a sphere above a large ground", &photon, &path, 0.08);
}

/// Fog above a white ground of 100 m, seen by a camera that looks at the horizon. The ground far
/// from the fog also lights the fog. Few photons that arrive there are scattered to the fog, and
/// they must not be so heavy that most pixels are too dark. The median of the pixels shows this.
#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn distant_ground_lights_a_body_of_fog() {
    let scene = json!({
        "camera": { "from": [0, 1.4, 2.6], "at": [0, 0.45, 0], "lens": { "pinhole": { "fov": 39 } } },
        "film": { "width": 12, "height": 8 },
        "media": { "fog": { "homogeneous": { "scattering": 0.1, "absorption": 0, "phase": "isotropic" } } },
        "materials": { "ground": diffuse(0.5), "fog": { "boundary": { "medium": "fog" } } },
        "objects": [
            { "shape": { "disk": { "radius": 100 } }, "material": "ground" },
            { "shape": { "box": { "size": [2, 2, 2] } }, "material": "fog", "transform": [{ "translate": [0, 1.2, 0] }] }
        ],
        "lights": [{ "directional": { "toward": [0.2, -1, -0.3], "spectrum": "D65", "illuminance": 10000,
                                      "angular_diameter": 30 } }],
        "render": { "photons": 5000 }
    });
    let pixels = |integrator, passes| -> Vec<f64> {
        render(&scene, integrator, passes).picture.xyz.iter().map(|pixel| pixel[1]).collect()
    };
    let truth = pixels(Integrator::Path, 2000);
    let mut ratios: Vec<f64> = pixels(Integrator::Photon, 60).iter().zip(&truth).map(|(y, truth)| y / truth).collect();
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    println!("fog above a large ground: median photon/path {median:.4}");
    assert!((median - 1.0).abs() < 0.01, "{median}");
}
