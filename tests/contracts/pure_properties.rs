//! Properties of the pure functions that transport uses, for random arguments. A failure is reduced
//! to its simplest arguments.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use abbe_optics::fresnel;
use abbe_optics::phase::{Deflection, PhaseFunction};
use abbe_scene::geometry::shape::{PlacedShape, Shape};
use abbe_scene::geometry::{Geometry, Ray};
use abbe_scene::medium::field::{FieldGrid, FieldShape, ScalarField};
use abbe_scene::medium_stack::MediumStack;
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::quadrature::{gauss4, gauss16};
use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_spectra::math::sum::ExactSum;
use abbe_spectra::math::warp;
use abbe_spectra::spectrum::{Outside, Spectrum};
use abbe_transport::map::kernel::{self, DiskKernel};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;

/// A number as samplers receive it: anywhere in [0, 1), and often at its ends.
fn unit() -> impl Strategy<Value = f64> {
    prop_oneof![8 => 0.0..1.0, 1 => Just(0.0), 1 => Just(ONE_MINUS_ULP)]
}

fn direction() -> impl Strategy<Value = DVec3> {
    (unit(), unit()).prop_map(|(u, v)| warp::sphere([u, v]))
}

fn index() -> impl Strategy<Value = f64> {
    prop_oneof![1.0..4.0, Just(1.0), Just(1.0 + 1e-9), Just(1.5)]
}

/// A spectrum of a few values.
fn spectrum() -> impl Strategy<Value = Spectrum> {
    prop::collection::vec(0.0..10.0_f64, 2..9).prop_map(|values| {
        let nm: Vec<f64> = (0..values.len()).map(|i| 360.0 + 470.0 * i as f64 / (values.len() - 1) as f64).collect();
        Spectrum::table(&nm, &values, Outside::Zero).unwrap()
    })
}

/// Smoke in a rotated and scaled box.
fn field() -> impl Strategy<Value = ScalarField> {
    let values = prop::collection::vec(prop_oneof![Just(0.0), 0.0..5.0, Just(1e4)], 4 * 3 * 5);
    (values, direction(), 0.1..3.0_f64).prop_map(|(values, axis, size)| {
        let grid = FieldGrid::new([4, 3, 5], values.into_iter()).unwrap();
        let stands = DAffine3::from_axis_angle(axis, 0.7) * DAffine3::from_scale(DVec3::new(size, 1.0, 0.5));
        ScalarField::new(FieldShape::Grid(grid), (DVec3::ZERO, DVec3::ONE), stands.inverse())
    })
}

fn ray() -> impl Strategy<Value = Ray> {
    (direction(), direction(), 0.0..4.0_f64).prop_map(|(place, way, far)| Ray { origin: place * far, direction: way })
}

