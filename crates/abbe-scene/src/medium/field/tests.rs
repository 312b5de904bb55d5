//! Compares fields with numerical integration, with closed forms and with each other.

use super::*;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use std::f64::consts::PI;

/// A box with unequal sides, away from the origin.
const BOUNDS: (DVec3, DVec3) = (DVec3::new(-1.0, 0.5, -2.0), DVec3::new(1.5, 2.0, 1.0));

fn random(number: u64) -> Stream {
    Stream::new(Seed::new(3), Purpose::SurveyPhoton, 0, number)
}

/// A rotation, an uneven scale and a translation from scene coordinates to field coordinates.
fn placement() -> DAffine3 {
    let turned = DAffine3::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 0.8);
    (DAffine3::from_translation(DVec3::new(0.3, -1.0, 2.0)) * DAffine3::from_scale(DVec3::new(2.0, 0.5, 1.3)) * turned)
        .inverse()
}

/// A grid with values up to 10⁻⁶, empty cells, and single cells of value 1.
fn spiky_grid(resolution: [usize; 3]) -> FieldGrid {
    let mut stream = random(1);
    let cells = resolution.iter().product::<usize>();
    let mut value = || match stream.uniform() {
        u if u < 0.4 => 0.0,
        u if u < 0.45 => 1.0,
        u => 1e-6 * u,
    };
    let values: Vec<f64> = (0..cells).map(|_| value()).collect();
    FieldGrid::new(resolution, values.into_iter()).unwrap()
}

fn planet_shape() -> FieldShape {
    let planet = Planet { center: DVec3::new(0.2, -0.6, -0.4), radius: 1.4 };
    FieldShape::Atmosphere(Atmosphere { value: 2.0, scale_height: 0.11, above: Ground::Planet(planet) })
}

fn shapes() -> Vec<(&'static str, FieldShape)> {
    let ball =
        |falloff| FieldShape::Ball(BallField { value: 3.0, center: DVec3::new(0.4, 1.2, -0.5), radius: 0.7, falloff });
    let noise = Noise { value: 2.0, scale: 0.5, octaves: 3, threshold: 0.45, falloff: 0.5, seed: 7 };
    vec![
        ("constant", FieldShape::Constant(0.7)),
        ("one cell", FieldShape::Grid(FieldGrid::new([1, 1, 1], [0.25].into_iter()).unwrap())),
        ("flat grid", FieldShape::Grid(spiky_grid([5, 1, 4]))),
        ("grid", FieldShape::Grid(spiky_grid([19, 8, 33]))),
        ("noise", FieldShape::Grid(noise.grid(BOUNDS).unwrap())),
        ("plain", FieldShape::Atmosphere(Atmosphere { value: 2.0, scale_height: 0.3, above: Ground::Plain(0.5) })),
        ("planet", planet_shape()),
        ("hard ball", ball(0.0)),
        ("soft ball", ball(0.3)),
        ("softest ball", ball(1.0)),
    ]
}

fn fields() -> Vec<(&'static str, ScalarField)> {
    let place = |(name, shape)| (name, ScalarField::new(shape, BOUNDS, placement()));
    shapes().into_iter().map(place).collect()
}

/// Rays that start inside or outside the box of the field, cross or miss it, and end before, inside
/// or behind it.
fn rays(count: u64) -> impl Iterator<Item = (Ray, f64)> {
    let to_world = placement().inverse();
    let place = move |u: [f64; 3], spread: f64| {
        let (low, high) = BOUNDS;
        to_world.transform_point3(0.5 * (low + high) + spread * (DVec3::from(u) - 0.5) * (high - low))
    };
    (0..count).map(move |number| {
        let mut stream = random(100 + number);
        let from = place(stream.triple(), if number % 2 == 0 { 0.9 } else { 4.0 });
        let to = place(stream.triple(), 1.1);
        let length = if number % 3 == 0 { f64::INFINITY } else { 2.0 * stream.uniform() * (to - from).length() };
        (Ray::new(from, (to - from).normalize()), length)
    })
}

/// The integral between two distances along a ray, by the midpoint rule.
fn by_force(field: &ScalarField, ray: &Ray, (from, to): (f64, f64), steps: u32) -> f64 {
    let step = (to - from) / f64::from(steps);
    (0..steps).map(|i| field.at(ray.at(from + (f64::from(i) + 0.5) * step))).sum::<f64>() * step
}

#[test]
fn the_column_is_the_integral_of_the_value_along_the_ray() {
    for (name, field) in fields() {
        for (ray, length) in rays(40) {
            let column = field.column_m(&ray, length);
            let Some(interval) = field.interval(&ray, length) else {
                assert_eq!(column, 0.0, "{name}");
                continue;
            };
            assert!(interval.0 >= 0.0 && interval.1 <= length && interval.0 < interval.1);
            let brute = by_force(&field, &ray, interval, 20_000);
            // At each jump of the field, the midpoint rule has an error of half a step.
            let jumps = if name == "hard ball" { 1.0 / 20_000.0 } else { 1e-7 };
            let bound = jumps * field.max() * (interval.1 - interval.0) + 1e-6 * column;
            assert!((column - brute).abs() < bound, "{name}: {column} against {brute} of {interval:?}");
        }
    }
}

