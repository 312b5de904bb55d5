//! Compares the hits of every shape with the shape's definition.

use super::*;

/// Returns true if a point is inside a shape, as the scene format defines the shape.
fn inside(shape: &Shape, p: DVec3) -> bool {
    match *shape {
        Shape::Sphere { radius } => p.length() < radius,
        Shape::Box { size } => p.abs().cmplt(0.5 * size).all(),
        Shape::Cylinder { radius, height } => p.x.hypot(p.z) < radius && p.y.abs() < 0.5 * height,
        Shape::Prism { side, length, apex_deg } => {
            let (half_base, height) =
                (side * (apex_deg.to_radians() / 2.0).sin(), side * (apex_deg.to_radians() / 2.0).cos());
            let up = p.y + height / 3.0;
            up > 0.0 && up < height && p.x.abs() < half_base * (1.0 - up / height) && p.z.abs() < 0.5 * length
        }
        Shape::Lens { radius1, radius2, thickness, diameter } => {
            let across = p.x.hypot(p.y);
            let surface = |radius: f64| {
                if radius == 0.0 { 0.0 } else { radius - radius.signum() * (radius * radius - across * across).sqrt() }
            };
            across < 0.5 * diameter && p.z > surface(radius1) && p.z < thickness + surface(radius2)
        }
        Shape::Rectangle { .. } | Shape::Disk { .. } | Shape::Mesh(_) => false,
    }
}

/// Returns all t where a ray crosses a shape's boundary: small steps and bisection.
fn transitions(shape: &Shape, to_local: DAffine3, ray: &Ray, length: f64, steps: u32) -> Vec<f64> {
    let is_inside = |t: f64| inside(shape, to_local.transform_point3(ray.at(t)));
    let step = length / f64::from(steps);
    let mut found = Vec::new();
    for i in 0..steps {
        let (mut near, mut far) = (f64::from(i) * step, f64::from(i + 1) * step);
        let before = is_inside(near);
        if before == is_inside(far) {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (near + far);
            if is_inside(middle) == before {
                near = middle;
            } else {
                far = middle;
            }
        }
        found.push(0.5 * (near + far));
    }
    found
}

fn agrees_with_its_definition(shape: &Shape, to_world: DAffine3) {
    let geometry = alone(shape.clone(), to_world);
    let (low, high) = geometry.bounds();
    let (middle, size) = (0.5 * (low + high), 0.5 * (high - low).length());
    let mut rng = random(11);
    let mut crossings = 0;
    for _ in 0..400 {
        let ray = towards(middle + 1.5 * size * unit_vector(&mut rng), middle + 0.5 * size * unit_vector(&mut rng));
        let (length, steps) = (3.5 * size, 2000);
        let expected = transitions(shape, to_world.inverse(), &ray, length, steps);
        let mut found = Vec::new();
        geometry.for_each_hit(&ray, None, |hit| found.push(*hit));
        let mut left = found.clone();
        for t in &expected {
            let nearest = left.iter().position(|hit| (hit.t - t).abs() < 1e-9 * size);
            let hit = left.remove(nearest.unwrap_or_else(|| panic!("{shape:?}: no hit at {t} on {ray:?}: {found:?}")));
            let local = to_world.inverse().transform_vector3(hit.normal);
            assert!(hit.position.distance(ray.at(hit.t)) < 1e-9 * size, "{shape:?}: {hit:?}");
            assert!((hit.normal.length() - 1.0).abs() < 1e-14 && local.is_finite());
        }
        // Small steps may miss thin regions, so extra hits are allowed as close pairs.
        let too_thin =
            left.chunks(2).all(|pair| pair.len() == 2 && pair[1].t - pair[0].t < 2.0 * length / f64::from(steps));
        assert!(too_thin, "{shape:?}: hits too many: {left:?}");
        crossings += found.len();
    }
    assert!(crossings > 20, "{shape:?}: only {crossings} crossings");
}