proptest! {
    #[test]
    fn frames_turn_and_turn_back(n in direction(), v in direction()) {
        let frame = Frame::new(n);
        prop_assert!((frame.to_world(frame.to_local(v)) - v).length() < 1e-14);
        prop_assert!((frame.to_local(v).length() - 1.0).abs() < 1e-14);
        prop_assert!((frame.to_local(n) - DVec3::Z).length() < 1e-14);
    }

    #[test]
    fn warps_stay_in_their_domains(u in unit(), v in unit(), half_angle in 1e-9..PI) {
        prop_assert!(warp::disk([u, v]).length() <= 1.0 + 1e-15);
        let up = warp::cosine_hemisphere([u, v]);
        prop_assert!((up.length() - 1.0).abs() < 1e-14 && up.z >= 0.0);
        let within = warp::cone(warp::one_minus_cos(half_angle), [u, v]);
        prop_assert!((within.length() - 1.0).abs() < 1e-14 && within.angle_between(DVec3::Z) <= half_angle * (1.0 + 1e-7) + 1e-7);
    }

    #[test]
    fn discrete_sampling_skips_zeros_and_reuses_its_number(
        weights in prop::collection::vec(prop_oneof![Just(0.0), 0.0..1e9, Just(1e-300)], 1..20), u in unit(),
    ) {
        let Some(distribution) = DiscreteDistribution::new(weights.iter().copied()) else {
            prop_assert!(weights.iter().all(|&weight| weight == 0.0));
            return Ok(());
        };
        let mut rest = u;
        let drawn = distribution.sample(&mut rest);
        prop_assert!(distribution.probability(drawn) > 0.0 && weights[drawn] > 0.0 && (0.0..1.0).contains(&rest));
        let total: f64 = (0..distribution.len()).map(|i| distribution.probability(i)).sum();
        prop_assert!((total - 1.0).abs() < 1e-12);
    }

    #[test]
    fn sums_are_the_same_in_any_order(terms in prop::collection::vec(-1e12..1e12_f64, 1..50), at in any::<prop::sample::Index>()) {
        let sum = |terms: &[f64]| {
            let mut sum = ExactSum::default();
            terms.iter().for_each(|&term| sum += term);
            sum
        };
        let cut = at.index(terms.len());
        let mut turned = terms.clone();
        turned.rotate_left(cut);
        let mut parts = sum(&terms[..cut]);
        parts += sum(&terms[cut..]);
        prop_assert_eq!(sum(&terms), sum(&turned));
        prop_assert_eq!(sum(&terms), parts);
        prop_assert_eq!(ExactSum::from_bits(parts.bits()), parts);
    }

    #[test]
    fn quadrature_is_exact_for_polynomials(c in prop::collection::vec(-3.0..3.0_f64, 8), from in -2.0..0.0_f64, to in 0.0..2.0_f64) {
        let at = |x: f64| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
        let integral = |x: f64| c.iter().enumerate().rev().fold(0.0, |sum, (i, c)| (sum + c / (i + 1) as f64) * x);
        let truth = integral(to) - integral(from);
        prop_assert!((gauss4((from, to), at) - truth).abs() < 1e-11);
        prop_assert!((gauss16((from, to), at) - truth).abs() < 1e-11);
    }

    #[test]
    fn reflectance_is_a_share_and_the_same_from_the_other_side(cos in unit(), n_i in index(), n_t in index()) {
        let reflectance = fresnel::dielectric(cos, n_i, n_t);
        prop_assert!((0.0..=1.0).contains(&reflectance));
        let w = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        match fresnel::refract(w, DVec3::Z, n_i, n_t) {
            None => prop_assert_eq!(reflectance, 1.0),
            Some(refracted) => {
                prop_assert!((refracted.length() - 1.0).abs() < 1e-14 && refracted.z <= 0.0);
                prop_assert!((n_i * w.x + n_t * refracted.x).abs() < 1e-14 * n_t.max(n_i), "Snell");
                let back = fresnel::dielectric(-refracted.z, n_t, n_i);
                // Near grazing, a cosine determines its angle only to an ulp of 1.
                prop_assert!(cos.min(-refracted.z) < 1e-4 || (back - reflectance).abs() < 1e-9, "{} {}", back, reflectance);
            }
        }
    }

    #[test]
    fn metals_reflect_a_share(cos in unit(), n in 0.01..10.0_f64, k in 0.0..20.0_f64) {
        prop_assert!((0.0..=1.0).contains(&fresnel::conductor(cos, n, k, 1.0)));
        // Without extinction, a conductor equals a dielectric.
        let clear = fresnel::conductor(cos, 1.0 + n, 0.0, 1.0);
        prop_assert!((clear - fresnel::dielectric(cos, 1.0, 1.0 + n)).abs() < 1e-10);
    }

    #[test]
    fn at_brewsters_angle_no_p_polarised_light_is_reflected(n_i in index(), n_t in index()) {
        let angle = fresnel::brewster_angle_deg(n_i, n_t).to_radians();
        prop_assert!(angle > 0.0 && angle < FRAC_PI_2);
        prop_assert!(fresnel::dielectric_sp(angle.cos(), n_i, n_t).1 < 1e-25);
    }

    #[test]
    fn phase_functions_are_densities(g in -0.95..0.95_f64, incoming in direction(), u in unit(), v in unit()) {
        for phase in [PhaseFunction::Isotropic, PhaseFunction::Rayleigh, PhaseFunction::HenyeyGreenstein { g: Spectrum::constant(g) }] {
            // In w, with cos θ = ±(1 − 2w²), peaks are as wide as the panels.
            let over = |f: &dyn Fn(f64) -> f64| -> f64 {
                let of_w = |w: f64| 4.0 * w * f(1.0_f64.copysign(g) * (1.0 - 2.0 * w * w));
                (0..64).map(|i| gauss16((f64::from(i) / 64.0, f64::from(i + 1) / 64.0), of_w)).sum()
            };
            let eval = |cos: f64| phase.eval(Deflection::horizontal(cos), 550.0);
            prop_assert!((TAU * over(&eval) - 1.0).abs() < 1e-9);
            prop_assert!((TAU * over(&|cos| cos * eval(cos)) - phase.mean_cosine(550.0).unwrap()).abs() < 1e-9);
            let outgoing = phase.sample(incoming, 550.0, [u, v]);
            prop_assert!((outgoing.length() - 1.0).abs() < 1e-14 && phase.eval(Deflection::between(incoming, outgoing), 550.0) > 0.0);
        }
    }

    #[test]
    fn spectra_add_and_multiply_as_functions_do(a in spectrum(), b in spectrum(), factor in 0.0..5.0_f64, nm in 360.0..830.0_f64) {
        let mixed = Spectrum::mix(&[(1.0, &a), (factor, &b)]);
        let near = |found: f64, truth: f64| (found - truth).abs() <= 1e-12 * (1.0 + truth.abs());
        prop_assert!(near(mixed.at(nm), a.at(nm) + factor * b.at(nm)));
        prop_assert!(near(a.scaled(factor).at(nm), factor * a.at(nm)));
        prop_assert!((a.min() - 1e-12..=a.max() + 1e-12).contains(&a.at(nm)));
        let [ab, ba] = [a.product_integral(&b), b.product_integral(&a)];
        prop_assert!((ab - ba).abs() <= 1e-12 * ab.abs());
        let with_mixed = mixed.product_integral(&a);
        prop_assert!((with_mixed - a.product_integral(&a) - factor * ba).abs() <= 1e-10 * (1.0 + with_mixed.abs()));
    }

    #[test]
    fn kernels_hold_all_their_mass_and_no_negative_value(d in 0.0..1.0_f64, r in 1e-9..1e6_f64) {
        let [disk, line] = [DiskKernel::new(r * r).at(d * d * r * r), kernel::on_line(d * r, r)];
        prop_assert!(disk.estimate >= 0.0 && line.estimate >= 0.0);
        // The rings up to d contain the mass of the closed form.
        let ring = |x: f64| DiskKernel::new(r * r).at(x * x).estimate * TAU * x;
        prop_assert!((gauss4((0.0, d * r), ring) - kernel::BoundaryCorrection::within(d).estimate).abs() < 1e-12);
        prop_assert!((gauss4((-r, r), |x| kernel::on_line(x.abs(), r).estimate) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn columns_add_up_and_places_are_found_again(field in field(), ray in ray(), a in 0.0..4.0_f64, b in 0.0..4.0_f64) {
        let all = field.column_m(&ray, a + b);
        let parts = field.column_m(&ray, a) + field.column_m(&Ray { origin: ray.at(a), direction: ray.direction }, b);
        prop_assert!((all - parts).abs() <= 1e-9 * (1.0 + all), "{} {}", all, parts);
        let part = field.column_m(&ray, a);
        prop_assert!(field.at(ray.at(a)) <= field.majorant(&ray, a + b + 1e-9) * (1.0 + 1e-12));
        if let Some(t) = field.distance_at(&ray, f64::INFINITY, part * (1.0 - 1e-12)) {
            prop_assert!((field.column_m(&ray, t) - part).abs() <= 1e-9 * (1.0 + part));
        }
    }

    #[test]
    fn who_goes_in_and_out_is_where_he_was(bodies in prop::collection::vec(0..20_u32, 0..7), visitor in 20..30_u32) {
        let around = bodies.iter().fold(MediumStack::AIR, |medium_stack, &body| medium_stack.entered(body));
        prop_assert!(around.entered(visitor).contains(visitor));
        prop_assert_eq!(around.entered(visitor).left(visitor), around);
        prop_assert_eq!(around.entered(visitor).entered(visitor), around.entered(visitor));
        prop_assert_eq!(bodies.iter().fold(around, |medium_stack, &body| medium_stack.left(body)), MediumStack::AIR);
    }

    #[test]
    fn rays_meet_balls_on_their_surface_and_leave_what_they_entered(ray in ray(), radius in 1e-3..2.0_f64, x in -1.0..1.0_f64) {
        let to_world = DAffine3::from_translation(DVec3::new(x, 0.5 * x, -x));
        let ball = PlacedShape { shape: Shape::Sphere { radius }, to_world, object: 0 };
        let geometry = Geometry::build(vec![ball], DVec3::ZERO).unwrap();
        let centre = to_world.translation;
        let outside = (ray.origin - centre).length() > radius;
        let (mut start, mut from, mut entries, mut exits) = (ray, None, 0, 0);
        while let Some(hit) = geometry.intersect(&start, from, f64::INFINITY) {
            prop_assert!(((hit.position - centre).length() - radius).abs() < 1e-15 * (8.0 + 8.0 * ray.origin.length()));
            prop_assert!((hit.normal.length() - 1.0).abs() < 1e-14);
            if start.direction.dot(hit.normal) < 0.0 { entries += 1 } else { exits += 1 }
            prop_assert!(entries + exits <= 2);
            (start.origin, from) = (hit.position, Some(hit.surface));
        }
        prop_assert_eq!(exits - entries, if outside { 0 } else { 1 });
    }
}
