//! More bodies inside each other than a medium stack can hold, compared with closed forms.

use abbe_optics::bsdf::ScatterEvent;
use abbe_scene::geometry::Ray;
use abbe_session::render::{Integrator, Rendered};
use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_transport::walk::{RayState, SurfaceLookup, next_interaction};
use glam::DVec3;
use serde_json::{Value, json};

use crate::common::compare::{Measured, compare};
use crate::common::{all_y, block_means, diffuse, glass, job, render};

/// The number of shells of the Luneburg lens.
const SHELLS: usize = 20;

/// The radius of each ball of the onion, from the outermost to the innermost.
fn radius(shell: usize) -> f64 {
    1.0 - shell as f64 / SHELLS as f64
}

/// The index of the Luneburg lens, √(2 − r²), in the middle of each shell.
fn index(shell: usize) -> f64 {
    let r = radius(shell) - 0.5 / SHELLS as f64;
    (2.0 - r * r).sqrt()
}

fn onion() -> Value {
    let materials: serde_json::Map<String, Value> =
        (0..SHELLS).map(|shell| (format!("shell{shell}"), json!({ "dielectric": { "ior": index(shell) } }))).collect();
    let objects: Vec<Value> = (0..SHELLS)
        .map(|shell| json!({ "shape": { "sphere": { "radius": radius(shell) } }, "material": format!("shell{shell}") }))
        .collect();
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 20 } } },
        "film": { "width": 1, "height": 1 }, "materials": materials, "objects": objects,
        "lights": [{ "environment": { "spectrum": "E", "illuminance": 1 } }]
    })
}

/// Returns the angle by which the onion bends a ray at the distance `offset` from the centre.
/// Bouguer's law: n·r·sin θ is constant along the ray.
fn closed_form(offset: f64) -> f64 {
    let mut bend = 0.0;
    let mut outside = 1.0;
    for shell in 0..SHELLS {
        if offset >= outside * radius(shell) {
            break;
        }
        let angle = |n: f64| (offset / (n * radius(shell))).asin();
        bend += 2.0 * (angle(outside) - angle(index(shell)));
        outside = index(shell);
    }
    bend
}

#[test]
fn a_luneburg_onion_of_20_shells_bends_rays_as_bouguer_says() {
    let job = job(&onion());
    let scene = &job.scene;
    let sphere = |shell: usize| offset_reaches(shell);
    assert!(sphere(SHELLS - 1) > 0.0);
    for i in 0..50 {
        let offset = 0.019 * (f64::from(i) + 0.41);
        let ray = Ray::new(DVec3::new(offset, 0.0, 5.0) - scene.centre, DVec3::NEG_Z);
        let mut state = RayState { ray, from: None, medium_stack: scene.medium_stack_at(ray.origin) };
        let mut faces = 0;
        while let Some(interaction) = next_interaction(scene, state, SurfaceLookup::of_line(0.0)) {
            let u = [0.5, 0.5, ONE_MINUS_ULP];
            let sample = interaction.bsdf.sample(interaction.wo, interaction.sides, 589.3, u).expect("glass is clear");
            assert_eq!(sample.event, ScatterEvent::Transmission, "offset {offset}");
            let direction = interaction.frame.to_world(sample.wi);
            state = interaction.spawn_ray(direction, interaction.medium_stack_after(sample.event));
            faces += 1;
        }
        let bend = state.ray.direction.angle_between(DVec3::NEG_Z);
        assert!((bend - closed_form(offset)).abs() < 1e-7, "offset {offset}: {bend}, not {}", closed_form(offset));
        assert!(state.medium_stack.is_air(), "offset {offset}: {faces} faces");
        assert!(faces >= 2 * (0..SHELLS).filter(|&shell| offset < sphere(shell)).count(), "offset {offset}: {faces}");
    }
}

/// Returns the largest offset of a ray that enters a shell.
fn offset_reaches(shell: usize) -> f64 {
    (0..=shell).map(|k| radius(k) * if k == 0 { 1.0 } else { index(k - 1) }).fold(f64::INFINITY, f64::min)
}

