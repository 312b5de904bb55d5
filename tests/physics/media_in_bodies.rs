//! Media and the bodies that contain them: overlaps, liquids in glasses, lights and cameras inside,
//! compared with closed forms and uniform surroundings.

use crate::common::compare::Measured;
use crate::common::{diffuse, job, mean_y, render, with_setting};
use crate::furnace::{self, surroundings};
use abbe_session::render::Integrator;
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::PI;

const WAYS: [(Integrator, u64); 2] = [(Integrator::Photon, 16), (Integrator::Path, 512)];

fn absorbing(sigma: f64) -> Value {
    json!({ "homogeneous": { "absorption": sigma, "scattering": 0, "phase": "isotropic" } })
}

/// A camera at z = `from` that sees a small region straight ahead.
fn ahead(from: f64) -> Value {
    json!({ "from": [0, 0, from], "at": [0, 0, from - 1.0], "lens": { "pinhole": { "fov": 0.1 } } })
}

/// A box 10 m wide and high of this material, between these distances from the camera.
fn layer(material: &str, [near, far]: [f64; 2]) -> Value {
    let size = [10.0, 10.0, far - near];
    json!({ "shape": { "box": { "size": size } }, "material": material,
            "transform": [{ "translate": [0, 0, -0.5 * (near + far)] }] })
}

