//! Direct light in media from light maps, compared with integrals along camera rays, shadow rays
//! and photons.

use crate::common::compare::{Measured, assert_differs, assert_same};
use crate::common::{all_y, block_means, job, mean_y, render, with_setting};
use crate::media_single_scattering::integral;
use abbe_session::render::{Integrator, Rendered};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Pixels per side.
const FILM: usize = 16;

/// Scattering as a share of the extinction. It is so small that double scattering does not matter.
const SCATTERING: f64 = 1e-4;
const ABSORPTION: f64 = 1.0;

/// The position of a light of 1 cd beside a ball of smoke of radius 1.
const LAMP: DVec3 = DVec3::new(1.2, 0.9, 0.4);

/// A ball of smoke whose density falls smoothly from its centre to 0 at its surface.
fn smoke(resolution: u32, lamp: Value) -> Value {
    let smoke = json!({ "grid": { "bounds": [[-1, -1, -1], [1, 1, 1]],
        "density": { "sphere": { "value": 1, "center": [0, 0, 0], "radius": 1, "falloff": 1 } },
        "absorption": ABSORPTION, "scattering": SCATTERING, "phase": "isotropic" } });
    ball(smoke, json!({ "box": { "size": [2, 2, 2] } }), resolution, lamp)
}

/// A ball of homogeneous fog.
fn fog(resolution: u32, lamp: Value) -> Value {
    let fog = json!({ "homogeneous": { "absorption": ABSORPTION, "scattering": SCATTERING, "phase": "isotropic" } });
    ball(fog, json!({ "sphere": { "radius": 1 } }), resolution, lamp)
}

fn ball(medium: Value, shape: Value, resolution: u32, lamp: Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 4], "at": [0, 0, 0], "up": [0, 1, 0], "lens": { "pinhole": { "fov": 18 } } },
        "film": { "width": FILM, "height": FILM },
        "media": { "smoke": medium },
        "materials": { "smoke": { "boundary": { "medium": "smoke" } }, "black": "absorber" },
        "objects": [{ "shape": shape, "material": "smoke" }],
        "lights": [lamp],
        "render": { "photons": 100, "light_map": { "resolution": resolution } }
    })
}

fn point_lamp() -> Value {
    json!({ "point": { "at": LAMP.to_array(), "spectrum": { "lines": [{ "nm": 550, "power": 1 }] }, "luminous_intensity": 1 } })
}

/// The density in the ball as a function of the squared distance from its centre.
type Density = fn(f64) -> f64;

fn fading(r2: f64) -> f64 {
    let share = (1.0 - r2).max(0.0);
    share * share * (3.0 - 2.0 * share)
}

/// Returns the part of the segment `way` from `from` that lies in the ball, as shares of its
/// length.
fn inside(from: DVec3, way: DVec3) -> Option<[f64; 2]> {
    let (a, b) = (way.length_squared(), from.dot(way));
    let discriminant = b * b - a * (from.length_squared() - 1.0);
    (discriminant > 0.0).then(|| [-1.0, 1.0].map(|sign| (-b + sign * discriminant.sqrt()) / a))
}

/// Returns ∫ρ between two points. Within the ball, the density along a line is a polynomial of
/// degree 6.
fn column(density: Density, from: DVec3, to: DVec3) -> f64 {
    let way = to - from;
    let Some(ends) = inside(from, way) else { return 0.0 };
    let [enter, leave] = ends.map(|end| end.clamp(0.0, 1.0));
    let half = 0.5 * (leave - enter);
    // Gauss–Legendre quadrature with four points is exact here.
    let points =
        [(0.861_136_311_594_052_6, 0.347_854_845_137_453_85), (0.339_981_043_584_856_26, 0.652_145_154_862_546_1)];
    let at = |x: f64| density((from + (enter + half * (1.0 + x)) * way).length_squared());
    half * way.length() * points.iter().map(|&(x, weight)| weight * (at(x) + at(-x))).sum::<f64>()
}

/// Returns the mean luminance of the picture from integrals along rays through the centres of 4 × 4
/// parts of each pixel.
fn expected(scene: &Value, density: Density) -> f64 {
    let scene = job(scene).scene;
    let (parts, eye) = (4 * FILM, DVec3::new(0.0, 0.0, 4.0));
    let along = |i: usize| {
        let film = DVec2::new((i % parts) as f64 + 0.5, (i / parts) as f64 + 0.5) * 0.25;
        let direction = scene.camera.ray(film, [0.5; 2]).direction;
        let Some([enter, leave]) = inside(eye, direction) else { return 0.0 };
        let scattered = |t: f64| {
            let place = eye + (enter + t) * direction;
            let depth = (ABSORPTION + SCATTERING) * (column(density, eye, place) + column(density, place, LAMP));
            SCATTERING * density(place.length_squared()) * 0.25 / PI * (-depth).exp() / (LAMP - place).length_squared()
        };
        integral(scattered, leave - enter)
    };
    (0..parts * parts).map(along).sum::<f64>() / (parts * parts) as f64
}

