//! Paths through surfaces that touch each other.

use super::*;

/// Returns a floor (object 0), a glass block on it (object 1) and a mesh on the block (object 2),
/// relative to `centre`. Because of the rotation, no coordinate is exactly representable.
fn block_on_floor(to_world: DAffine3, order: [usize; 3], floor_faces_up: bool, centre: DVec3) -> Geometry {
    let up = |height: f64| DAffine3::from_translation(DVec3::new(0.0, height, 0.0));
    let flip = if floor_faces_up { DAffine3::IDENTITY } else { DAffine3::from_rotation_x(std::f64::consts::PI) };
    let things = [
        placed(Shape::Rectangle { width: 9.0, height: 9.0 }, to_world * flip, 0),
        placed(Shape::Box { size: DVec3::new(1.0, 0.7, 1.3) }, to_world * up(0.35), 1),
        placed(mesh(box_mesh(DVec3::new(1.0, 0.4, 1.3))), to_world * up(0.9), 2),
    ];
    let things = order.map(|index| things[index].clone()).to_vec();
    Geometry::build(things, centre).unwrap()
}

/// Follows a path through the objects in `bodies`; all other surfaces reflect it. The path must
/// enter and leave each body alternately, and hit the other surfaces only from outside all bodies.
fn paths_keep_their_order(geometry: &Geometry, start: DVec3, bodies: &[u32], rng: &mut Pcg64) {
    let mut ray = Ray::new(start, unit_vector(rng));
    let (mut from, mut inside) = (None, [false; 4]);
    for _ in 0..24 {
        let Some(hit) = geometry.intersect(&ray, from, f64::INFINITY) else {
            assert_eq!(inside, [false; 4], "lost inside a body at {ray:?}");
            return;
        };
        let object = hit.object as usize;
        let leaves = ray.direction.dot(hit.normal) > 0.0;
        let mut direction = unit_vector(rng);
        if bodies.contains(&hit.object) {
            assert_eq!(leaves, inside[object], "object {object} entered or left twice");
            inside[object] = rng.random::<f64>() < 0.6;
            if (direction.dot(hit.normal) < 0.0) != inside[object] {
                direction = -direction;
            }
        } else {
            assert_eq!(inside, [false; 4], "a sheet was met from inside a body");
            // The path is reflected to the side from which it arrived.
            if (direction.dot(hit.normal) > 0.0) != (ray.direction.dot(hit.normal) < 0.0) {
                direction = -direction;
            }
        }
        ray = Ray::new(hit.position, direction);
        from = Some(hit.surface);
    }
}

#[test]
fn paths_between_touching_bodies_and_floor_keep_their_order() {
    for (scale, order, faces_up) in
        [(1.0, [0, 1, 2], true), (1e-6, [2, 1, 0], true), (1e6, [1, 0, 2], true), (1.0, [2, 0, 1], false)]
    {
        for offset in [DVec3::ZERO, scale * DVec3::new(1e6, -2e5, 3e6)] {
            let to_world = DAffine3::from_translation(offset) * turned(scale);
            let geometry = block_on_floor(to_world, order, faces_up, offset);
            let mut rng = random(21);
            for _ in 0..10_000 {
                let start = DVec3::new(rng.random_range(-2.0..2.0), rng.random_range(1.2..2.0), 0.3);
                let start = turned(scale).transform_point3(start);
                paths_keep_their_order(&geometry, start, &[1, 2], &mut rng);
            }
        }
    }
}

#[test]
fn a_cemented_doublet_is_passed_lens_by_lens() {
    let apart = |z: f64| turned(1.0) * DAffine3::from_translation(DVec3::new(0.0, 0.0, z));
    let crown = Shape::Lens { radius1: 0.6, radius2: -0.45, thickness: 0.2, diameter: 0.5 };
    let flint = Shape::Lens { radius1: -0.45, radius2: -1.5, thickness: 0.08, diameter: 0.5 };
    for order in [[0, 1], [1, 0]] {
        let things = [placed(crown.clone(), apart(0.7), 0), placed(flint.clone(), apart(0.7 + 0.2), 1)];
        let geometry = Geometry::build(order.map(|i| things[i].clone()).to_vec(), DVec3::ZERO).unwrap();
        let mut rng = random(22);
        for _ in 0..10_000 {
            let across = DVec3::new(rng.random_range(-0.15..0.15), rng.random_range(-0.15..0.15), -1.0);
            let ray = Ray::new(turned(1.0).transform_point3(across), turned(1.0).transform_vector3(DVec3::Z));
            let mut met = Vec::new();
            geometry.for_each_hit(&ray, None, |hit| met.push((hit.object, ray.direction.dot(hit.normal) > 0.0)));
            assert_eq!(met, [(0, false), (0, true), (1, false), (1, true)]);
            let start = turned(1.0).transform_point3(DVec3::new(0.0, 0.0, -1.0) + 0.5 * unit_vector(&mut rng));
            paths_keep_their_order(&geometry, start, &[0, 1], &mut rng);
        }
    }
}

