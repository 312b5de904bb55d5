//! The bounding volume hierarchy finds the same hits as brute force.

use super::*;
use crate::geometry::primitive::Candidate;
use crate::geometry::trace::RayQuery;

fn soup(count: usize, size: f64, rng: &mut Pcg64) -> TriangleMesh {
    let mut positions = Vec::new();
    for _ in 0..count {
        let at = DVec3::from_array(numbers(rng)) - 0.5;
        positions.extend((0..3).map(|_| at + size * unit_vector(rng)));
    }
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriangleMesh::new(positions, None, None, triangles).unwrap()
}

fn by_brute_force(geometry: &Geometry, ray: &Ray) -> Option<Candidate> {
    let query = RayQuery::new(geometry, ray, None);
    (0..geometry.primitive_count() as u32)
        .filter_map(|primitive| query.first_crossing(primitive))
        .min_by(|a, b| a.t.total_cmp(&b.t))
}

fn agrees(geometry: &Geometry, rays: usize, seed: u64) {
    let mut rng = random(seed);
    let (low, high) = geometry.bounds();
    let (middle, size) = (0.5 * (low + high), (high - low).length());
    let mut hits = 0;
    for i in 0..rays {
        let far = [0.3, 2.0, 1e4][i % 3];
        let origin = middle + far * size * unit_vector(&mut rng);
        let vertices = &geometry.primitives.vertices;
        let start = rng.random_range(0..vertices.len() / 3) * 3;
        let target = (vertices[start] + vertices[start + 1] + vertices[start + 2]) / 3.0;
        let ray = towards(origin, target);
        let expected = by_brute_force(geometry, &ray);
        let found = geometry.intersect(&ray, None, f64::INFINITY);
        assert_eq!(found.map(|hit| (hit.surface, hit.t)), expected.map(|hit| (hit.surface, hit.t)));
        if let Some(hit) = found {
            hits += 1;
            assert!(geometry.occluded(&ray, None, None, hit.t * 1.0001));
            assert!(!geometry.occluded(&ray, None, None, hit.t * 0.9999));
            assert!(!geometry.occluded(&ray, None, Some(hit.surface), hit.t));
            assert!(geometry.intersect(&ray, None, hit.t).is_none());
        }
    }
    assert!(hits > rays / 2, "only {hits} hits");
}

#[test]
fn bvh_finds_the_same_hits_as_brute_force() {
    let mut rng = random(31);
    for (count, size) in [(40, 0.3), (1500, 0.03), (1500, 0.3), (3000, 1e-3)] {
        let triangles = soup(count, size, &mut rng);
        for scale in [1e-6, 1.0, 1e6] {
            let mut things = vec![placed(mesh(triangles.clone()), turned(scale), 0)];
            for (object, shape) in (1..).zip(closed_shapes()) {
                let at = DAffine3::from_translation(2.0 * (DVec3::from_array(numbers(&mut rng)) - 0.5));
                things.push(placed(shape, turned(scale) * at * DAffine3::from_scale(DVec3::splat(0.1)), object));
            }
            agrees(&Geometry::build(things, DVec3::ZERO).unwrap(), 1000, 17);
        }
    }
}

#[test]
fn a_scene_of_very_different_sizes_loses_nothing() {
    // A mesh of one centimetre near a rectangle of ten kilometres.
    let mut rng = random(8);
    let small = DAffine3::from_translation(DVec3::new(3.0, 1.0, -2.0)) * DAffine3::from_scale(DVec3::splat(0.01));
    let triangles = mesh(soup(500, 0.1, &mut rng));
    let plain = placed(Shape::Rectangle { width: 1e4, height: 1e4 }, DAffine3::IDENTITY, 1);
    let geometry = Geometry::build(vec![placed(triangles, small, 0), plain], DVec3::ZERO).unwrap();
    for _ in 0..3000 {
        let target = small.transform_point3(DVec3::from_array(numbers(&mut rng)) - 0.5);
        let ray = towards(target + 10.0 * rng.random::<f64>() * unit_vector(&mut rng), target);
        let expected = by_brute_force(&geometry, &ray);
        let found = geometry.intersect(&ray, None, f64::INFINITY);
        assert_eq!(found.map(|hit| hit.surface), expected.map(|hit| hit.surface));
    }
}

#[test]
fn rays_along_the_axes_and_flat_scenes_are_no_exception() {
    // All triangles lie in one plane, so the box of the scene has no thickness.
    let mut positions = Vec::new();
    for i in 0..20 {
        for j in 0..20 {
            let at = DVec3::new(f64::from(i), 0.0, f64::from(j));
            positions.extend([at, at + 0.5 * DVec3::X, at + 0.5 * DVec3::Z]);
        }
    }
    let triangles = (0..400_u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let flat = TriangleMesh::new(positions, None, None, triangles).unwrap();
    let geometry = alone(mesh(flat), DAffine3::IDENTITY);
    for i in 0..20 {
        for j in 0..20 {
            let at = DVec3::new(f64::from(i) + 0.125, 0.0, f64::from(j) + 0.125);
            for (direction, back) in [(DVec3::NEG_Y, 7.0), (DVec3::Y, 1e-3), (DVec3::new(-0.0, -1.0, -0.0), 1e5)] {
                let hit = geometry.intersect(&Ray::new(at - back * direction, direction), None, f64::INFINITY).unwrap();
                assert_eq!(hit.position, at);
            }
            // A ray that lies in the plane hits nothing.
            assert!(geometry.intersect(&Ray::new(at - 50.0 * DVec3::X, DVec3::X), None, f64::INFINITY).is_none());
        }
    }
}

#[test]
fn many_boxes_at_one_place_do_not_exhaust_the_tree() {
    let things =
        (0..500).map(|object| placed(Shape::Sphere { radius: 1.0 + 1e-3 * f64::from(object) }, turned(1.0), object));
    let geometry = Geometry::build(things.collect(), DVec3::ZERO).unwrap();
    let centre = turned(1.0).translation;
    let mut passed = 0;
    geometry.for_each_hit(&Ray::new(centre, DVec3::X), None, |hit| {
        assert_eq!(hit.object, passed);
        passed += 1;
    });
    assert_eq!(passed, 500);
}

#[test]
fn a_triangle_takes_less_than_a_hundred_bytes() {
    let ball = icosphere(5);
    let count = ball.triangles().len();
    let with_normals =
        TriangleMesh::new(ball.positions().to_vec(), Some(ball.positions().to_vec()), None, ball.triangles().to_vec());
    let geometry = alone(mesh(with_normals.unwrap()), DAffine3::IDENTITY);
    let bytes = geometry.memory_bytes() as f64 / count as f64;
    assert!(bytes < 100.0, "{bytes} bytes a triangle");
}