/// Nine balls of air in a ball that absorbs. The light crosses the outermost shell twice.
#[test]
fn an_absorbing_body_around_nine_others_absorbs_by_beer_s_law() {
    const COEFFICIENT: f64 = 0.6;
    let balls = |priority: i32| {
        (1..=9).map(move |i| {
            let ball = json!({ "shape": { "sphere": { "radius": 0.5 - 0.05 * f64::from(i - 1) } }, "material": format!("clear{i}") });
            (format!("clear{i}"), json!({ "dielectric": { "ior": 1, "priority": priority } }), ball)
        })
    };
    for integrator in [Integrator::Photon, Integrator::Path] {
        let mut materials = serde_json::Map::new();
        materials.insert("outer".into(), json!({ "dielectric": { "ior": 1, "absorption": COEFFICIENT } }));
        let mut objects = vec![json!({ "shape": { "sphere": { "radius": 1 } }, "material": "outer" })];
        for (name, material, ball) in balls(0) {
            materials.insert(name, material);
            objects.push(ball);
        }
        let scene = json!({
            "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 0.01 } } },
            "film": { "width": 8, "height": 8 }, "materials": materials, "objects": objects,
            "lights": [{ "environment": { "spectrum": "E", "illuminance": std::f64::consts::PI } }],
            "render": { "photons": 100 }
        });
        let mean = |rendered: &Rendered| vec![rendered.picture.mean_y()];
        let measured = Measured::new(&scene, (integrator, 16), 0..8, mean);
        let (y, error, truth) = (measured.mean(0), measured.error(0), (-COEFFICIENT).exp());
        println!("nine balls in an absorbing one, {integrator:?}: {y:.5} ± {error:.5} of {truth:.5}");
        assert!(error < 0.02 * truth, "too noisy to tell: {y} ± {error}");
        assert!((y - truth).abs() < 4.0 * error + 1e-6, "{integrator:?}: {y} ± {error}, not {truth}");
    }
}

/// A surface of water without a bottom, or a closed box of water.
#[test]
fn light_that_leaves_the_scene_inside_an_open_body_is_noted() {
    let water = |shape: Value| {
        let scene = json!({
            "camera": { "from": [0, 1, 3], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
            "film": { "width": 4, "height": 4 },
            "materials": { "water": glass(1.33), "grey": diffuse(0.5) },
            "objects": [{ "shape": shape, "material": "water" },
                        { "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey",
                          "transform": [{ "translate": [9, 0, 0] }] }],
            "lights": [{ "beam": { "from": [0, 3, 0], "to": [0, 0, 0], "radius": 0.1, "spectrum": "E", "power": 2 } }],
            "render": { "photons": 2000 }
        });
        render(&scene, Integrator::Photon, 1)
    };
    let open = water(json!({ "rectangle": { "width": 4, "height": 4 } }));
    // Snell's law and Fresnel's equations: at normal incidence water reflects 2 % of the light.
    let reflectance = (0.33_f64 / 2.33).powi(2);
    assert!((open.ledger.escaped_inside - 2.0 * (1.0 - reflectance)).abs() < 0.02, "{:?}", open.ledger);
    assert!(open.stats.notes.iter().any(|note| note.contains("inside a body")), "{:?}", open.stats.notes);
    let closed = water(json!({ "box": { "size": [4, 1, 4] } }));
    assert_eq!(closed.ledger.escaped_inside, 0.0);
    assert!(closed.stats.notes.is_empty(), "{:?}", closed.stats.notes);
}

/// Light that fog scatters leaves the ball of fog through its boundary, not inside a body.
#[test]
fn light_that_fog_scatters_does_not_leave_the_scene_inside_the_fog() {
    let scene = json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 4, "height": 4 },
        "media": { "fog": { "homogeneous": { "scattering": 1, "absorption": 0, "phase": "isotropic" } } },
        "materials": { "fog": { "boundary": { "medium": "fog" } } },
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "fog" }],
        "lights": [{ "environment": { "spectrum": "E", "illuminance": 1 } }],
        "render": { "photons": 2000 }
    });
    let rendered = render(&scene, Integrator::Photon, 1);
    assert!(rendered.ledger.escaped > 0.0, "{:?}", rendered.ledger);
    assert_eq!(rendered.ledger.escaped_inside, 0.0);
    assert!(rendered.stats.notes.is_empty(), "{:?}", rendered.stats.notes);
}

