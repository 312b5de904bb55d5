//! Rays a second: from outside, from surfaces, and shadow rays, on scenes of few, twelve and many
//! primitives. Time and memory of a mesh file.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::hint::black_box;
use std::sync::Arc;

use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_scene::geometry::shape::{PlacedShape, Shape};
use abbe_scene::geometry::{Geometry, Ray, SurfaceId};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DAffine3, DVec3};

const RAYS: usize = 4096;

/// The fractional parts of multiples of irrational numbers: even, and the same every time.
fn numbers(i: usize) -> [f64; 4] {
    [0.754_877_666, 0.569_840_291, 0.819_172_513, 0.671_043_607].map(|step| (i as f64 * step).fract())
}

fn unit_vector(u: f64, v: f64) -> DVec3 {
    let z = 1.0 - 2.0 * u;
    let (sin, cos) = (TAU * v).sin_cos();
    DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
}

fn placed(shape: Shape, to_world: DAffine3, object: u32) -> PlacedShape {
    PlacedShape { shape, to_world, object }
}

fn build(placed: Vec<PlacedShape>) -> Geometry {
    Geometry::build(placed, DVec3::ZERO).expect("the bench's scenes are valid")
}

fn cube() -> Geometry {
    let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = TriangleMesh::new((0..8).map(corner).collect(), None, None, triangles).expect("a cube");
    build(vec![placed(Shape::Mesh(Arc::new(mesh)), DAffine3::IDENTITY, 0)])
}

/// A wavy sheet of 2·n² triangles.
fn sheet(n: u32) -> TriangleMesh {
    let side = n + 1;
    let at = |i: u32| {
        let (x, z) = (f64::from(i % side) / f64::from(n), f64::from(i / side) / f64::from(n));
        DVec3::new(x, 0.2 * (13.0 * x).sin() * (17.0 * z).cos(), z)
    };
    let triangles = (0..n * n)
        .flat_map(|i| {
            let a = i / n * side + i % n;
            [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]
        })
        .collect();
    TriangleMesh::new((0..side * side).map(at).collect(), None, None, triangles).expect("a sheet")
}

fn waves(n: u32) -> Geometry {
    build(vec![placed(Shape::Mesh(Arc::new(sheet(n))), DAffine3::IDENTITY, 0)])
}

/// A thousand instances of a sheet of 100,352 triangles, one above the other.
fn instances() -> Geometry {
    let mesh = Arc::new(sheet(224));
    let above = |i: u32| DAffine3::from_translation(f64::from(i) * DVec3::Y);
    build((0..1000).map(|i| placed(Shape::Mesh(Arc::clone(&mesh)), above(i), i)).collect())
}

/// The bytes of a binary PLY file with a sheet of 2·n² triangles.
fn ply(n: u32) -> Vec<u8> {
    let mesh = sheet(n);
    let (vertices, triangles) = (mesh.positions().len(), mesh.triangles().len());
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {triangles}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    bytes.extend(mesh.positions().iter().flat_map(|p| p.to_array()).flat_map(|x| (x as f32).to_le_bytes()));
    for corners in mesh.triangles() {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    }
    bytes
}

fn ball_on_floor() -> Geometry {
    let floor = placed(Shape::Rectangle { width: 4.0, height: 4.0 }, DAffine3::IDENTITY, 0);
    build(vec![floor, placed(Shape::Sphere { radius: 1.0 }, DAffine3::from_translation(DVec3::Y), 1)])
}

