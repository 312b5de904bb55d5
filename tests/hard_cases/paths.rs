//! Random paths through glass objects, compared with closed forms of what is inside.

use glam::DVec3;
use serde_json::{Value, json};

use abbe_optics::bsdf::TransportMode;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::warp;
use abbe_spectra::spectrum::Wavelengths;
use abbe_transport::walk::{RayState, SurfaceLookup, next_interaction, scatter};

use super::common::job;

/// An object about the origin whose inside has a closed form.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Body {
    /// A ball, by its radius.
    Ball(f64),
    /// A box, by its centre and half extents.
    Box(DVec3, DVec3),
    /// An equilateral prism along z, by its inner radius and half its length.
    Prism(f64, f64),
}

/// A body with the name, shape and material of its object.
pub(crate) type NamedBody = (Body, (String, Value, Value));

impl Body {
    pub(crate) fn prism(side: f64, length: f64) -> Self {
        Self::Prism(side / 12.0_f64.sqrt(), 0.5 * length)
    }

    /// A slab of 1 × `thickness` × 1.
    pub(crate) fn slab(thickness: f64) -> Self {
        Self::Box(DVec3::ZERO, DVec3::new(0.5, 0.5 * thickness, 0.5))
    }

    /// Returns the distance of a point from the body; negative inside.
    fn outside(&self, p: DVec3) -> f64 {
        match *self {
            Self::Ball(radius) => p.length() - radius,
            Self::Box(middle, half) => ((p - middle).abs() - half).max_element(),
            Self::Prism(inner, half) => {
                let (sin, cos) = std::f64::consts::FRAC_PI_6.sin_cos();
                let legs = [-p.y, cos * p.x + sin * p.y, -cos * p.x + sin * p.y];
                legs.into_iter().fold(p.z.abs() - half, |out, leg| out.max(leg - inner))
            }
        }
    }
}

/// Follows random paths through bodies (in rising order of priority). Counts the segments whose
/// midpoint is not in the medium of the path's stack, and the paths that leave the scene in a
/// medium other than air.
pub(crate) fn wrong_sides(bodies: &[NamedBody], paths: u64) -> f64 {
    const FARTHEST: f64 = 1.2;
    let objects: Vec<Value> = bodies
        .iter()
        .map(|(body, (name, shape, _))| {
            let middle = match body {
                Body::Box(middle, _) => middle.to_array(),
                Body::Ball(_) | Body::Prism(..) => [0.0; 3],
            };
            json!({ "name": name, "shape": shape, "material": name, "transform": [{ "translate": middle }] })
        })
        .collect();
    let materials: serde_json::Map<String, Value> =
        bodies.iter().map(|(_, (name, _, material))| (name.clone(), material.clone())).collect();
    let job = job(&json!({
        "camera": { "from": [0, 0, 9], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 1, "height": 1 }, "materials": materials, "objects": objects,
        "lights": [{ "point": { "at": [5, 5, 5], "spectrum": 1, "power": 1 } }]
    }));
    let scene = &job.scene;
    let sodium = Wavelengths::single(589.3);
    let mut wrong = 0_u64;
    for path in 0..paths {
        let mut stream = Stream::new(Seed::new(11), Purpose::FreePhoton, 0, path);
        let from = warp::sphere(stream.pair()) * 3.0;
        let at = warp::sphere(stream.pair()) * (FARTHEST * 0.5 * stream.uniform());
        let ray = Ray::new(from - scene.centre, (at - from).normalize());
        let mut start = RayState { ray, from: None, medium_stack: scene.medium_stack_at(ray.origin) };
        let mut events = 0;
        while let Some(interaction) = next_interaction(scene, start, SurfaceLookup::of_line(0.0)) {
            let middle = 0.5 * (start.ray.origin + interaction.hit.position) + scene.centre;
            let sure = bodies.iter().all(|(body, _)| body.outside(middle).abs() > 1e-13);
            let truth = bodies.iter().rposition(|(body, _)| body.outside(middle) < 0.0).map(|index| index as u32);
            wrong += u64::from(sure && scene.dominant_dielectric(&interaction.here) != truth);
            events += 1;
            let Some(scattered) = scatter(&interaction, &sodium, TransportMode::Importance, &mut stream) else { break };
            start = interaction.spawn_scattered(&scattered);
            if events == 40 {
                break;
            }
        }
        wrong += u64::from(events < 40 && !start.medium_stack.is_air());
    }
    wrong as f64
}

/// The same count for glass beside glass, and glass flush with the faces of the surrounding water.
pub(crate) fn wrong_sides_at_coincident_faces(paths: u64) -> f64 {
    let block = |name: &str, middle: [f64; 3], size: [f64; 3], ior: f64, priority: i32| {
        let material = json!({ "dielectric": { "ior": ior, "priority": priority } });
        let body = Body::Box(DVec3::from(middle), DVec3::from(size) * 0.5);
        (body, (name.to_string(), json!({ "box": { "size": size } }), material))
    };
    let beside = [
        block("crown", [-0.35, 0.0, 0.0], [0.7, 0.6, 0.6], 1.5, 0),
        block("flint", [0.35, 0.0, 0.0], [0.7, 0.6, 0.6], 1.7, 0),
    ];
    let flush =
        [block("water", [0.0; 3], [1.0, 0.8, 0.6], 1.33, 0), block("glass", [0.2, 0.1, 0.0], [0.6, 0.6, 0.6], 1.5, 1)];
    wrong_sides(&beside, paths) + wrong_sides(&flush, paths)
}