#[test]
fn closed_shapes_are_hit_where_their_definition_says() {
    for shape in closed_shapes() {
        agrees_with_its_definition(&shape, turned(1.0));
        agrees_with_its_definition(&shape, stretched());
    }
}

/// The normal must point from the inside of the shape, by its definition, to the outside.
#[test]
fn normals_of_closed_shapes_point_outwards_also_when_mirrored() {
    let mut rng = random(5);
    for shape in closed_shapes() {
        for to_world in [turned(1.0), stretched()] {
            let geometry = alone(shape.clone(), to_world);
            let size = (geometry.bounds().1 - geometry.bounds().0).length();
            for _ in 0..2000 {
                let sample = geometry.sample_area(0, numbers(&mut rng));
                let step = 1e-9 * size * sample.normal;
                let is_inside = |p: DVec3| inside(&shape, to_world.inverse().transform_point3(p));
                let edge = is_inside(sample.position - step) == is_inside(sample.position + step);
                assert!(edge || is_inside(sample.position - step), "{shape:?}: {sample:?}");
            }
        }
    }
}

#[test]
fn sheets_face_the_transformed_y_also_when_mirrored() {
    for shape in [Shape::Rectangle { width: 1.0, height: 2.0 }, Shape::Disk { radius: 0.7 }] {
        for to_world in [
            turned(2.0),
            stretched(),
            DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
            DAffine3::from_scale(DVec3::new(1.0, -1.0, 1.0)),
        ] {
            let geometry = alone(shape.clone(), to_world);
            let normal = geometry.sample_area(0, [0.5, 0.3, 0.4]).normal;
            assert!(normal.dot(to_world.matrix3.y_axis) > 0.0);
            for edge in [to_world.matrix3.x_axis, to_world.matrix3.z_axis] {
                assert!(normal.dot(edge.normalize()).abs() < 1e-15);
            }
        }
    }
}

#[test]
fn sheets_are_hit_inside_their_outline_only() {
    let mut rng = random(9);
    let rectangle = Shape::Rectangle { width: 1.0, height: 2.0 };
    let disk = Shape::Disk { radius: 0.7 };
    for to_world in [turned(1.0), stretched()] {
        let sheets = [alone(rectangle.clone(), to_world), alone(disk.clone(), to_world)];
        for _ in 0..10_000 {
            let local = DVec3::new(rng.random_range(-1.0..1.0), 0.0, rng.random_range(-1.5..1.5));
            let target = to_world.transform_point3(local);
            let ray = towards(target + 3.0 * unit_vector(&mut rng), target);
            let contained = [local.x.abs() < 0.5 && local.z.abs() < 1.0, local.length() < 0.7];
            for (geometry, contained) in sheets.iter().zip(contained) {
                let hit = geometry.intersect(&ray, None, f64::INFINITY);
                assert_eq!(hit.is_some(), contained, "{local}");
                let cos = |normal: DVec3| ray.direction.dot(normal).abs();
                assert!(hit.is_none_or(|hit| hit.position.distance(target) < 1e-14 / cos(hit.normal)));
            }
        }
    }
}

#[test]
fn bounds_hold_every_point_and_little_more() {
    let mut rng = random(10);
    let sheets = [Shape::Rectangle { width: 1.0, height: 2.0 }, Shape::Disk { radius: 0.7 }, mesh(icosphere(1))];
    for shape in closed_shapes().into_iter().chain(sheets) {
        for to_world in [turned(1.0), stretched()] {
            let geometry = alone(shape.clone(), to_world);
            let (low, high) = geometry.bounds();
            let (mut least, mut largest) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for _ in 0..20_000 {
                let position = geometry.sample_area(0, numbers(&mut rng)).position;
                least = least.min(position);
                largest = largest.max(position);
            }
            let rounding = 1e-15 * (high - low).length();
            assert!(least.cmpge(low - rounding).all() && largest.cmple(high + rounding).all(), "{shape:?}");
            assert!(
                ((largest - least) / (high - low)).min_element() > 0.8,
                "{shape:?}: {low} {high} for {least} {largest}"
            );
        }
    }
}

