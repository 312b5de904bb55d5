//! Media and the bodies that contain them: overlaps, liquids in glasses, lights and cameras inside,
//! compared with closed forms and uniform surroundings.

use crate::common::compare::Measured;
use crate::common::{diffuse, mean_y, render};
use crate::furnace::{self, surroundings};
use abbe::render::Integrator;
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
fn inner_bodies_displace_the_medium_around_them() {
    let materials = json!({ "near": { "boundary": { "medium": "near" } }, "far": { "boundary": { "medium": "far" } } });
    let inside = before_a_bright_wall(materials.clone(), vec![layer("near", [1.0, 4.0]), layer("far", [2.0, 3.0])]);
    check_depth("a medium inside another", &inside, 2.0 * 0.3 + 1.1);
    let mut air = before_a_bright_wall(materials, vec![layer("far", [2.0, 4.0])]);
    air["atmosphere"] = json!("near");
    check_depth("a body in the atmosphere", &air, 3.0 * 0.3 + 2.0 * 1.1);
    // The camera is inside the body.
    air["objects"][0] = layer("far", [-2.0, 3.0]);
    check_depth("a camera in a body in the atmosphere", &air, 2.0 * 0.3 + 3.0 * 1.1);
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
    furnace::check("milk in a glass", &liquid_in_a_glass(20.0, 0.1), (Integrator::Path, 256));
}

/// A kernel loses the part that reaches beyond the liquid's surface. The loss vanishes with the
/// radius.
#[test]
#[ignore = "slow: a minute of CPU time; two radii, many scatterings"]
fn a_dense_white_liquid_in_a_glass_by_photons() {
    let [wide, narrow] = [0.1, 0.05]
        .map(|radius| Measured::new(&liquid_in_a_glass(10.0, radius), (Integrator::Photon, 32), 0..8, mean_y));
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