fn furnished_room() -> Geometry {
    let turns = [
        DAffine3::IDENTITY,
        DAffine3::from_rotation_x(FRAC_PI_2),
        DAffine3::from_rotation_x(PI),
        DAffine3::from_rotation_z(FRAC_PI_2),
        DAffine3::from_rotation_z(-FRAC_PI_2),
    ];
    let wall = |turn| turn * DAffine3::from_translation(DVec3::NEG_Y);
    let walls = (0..).zip(turns).map(|(i, turn)| placed(Shape::Rectangle { width: 2.0, height: 2.0 }, wall(turn), i));
    let block =
        |x: f64, turn: f64| DAffine3::from_translation(DVec3::new(x, -0.7, x)) * DAffine3::from_rotation_y(turn);
    let lamp = DAffine3::from_translation(0.99 * DVec3::Y) * DAffine3::from_rotation_x(PI);
    let furniture = [
        placed(Shape::Box { size: DVec3::splat(0.6) }, block(0.4, 0.3), 5),
        placed(Shape::Box { size: DVec3::splat(0.6) }, block(-0.4, -0.3), 6),
        placed(Shape::Rectangle { width: 0.5, height: 0.5 }, lamp, 7),
    ];
    build(walls.chain(furniture).collect())
}

fn rates(criterion: &mut Criterion, name: &str, geometry: &Geometry) {
    let (low, high) = geometry.bounds();
    let (middle, reach) = (0.5 * (low + high), 0.5 * (high - low).length());
    let outside: Vec<Ray> = (0..RAYS)
        .map(|i| {
            let [a, b, c, d] = numbers(i);
            let (from, to) = (middle + reach * unit_vector(a, b), middle + 0.5 * reach * unit_vector(c, d));
            Ray::new(from, (to - from).normalize())
        })
        .collect();
    let surfaces: Vec<(Ray, Option<SurfaceId>)> = (0..RAYS)
        .filter_map(|i| {
            let hit = geometry.intersect(&outside[i], None, f64::INFINITY)?;
            let [a, b, _, _] = numbers(i + RAYS);
            let direction = unit_vector(a, b);
            Some((Ray::new(hit.position, direction), Some(hit.surface)))
        })
        .collect();
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(outside.len() as u64));
    group.bench_function("from outside", |bench| {
        bench.iter(|| {
            outside.iter().filter(|ray| geometry.intersect(black_box(ray), None, f64::INFINITY).is_some()).count()
        });
    });
    group.throughput(Throughput::Elements(surfaces.len() as u64));
    group.bench_function("from surfaces", |bench| {
        bench.iter(|| {
            surfaces
                .iter()
                .filter(|(ray, from)| geometry.intersect(black_box(ray), *from, f64::INFINITY).is_some())
                .count()
        });
    });
    group.bench_function("shadow rays", |bench| {
        bench.iter(|| {
            surfaces.iter().filter(|(ray, from)| geometry.occluded(black_box(ray), *from, None, reach)).count()
        });
    });
    group.finish();
}

fn rays(criterion: &mut Criterion) {
    rates(criterion, "ball on a floor", &ball_on_floor());
    rates(criterion, "room of 8 shapes", &furnished_room());
    rates(criterion, "12 triangles", &cube());
    rates(criterion, "100,352 triangles", &waves(224));
    rates(criterion, "1000 instances of 100,352 triangles", &instances());
}

/// Reads a PLY file of 500,000 triangles and builds its hierarchy.
fn load(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sheet.ply");
    std::fs::write(&path, ply(500)).expect("the file is written");
    let load = || {
        let file = abbe_format::mesh::load(&path, abbe_format::FileAccess::Anywhere).expect("a mesh");
        let mesh = Arc::new(file.parts.into_iter().next().expect("one part").mesh);
        build(vec![placed(Shape::Mesh(mesh), DAffine3::IDENTITY, 0)])
    };
    let geometry = load();
    let triangles = geometry.primitive_count();
    println!("memory: {} bytes for each triangle", geometry.memory_bytes() / triangles);
    println!("memory: {} bytes for each triangle of 1000 instances", {
        let geometry = instances();
        geometry.memory_bytes() as f64 / geometry.primitive_count() as f64
    });
    let mut group = criterion.benchmark_group("mesh file");
    group.sample_size(10).throughput(Throughput::Elements(triangles as u64));
    group.bench_function("load", |bench| bench.iter(load));
    group.finish();
}

criterion_group!(benches, rays, load);
criterion_main!(benches);
