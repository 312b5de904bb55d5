//! Rays against the scene: the nearest surface, and whether anything stands in the way.

use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_scene::geometry::shape::{PlacedShape, Shape};
use abbe_scene::geometry::{Geometry, Ray};
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::warp;
use criterion::{Criterion, Throughput};
use glam::{DAffine3, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const RAYS: usize = 10_000;

fn placed(shape: Shape, at: DVec3, object: u32) -> PlacedShape {
    PlacedShape { shape, to_world: DAffine3::from_translation(at), object }
}

/// A sphere of `rows` × 2 `rows` quadrilaterals, less the poles' halves.
fn ball_of_triangles(rows: u32) -> TriangleMesh {
    let columns = 2 * rows;
    let vertex = |row: u32, column: u32| {
        let (theta, phi) = (PI * f64::from(row) / f64::from(rows), TAU * f64::from(column) / f64::from(columns));
        DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    let vertices = (0..=rows).flat_map(|row| (0..columns).map(move |column| vertex(row, column))).collect();
    let number = |row: u32, column: u32| row * columns + column % columns;
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (number(row, column), number(row, column + 1));
            let (c, d) = (number(row + 1, column), number(row + 1, column + 1));
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    TriangleMesh::new(vertices, None, None, triangles).expect("a sphere")
}

fn cube() -> TriangleMesh {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0;
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::new((0..8).map(corner).collect(), None, None, triangles).expect("a cube")
}

/// Rays from a sphere of radius 3 towards places near the origin, most of which meet something.
fn rays() -> Vec<Ray> {
    let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
    let mut ray = || {
        let from = 3.0 * warp::sphere(stream.pair());
        Ray::new(from, (1.2 * warp::sphere(stream.pair()) * stream.uniform() - from).normalize())
    };
    (0..RAYS).map(|_| ray()).collect()
}

pub(crate) fn benches(c: &mut Criterion) {
    let mesh = |mesh| vec![placed(Shape::Mesh(Arc::new(mesh)), DVec3::ZERO, 0)];
    let ball = placed(Shape::Sphere { radius: 1.0 }, DVec3::ZERO, 0);
    let floor = placed(Shape::Rectangle { width: 10.0, height: 10.0 }, DVec3::NEG_Y, 1);
    let scenes = [
        ("sphere and rectangle", vec![ball, floor]),
        ("12 triangles", mesh(cube())),
        ("100,000 triangles", mesh(ball_of_triangles(160))),
    ];
    let rays = rays();
    let mut group = c.benchmark_group("geometry");
    group.throughput(Throughput::Elements(RAYS as u64));
    for (name, placed) in scenes {
        let geometry = Geometry::build(placed, DVec3::ZERO).expect("shapes with area");
        group.bench_function(format!("nearest surface/{name}"), |b| {
            b.iter(|| rays.iter().filter(|ray| geometry.intersect(ray, None, f64::INFINITY).is_some()).count());
        });
        group.bench_function(format!("shadow/{name}"), |b| {
            b.iter(|| rays.iter().filter(|ray| geometry.occluded(ray, None, None, 6.0)).count());
        });
    }
    group.finish();
}