/// A bright wall 5 m from the camera, behind these materials and layers.
fn before_a_bright_wall(mut materials: Value, mut objects: Vec<Value>) -> Value {
    materials["black"] = json!("absorber");
    objects.push(json!({ "shape": { "rectangle": { "width": 10, "height": 10 } }, "material": "black",
                         "emission": { "spectrum": "E", "luminance": 1 },
                         "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -5] }] }));
    json!({
        "camera": ahead(0.0), "film": { "width": 4, "height": 4 },
        "media": { "near": absorbing(0.3), "far": absorbing(1.1) },
        "materials": materials, "objects": objects, "render": { "photons": 100 }
    })
}

/// Compares the luminance with Beer's law, for both integrators.
fn check_depth(name: &str, scene: &Value, depth: f64) {
    let truth = (-depth).exp();
    for way in [(Integrator::Photon, 4), (Integrator::Path, 512)] {
        let seen = Measured::new(scene, way, 0..16, mean_y);
        println!("{name}, {:?}: {:.6} ± {:.6} of {truth:.6}", way.0, seen.mean(0), seen.error(0));
        assert!(seen.error(0) < 3e-2 * truth, "too noisy to tell");
        assert!((seen.mean(0) - truth).abs() < (4.0 * seen.error(0)).max(1e-5 * truth), "{}", seen.mean(0));
    }
}

#[test]
fn overlapping_media_obey_priority_then_nesting() {
    let liquid =
        |medium: &str, priority: i32| json!({ "dielectric": { "ior": 1, "medium": medium, "priority": priority } });
    for (priorities, between) in [([1, 0], 0.3), ([0, 1], 1.1), ([0, 0], 1.1)] {
        let materials = json!({ "near": liquid("near", priorities[0]), "far": liquid("far", priorities[1]) });
        let scene = before_a_bright_wall(materials, vec![layer("near", [1.0, 3.0]), layer("far", [2.0, 4.0])]);
        check_depth(&format!("overlap {priorities:?}"), &scene, 0.3 + between + 1.1);
    }
}

#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn inner_bodies_displace_the_medium_around_them() {
    let materials = json!({ "near": { "boundary": { "medium": "near" } }, "far": { "boundary": { "medium": "far" } } });
    let inside = before_a_bright_wall(materials.clone(), vec![layer("near", [1.0, 4.0]), layer("far", [2.0, 3.0])]);
    check_depth("a medium inside another", &inside, 2.0 * 0.3 + 1.1);
    let mut air = before_a_bright_wall(materials, vec![layer("far", [2.0, 4.0])]);
    air["atmosphere"] = json!("near");
    check_depth("a body in the atmosphere", &air, 3.0 * 0.3 + 2.0 * 1.1);
    // The camera is inside both bodies.
    let around_the_camera = vec![layer("near", [-2.0, 3.0]), layer("far", [-1.0, 2.0])];
    for objects in [around_the_camera.clone(), around_the_camera.into_iter().rev().collect()] {
        let materials =
            json!({ "near": { "boundary": { "medium": "near" } }, "far": { "boundary": { "medium": "far" } } });
        check_depth("a camera in nested media", &before_a_bright_wall(materials, objects), 2.0 * 1.1 + 0.3);
    }
    // The camera is inside the body.
    air["objects"][0] = layer("far", [-2.0, 3.0]);
    check_depth("a camera in a body in the atmosphere", &air, 2.0 * 0.3 + 3.0 * 1.1);
}

/// The camera is in fog inside a coloured body. Each segment of the view is attenuated by the body
/// that contains the segment.
#[test]
fn a_camera_in_fog_inside_a_coloured_body_obeys_beer_s_law() {
    let materials = json!({ "near": { "boundary": { "medium": "near" } }, "coloured": { "dielectric": { "ior": 1, "absorption": 0.9 } } });
    let scene = before_a_bright_wall(materials, vec![layer("coloured", [-2.0, 4.0]), layer("near", [-1.0, 1.5])]);
    check_depth("a camera in fog inside a coloured body", &scene, 1.5 * 0.3 + 2.5 * 0.9);
}

/// A coloured liquid attenuates by its own absorption and by the medium that fills it.
#[test]
fn a_coloured_body_filled_with_a_medium_absorbs_by_both() {
    let materials = json!({ "both": { "dielectric": { "ior": 1, "absorption": 0.7, "medium": "near" } } });
    let scene = before_a_bright_wall(materials, vec![layer("both", [1.0, 3.0])]);
    check_depth("a coloured body with a medium", &scene, 2.0 * (0.3 + 0.7));
}

/// Hot gas in the middle of a larger body. A gas of optical depth τ and source radiance S has the
/// radiance S (1 − e^−τ).
#[test]
fn hot_gas_has_the_radiance_of_its_optical_depth() {
    const DEPTH: f64 = 1.2;
    let gas = json!({ "grid": { "bounds": [[-5, -5, -3.5], [5, 5, -2]], "density": { "constant": 1 },
        "absorption": DEPTH / 1.5, "scattering": 0, "phase": "isotropic", "emission": { "spectrum": 1, "radiance": 2 } } });
    let mut scene =
        before_a_bright_wall(json!({ "gas": { "boundary": { "medium": "gas" } } }), vec![layer("gas", [1.0, 4.5])]);
    scene["media"] = json!({ "gas": gas });
    let mut wall = scene.clone();
    wall["objects"].as_array_mut().expect("objects").remove(0);
    wall["objects"][0]["emission"] = json!({ "spectrum": 1, "radiance": 2 });
    scene["objects"].as_array_mut().expect("objects").pop();
    for way in [(Integrator::Photon, 16), (Integrator::Path, 512)] {
        let [gas, wall] = [&scene, &wall].map(|scene| Measured::new(scene, way, 0..8, mean_y));
        let (ratio, error) = (gas.mean(0) / wall.mean(0), gas.error(0) / wall.mean(0));
        println!("hot gas, {:?}: {ratio:.4} ± {error:.4}", way.0);
        assert!(error < 5e-3, "too noisy to tell");
        assert!((ratio + (-DEPTH).exp_m1()).abs() < 0.015, "{:?}: {ratio}", way.0);
    }
}

/// Half of a parallel beam starts inside a coloured body, 0.4 m before the face where it leaves.
#[test]
fn a_beam_that_starts_half_inside_a_body_is_half_absorbed() {
    const COEFFICIENT: f64 = 2.0;
    let scene = json!({
        "camera": { "from": [0, 3, 6], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 30 } } },
        "film": { "width": 4, "height": 4 },
        "materials": { "coloured": { "dielectric": { "ior": 1, "absorption": COEFFICIENT } }, "grey": diffuse(0.5) },
        "objects": [
            { "shape": { "box": { "size": [2, 1, 1] } }, "material": "coloured", "transform": [{ "translate": [1, 0, 0] }] },
            { "shape": { "rectangle": { "width": 9, "height": 9 } }, "material": "grey", "transform": [{ "translate": [0, -20, 0] }] }],
        "lights": [{ "beam": { "from": [0, -0.1, 0], "to": [0, -1, 0], "radius": 0.3, "spectrum": "E", "power": 1 } }],
        "render": { "photons": 10000 }
    });
    let ledger = render(&scene, Integrator::Photon, 2).ledger;
    let (absorbed, truth) = (ledger.absorbed_inside / ledger.emitted, -0.5 * (-COEFFICIENT * 0.4).exp_m1());
    println!("beam half inside a body: {absorbed:.4} of the power is absorbed, expected {truth:.4}");
    assert!((absorbed / truth - 1.0).abs() < 0.03, "{absorbed} for {truth}");
}

