//! Scenes with more than eight lights: a floor has the irradiance of the closed form, and fog has
//! the radiance of an integral. Shadow rays to lights of a light tree, scattered rays that hit
//! lights, and photons must all count these lights with the correct weights.

use crate::common::compare::{Measured, assert_same};
use crate::common::{colour_blocks, diffuse, mean_y, overhead_camera};
use abbe_session::render::Integrator;
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::PI;

const ALBEDO: f64 = 0.6;

/// Half the side of the visible square of floor around the origin.
const HALF: f64 = 0.1;

fn floor(objects: &[Value], lights: &[Value]) -> Value {
    let ground = json!({ "shape": { "rectangle": { "width": 60, "height": 60 } }, "material": "grey" });
    let objects = [std::slice::from_ref(&ground), objects].concat();
    json!({
        "camera": overhead_camera([0.0, 0.0], 0.4, 2.0 * HALF),
        "film": { "width": 8, "height": 8 },
        "materials": { "grey": diffuse(ALBEDO), "black": "absorber" },
        "objects": objects, "lights": lights, "render": { "photons": 1000 }
    })
}

/// Returns the mean of an illuminance over the visible square.
fn mean_over_view(illuminance: impl Fn(DVec3) -> f64) -> f64 {
    const N: u32 = 40;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(N) * 2.0 * HALF - HALF;
    (0..N * N).map(|i| illuminance(DVec3::new(at(i % N), 0.0, at(i / N)))).sum::<f64>() / f64::from(N * N)
}

/// Returns the illuminance of the floor under a point of a luminous intensity in cd.
fn under_point(at: DVec3, intensity: f64, floor: DVec3) -> f64 {
    let offset = at - floor;
    intensity * offset.y / offset.length().powi(3)
}

fn check(name: &str, scene: &Value, illuminance: f64, passes: u64) {
    for integrator in [Integrator::Photon, Integrator::Path] {
        let luminance = ALBEDO * illuminance / PI;
        let measured = Measured::new(scene, (integrator, passes), 0..4, mean_y);
        let (ratio, error) = (measured.mean(0) / luminance, measured.error(0) / luminance);
        println!("many lights, {name}, {integrator:?}: {ratio:.5} ± {error:.5}");
        assert!(error < 2e-3, "too noisy to tell");
        assert!((ratio - 1.0).abs() < 5e-3, "{name}: {ratio} of the closed form");
    }
}

/// Positions on a spiral above the floor, from near to far.
fn spiral(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(|i| {
        let (turn, share) = (2.4 * f64::from(i), f64::from(i + 1) / 60.0);
        DVec3::new(20.0 * share * turn.cos(), 0.6 + 2.0 * share, 20.0 * share * turn.sin())
    })
}

/// Points, spheres, spots and distant lights together. Scattered rays hit the spheres. Half of the
/// spots shine on the view, and the others shine away from it.
#[test]
fn lamps_of_all_kinds_light_a_floor() {
    let (mut objects, mut lights, mut known) = (Vec::new(), Vec::new(), Vec::new());
    for (i, at) in spiral(60).enumerate() {
        let intensity = 1.5_f64.powi(i as i32 % 12);
        match i % 4 {
            0 => lights
                .push(json!({ "point": { "at": at.to_array(), "spectrum": "D65", "luminous_intensity": intensity } })),
            1 => objects
                .push(json!({ "shape": { "sphere": { "center": at.to_array(), "radius": 0.3 } }, "material": "black",
                                      "emission": { "spectrum": "A", "luminous_flux": 4.0 * PI * intensity } })),
            2 => lights
                .push(json!({ "spot": { "at": at.to_array(), "to": [0, 0, 0], "half_angle": 60, "spectrum": "D65",
                                               "luminous_intensity": intensity } })),
            _ => lights.push(
                json!({ "spot": { "at": at.to_array(), "to": (2.0 * at).to_array(), "half_angle": 60, "spectrum": "D65",
                                               "luminous_intensity": intensity } }),
            ),
        }
        if i % 4 != 3 {
            known.push((at, intensity));
        }
    }
    for illuminance in [3.0, 8.0] {
        lights.push(json!({ "directional": { "toward": [0, -1, 0], "spectrum": "D65", "illuminance": illuminance,
                                             "angular_diameter": 5 } }));
    }
    let illuminance = 11.0 + mean_over_view(|floor| known.iter().map(|&(at, cd)| under_point(at, cd, floor)).sum());
    check("all kinds", &floor(&objects, &lights), illuminance, 64);
}