/// Interpolation between nodes has an error of second order in the cell size for a smooth density.
/// At a surface where the density ends, the error is of first order in a share of the volume that
/// is itself proportional to the cell size. Both are second order: halving the cells leaves a
/// quarter.
fn check_order(name: &str, scene: impl Fn(u32, Value) -> Value, density: Density) {
    let truth = expected(&scene(8, point_lamp()), density);
    let mut last = f64::INFINITY;
    for resolution in [4, 8, 16, 32] {
        let found = Measured::new(&scene(resolution, point_lamp()), (Integrator::Photon, 1), 0..64, |rendered| {
            vec![
                rendered.picture.mean_y(),
                rendered.picture.bias.iter().flatten().map(|&bias| f64::from(bias)).sum::<f64>(),
            ]
        });
        let (off, error) = (found.mean(0) / truth - 1.0, found.error(0) / truth);
        let told = found.mean(1) / (FILM * FILM) as f64 / truth;
        let order = (last / off.abs()).log2();
        println!(
            "light map, {name}, {resolution} cells: off by {off:+.5} ± {error:.5}, told {told:.5}, order {order:.2}"
        );
        assert!(error < 1.5e-3, "too noisy to tell");
        assert!((off.abs() - told).abs() < 4.0 * error + 0.5 * off.abs(), "the bias that was told");
        assert!(off.abs() < 0.4 * last + 4.0 * error, "{resolution} cells");
        last = off.abs();
    }
    assert!(last < 5e-3);
}

#[test]
fn smoke_by_a_light_map_is_the_integral_as_its_cells_shrink() {
    check_order("smoke", smoke, fading);
}

#[test]
#[ignore = "nightly: 9 seconds of CPU time"]
fn even_fog_by_a_light_map_is_the_integral_as_its_cells_shrink() {
    check_order("fog", fog, |_| 1.0);
}

/// The light and the camera are inside a ball of a coloured liquid that scatters little. The light
/// map and the shadow rays contain the absorption of the liquid on both ways.
#[test]
fn a_light_map_in_a_coloured_liquid_is_the_integral() {
    const RADIUS: f64 = 2.0;
    let eye = DVec3::new(0.0, 0.0, 1.5);
    let mut scene = fog(8, point_lamp());
    scene["camera"]["from"] = json!(eye.to_array());
    scene["media"]["smoke"]["homogeneous"]["absorption"] = json!(0);
    scene["materials"]["smoke"] = json!({ "dielectric": { "ior": 1, "absorption": ABSORPTION, "medium": "smoke" } });
    scene["objects"][0]["shape"] = json!({ "sphere": { "radius": RADIUS } });
    let camera = job(&scene).scene.camera;
    let along = |pixel: usize| {
        let film = DVec2::new((pixel % FILM) as f64 + 0.5, (pixel / FILM) as f64 + 0.5);
        let direction = camera.ray(film, [0.5; 2]).direction;
        let towards = eye.dot(direction);
        let leave = -towards + (towards * towards + RADIUS * RADIUS - eye.length_squared()).sqrt();
        let scattered = |t: f64| {
            let d = (eye + t * direction - LAMP).length();
            SCATTERING * 0.25 / PI * (-(ABSORPTION + SCATTERING) * (t + d)).exp() / (d * d)
        };
        integral(scattered, leave)
    };
    let truth = (0..FILM * FILM).map(along).sum::<f64>() / (FILM * FILM) as f64;
    for (name, forbid) in [("light map", json!([])), ("shadow rays", json!(["light-map"]))] {
        let found = Measured::new(&with_setting(&scene, "forbid", forbid), (Integrator::Photon, 16), 0..4, mean_y);
        let (ratio, error) = (found.mean(0) / truth, found.error(0) / truth);
        println!("coloured liquid, {name}: {ratio:.4} ± {error:.4} of the integral");
        assert!(error < 5e-3, "too noisy to tell");
        assert!((ratio - 1.0).abs() < 0.02, "{name}: {ratio}");
    }
}

fn blocks(rendered: &Rendered) -> Vec<f64> {
    block_means(&all_y(rendered), FILM, 8, &[true; FILM * FILM])
}

/// Adds half a wall between the light and the smoke, and a post inside the smoke.
fn with_obstacles(mut scene: Value) -> Value {
    let obstacles = [
        json!({ "shape": { "rectangle": { "width": 1, "height": 1 } }, "material": "black",
                "transform": [{ "rotate": { "axis": [0, 0, 1], "degrees": 60 } }, { "translate": [0.5, 1.2, 0] }] }),
        json!({ "shape": { "cylinder": { "radius": 0.15, "height": 1.2 } }, "material": "black" }),
    ];
    scene["objects"].as_array_mut().expect("objects").extend(obstacles);
    scene
}

