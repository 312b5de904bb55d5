//! Compares sampled points with areas and solid angles that have closed forms.

use std::f64::consts::PI;

use super::*;

fn all_shapes() -> Vec<Shape> {
    let mut all = closed_shapes();
    all.extend([Shape::Rectangle { width: 1.0, height: 0.4 }, Shape::Disk { radius: 0.3 }, mesh(icosphere(1))]);
    all
}

#[test]
fn areas_of_plainly_scaled_shapes_are_exact() {
    let (side, length) = (0.5, 0.6);
    let cases = [
        (Shape::Sphere { radius: 0.5 }, PI),
        (Shape::Rectangle { width: 2.0, height: 0.5 }, 1.0),
        (Shape::Disk { radius: 2.0 }, 4.0 * PI),
        (Shape::Box { size: DVec3::new(1.0, 2.0, 3.0) }, 22.0),
        (Shape::Cylinder { radius: 1.0, height: 2.0 }, 6.0 * PI),
        (Shape::Prism { side, length, apex_deg: 60.0 }, 3.0 * side * length + 0.5 * 3.0_f64.sqrt() * side * side),
        // Caps of areas 2πRh, h = 0.5 − 0.3 and 1 − 0.8, and rims 0.6 − 0.4 apart.
        (
            Shape::Lens { radius1: 0.5, radius2: -0.5, thickness: 0.6, diameter: 0.8 },
            PI * (2.0 * 2.0 * 0.5 * 0.2 + 0.8 * 0.2),
        ),
        (mesh(box_mesh(DVec3::new(1.0, 2.0, 3.0))), 22.0),
    ];
    for (shape, area) in cases {
        for scale in [1e-6, 1.0, 1e6] {
            let found = alone(shape.clone(), turned(scale)).area(0);
            assert!((found / (area * scale * scale) - 1.0).abs() < 1e-13, "{shape:?}: {found} for {area}");
        }
    }
}

/// The square of such a small length is 0. A light of this shape would have no point to emit from.
#[test]
fn a_shape_whose_area_is_rounded_to_0_is_an_error() {
    for shape in all_shapes() {
        let tiny = placed(shape.clone(), DAffine3::from_scale(DVec3::splat(1e-170)), 0);
        assert!(Geometry::build(vec![tiny], DVec3::ZERO).is_err(), "{shape:?}");
    }
    let radius = 1e-320;
    let tiny = placed(Shape::Sphere { radius }, DAffine3::IDENTITY, 0);
    let error = Geometry::build(vec![tiny], DVec3::ZERO).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("object 0: the placed shape is so small"), "{error}");
}

#[test]
fn areas_of_stretched_round_shapes_match_closed_forms() {
    // Oblate and prolate spheroids.
    for ratio in [0.03_f64, 0.3, 3.0, 30.0] {
        let spheroid = alone(Shape::Sphere { radius: 1.0 }, DAffine3::from_scale(DVec3::new(1.0, ratio, 1.0)));
        let area = if ratio < 1.0 {
            let e = (1.0 - ratio * ratio).sqrt();
            TAU * (1.0 + (1.0 - e * e) / e * e.atanh())
        } else {
            let e = (1.0 - 1.0 / (ratio * ratio)).sqrt();
            TAU * (1.0 + ratio / e * e.asin())
        };
        assert!((spheroid.area(0) / area - 1.0).abs() < 1e-9, "{ratio}: {} for {area}", spheroid.area(0));
        // The same body with its long axis perpendicular to the sampling axis.
        let turned_over = alone(Shape::Sphere { radius: 1.0 }, DAffine3::from_scale(DVec3::new(ratio, 1.0, 1.0)));
        assert!((turned_over.area(0) / area - 1.0).abs() < 1e-9, "{ratio}: {} for {area}", turned_over.area(0));
    }
}

#[test]
fn points_lie_on_the_surface_and_pdfs_integrate_to_one() {
    let mut rng = random(12);
    for shape in all_shapes() {
        for to_world in [turned(1e-3), stretched()] {
            let geometry = alone(shape.clone(), to_world);
            let size = (geometry.bounds().1 - geometry.bounds().0).length();
            // The mean of 1/pdf is the area, and all are equal if the pdf is uniform.
            let (count, mut sum, mut squares) = (4000, 0.0, 0.0);
            for _ in 0..count {
                let sample = geometry.sample_area(0, numbers(&mut rng));
                sum += 1.0 / sample.pdf_area;
                squares += (1.0 / sample.pdf_area).powi(2);
                let height = 1e-7 * size;
                let above = Ray::new(sample.position + height * sample.normal, -sample.normal);
                let hit = geometry.intersect(&above, None, 2.0 * height);
                let near_edge = hit.is_none_or(|hit| hit.surface != sample.surface);
                if let Some(hit) = hit.filter(|_| !near_edge) {
                    assert!(hit.position.distance(sample.position) < 1e-14 * size, "{shape:?}");
                    assert!(hit.normal.distance(sample.normal) < 1e-9, "{shape:?}");
                }
            }
            let n = f64::from(count);
            let (mean, area) = (sum / n, geometry.area(0));
            let error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
            assert!((mean - area).abs() <= 4.0 * error + 1e-9 * area, "{shape:?}: {mean} ± {error} for {area}");
        }
    }
}

