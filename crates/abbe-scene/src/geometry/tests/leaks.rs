//! Rays do not leak through closed meshes, not even at edges and vertices.

use super::*;

/// Counts rays from inside that do not leave once more often than they enter.
fn leaks(geometry: &Geometry, rays: impl Iterator<Item = Ray>) -> u64 {
    let mut leaks = 0;
    for ray in rays {
        let mut balance = 0;
        geometry.for_each_hit(&ray, None, |hit| balance += if ray.direction.dot(hit.normal) > 0.0 { 1 } else { -1 });
        leaks += u64::from(balance != 1);
    }
    leaks
}

#[test]
fn random_rays_do_not_leak_out_of_a_closed_mesh() {
    let mut rng = random(1);
    for to_world in [turned(1.0), turned(1e-6), turned(1e6)] {
        let geometry = alone(mesh(icosphere(4)), to_world);
        let from_inside = (0..100_000).map(|_| {
            let origin = to_world.transform_point3(0.9 * rng.random::<f64>() * unit_vector(&mut rng));
            Ray::new(origin, unit_vector(&mut rng))
        });
        assert_eq!(leaks(&geometry, from_inside), 0);
    }
}

#[test]
#[ignore = "ten million rays: ten seconds; cargo test --release -- --ignored ten_million"]
fn ten_million_rays_do_not_leak_out_of_a_closed_mesh() {
    let geometry = alone(mesh(icosphere(5)), turned(1.0));
    let mut rng = random(1);
    let from_inside = (0..10_000_000).map(|_| {
        let origin = turned(1.0).transform_point3(0.9 * rng.random::<f64>() * unit_vector(&mut rng));
        Ray::new(origin, unit_vector(&mut rng))
    });
    assert_eq!(leaks(&geometry, from_inside), 0);
}

#[test]
fn rays_at_vertices_and_edges_do_not_leak() {
    let ball = icosphere(3);
    let geometry = alone(mesh(ball.clone()), DAffine3::IDENTITY);
    let mut rng = random(6);
    let mut targets = ball.positions().to_vec();
    for &triangle in ball.triangles() {
        let [a, b, c] = ball.corners(triangle);
        targets.extend([0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), 0.25 * a + 0.75 * b]);
    }
    let rays: Vec<Ray> = targets
        .iter()
        .flat_map(|&target| {
            let origin = 0.8 * rng.random::<f64>() * unit_vector(&mut rng);
            [towards(DVec3::ZERO, target), towards(origin, target)]
        })
        .collect();
    assert_eq!(leaks(&geometry, rays.into_iter()), 0);
}

/// Exactly representable rays pass exactly through edges, corners and diagonals.
#[test]
fn exact_rays_through_edges_and_corners_of_a_box_do_not_leak() {
    let geometry = alone(mesh(box_mesh(DVec3::splat(2.0))), DAffine3::IDENTITY);
    let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let origins = [DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.5, -0.5, 0.25)];
    let rays = origins.into_iter().flat_map(|origin| {
        steps.into_iter().flat_map(move |x| {
            steps.into_iter().flat_map(move |y| {
                [DVec3::new(x, y, 1.0), DVec3::new(1.0, x, y), DVec3::new(y, -1.0, x)].map(|to| towards(origin, to))
            })
        })
    });
    assert_eq!(leaks(&geometry, rays), 0);
    let outside = alone(mesh(box_mesh(DVec3::splat(2.0))), DAffine3::IDENTITY);
    for x in steps {
        for y in steps {
            let mut balance = 0;
            let ray = Ray::new(DVec3::new(x, y, -5.0), DVec3::Z);
            outside.for_each_hit(&ray, None, |hit| {
                balance += if ray.direction.dot(hit.normal) > 0.0 { 1 } else { -1 };
                assert!((-1..=0).contains(&balance), "left before it was entered, at {x} {y}");
            });
            assert_eq!(balance, 0, "{x} {y}");
        }
    }
}