/// One mesh joins two boxes that overlap and have coplanar sides. A ray through both sees the glass
/// of their union, from both ends.
#[test]
fn joined_boxes_are_the_glass_of_their_union() {
    let absorption = 0.5;
    for (from, length_m) in
        [([-6.0, 0.1, 0.15], 3.0), ([6.0, 0.1, 0.15], 3.0), ([0.1, 6.0, 0.15], 2.0), ([0.1, 0.2, -6.0], 2.0)]
    {
        let at = [0.1, 0.2, 0.15];
        let along = DVec3::from_array(at) - DVec3::from_array(from);
        let length_m = length_m * along.length() / along.abs().max_element();
        let scene = json!({
            "camera": { "from": from, "at": at, "up": [0.3, 0.5, 0.4], "lens": { "pinhole": { "fov": 0.2 } } },
            "film": { "width": 2, "height": 2 },
            "materials": { "grey": { "dielectric": { "ior": 1, "absorption": absorption } } },
            "objects": [{ "shape": { "mesh": { "path": "physics/joined_boxes.obj" } }, "material": "grey" }],
            "lights": [{ "environment": { "spectrum": "E", "luminance": 1 } }], "render": { "photons": 1000 }
        });
        let known = (-absorption * length_m).exp();
        for integrator in [Integrator::Photon, Integrator::Path] {
            let rendered = render(&scene, integrator, 4);
            let seen = rendered.picture.mean_y();
            assert!((seen / known - 1.0).abs() < 0.01, "{from:?}, {integrator:?}: {seen} for {known}");
        }
        let notes = job(&scene).scene.notes.join("\n");
        assert!(notes.contains("2 closed shells"), "{notes}");
    }
}

/// A glowing ball overlaps a ball of glass that has the priority. The part of its surface inside of
/// the other ball is no interface, but it glows too, for photons and for camera paths.
#[test]
fn the_hidden_part_of_a_glowing_ball_glows_too() {
    let scene = json!({
        "camera": { "from": [0, 0, 4.5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 30 } } },
        "film": { "width": 8, "height": 8 },
        "materials": { "lamp": glass(1.5), "first": { "dielectric": { "ior": 1.3, "priority": 1 } }, "grey": diffuse(0.5) },
        "objects": [
            { "shape": { "sphere": { "radius": 0.5 } }, "material": "lamp", "emission": { "spectrum": "E", "power": 5 } },
            { "shape": { "sphere": { "radius": 0.5 } }, "material": "first", "transform": [{ "translate": [0.5, 0, 0] }] },
            { "shape": { "box": { "size": [10, 10, 10] } }, "material": "grey" }
        ],
        "lights": [], "render": { "photons": 5000 }
    });
    let seen = |way| Measured::new(&scene, way, 0..6, |rendered| block_means(&all_y(rendered), 8, 4, &[true; 64]));
    let found = compare(&seen((Integrator::Photon, 16)), &seen((Integrator::Path, 128)));
    println!("a glowing ball in a ball of glass: {found}");
    assert!(found.is_equal(), "{found}");
}

/// A body with the index of air and the priority covers a glowing ball, which looks as without it.
#[test]
fn a_covered_lamp_looks_like_a_bare_one() {
    for integrator in [Integrator::Photon, Integrator::Path] {
        let luminance = |radius: f64| {
            let scene = json!({
                "camera": { "from": [0, 0, 4.5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 3 } } },
                "film": { "width": 2, "height": 2 },
                "materials": { "lamp": glass(1.0), "cover": { "dielectric": { "ior": 1, "priority": 1 } } },
                "objects": [
                    { "shape": { "sphere": { "radius": 0.5 } }, "material": "lamp",
                      "emission": { "spectrum": "E", "luminance": 100 } },
                    { "shape": { "sphere": { "radius": radius } }, "material": "cover",
                      "transform": [{ "translate": [5, 0, 0] }] }
                ],
                "lights": [], "render": { "photons": 100 }
            });
            all_y(&render(&scene, integrator, 1)).iter().sum::<f64>() / 4.0
        };
        let (bare, covered) = (luminance(1.0), luminance(6.0));
        assert!(bare > 0.0 && (covered / bare - 1.0).abs() < 1e-6, "{integrator:?}: {covered} for {bare}");
    }
}

/// Plates of glass that touch exactly are named, because a film of air remains between them. Plates
/// that overlap or that are apart are not.
#[test]
fn touching_plates_are_named() {
    for (height, touches) in [(0.25, true), (0.24, false), (0.26, false)] {
        let plate = |name: &str, y: f64| {
            json!({ "name": name, "shape": { "box": { "size": [4, 0.25, 4] } }, "material": "glass",
                    "transform": [{ "translate": [0, y, 0] }, { "rotate": { "axis": [1, 2, 0.5], "degrees": 37 } }] })
        };
        let scene = json!({
            "camera": { "from": [0, 0, 9], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 20 } } },
            "film": { "width": 2, "height": 2 }, "materials": { "glass": glass(1.5) },
            "objects": [plate("upper", height), plate("lower", 0.0)],
            "lights": [{ "environment": { "spectrum": "E", "luminance": 1 } }]
        });
        let notes = job(&scene).scene.notes.join("\n");
        assert_eq!(notes.contains("\"upper\" and \"lower\" touch"), touches, "{height}: {notes}");
    }
}