/// χ² test on a sphere and spherical caps, in slices of equal height and thus area.
#[test]
fn points_are_uniform_over_the_area() {
    let mut rng = random(13);
    let sphere = alone(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY);
    let capped = alone(lens(0.5, -0.4, 0.25), DAffine3::IDENTITY);
    let (bins, count) = (20, 20_000);
    let mut along = vec![[0_u32; 20]; 5];
    let sagitta = |radius: f64| radius - (radius * radius - 0.0625_f64).sqrt();
    for _ in 0..count {
        let p = sphere.sample_area(0, numbers(&mut rng)).position;
        for axis in 0..3 {
            along[axis][((0.5 * p[axis] + 0.5) * 20.0) as usize] += 1;
        }
        let sample = capped.sample_area(0, numbers(&mut rng));
        let height = match sample.surface.face {
            0 => sample.position.z / sagitta(0.5),
            1 => (0.25 - sample.position.z) / sagitta(0.4),
            _ => continue,
        };
        along[3 + sample.surface.face as usize][(height * 20.0).min(19.0) as usize] += 1;
    }
    for counts in along {
        let total: u32 = counts.iter().sum();
        let expected = f64::from(total) / f64::from(bins);
        let chi2: f64 = counts.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
        // 19 degrees of freedom: χ² exceeds 43.8 with a probability of 0.001.
        assert!(total > 1000 && chi2 < 43.8, "χ² = {chi2}: {counts:?}");
    }
}

/// Returns the solid angle of a rectangle with corners relative to the point of view, as the sum
/// over two triangles (Van Oosterom & Strackee 1983).
fn solid_angle(corners: [DVec3; 4]) -> f64 {
    let triangle = |a: DVec3, b: DVec3, c: DVec3| {
        let (x, y, z) = (a.length(), b.length(), c.length());
        let scalar = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).abs().atan2(scalar)
    };
    let [a, b, c, d] = corners;
    triangle(a, b, c) + triangle(a, c, d)
}

#[test]
fn a_rectangles_pdf_is_its_solid_angle() {
    let mut rng = random(14);
    for scale in [1e-6, 1.0, 1e6] {
        let geometry = alone(Shape::Rectangle { width: 1.0, height: 0.4 }, turned(scale));
        let corner = |x: f64, z: f64| turned(scale).transform_point3(DVec3::new(x, 0.0, z));
        let corners = [corner(-0.5, -0.2), corner(0.5, -0.2), corner(0.5, 0.2), corner(-0.5, 0.2)];
        for _ in 0..200 {
            let distance = 10.0_f64.powf(rng.random_range(-2.0..2.0));
            let from = turned(scale).translation + scale * distance * unit_vector(&mut rng);
            let expected = solid_angle(corners.map(|corner| corner - from));
            if expected < 1e-5 {
                continue;
            }
            for _ in 0..20 {
                let (sample, pdf) = geometry.sample_solid_angle(0, from, numbers(&mut rng)).unwrap();
                assert!((pdf * expected - 1.0).abs() < 1e-9, "{pdf} for 1/{expected}");
                let local = turned(scale).inverse().transform_point3(sample.position);
                assert!(local.x.abs() < 0.5 + 1e-12 && local.y.abs() < 1e-14 && local.z.abs() < 0.2 + 1e-12);
            }
        }
    }
}