#[test]
fn columns_of_two_halves_add_up() {
    for (name, field) in fields() {
        for (ray, length) in rays(60) {
            let (middle, far) = (0.4 * length.min(3.0), length.min(50.0));
            let second = Ray::new(ray.at(middle), ray.direction);
            let sum = field.column_m(&ray, middle) + field.column_m(&second, far - middle);
            let whole = field.column_m(&ray, far);
            assert!((whole - sum).abs() <= 1e-12 * field.max() * far.min(10.0), "{name}: {whole} against {sum}");
        }
    }
}

#[test]
fn the_distance_at_a_column_holds_that_column() {
    for (name, field) in fields() {
        let mut reached = 0;
        for (number, (ray, length)) in rays(60).enumerate() {
            let whole = field.column_m(&ray, length);
            assert_eq!(field.distance_at(&ray, length, whole * (1.0 + 1e-12) + 1e-300), None, "{name}");
            if whole == 0.0 {
                continue;
            }
            for fraction in [0.0, 1e-9, 0.3, 0.999, 1.0 - 1e-9] {
                let t = field.distance_at(&ray, length, fraction * whole).expect("the ray holds that much");
                assert!(t >= 0.0 && t <= length);
                let column = field.column_m(&ray, t);
                // The rounding error of t itself.
                let rounding = 4.0 * f64::EPSILON * t * field.max();
                let off = (column - fraction * whole).abs();
                assert!(
                    off <= 1e-12 * whole + rounding,
                    "{name} {number}: {column}, wanted {} of {whole}",
                    fraction * whole
                );
                reached += 1;
            }
        }
        assert!(reached > 100, "{name}: only {reached}");
    }
}

#[test]
fn no_value_along_a_ray_exceeds_its_majorant() {
    for (name, field) in fields() {
        let mut tight = 0;
        for (ray, length) in rays(60) {
            let majorant = field.majorant(&ray, length);
            assert!(majorant <= field.max() * (1.0 + 1e-12), "{name}");
            let Some((from, to)) = field.interval(&ray, length) else { continue };
            let values = (0..2000).map(|i| field.at(ray.at(from + (to - from) * (f64::from(i) + 0.5) / 2000.0)));
            let largest = values.fold(0.0, f64::max);
            assert!(largest <= majorant * (1.0 + 1e-12), "{name}: {largest} above {majorant}");
            tight += u32::from(largest >= 0.99 * majorant);
        }
        let bounded_by_blocks = ["grid", "flat grid", "noise"].contains(&name);
        assert!(bounded_by_blocks || tight > 40, "{name}: the bound is tight on {tight} rays");
    }
}

#[test]
fn rays_along_faces_and_planes_of_centres_are_exact() {
    // Values 0, 1, 2, … along x: the field is linear in x and constant beyond the outer centres.
    let cells = 6;
    let values: Vec<f64> = (0..cells * 4).map(|i| (i % cells) as f64).collect();
    let grid = FieldShape::Grid(FieldGrid::new([cells, 2, 2], values.into_iter()).unwrap());
    let field = ScalarField::new(grid, (DVec3::ZERO, DVec3::new(6.0, 2.0, 2.0)), DAffine3::IDENTITY);
    for y in [0.0, 0.5, 1.0, 1.5, 2.0] {
        for z in [0.0, 0.5, 1.7, 2.0] {
            for (x, direction) in [(-1.0, DVec3::X), (7.0, DVec3::NEG_X), (0.0, DVec3::X), (6.0, DVec3::NEG_X)] {
                let ray = Ray::new(DVec3::new(x, y, z), direction);
                assert!((field.column_m(&ray, f64::INFINITY) - 15.0).abs() < 1e-12, "{y} {z} {x}");
            }
        }
    }
    let beside = Ray::new(DVec3::new(-1.0, 2.0 + 1e-12, 1.0), DVec3::X);
    assert_eq!(field.column_m(&beside, f64::INFINITY), 0.0);
    assert_eq!(field.interval(&beside, f64::INFINITY), None);
    // One line in the first plane of cell centres, where the value is 0, and one in the last plane.
    assert_eq!(field.column_m(&Ray::new(DVec3::new(0.5, -1.0, 0.5), DVec3::Y), 10.0), 0.0);
    assert!((field.column_m(&Ray::new(DVec3::new(5.5, 3.0, 0.5), DVec3::NEG_Y), 10.0) - 10.0).abs() < 1e-12);
}