#[test]
fn far_and_tiny_balls_are_hit_to_the_last_digits() {
    // The ray starts 10⁶ radii away, half a radius off the axis: t = d − √(1 − ¼).
    let geometry = alone(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY);
    let hit = geometry.intersect(&Ray::new(DVec3::new(0.5, 0.0, -1e6), DVec3::Z), None, f64::INFINITY).unwrap();
    // The distance of 10⁶ radii has 16 correct digits. The projection onto the ball makes the
    // distance of the position from the centre accurate to full precision.
    assert!((hit.t - (1e6 - 0.75_f64.sqrt())).abs() < 2e-10);
    assert!((hit.position - DVec3::new(0.5, 0.0, -0.75_f64.sqrt())).length() < 2e-10);
    assert!((hit.position.length() - 1.0).abs() < 3e-16);
}

/// A hit at t ≥ `t_max` is not reported. A mesh interpolates normals and texture coordinates.
#[test]
fn hits_stop_at_t_max_and_meshes_interpolate_attributes() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Z];
    let normals = Some(vec![DVec3::NEG_Y, DVec3::new(1.0, -1.0, 0.0), DVec3::NEG_Y]);
    let uvs = Some(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let triangle = mesh(TriangleMesh::new(positions, normals, uvs, vec![[0, 1, 2]]).unwrap());
    let geometry = alone(triangle, DAffine3::IDENTITY);
    let ray = Ray::new(DVec3::new(0.5, 1.0, 0.25), DVec3::NEG_Y);
    assert!(geometry.intersect(&ray, None, 1.0).is_none());
    let hit = geometry.intersect(&ray, None, 1.000001).unwrap();
    assert_eq!((hit.position, geometry.uv(&hit)), (DVec3::new(0.5, 0.0, 0.25), [0.5, 0.25]));
    assert_eq!(hit.normal, DVec3::NEG_Y);
    let expected = DVec3::new(0.5, -1.0, 0.0);
    // The middle normal is stored as the unit vector (1,−1,0)/√2.
    let mean = 0.5 * DVec3::NEG_Y + 0.5 * DVec3::new(1.0, -1.0, 0.0).normalize();
    assert!(hit.shading_normal.distance(mean.normalize()) < 1e-7 && expected.dot(hit.shading_normal) > 0.0);
}

#[test]
fn shapes_and_transforms_that_make_no_body_are_errors() {
    let wrong = [
        Shape::Sphere { radius: 0.0 },
        Shape::Sphere { radius: f64::NAN },
        Shape::Box { size: DVec3::new(1.0, -1.0, 1.0) },
        Shape::Prism { side: 1.0, length: 1.0, apex_deg: 180.0 },
        Shape::Cylinder { radius: 1.0, height: f64::INFINITY },
        lens(0.1, -0.5, 0.3),
        lens(0.5, -0.5, 0.1),
        Shape::Disk { radius: -1.0 },
    ];
    for shape in wrong {
        assert!(shape.validate().is_err(), "{shape:?}");
        assert!(Geometry::build(vec![placed(shape, DAffine3::IDENTITY, 0)], DVec3::ZERO).is_err());
    }
    let mut flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let ball = Shape::Sphere { radius: 1.0 };
    assert!(Geometry::build(vec![placed(ball.clone(), flat, 0)], DVec3::ZERO).is_err());
    flat.matrix3.y_axis.y = f64::NAN;
    assert!(Geometry::build(vec![placed(ball.clone(), flat, 0)], DVec3::ZERO).is_err());
    let far = DAffine3::from_translation(DVec3::new(f64::INFINITY, 0.0, 0.0));
    assert!(Geometry::build(vec![placed(ball, far, 0)], DVec3::ZERO).is_err());
}