/// Checks near, distant and tiny spheres.
#[test]
fn sphere_pdf_is_one_over_its_cone_solid_angle() {
    let mut rng = random(15);
    for (radius, distance) in
        [(1.0, 1.0001), (1.0, 1.5), (1.0, 10.0), (1.0, 1e4), (1e-3, 1e3), (1e-6, 1e6), (1e6, 1.1e6)]
    {
        let geometry = alone(Shape::Sphere { radius }, DAffine3::IDENTITY);
        let axis = unit_vector(&mut rng);
        let from = distance * axis;
        let sin2 = (radius / distance) * (radius / distance);
        let expected = TAU * sin2 / (1.0 + ((1.0 - radius / distance) * (1.0 + radius / distance)).sqrt());
        let mut heights = [0_u32; 16];
        for _ in 0..8000 {
            let (sample, pdf) = geometry.sample_solid_angle(0, from, numbers(&mut rng)).unwrap();
            assert!((pdf * expected - 1.0).abs() < 1e-12);
            assert!((sample.position.length() / radius - 1.0).abs() < 1e-14);
            let facing = sample.normal.dot((from - sample.position).normalize());
            assert!(facing > -1e-6, "the point drawn faces away: {facing}");
            // For uniform directions in the cone, 1 − cos θ = sin² θ / (1 + cos θ) is uniform.
            let to = sample.position - from;
            let across2 = (sample.position - sample.position.dot(axis) * axis).length_squared() / to.length_squared();
            let fraction = across2 / (1.0 + (1.0 - across2).sqrt()) * TAU / expected;
            heights[(16.0 * fraction).min(15.0) as usize] += 1;
        }
        let chi2: f64 = heights.iter().map(|&n| (f64::from(n) - 500.0).powi(2) / 500.0).sum();
        // 15 degrees of freedom: χ² exceeds 37.7 with a probability of 0.001.
        assert!(chi2 < 37.7, "radius {radius}, distance {distance}: χ² = {chi2}: {heights:?}");
    }
}

/// The mean of 1/pdf over visible points equals the solid angle, which random rays estimate.
#[test]
fn directional_pdfs_integrate_to_the_visible_solid_angle() {
    let mut rng = random(16);
    for shape in all_shapes() {
        for to_world in [turned(1.0), stretched()] {
            let geometry = alone(shape.clone(), to_world);
            let (low, high) = geometry.bounds();
            let (middle, size) = (0.5 * (low + high), 0.5 * (high - low).length());
            let from = middle + 1.6 * size * unit_vector(&mut rng);
            // Uniform directions in the cone around the bounding ball.
            let cone_height = 1.0 - (1.0 - 1.0 / (1.6_f64 * 1.6)).sqrt();
            let axis = (middle - from).normalize();
            let (across_x, across_y) = axis.any_orthonormal_pair();
            let (mut seen, mut sum, mut squares) = (0.0, 0.0, 0.0);
            let count = 20_000;
            for _ in 0..count {
                let (height, turn) = (cone_height * rng.random::<f64>(), TAU * rng.random::<f64>());
                let ring = (height * (2.0 - height)).sqrt();
                let direction = (1.0 - height) * axis + ring * (turn.cos() * across_x + turn.sin() * across_y);
                let ray = Ray::new(from, direction.normalize());
                seen += f64::from(u8::from(geometry.intersect(&ray, None, f64::INFINITY).is_some()));
                let Some((sample, pdf)) = geometry.sample_solid_angle(0, from, numbers(&mut rng)) else { continue };
                let ray = towards(from, sample.position);
                let distance = from.distance(sample.position);
                let faces = matches!(shape, Shape::Rectangle { .. } | Shape::Disk { .. })
                    || sample.normal.dot(ray.direction) < 0.0;
                if faces && !geometry.occluded(&ray, None, Some(sample.surface), distance) {
                    sum += 1.0 / pdf;
                    squares += 1.0 / (pdf * pdf);
                    if let Some(hit) =
                        geometry.intersect(&ray, None, f64::INFINITY).filter(|hit| hit.surface == sample.surface)
                    {
                        let found_pdf = geometry.pdf_solid_angle(0, from, &hit);
                        let cos = hit.normal.dot(ray.direction).abs();
                        assert!(
                            (found_pdf / pdf - 1.0).abs() < 1e-13 / (cos * cos) + 1e-11,
                            "{shape:?}: {found_pdf} for {pdf}"
                        );
                    }
                }
            }
            let n = f64::from(count);
            let fraction = seen / n;
            let (rays, rays_error) =
                (TAU * cone_height * fraction, TAU * cone_height * (fraction * (1.0 - fraction) / n).sqrt());
            let (drawn, drawn_error) = (sum / n, ((squares / n - (sum / n).powi(2)).max(0.0) / n).sqrt());
            let error = rays_error.hypot(drawn_error);
            assert!((rays - drawn).abs() <= 4.0 * error, "{shape:?}: {drawn} drawn, {rays} by rays, ± {error}");
        }
    }
}

#[test]
fn an_unknown_object_sends_nothing() {
    let geometry = alone(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY);
    assert!(geometry.sample_solid_angle(7, DVec3::ONE, [0.5; 3]).is_none());
    let hit = geometry.intersect(&Ray::new(DVec3::new(0.0, 0.0, -3.0), DVec3::Z), None, f64::INFINITY).unwrap();
    assert_eq!(geometry.pdf_solid_angle(7, DVec3::ONE, &hit), 0.0);
}
