//! Test scenes, shapes and random numbers shared by the geometry tests.

mod alternation;
mod bvh;
mod closed_form;
mod coincidences;
mod instances;
mod leaks;
mod sampling;

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Geometry, Ray};
use crate::geometry::mesh::TriangleMesh;
use crate::geometry::shape::{PlacedShape, Shape};

fn random(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

fn unit_vector(rng: &mut Pcg64) -> DVec3 {
    let z: f64 = rng.random_range(-1.0..1.0);
    let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
    let ring = (1.0 - z * z).sqrt();
    DVec3::new(ring * cos, ring * sin, z)
}

fn numbers(rng: &mut Pcg64) -> [f64; 3] {
    [rng.random(), rng.random(), rng.random()]
}

fn towards(from: DVec3, to: DVec3) -> Ray {
    Ray::new(from, (to - from).normalize())
}

fn placed(shape: Shape, to_world: DAffine3, object: u32) -> PlacedShape {
    PlacedShape { shape, to_world, object }
}

fn alone(shape: Shape, to_world: DAffine3) -> Geometry {
    Geometry::build(vec![placed(shape, to_world, 0)], DVec3::ZERO).unwrap()
}

/// Rotates, translates and scales uniformly, with matrix entries that are not round numbers.
fn turned(scale: f64) -> DAffine3 {
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    DAffine3::from_scale_rotation_translation(DVec3::splat(scale), rotation, scale * DVec3::new(0.3, -0.2, 0.5))
}

/// Returns a mirroring transform with a different scale along each axis.
fn stretched() -> DAffine3 {
    turned(1.0) * DAffine3::from_scale(DVec3::new(1.7, -0.6, 0.9))
}

fn lens(radius1: f64, radius2: f64, thickness: f64) -> Shape {
    Shape::Lens { radius1, radius2, thickness, diameter: 0.5 }
}

/// Returns all pairs of convex, concave and plane surfaces, a flat and a rod lens.
fn lenses() -> Vec<Shape> {
    let mut all = Vec::new();
    for radius1 in [0.5, -0.6, 0.0] {
        for radius2 in [-0.4, 0.7, 0.0] {
            all.push(lens(radius1, radius2, 0.25));
        }
    }
    all.extend([lens(1e4, -1e4, 0.01), lens(0.25, -0.25, 0.8), lens(0.3, 0.3, 0.05), lens(-0.26, 0.26, 0.01)]);
    all
}

/// Returns closed analytic shapes of every kind, including a 1 cm prism and a 10 µm slab.
fn closed_shapes() -> Vec<Shape> {
    let mut all = vec![
        Shape::Sphere { radius: 1.0 },
        Shape::Prism { side: 1.0, length: 1.0, apex_deg: 60.0 },
        Shape::Prism { side: 0.01, length: 0.01, apex_deg: 35.0 },
        Shape::Box { size: DVec3::new(1.0, 2.0, 0.5) },
        Shape::Box { size: DVec3::new(1.0, 1e-5, 1.0) },
        Shape::Cylinder { radius: 0.3, height: 1.0 },
        Shape::Cylinder { radius: 1.0, height: 0.001 },
    ];
    all.extend(lenses());
    all
}

/// Returns a closed mesh of 20·4ⁿ triangles with shared vertices on the unit sphere.
fn icosphere(levels: u32) -> TriangleMesh {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions: Vec<DVec3> = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        positions.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let near = |a: DVec3, b: DVec3| (a.distance(b) - 2.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for a in 0..12_usize {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|i| positions[i]);
                if near(p, q) && near(q, r) && near(r, p) {
                    let outwards = (q - p).cross(r - p).dot(p) > 0.0;
                    triangles.push(if outwards { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    positions.push(0.5 * (positions[a as usize] + positions[b as usize]));
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let positions = positions.into_iter().map(DVec3::normalize).collect();
    TriangleMesh::new(positions, None, None, triangles).unwrap()
}

fn box_mesh(size: DVec3) -> TriangleMesh {
    let corner = |i: usize| 0.5 * size * DVec3::new([-1.0, 1.0][i & 1], [-1.0, 1.0][i >> 1 & 1], [-1.0, 1.0][i >> 2]);
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::new((0..8).map(corner).collect(), None, None, triangles).unwrap()
}

fn mesh(mesh: TriangleMesh) -> Shape {
    Shape::Mesh(Arc::new(mesh))
}
