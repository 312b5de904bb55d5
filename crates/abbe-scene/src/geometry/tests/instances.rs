use super::*;
use crate::geometry::hit::Hit;

/// Returns transforms of very different sizes that overlap in places. Some of them mirror.
fn places(count: u32) -> Vec<DAffine3> {
    let mut rng = random(5);
    (0..count)
        .map(|i| {
            let size = [1.0, 0.3, 1e-4][i as usize % 3];
            let shift = DAffine3::from_translation(3.0 * DVec3::from(numbers(&mut rng)) - 1.5);
            shift * if i % 4 == 3 { stretched() * DAffine3::from_scale(DVec3::splat(size)) } else { turned(size) }
        })
        .collect()
}

/// Returns a scene with one object at each place. `mesh` returns the mesh of an object.
fn scene(places: &[DAffine3], mesh: impl Fn() -> Arc<TriangleMesh>) -> Geometry {
    let shapes = (0..).zip(places).map(|(object, &to_world)| placed(Shape::Mesh(mesh()), to_world, object));
    Geometry::build(shapes.collect(), DVec3::new(0.1, -0.2, 0.3)).unwrap()
}

fn shared(mesh: &TriangleMesh, places: &[DAffine3]) -> Geometry {
    let one = Arc::new(mesh.clone());
    scene(places, || Arc::clone(&one))
}

/// Returns the same scene twice: with one shared mesh, and with a copy of the mesh for each object.
fn shared_and_copied(mesh: &TriangleMesh, places: &[DAffine3]) -> [Geometry; 2] {
    [shared(mesh, places), scene(places, || Arc::new(mesh.clone()))]
}

fn same(a: &Hit, b: &Hit) -> bool {
    let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-12;
    a.object == b.object
        && (a.t - b.t).abs() < 1e-12
        && close(a.position, b.position)
        && close(a.normal, b.normal)
        && close(a.shading_normal, b.shading_normal)
}

/// Instances are hit where copies are hit, also by rays that start on them.
#[test]
fn instances_are_hit_like_copies() {
    let ball = icosphere(2);
    let (positions, triangles) = (ball.positions().to_vec(), ball.triangles().to_vec());
    let uvs = positions.iter().map(|p| [p.x, 2.0 * p.y + p.z]).collect();
    let ball = TriangleMesh::new(positions.clone(), Some(positions), Some(uvs), triangles).unwrap();
    let [shared, copied] = shared_and_copied(&ball, &places(24));
    assert_eq!(shared.primitive_count(), copied.primitive_count());
    let mut rng = random(6);
    let mut hits = 0;
    for _ in 0..4_000 {
        let ray = Ray::new(4.0 * unit_vector(&mut rng), unit_vector(&mut rng));
        let ray = towards(ray.origin, 1.5 * DVec3::from(numbers(&mut rng)) - 0.5);
        let [mut found, mut expected] = [Vec::new(), Vec::new()];
        shared.for_each_hit(&ray, None, |hit| found.push(*hit));
        copied.for_each_hit(&ray, None, |hit| expected.push(*hit));
        assert_eq!(found.len(), expected.len(), "{ray:?}");
        for (a, b) in found.iter().zip(&expected) {
            assert!(same(a, b), "{a:?}\n{b:?}");
            let (uv, expected) = (shared.uv(a), copied.uv(b));
            assert!(uv.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{uv:?} {expected:?}");
        }
        hits += found.len();
        let end = 8.0 * numbers(&mut rng)[0];
        assert_eq!(shared.occluded(&ray, None, None, end), copied.occluded(&ray, None, None, end), "{ray:?}");
    }
    assert!(hits > 8_000, "{hits}");
}

#[test]
fn instances_have_the_areas_and_the_bounds_of_copies() {
    let places = places(12);
    let [shared, copied] = shared_and_copied(&icosphere(2), &places);
    for object in 0..places.len() as u32 {
        let [a, b] = [&shared, &copied].map(|geometry| geometry.area(object));
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        let [(low, high), (least, most)] = [&shared, &copied].map(|geometry| geometry.bounds_of(object).unwrap());
        let slack = 1e-12 * DVec3::ONE;
        assert!(low.cmple(least + slack).all() && high.cmpge(most - slack).all());
        assert!((high - low).length() < 2.0 * (most - least).length(), "the box is not much too large");
    }
}

/// A thousand instances take the memory of one mesh and less than 1 KB each.
#[test]
fn an_instance_takes_less_than_a_kilobyte() {
    let mesh = icosphere(5);
    let bytes = |count| shared(&mesh, &places(count)).memory_bytes() as f64;
    let (two, many) = (bytes(2), bytes(1_000));
    assert!((many - two) / 998.0 < 1024.0, "{} bytes for each instance", (many - two) / 998.0);
    let triangles = mesh.triangles().len() as f64;
    assert!(two / triangles < 120.0, "{} bytes for each triangle", two / triangles);
}

/// Meshes with few triangles, and meshes that are placed once, are copied.
#[test]
fn small_meshes_are_copied() {
    let instances = |levels, count| shared(&icosphere(levels), &places(count)).primitives.instances.list.len();
    assert_eq!([instances(1, 3), instances(2, 1), instances(2, 3)], [0, 0, 3]);
}