#[test]
fn an_empty_scene_is_never_hit() {
    let geometry = Geometry::build(Vec::new(), DVec3::ZERO).unwrap();
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    assert!(geometry.intersect(&ray, None, f64::INFINITY).is_none());
    assert!(!geometry.occluded(&ray, None, None, f64::INFINITY));
    assert_eq!(geometry.area(0), 0.0);
}

#[test]
fn texture_coordinates_cover_the_unit_square_and_stay_in_it() {
    let shapes = [
        Shape::Sphere { radius: 0.5 },
        Shape::Rectangle { width: 2.0, height: 1.0 },
        Shape::Disk { radius: 0.7 },
        Shape::Box { size: DVec3::new(1.0, 2.0, 0.5) },
        Shape::Cylinder { radius: 0.5, height: 1.0 },
        Shape::Lens { radius1: 1.0, radius2: -1.0, thickness: 0.4, diameter: 0.8 },
    ];
    for shape in shapes {
        let geometry = alone(shape.clone(), turned(1.0));
        let mut rng = random(3);
        let (mut low, mut high) = ([1.0_f64; 2], [0.0_f64; 2]);
        for _ in 0..4000 {
            let place = geometry.sample_area(0, numbers(&mut rng));
            let ray = Ray::new(place.position + place.normal, -place.normal);
            let hit = geometry.intersect(&ray, None, 2.0).unwrap();
            for (i, x) in geometry.uv(&hit).into_iter().enumerate() {
                assert!((-1e-9..1.0 + 1e-9).contains(&x), "{shape:?}: {x}");
                (low[i], high[i]) = (low[i].min(x), high[i].max(x));
            }
        }
        assert!(low.iter().all(|&x| x < 0.05) && high.iter().all(|&x| x > 0.95), "{shape:?}: {low:?} to {high:?}");
    }
}

/// From outside with +y up, u increases to the right, and v down on upright faces.
#[test]
fn pictures_are_upright_and_not_mirrored() {
    let (level, facing) = (DAffine3::IDENTITY, DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2));
    let shapes = [
        (Shape::Sphere { radius: 0.5 }, level),
        (Shape::Cylinder { radius: 0.5, height: 1.0 }, level),
        (Shape::Box { size: DVec3::ONE }, level),
        (Shape::Rectangle { width: 1.0, height: 1.0 }, facing),
        (Shape::Disk { radius: 0.5 }, facing),
    ];
    for (shape, placement) in shapes {
        let geometry = alone(shape.clone(), placement);
        for turn in 0..4 {
            let from = [DVec3::Z, DVec3::X, DVec3::NEG_Z, DVec3::NEG_X][turn];
            let right = DVec3::Y.cross(from);
            let flat = matches!(shape, Shape::Rectangle { .. } | Shape::Disk { .. });
            if flat && turn > 0 {
                continue;
            }
            let seen = |across: f64, up: f64| {
                let ray = Ray::new(3.0 * from + across * right + up * DVec3::Y, -from);
                geometry.uv(&geometry.intersect(&ray, None, 6.0).unwrap())
            };
            let [u, v] = seen(0.02, 0.03);
            assert!(seen(0.04, 0.03)[0] > u && seen(0.02, 0.06)[1] < v, "{shape:?} from {from}");
        }
    }
}

/// The coordinate u of a ball is the angle about +y, and v is the distance from the upper pole.
#[test]
fn texture_coordinates_of_a_ball_are_its_angles() {
    let ball = alone(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY);
    let seen = |from: DVec3| ball.uv(&ball.intersect(&Ray::new(2.0 * from, -from), None, 3.0).unwrap());
    assert_eq!(seen(DVec3::Y)[1], 0.0);
    assert_eq!([DVec3::X, DVec3::NEG_Z, DVec3::NEG_X, DVec3::Z].map(seen), [0.0, 0.25, 0.5, 0.75].map(|u| [u, 0.5]));
}
