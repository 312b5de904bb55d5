use std::f64::consts::TAU;

use glam::{DAffine3, DQuat};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;
use crate::scene::shape::{Placed, Shape};

fn unit_vector(rng: &mut Pcg64) -> DVec3 {
    let z: f64 = rng.random_range(-1.0..1.0);
    let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
    let ring = (1.0 - z * z).sqrt();
    DVec3::new(ring * cos, ring * sin, z)
}

fn placed(shape: Shape, to_world: DAffine3) -> Placed {
    Placed { shape, to_world, object: 0 }
}

fn alone(shape: Shape, to_world: DAffine3) -> Geometry {
    Geometry::build(vec![placed(shape, to_world)], DVec3::ZERO).unwrap()
}

fn turned(scale: f64) -> DAffine3 {
    let rotation = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    DAffine3::from_scale_rotation_translation(DVec3::splat(scale), rotation, scale * DVec3::new(0.3, -0.2, 0.5))
}

/// A path that goes through the surface or is reflected inside at random must enter and leave by turns, and must
/// not escape from inside.
fn enter_and_leave_alternate(shape: Shape, paths: u64) {
    for scale in [1e-6, 1.0, 1e6] {
        let geometry = alone(shape.clone(), turned(scale));
        let (low, high) = geometry.bounds();
        let (middle, reach) = (0.5 * (low + high), 0.5 * (high - low).length());
        let mut rng = Pcg64::seed_from_u64(7);
        for path in 0..paths {
            let towards = middle + 0.8 * rng.random::<f64>() * reach * unit_vector(&mut rng);
            let origin = middle + 3.0 * reach * unit_vector(&mut rng);
            let mut ray = Ray::new(origin, (towards - origin).normalize());
            let (mut from, mut inside) = (None, false);
            for _ in 0..12 {
                let Some(hit) = geometry.intersect(&ray, from, f64::INFINITY) else {
                    assert!(!inside, "path {path} at scale {scale} escaped from inside {shape:?}");
                    break;
                };
                let leaving = ray.direction.dot(hit.normal) > 0.0;
                assert_eq!(leaving, inside, "path {path} at scale {scale} of {shape:?}");
                // Refraction-like: through the surface with a bent direction, or back inside.
                let side = if leaving && rng.random::<f64>() < 0.6 {
                    -hit.normal
                } else if leaving {
                    hit.normal
                } else {
                    -hit.normal
                };
                inside = side.dot(hit.normal) < 0.0;
                let mut direction = unit_vector(&mut rng);
                if direction.dot(side) < 0.0 {
                    direction = -direction;
                }
                ray = Ray::new(hit.position, direction);
                from = Some(hit.surface);
            }
        }
    }
}

#[test]
fn rays_enter_and_leave_closed_shapes_by_turns() {
    let paths = 20_000;
    enter_and_leave_alternate(Shape::Sphere { radius: 1.0 }, paths);
    enter_and_leave_alternate(Shape::Prism { side: 1.0, length: 1.0, apex_deg: 60.0 }, paths);
    enter_and_leave_alternate(Shape::Prism { side: 0.01, length: 0.01, apex_deg: 60.0 }, paths);
    enter_and_leave_alternate(Shape::Box { size: DVec3::new(1.0, 2.0, 0.5) }, paths);
    enter_and_leave_alternate(Shape::Box { size: DVec3::new(1.0, 1e-5, 1.0) }, paths);
    enter_and_leave_alternate(Shape::Cylinder { radius: 0.3, height: 1.0 }, paths);
    for (radius1, radius2) in
        [(0.5, -0.5), (-0.5, 0.5), (0.4, 0.7), (0.7, 0.5), (0.0, -0.3), (0.0, 0.4), (0.3, 0.0), (1e4, -1e4)]
    {
        enter_and_leave_alternate(Shape::Lens { radius1, radius2, thickness: 0.25, diameter: 0.5 }, paths);
    }
    enter_and_leave_alternate(Shape::Lens { radius1: 0.25, radius2: -0.25, thickness: 0.8, diameter: 0.5 }, paths);
}
