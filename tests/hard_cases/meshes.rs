//! Hand-made meshes, and rays at their edges and vertices.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use serde_json::json;

use abbe_format as format;
use abbe_format::resolve::resolve;
use abbe_optics::bsdf::TransportMode;
use abbe_scene::Scene;
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_scene::geometry::shape::{PlacedShape, Shape};
use abbe_scene::geometry::{Geometry, Ray};
use abbe_scene::medium_stack::MediumStack;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::warp;
use abbe_spectra::spectrum::Wavelengths;
use abbe_transport::walk::{RayState, SurfaceLookup, next_interaction, scatter};

/// Vertices and triangles.
pub(crate) type Raw = (Vec<DVec3>, Vec<[u32; 3]>);

/// An octahedron subdivided `levels` times, with its vertices on the unit sphere.
pub(crate) fn ball(levels: usize) -> Raw {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut corners = axes.to_vec();
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                corners.push((corners[a as usize] + corners[b as usize]).normalize());
                corners.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    (corners, triangles)
}

/// The geometry of a single shape.
pub(crate) fn alone(shape: Shape) -> Geometry {
    Geometry::build(vec![PlacedShape { shape, to_world: DAffine3::IDENTITY, object: 0 }], DVec3::ZERO).unwrap()
}

pub(crate) fn mesh((corners, triangles): Raw) -> TriangleMesh {
    TriangleMesh::new(corners, None, None, triangles).unwrap()
}

/// The targets of rays on a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum At {
    /// Vertices, points on edges, directions along edges, and faces.
    Everything,
    /// Points of faces only.
    Faces,
}

/// A scene that contains only a glass mesh, written as an OBJ file.
pub(crate) fn glass_scene((corners, triangles): &Raw) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let mut text: String = corners.iter().map(|c| format!("v {} {} {}\n", c.x, c.y, c.z)).collect();
    triangles.iter().for_each(|[a, b, c]| text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    std::fs::write(folder.path().join("mesh.obj"), text).unwrap();
    let scene = json!({
        "camera": { "from": [0, 0, 9], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
        "film": { "width": 1, "height": 1 }, "materials": { "glass": { "dielectric": { "ior": 1.5 } } },
        "objects": [{ "name": "stone", "shape": { "mesh": { "path": "mesh.obj" } }, "material": "glass" }],
        "lights": [{ "point": { "at": [5, 5, 5], "spectrum": 1, "power": 1 } }]
    });
    let (scene, source) = format::parse(scene.to_string(), &folder.path().join("scene.json"), &[]).unwrap();
    resolve(&scene, &source).unwrap()
}

/// Sends rays into a closed star-shaped glass mesh about the origin. They start outside and inside
/// and aim at vertices, points on edges, along edges and at faces. Returns the number of paths that
/// never leave the mesh, leave it without having entered, or end outside it in glass.
pub(crate) fn leaks(raw: &Raw, at: At, rays: u64) -> f64 {
    const CHUNK: u64 = 4096;
    const LONGEST: usize = 30;
    let scene = glass_scene(raw);
    let corners: Vec<DVec3> = raw.0.iter().map(|corner| *corner - scene.centre).collect();
    let reach = corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
    let leaky = |index: u64| {
        let mut stream = Stream::new(Seed::new(3), Purpose::Camera, 0, index);
        let mut triangle =
            || raw.1[(stream.uniform() * raw.1.len() as f64) as usize].map(|corner| corners[corner as usize]);
        let ([a, b, c], [from, ..]) = (triangle(), triangle());
        let share = stream.uniform();
        let edge = a + share * (b - a);
        let target = match (at, index % 4) {
            (At::Everything, 0) => a,
            (At::Everything, 1) => edge,
            (At::Everything, 2) => 0.5 * (a + b),
            (At::Everything | At::Faces, _) => edge + stream.uniform() * (c - edge),
        };
        let within = index % 8 < 4;
        let from = match (within, index % 16) {
            (true, _) => 1e-3 * from,
            (false, 13) if at == At::Everything => target + (a - b).normalize() * (3.0 * reach),
            (false, _) => warp::sphere(stream.pair()) * (3.0 * reach),
        };
        let ray = Ray::new(from, (target - from).normalize());
        let medium_stack = if within { MediumStack::AIR.entered(0) } else { MediumStack::AIR };
        let mut start = RayState { ray, from: None, medium_stack };
        for _ in 0..LONGEST {
            let Some(interaction) = next_interaction(&scene, start, SurfaceLookup::of_line(0.0)) else {
                return !start.medium_stack.is_air();
            };
            let leaves = interaction.incoming.dot(interaction.hit.normal) > 0.0;
            if leaves == interaction.here.is_air() {
                return true;
            }
            let Some(way) = scatter(&interaction, &Wavelengths::single(550.0), TransportMode::Importance, &mut stream)
            else {
                return true;
            };
            start = interaction.spawn_scattered(&way);
        }
        false
    };
    let count = |chunk: u64| (chunk * CHUNK..((chunk + 1) * CHUNK).min(rays)).filter(|&index| leaky(index)).count();
    (0..rays.div_ceil(CHUNK)).into_par_iter().map(count).sum::<usize>() as f64
}