/// A ball of a liquid that scatters. The absorption is a property of the medium, or of the
/// body around the medium. Both descriptions mean the same light.
#[test]
#[ignore = "nightly: 5 seconds of CPU time"]
fn absorption_of_the_body_or_of_its_medium_is_the_same_light() {
    let ball = |of_medium: f64, of_body: f64| {
        json!({
            "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 22 } } },
            "film": { "width": 4, "height": 4 },
            "media": { "milk": { "homogeneous": { "absorption": of_medium, "scattering": 2, "phase": "isotropic" } } },
            "materials": { "milk": { "dielectric": { "ior": 1, "absorption": of_body, "medium": "milk" } } },
            "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "milk" }],
            "lights": surroundings(), "render": { "photons": 10000, "radius": 0.15 }
        })
    };
    for (way, tolerance) in [((Integrator::Photon, 16), 0.06), ((Integrator::Path, 128), 0.03)] {
        let [medium, body] = [ball(0.8, 0.0), ball(0.0, 0.8)].map(|scene| Measured::new(&scene, way, 0..4, mean_y));
        let (ratio, error) = (body.mean(0) / medium.mean(0), body.error(0).hypot(medium.error(0)) / medium.mean(0));
        println!("absorption of the body or of the medium, {:?}: ratio {ratio:.4} ± {error:.4}", way.0);
        assert!(error < 0.5 * tolerance, "too noisy to tell");
        assert!((ratio - 1.0).abs() < tolerance, "{:?}: {ratio}", way.0);
    }
}

/// A ball touches the faces of a box of equal priority. Inside the ball, the ball is the inner
/// body.
#[test]
fn a_ball_in_a_box_of_its_size_is_the_inner_body() {
    let materials = json!({ "near": { "boundary": { "medium": "near" } }, "far": { "boundary": { "medium": "far" } } });
    let object = |shape: Value, material: &str| json!({ "shape": shape, "material": material });
    let ball = object(json!({ "sphere": { "radius": 2 } }), "far");
    let cube = object(json!({ "box": { "size": [4, 4, 4] } }), "near");
    for objects in [vec![ball.clone(), cube.clone()], vec![cube, ball]] {
        let scene = job(&before_a_bright_wall(materials.clone(), objects)).scene;
        let medium_at = |point: DVec3| {
            let number = scene.medium_in(&scene.medium_stack_at(point - scene.centre));
            number.map(|number| scene.media[number].name.as_str())
        };
        let places = [DVec3::new(0.1, -0.2, 0.3), DVec3::splat(1.7), DVec3::splat(2.1)];
        assert_eq!(places.map(medium_at), [Some("far"), Some("near"), None]);
    }
}

/// A light of 1 cd and a camera inside a box of smoke of this density, with z from −1 to 1. Both
/// face a wall at z = −3. `lamp_z` is the z of the light.
fn inside_a_grid(scattering: f64, lamp_z: f64) -> Value {
    json!({
        "camera": ahead(0.5), "film": { "width": 4, "height": 4 },
        "media": { "smoke": { "grid": { "bounds": [[-1, -1, -1], [1, 1, 1]],
            "density": { "values": [1, 1, 1, 1, 1, 1, 1, 1, 1], "resolution": [1, 1, 9] },
            "absorption": 0.7, "scattering": scattering, "phase": "isotropic" } } },
        "materials": { "smoke": { "boundary": { "medium": "smoke" } }, "grey": diffuse(0.5) },
        "objects": [
            { "shape": { "sphere": { "radius": 2 } }, "material": "smoke" },
            { "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey",
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0, -3] }] }],
        "lights": [{ "point": { "at": [0, 0, lamp_z], "spectrum": "E", "luminous_intensity": 1 } }],
        "render": { "photons": 1000, "radius": 0.1, "forbid": ["indirect"] }
    })
}

#[test]
fn a_lamp_and_a_camera_inside_a_grid() {
    // 1 m from the light to the end of the grid, and 1.5 m from there to the camera.
    let truth = 0.5 / PI / 9.0 * (-0.7 * 2.5_f64).exp();
    for way in WAYS {
        let seen = Measured::new(&inside_a_grid(0.0, 0.0), way, 0..4, mean_y);
        println!("lamp and camera in a grid, {:?}: {:.6} of {truth:.6}", way.0, seen.mean(0));
        assert!((seen.mean(0) - truth).abs() < (4.0 * seen.error(0)).max(1e-3 * truth), "{}", seen.mean(0));
    }
}

#[test]
#[ignore = "nightly: 7 seconds of CPU time"]
fn a_lamp_in_a_node_of_a_grid_is_as_one_beside_it() {
    // The nine nodes of the grid lie at x = y = 0 and z = −8/9, −6/9, … 8/9. The light is outside
    // the view.
    let [node, beside] = [0.0, 1e-5].map(|z| {
        let mut scene = inside_a_grid(0.3, z);
        scene["camera"]["from"] = json!([0.4, 0.1, 0.5]);
        scene["camera"]["at"] = json!([0.4, 0.1, -0.5]);
        Measured::new(&scene, (Integrator::Photon, 64), 0..4, mean_y)
    });
    println!("lamp in a node {:.6}, beside it {:.6} ± {:.6}", node.mean(0), beside.mean(0), beside.error(0));
    assert!(node.mean(0) > 0.0 && (node.mean(0) / beside.mean(0) - 1.0).abs() < 1e-3);
}

