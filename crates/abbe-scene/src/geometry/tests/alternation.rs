//! Paths enter and leave closed bodies alternately.

use super::*;

/// Follows random paths that cross each surface or stay on the same side of it. They must enter and
/// leave the body alternately, and must not escape from its inside.
fn enter_and_leave_alternate(shape: &Shape, to_world: DAffine3, paths: u64) {
    let geometry = alone(shape.clone(), to_world);
    let (low, high) = geometry.bounds();
    let (middle, size) = (0.5 * (low + high), 0.5 * (high - low).length());
    let mut rng = random(7);
    let mut entered = 0;
    for path in 0..paths {
        let target = middle + rng.random::<f64>() * size * unit_vector(&mut rng);
        let mut ray = towards(middle + 3.0 * size * unit_vector(&mut rng), target);
        let (mut from, mut inside) = (None, false);
        for _ in 0..16 {
            let Some(hit) = geometry.intersect(&ray, from, f64::INFINITY) else {
                assert!(!inside, "path {path} escaped from inside {shape:?} at {ray:?}");
                break;
            };
            let leaving = ray.direction.dot(hit.normal) > 0.0;
            assert_eq!(leaving, inside, "path {path} in {shape:?} at {ray:?} met {hit:?}");
            inside = rng.random::<f64>() < 0.6;
            entered += u64::from(inside);
            let mut direction = unit_vector(&mut rng);
            if (direction.dot(hit.normal) < 0.0) != inside {
                direction = -direction;
            }
            ray = Ray::new(hit.position, direction);
            from = Some(hit.surface);
        }
    }
    assert!(entered > paths / 4, "too few paths entered {shape:?}");
}

/// Returns closed shapes and meshes, of which one is very flat.
fn bodies() -> Vec<Shape> {
    let meshes = [mesh(icosphere(3)), mesh(box_mesh(DVec3::ONE)), mesh(box_mesh(DVec3::new(1.0, 1e-5, 1.0)))];
    closed_shapes().into_iter().chain(meshes).collect()
}

#[test]
fn paths_enter_and_leave_closed_bodies_by_turns_at_every_scale() {
    for shape in bodies() {
        for to_world in [turned(1e-6), turned(1.0), turned(1e6), stretched()] {
            enter_and_leave_alternate(&shape, to_world, 4000);
        }
    }
}

#[test]
#[ignore = "a million paths through each shape: a minute; cargo test --release -- --ignored million_paths"]
fn a_million_paths_enter_and_leave_every_shape_by_turns() {
    for shape in bodies() {
        enter_and_leave_alternate(&shape, turned(1.0), 1_000_000);
    }
}

#[test]
fn a_ray_that_starts_on_a_ball_finds_only_the_far_side() {
    for scale in [1e-6, 1.0, 1e6] {
        let geometry = alone(Shape::Sphere { radius: 1.0 }, turned(scale));
        let mut rng = random(3);
        for _ in 0..10_000 {
            let start = geometry.sample_area(0, numbers(&mut rng));
            let direction = unit_vector(&mut rng);
            let found = geometry.intersect(&Ray::new(start.position, direction), Some(start.surface), f64::INFINITY);
            let cos = direction.dot(start.normal);
            match found {
                Some(hit) => {
                    assert!(cos < 0.0);
                    assert!((hit.t + 2.0 * scale * cos).abs() <= 1e-14 * scale, "chord {} for cos {cos}", hit.t);
                }
                None => assert!(cos > 0.0),
            }
        }
    }
}