#[test]
fn balls_that_share_their_surface_are_both_entered_and_left() {
    let ball = |object| placed(Shape::Sphere { radius: 0.7 }, turned(1.0), object);
    // The same ball with another radius and scale.
    let other = placed(Shape::Sphere { radius: 0.1 }, turned(1.0) * DAffine3::from_scale(DVec3::splat(7.0)), 2);
    let geometry = Geometry::build(vec![ball(1), other, ball(0)], DVec3::ZERO).unwrap();
    let mut rng = random(23);
    for _ in 0..10_000 {
        paths_keep_their_order(&geometry, turned(1.0).translation + 2.0 * unit_vector(&mut rng), &[0, 1, 2], &mut rng);
    }
}

#[test]
fn rays_through_a_stack_hit_each_surface_once_in_order() {
    let geometry = block_on_floor(turned(1.0), [1, 2, 0], true, DVec3::ZERO);
    let to_world = turned(1.0);
    let mut rng = random(2);
    for _ in 0..10_000 {
        let across = DVec3::new(rng.random_range(-0.3..0.3), 0.0, rng.random_range(-0.3..0.3));
        let tilt = DVec3::new(rng.random_range(-0.1..0.1), -1.0, rng.random_range(-0.1..0.1));
        let direction = to_world.transform_vector3(tilt).normalize();
        let ray = Ray::new(to_world.transform_point3(across + DVec3::new(0.0, 2.0, 0.0)), direction);
        let mut met = Vec::new();
        geometry.for_each_hit(&ray, None, |hit| met.push((hit.object, ray.direction.dot(hit.normal) > 0.0)));
        assert_eq!(met, [(2, false), (2, true), (1, false), (1, true), (0, false)]);
        let back = Ray::new(ray.at(5.0), -ray.direction);
        let mut met = Vec::new();
        geometry.for_each_hit(&back, None, |hit| met.push((hit.object, back.direction.dot(hit.normal) > 0.0)));
        assert_eq!(met, [(0, true), (1, false), (1, true), (2, false), (2, true)]);
    }
}

/// Rays hit a light that is flush with a ceiling, and shadow rays to the light are not occluded.
#[test]
fn a_light_flush_with_a_ceiling_is_visible() {
    let down = turned(1.0) * DAffine3::from_rotation_x(std::f64::consts::PI);
    let lamp = placed(Shape::Rectangle { width: 0.5, height: 0.5 }, down, 0);
    let ceiling = placed(Shape::Rectangle { width: 4.0, height: 4.0 }, down, 1);
    let geometry = Geometry::build(vec![ceiling, lamp], DVec3::ZERO).unwrap();
    let mut rng = random(4);
    for _ in 0..10_000 {
        let from = turned(1.0).transform_point3(DVec3::new(0.3, -2.0, 0.1)) + 0.5 * unit_vector(&mut rng);
        let sample = geometry.sample_area(0, numbers(&mut rng));
        let ray = towards(from, sample.position);
        let distance = from.distance(sample.position);
        assert!(!geometry.occluded(&ray, None, Some(sample.surface), distance));
        assert_eq!(geometry.intersect(&ray, None, f64::INFINITY).unwrap().object, 0);
    }
}

#[test]
fn a_thin_gap_is_a_gap() {
    // An air gap of one nanometre under a block of one metre is not a coincidence.
    let gap = 1e-9;
    let floor = placed(Shape::Rectangle { width: 9.0, height: 9.0 }, turned(1.0), 0);
    let lifted = turned(1.0) * DAffine3::from_translation(DVec3::new(0.0, 0.5 + gap, 0.0));
    let geometry =
        Geometry::build(vec![floor, placed(Shape::Box { size: DVec3::ONE }, lifted, 1)], DVec3::ZERO).unwrap();
    let direction = turned(1.0).transform_vector3(DVec3::NEG_Y);
    let start = turned(1.0).transform_point3(DVec3::new(0.1, 0.5, 0.2));
    let leaves = geometry.intersect(&Ray::new(start, direction), None, f64::INFINITY).unwrap();
    let floor = geometry.intersect(&Ray::new(leaves.position, direction), Some(leaves.surface), f64::INFINITY).unwrap();
    assert_eq!((leaves.object, floor.object), (1, 0));
    assert!((floor.t - gap).abs() < 1e-14);
}