#[test]
#[ignore = "slow: 4 seconds of CPU time"]
fn maps_and_shadow_rays_find_the_same_light() {
    let sphere = json!({ "shape": { "sphere": { "radius": 0.2 } }, "material": "black", "transform": [{ "translate": LAMP.to_array() }],
                         "emission": { "spectrum": "E", "luminance": 8 } });
    let spot = json!({ "spot": { "at": LAMP.to_array(), "to": [0, 0, 0], "half_angle": 25, "penumbra": 10, "spectrum": "E",
                                 "luminous_intensity": 1 } });
    let sun = json!({ "directional": { "toward": [-1, -0.7, -0.2], "spectrum": "E", "illuminance": 0.4 } });
    let beam = json!({ "beam": { "from": LAMP.to_array(), "to": [0, 0, 0], "radius": 0.4, "spectrum": "E", "luminous_flux": 1 } });
    // A pass sees one point of an extended light, so this light needs more passes. Each pass builds
    // its own map.
    for (name, lamp, passes) in [("spot", spot, 16), ("sun", sun, 16), ("beam", beam, 16), ("sphere", Value::Null, 64)]
    {
        let mut scene = with_obstacles(smoke(16, point_lamp()));
        if lamp.is_null() {
            scene["lights"] = json!([]);
            scene["render"]["light_map"]["resolution"] = json!(6);
            scene["objects"].as_array_mut().expect("objects").push(sphere.clone());
        } else {
            scene["lights"] = json!([lamp]);
        }
        let [by_map, asked] = [json!([]), json!(["light-map"])].map(|forbid| {
            Measured::new(&with_setting(&scene, "forbid", forbid), (Integrator::Photon, passes), 0..8, blocks)
        });
        assert_same(&format!("{name}, maps against shadow rays"), &by_map, &asked, 2e-2);
    }
}

/// A sheet of light between the nodes of the map. All nodes are in the shadow of the roof.
#[test]
fn light_through_a_slit_between_the_nodes_of_a_map_is_found() {
    let sun = json!({ "directional": { "toward": [0, -1, 0], "spectrum": "E", "illuminance": 1 } });
    let mut scene = fog(4, sun);
    scene["camera"]["from"] = json!([4, 0, 0]);
    let half = |from: f64, to: f64| {
        json!({ "shape": { "rectangle": { "width": to - from, "height": 8 } }, "material": "black",
                "transform": [{ "translate": [0.5 * (from + to), 1.5, 0] }] })
    };
    scene["objects"].as_array_mut().expect("objects").extend([half(-4.0, 0.08), half(0.18, 4.0)]);
    let [by_map, asked] = [json!([]), json!(["light-map"])]
        .map(|forbid| Measured::new(&with_setting(&scene, "forbid", forbid), (Integrator::Photon, 64), 0..8, mean_y));
    assert!(asked.mean(0) > 0.0);
    assert_same("a sheet of light", &by_map, &asked, 5e-2);
}

#[test]
fn a_light_counts_by_its_map_or_by_shadow_rays_but_not_by_both() {
    let looks = |scene: &Value| render(scene, Integrator::Photon, 1).stats.effects["light-map"].events;
    let scene = smoke(4, point_lamp());
    assert!(looks(&scene) > 1000);
    assert_eq!(looks(&with_setting(&scene, "forbid", json!(["light-map"]))), 0);
    // Two lights, one of which has a map: twice the light.
    let environment = json!({ "environment": { "spectrum": "E", "irradiance": 1e-3 } });
    let mut both = scene.clone();
    both["lights"] = json!([point_lamp(), environment]);
    let mut sky = scene.clone();
    sky["lights"] = json!([environment]);
    let [one, sky, both] =
        [scene, sky, both].map(|scene| Measured::new(&scene, (Integrator::Photon, 32), 0..4, mean_y));
    let sum = Measured::combine(&[&one, &sky], |y| y[0] + y[1]);
    assert_same("a lamp and the sky", &both, &sum, 2e-2);
}

#[test]
#[ignore = "slow: half a minute of CPU time; photons that are scattered once are few"]
fn a_light_map_and_volume_photons_find_the_same_light() {
    // A pane of glass with index 1. Light that passes it is carried by photons.
    let open = with_obstacles(smoke(32, point_lamp()));
    let mut closed = open.clone();
    closed["materials"]["pane"] = json!({ "dielectric": { "ior": 1 } });
    let around = json!({ "shape": { "sphere": { "center": LAMP.to_array(), "radius": 0.05 } }, "material": "pane" });
    closed["objects"].as_array_mut().expect("objects").push(around);
    closed["render"] =
        json!({ "photons": 20000, "force": ["volume-photons"], "forbid": ["photon-beams", "light-map", "aim"] });
    let photons =
        |radius: f64| Measured::new(&with_setting(&closed, "radius", radius), (Integrator::Photon, 192), 0..8, blocks);
    let photons = Measured::extrapolated(&photons(0.2), &photons(0.1));
    let by_map = Measured::new(&open, (Integrator::Photon, 64), 100..108, blocks);
    assert_same("a light map against volume photons", &by_map, &photons, 2e-2);
    let mut brighter = open.clone();
    brighter["media"]["smoke"]["grid"]["scattering"] = json!(1.1 * SCATTERING);
    let mutant = Measured::new(&brighter, (Integrator::Photon, 64), 100..108, blocks);
    assert_differs("a light map against volume photons, mutant", &mutant, &photons);
}