#[test]
fn the_columns_of_a_planetary_atmosphere_are_exact() {
    let (radius, scale_height) = (6_371e3, 8e3);
    let center = DVec3::new(0.0, -radius, 0.0);
    let air = Atmosphere { value: 1.0, scale_height, above: Ground::Planet(Planet { center, radius }) };
    let far = DVec3::splat(7e6);
    let field = ScalarField::new(FieldShape::Atmosphere(air), (center - far, center + far), DAffine3::IDENTITY);
    // The column density of a vertical ray equals the scale height.
    let up = field.column_m(&Ray::new(DVec3::ZERO, DVec3::Y), f64::INFINITY);
    assert!((up / scale_height - 1.0).abs() < 1e-12, "{up}");
    // Along the horizon: ∫ exp(−(√(R² + s²) − R)/H) ds = R e^{R/H} K₁(R/H), with the series of K₁
    // for large arguments.
    let x = radius / scale_height;
    let bessel = (PI / (2.0 * x)).sqrt()
        * (1.0 + 3.0 / (8.0 * x) - 15.0 / (128.0 * x * x) + 315.0 / (3072.0 * x.powi(3))
            - 4725.0 / (98304.0 * x.powi(4)));
    for direction in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.6, 0.0, 0.8)] {
        let along = field.column_m(&Ray::new(DVec3::ZERO, direction), f64::INFINITY);
        assert!((along / (radius * bessel) - 1.0).abs() < 1e-11, "{along} against {}", radius * bessel);
    }
    // The column density of a ray that grazes the planet is twice that of the half beyond its
    // lowest point.
    let height = 3_000.0;
    let ray = Ray::new(DVec3::new(-6.9e6, height, 0.0), DVec3::X);
    let x = (radius + height) / scale_height;
    let half = (radius + height) * (PI / (2.0 * x)).sqrt() * (1.0 + 3.0 / (8.0 * x) - 15.0 / (128.0 * x * x));
    let whole = field.column_m(&ray, f64::INFINITY);
    let expected = 2.0 * half * (-height / scale_height).exp();
    assert!((whole / expected - 1.0).abs() < 1e-8, "{whole} against {expected}");
    for fraction in [1e-6, 0.1, 0.5, 0.9] {
        let t = field.distance_at(&ray, f64::INFINITY, fraction * whole).unwrap();
        let column = field.column_m(&ray, t);
        assert!((column / (fraction * whole) - 1.0).abs() < 1e-10, "{fraction}: {column}");
    }
    // The value inside the planet equals the value at the ground.
    let through = field.column_m(&Ray::new(DVec3::ZERO, DVec3::NEG_Y), 1000.0);
    assert!((through - 1000.0).abs() < 1e-6, "{through}");
}

#[test]
fn halving_the_step_quarters_the_error_of_a_march() {
    for (name, field) in fields().into_iter().filter(|(name, _)| ["plain", "planet", "flat grid"].contains(name)) {
        // The error is averaged over many rays, because the position of a kink within a step is
        // random.
        let error = |steps: u32| {
            let error =
                |ray: &Ray, length: f64| field.column_by_steps(ray, length, steps) - field.column_m(ray, length);
            rays(300).map(|(ray, length)| error(&ray, length).powi(2)).sum::<f64>().sqrt()
        };
        let order = (error(512) / error(1024)).log2();
        println!("{name}: order {order:.3}");
        assert!((order - 2.0).abs() < 0.1, "{name}: order {order}");
    }
}

#[test]
fn the_seed_and_the_threshold_determine_the_noise() {
    let noise = Noise { value: 2.0, scale: 0.5, octaves: 4, threshold: 0.5, falloff: 0.0, seed: 1 };
    let grid = noise.grid(BOUNDS).unwrap();
    assert_eq!(grid, noise.grid(BOUNDS).unwrap());
    assert_ne!(grid, Noise { seed: 2, ..noise }.grid(BOUNDS).unwrap());
    let fraction_empty = |grid: FieldGrid| {
        let field = ScalarField::new(FieldShape::Grid(grid), BOUNDS, DAffine3::IDENTITY);
        let mut stream = random(9);
        let empty = |_| field.at(BOUNDS.0 + DVec3::from(stream.triple()) * (BOUNDS.1 - BOUNDS.0)) == 0.0;
        (0..4000).map(empty).filter(|&empty| empty).count()
    };
    let fractions =
        [0.0, 0.5, 0.7, 1.0].map(|threshold| fraction_empty(Noise { threshold, ..noise }.grid(BOUNDS).unwrap()));
    assert!(
        fractions[0] < 100
            && (800..3000).contains(&fractions[1])
            && fractions[2] > fractions[1]
            && fractions[3] == 4000,
        "{fractions:?}"
    );
    assert!(grid.max() <= 2.0 && grid.max() > 1.2, "{}", grid.max());
}

#[test]
fn only_thin_atmospheres_are_too_fine_for_a_grid() {
    for (name, field) in fields() {
        // The longest side of the box is 3: a cell is 0.094 long with 32 cells, and 0.75 with 4
        // cells.
        assert!(field.is_smooth_in_cells(32), "{name}");
        assert_eq!(field.is_smooth_in_cells(4), !["plain", "planet"].contains(&name), "{name}");
    }
}