/// A hundred equal lamps in a circle, a third of them behind a wall. Most of the light comes from
/// lamps that the trials before pass 0 do not name.
#[test]
#[ignore = "nightly: 14 seconds of CPU time"]
fn a_hundred_equal_lamps_light_a_floor() {
    let places: Vec<DVec3> = (0..100)
        .map(|i| {
            let (sin, cos) = (2.0 * PI * f64::from(i) / 100.0).sin_cos();
            DVec3::new(8.0 * cos, 3.0, 8.0 * sin)
        })
        .collect();
    let lamp = |at: &DVec3| json!({ "point": { "at": at.to_array(), "spectrum": "D65", "luminous_intensity": 5 } });
    let lights: Vec<Value> = places.iter().map(lamp).collect();
    let wall = json!({ "shape": { "box": { "size": [0.1, 10, 40] } }, "material": "black",
                       "transform": [{ "translate": [-4, 5, 0] }] });
    let visible = || places.iter().filter(|at| at.x > -4.0);
    let illuminance = mean_over_view(|floor| visible().map(|&at| under_point(at, 5.0, floor)).sum());
    check("equal lamps", &floor(&[wall], &lights), illuminance, 256);
}

/// A rectangle of 32 triangles. A light tree selects one of the triangles. With more than eight
/// lights, the triangles are in the tree of all lights.
#[test]
#[ignore = "nightly: 14 seconds of CPU time"]
fn a_luminous_mesh_lights_a_floor() {
    let (flux, width, depth, height) = (500.0, 0.8, 0.5, 0.9);
    let mesh = json!({ "shape": { "mesh": { "path": "physics/panel.obj" } }, "material": "black",
                       "emission": { "spectrum": "FL2", "luminous_flux": flux },
                       "transform": [{ "translate": [0.1, height, 0.2] }] });
    // The form factor of a parallel rectangle with one corner above the point, as in irradiance.rs.
    let corner = |a: f64, b: f64| {
        let (p, q) = ((a * a + height * height).sqrt(), (b * b + height * height).sqrt());
        0.5 * (a / p * (b / p).atan() + b / q * (a / q).atan())
    };
    let of_mesh = mean_over_view(|at| {
        let [left, right] = [-0.5, 0.5].map(|s| 0.1 + s * width - at.x);
        let [near, far] = [-0.5, 0.5].map(|s| 0.2 + s * depth - at.z);
        let sum = corner(right, far) - corner(left, far) - corner(right, near) + corner(left, near);
        flux / (PI * width * depth) * sum
    });
    let mesh = std::slice::from_ref(&mesh);
    check("mesh", &floor(mesh, &[]), of_mesh, 128);
    let points: Vec<DVec3> = spiral(12).collect();
    let lights: Vec<Value> = points
        .iter()
        .map(|at| json!({ "point": { "at": at.to_array(), "spectrum": "D65", "luminous_intensity": 30 } }))
        .collect();
    let of_points = mean_over_view(|floor| points.iter().map(|&at| under_point(at, 30.0, floor)).sum());
    check("mesh and points", &floor(mesh, &lights), of_mesh + of_points, 256);
}

/// A closed room with ten lamps. If `surrounded` is true, 60 brighter lamps are behind its walls.
fn room(surrounded: bool) -> Value {
    let lamp = |at: [f64; 3], intensity: f64| json!({ "point": { "at": at, "spectrum": "D65", "luminous_intensity": intensity } });
    let inside = (0..10).map(|i| {
        let turn = 0.6 * f64::from(i);
        lamp([1.6 * turn.cos(), 2.2, 1.6 * turn.sin()], 10.0 + f64::from(i))
    });
    let behind = (0..60).map(|i| {
        let (along, height) = (f64::from(i / 4) * 0.25 - 1.75, 0.3 + f64::from(i * 7 % 15) * 0.15);
        let [x, z] = [[2.2, along], [-2.2, along], [along, 2.2], [along, -2.2]][i as usize % 4];
        lamp([x, height, z], 400.0)
    });
    let lights: Vec<Value> = inside.chain(behind.filter(|_| surrounded)).collect();
    json!({
        "camera": overhead_camera([0.0, 0.0], 2.5, 3.2),
        "film": { "width": 24, "height": 24 },
        "materials": { "grey": diffuse(ALBEDO) },
        "objects": [{ "shape": { "box": { "size": [4, 3, 4] } }, "material": "grey",
                      "transform": [{ "translate": [0, 1.5, 0] }] }],
        "lights": lights, "render": { "photons": 1000, "camera_samples": 4, "forbid": ["indirect"] }
    })
}

/// Lamps behind walls do not change the light in a room, and few shadow rays go to them. If the
/// tree alone selected the lamps, the noise would be about 100 times as large as without these
/// lamps.
#[test]
fn lamps_behind_walls_take_few_shadow_rays() {
    let blocks =
        |surrounded: bool, seeds| Measured::new(&room(surrounded), (Integrator::Photon, 4), seeds, colour_blocks(4));
    let (alone, surrounded) = (blocks(false, 0..8), blocks(true, 10..18));
    let errors = [&alone, &surrounded].map(Measured::relative_error);
    println!("relative errors {:.4} without and {:.4} with lamps behind the walls", errors[0], errors[1]);
    assert_same("lamps behind walls", &surrounded, &alone, 2e-2);
    assert!(errors[1] < 6.0 * errors[0], "{errors:?}");
}