#[test]
fn a_medium_that_nothing_holds_changes_nothing() {
    let mut scene = inside_a_grid(0.3, 0.0);
    scene["objects"].as_array_mut().expect("objects").remove(0);
    let mut without = scene.clone();
    without["media"] = json!({});
    without["materials"].as_object_mut().expect("materials").remove("smoke");
    let [unheld, without] = [&scene, &without].map(|scene| render(scene, Integrator::Photon, 4).picture);
    assert_eq!(unheld, without);
    assert!(unheld.mean_y() > 0.0);
}

/// Non-absorbing fog around a ball of glass.
fn fog_around_glass() -> Value {
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 20 } } },
        "film": { "width": 8, "height": 8 },
        "media": { "white": { "homogeneous": { "absorption": 0, "scattering": 0.2,
                                               "phase": { "henyey_greenstein": { "g": 0.5 } } } } },
        "materials": { "white": { "boundary": { "medium": "white" } }, "glass": { "dielectric": { "ior": 1.5 } } },
        "objects": [{ "shape": { "sphere": { "radius": 2 } }, "material": "white" },
                    { "shape": { "sphere": { "radius": 0.7 } }, "material": "glass" }],
        "lights": surroundings(), "render": { "photons": 10000, "radius": 0.1 }
    })
}

#[test]
fn white_fog_around_a_ball_of_glass_in_uniform_surroundings() {
    furnace::check("fog around glass", &fog_around_glass(), (Integrator::Path, 256));
}

/// A non-absorbing liquid in a glass, seen from above the rim. The liquid reaches slightly into the
/// glass, so that there is no gap. `scattering` is in 1/m.
fn liquid_in_a_glass(scattering: f64, radius: f64) -> Value {
    let cylinder = |name: &str, radius: f64, height: f64, y: f64| {
        json!({ "shape": { "cylinder": { "radius": radius, "height": height } }, "material": name,
                "transform": [{ "translate": [0, y, 0] }] })
    };
    json!({
        "camera": { "from": [0, 1.2, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 14 } } },
        "film": { "width": 8, "height": 8 },
        "media": { "milk": { "homogeneous": { "absorption": 0, "scattering": scattering,
                                              "phase": { "henyey_greenstein": { "g": 0.5 } } } } },
        "materials": { "glass": { "dielectric": { "ior": 1.5 } }, "cavity": { "dielectric": { "ior": 1, "priority": 1 } },
                       "milk": { "dielectric": { "ior": 1.33, "medium": "milk", "priority": 2 } } },
        "objects": [cylinder("glass", 1.0, 2.4, 0.0), cylinder("cavity", 0.85, 2.4, 0.2), cylinder("milk", 0.86, 1.6, -0.21)],
        "lights": surroundings(), "render": { "photons": 3000, "radius": radius }
    })
}

#[test]
fn a_dense_white_liquid_in_a_glass_in_uniform_surroundings() {
    furnace::check("milk in a glass", &liquid_in_a_glass(20.0, 0.1), (Integrator::Path, 128));
}

/// A kernel loses the part that reaches beyond the liquid's surface. The loss vanishes with the
/// radius. With a stated number of camera samples, a pass stores the planned number of photons, so
/// that the radii are those stated.
#[test]
#[ignore = "slow: a minute of CPU time; two radii, many scatterings"]
fn a_dense_white_liquid_in_a_glass_by_photons() {
    let [wide, narrow] = [0.1, 0.05].map(|radius| {
        let scene = with_setting(&liquid_in_a_glass(10.0, radius), "camera_samples", 1);
        Measured::new(&scene, (Integrator::Photon, 32), 0..8, mean_y)
    });
    let limit = Measured::combine(&[&narrow, &wide], |l| 2.0 * l[0] - l[1]);
    println!(
        "milk in a glass by photons: {:.4}, {:.4}, limit {:.4} ± {:.4}",
        wide.mean(0),
        narrow.mean(0),
        limit.mean(0),
        limit.error(0)
    );
    assert!(limit.error(0) < 1.2e-2, "too noisy to tell");
    assert!((limit.mean(0) - 1.0).abs() < 4.0 * limit.error(0));
    assert!(wide.mean(0) < narrow.mean(0) && wide.mean(0) > 0.92, "the loss is not that of the kernel's rim");
}
