//! The contract that every surface keeps, tested on all of them alike.
//!
//! A case is a surface between two media; each is seen from both sides, at several angles and wavelengths. Chance enters with
//! fixed seeds; χ² and mean tests leave about one false alarm in 10⁵ per comparison before the seeds were fixed.

mod grid;

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use self::grid::{Histogram, chi_square_deviations};
use super::*;
use crate::math::random::{Purpose, Stream};
use crate::spectrum::Outside;
use glam::DVec3;

/// A surface and the media in front of it and behind it.
struct Case {
    name: &'static str,
    surface: Surface,
    front: Index,
    behind: Index,
}

impl Case {
    fn sides(&self, wo: DVec3) -> Sides<'_> {
        if wo.z >= 0.0 {
            Sides { here: &self.front, there: &self.behind }
        } else {
            Sides { here: &self.behind, there: &self.front }
        }
    }

    fn sample(&self, wo: DVec3, nm: f64, u: [f64; 3]) -> Option<Scatter> {
        self.surface.sample(wo, self.sides(wo), nm, Transport::Importance, u)
    }

    fn weight(&self, wo: DVec3, scatter: &Scatter, transport: Transport, nm: f64) -> f64 {
        self.surface.response(wo, scatter, self.sides(wo), transport, nm) / scatter.probability
    }

    fn absorbed(&self, wo: DVec3, scatter: &Scatter, nm: f64) -> f64 {
        self.surface.absorbed(wo, scatter, self.sides(wo), nm)
    }

    fn eval(&self, wo: DVec3, wi: DVec3, transport: Transport, nm: f64) -> f64 {
        self.surface.eval(wo, wi, self.sides(wo), transport, nm)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        self.surface.pdf(wo, wi, self.sides(wo), nm)
    }
}

fn ramp(at_360: f64, at_830: f64) -> Spectrum {
    Spectrum::table(&[360.0, 830.0], &[at_360, at_830], Outside::Hold).unwrap()
}

fn copper_like(alpha: f64) -> Surface {
    Surface::conductor(ramp(1.3, 0.2), ramp(1.8, 5.0), alpha).unwrap()
}

fn glass(name: &str) -> Index {
    Index::catalogue(name).unwrap()
}

/// Every variant, smooth and rough, with spectra that vary.
fn cases() -> Vec<Case> {
    let air = || Index::constant(1.0).unwrap();
    let in_air = |name, surface| Case { name, surface, front: air(), behind: air() };
    let into = |name, alpha, behind| Case { name, surface: Surface::dielectric(alpha).unwrap(), front: air(), behind };
    let leaf = || Surface::translucent(ramp(0.05, 0.6), ramp(0.0, 0.35)).unwrap();
    let paint = |alpha| Surface::glossy(ramp(0.1, 0.9), glass("polystyrene"), alpha).unwrap();
    let mixture = Surface::mix(vec![
        (0.5, Surface::diffuse(ramp(0.2, 0.9)).unwrap()),
        (1.0, copper_like(0.3)),
        (0.3, Surface::mirror(ramp(0.9, 0.7)).unwrap()),
        (0.2, Surface::mix(vec![(1.0, Surface::Absorber), (3.0, leaf())]).unwrap()),
    ]);
    vec![
        in_air("absorber", Surface::Absorber),
        in_air("diffuse", Surface::diffuse(ramp(0.0, 1.0)).unwrap()),
        in_air("white diffuse", Surface::diffuse(Spectrum::constant(1.0)).unwrap()),
        in_air("translucent", leaf()),
        in_air("black translucent", Surface::translucent(ramp(0.0, 0.0), ramp(0.0, 0.0)).unwrap()),
        in_air("mirror", Surface::mirror(ramp(0.9, 0.3)).unwrap()),
        in_air("polished metal", copper_like(0.0)),
        in_air("rough metal", copper_like(0.15)),
        in_air("very rough metal", copper_like(0.8)),
        Case { name: "rough metal under water", front: glass("water 20C"), ..in_air("", copper_like(0.4)) },
        into("polished glass", 0.0, glass("N-SF10")),
        into("rough glass", 0.2, glass("N-SF10")),
        into("rough plain glass", 0.5, Index::constant(1.5).unwrap()),
        into("rough matched glass", 0.3, air()),
        Case { name: "rough glass to water", front: glass("N-BK7"), ..into("", 0.3, glass("water 20C")) },
        in_air("pane", Surface::thin_dielectric(glass("N-BK7"))),
        in_air("paint", paint(0.25)),
        in_air("varnish", paint(0.08)),
        in_air("clear coat on black", Surface::glossy(ramp(0.0, 0.0), Index::constant(1.6).unwrap(), 0.5).unwrap()),
        in_air("mixture", mixture.unwrap()),
    ]
}

/// Directions that a surface is seen from: along the normal, at mid angles, near grazing; from the front and from behind.
fn views() -> Vec<DVec3> {
    let at = |degrees: f64, azimuth: f64, side: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos * side)
    };
    vec![DVec3::Z, at(35.0, 0.7, 1.0), at(60.0, 3.9, 1.0), at(82.0, 5.1, 1.0), at(20.0, 2.2, -1.0), at(65.0, 1.3, -1.0)]
}

const WAVELENGTHS_NM: [f64; 2] = [430.0, 690.0];

fn random(seed: u64) -> impl FnMut() -> [f64; 3] {
    let mut stream = Stream::new(seed, Purpose::Camera, 0, 0);
    move || stream.triple()
}

fn any_direction(u: [f64; 3]) -> DVec3 {
    let z = 2.0 * u[0] - 1.0;
    let (sin, cos) = (TAU * u[1]).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

fn histogram(case: &Case, wo: DVec3, nm: f64, samples: usize, seed: u64) -> Histogram {
    let mut random = random(seed);
    let mut seen =
        Histogram { cells: vec![0.0; grid::BANDS * grid::SECTORS], deltas: 0.0, nowhere: 0.0, total: samples as f64 };
    for _ in 0..samples {
        match case.sample(wo, nm, random()) {
            Some(scatter) if scatter.delta => seen.deltas += 1.0,
            Some(scatter) if scatter.gets_away(wo) => seen.cells[grid::cell(scatter.wi)] += 1.0,
            Some(_) | None => seen.nowhere += 1.0,
        }
    }
    seen
}

/// Every combination of case, view and wavelength, with its own seed.
fn each_view(mut check: impl FnMut(&Case, DVec3, f64, u64)) {
    let mut seed = 0;
    for case in cases() {
        for wo in views() {
            for nm in WAVELENGTHS_NM {
                seed += 1;
                check(&case, wo, nm, seed);
            }
        }
    }
}

#[test]
fn samples_fall_as_their_density_says() {
    const SAMPLES: usize = 30_000;
    each_view(|case, wo, nm, seed| {
        let name = case.name;
        let seen = histogram(case, wo, nm, SAMPLES, seed);
        let density = grid::integrals(|wi| case.pdf(wo, wi, nm));
        let mass: f64 = density.iter().sum();
        let elsewhere = (seen.deltas + seen.nowhere) / seen.total;
        let error = (mass + elsewhere - 1.0).abs();
        let bound = 4.5 * (elsewhere * (1.0 - elsewhere) / seen.total).sqrt() + 1e-5;
        assert!(error < bound, "{name} from {wo} at {nm} nm: the density integrates to {mass}, not 1 − {elsewhere}");
        let expected: Vec<f64> = density.iter().map(|mass| mass * seen.total).collect();
        let deviations = chi_square_deviations(&seen, &expected);
        assert!(deviations < 4.5, "{name} from {wo} at {nm} nm: χ² is {deviations} deviations too large");
    });
}

#[test]
fn the_chi_square_test_rejects_a_density_of_a_slightly_different_roughness() {
    let (metal, near) = (copper_like(0.3), copper_like(0.34));
    let air = Index::constant(1.0).unwrap();
    let case = Case { name: "metal", surface: metal, front: air.clone(), behind: air };
    for wo in views() {
        let seen = histogram(&case, wo, 500.0, 30_000, 3);
        let expected = grid::integrals(|wi| 30_000.0 * near.pdf(wo, wi, case.sides(wo), 500.0));
        assert!(chi_square_deviations(&seen, &expected) > 4.5, "from {wo}");
    }
}

#[test]
fn a_scatter_carries_the_density_of_its_direction() {
    each_view(|case, wo, nm, seed| {
        let mut random = random(seed);
        for _ in 0..50 {
            let u = random();
            let part = case.surface.pick(random()[2]);
            let Some(scatter) = part.sample(wo, case.sides(wo), nm, Transport::Radiance, u) else { continue };
            assert!((scatter.wi.length() - 1.0).abs() < 1e-12, "{}: |wi| = {}", case.name, scatter.wi.length());
            assert!(scatter.probability > 0.0, "{}", case.name);
            if !scatter.delta && scatter.gets_away(wo) {
                let density = part.pdf(wo, scatter.wi, case.sides(wo), nm);
                let error = (density / scatter.probability - 1.0).abs();
                assert!(error < 1e-9, "{}: {density} and {}", case.name, scatter.probability);
            }
        }
    });
}

#[test]
fn no_surface_gives_back_more_power_than_arrives() {
    each_view(|case, wo, nm, seed| {
        let spread: f64 = grid::integrals(|wi| case.eval(wo, wi, Transport::Importance, nm) * wi.z.abs()).iter().sum();
        let mut random = random(seed);
        let mut deltas = 0.0;
        for _ in 0..2000 {
            let scatter = case.sample(wo, nm, random()).filter(|scatter| scatter.delta);
            deltas += scatter.map_or(0.0, |scatter| case.weight(wo, &scatter, Transport::Importance, nm) / 2000.0);
        }
        assert!(spread + deltas < 1.0 + 1e-5, "{} from {wo} at {nm} nm: {spread} + {deltas}", case.name);
    });
}

/// The mean and its standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Per sample at `nm`, for a path that chose at `hero_nm`: the weight and what is absorbed.
fn balance(case: &Case, wo: DVec3, hero_nm: f64, nm: f64, seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    (0..20_000)
        .map(|_| match case.sample(wo, hero_nm, random()) {
            Some(scatter) => case.weight(wo, &scatter, Transport::Importance, nm) + case.absorbed(wo, &scatter, nm),
            None => 1.0,
        })
        .collect()
}

#[test]
fn what_goes_on_and_what_is_absorbed_add_up_to_what_arrives() {
    each_view(|case, wo, nm, seed| {
        let (mean, error) = mean_and_error(&balance(case, wo, nm, nm, seed));
        let off = (mean - 1.0).abs();
        assert!(off <= 4.5 * error + 2e-5, "{} from {wo} at {nm} nm: {mean} ± {error}", case.name);
        let event_by_event = matches!(
            case.name,
            "diffuse"
                | "white diffuse"
                | "mirror"
                | "polished metal"
                | "rough metal"
                | "very rough metal"
                | "rough metal under water"
                | "polished glass"
                | "rough glass"
                | "rough plain glass"
                | "rough glass to water"
                | "pane"
        );
        if event_by_event {
            assert!(error < 1e-9, "{} from {wo} at {nm} nm is not balanced in each event: ± {error}", case.name);
        }
    });
}

#[test]
fn the_balance_test_rejects_absorption_that_forgets_shadowed_light() {
    let case = cases().into_iter().find(|case| case.name == "very rough metal").unwrap();
    let Surface::Conductor(metal) = &case.surface else { panic!("a metal is a conductor") };
    for wo in views() {
        let mut random = random(5);
        let mutant: Vec<f64> = (0..20_000)
            .map(|_| match case.sample(wo, 500.0, random()) {
                Some(scatter) => {
                    let cos = wo.dot((wo + scatter.wi).normalize());
                    let lost_in_the_metal = 1.0 - metal.fresnel(cos, case.sides(wo), 500.0);
                    case.weight(wo, &scatter, Transport::Importance, 500.0) + lost_in_the_metal
                }
                None => 1.0,
            })
            .collect();
        let (mean, error) = mean_and_error(&mutant);
        assert!((mean - 1.0).abs() > 4.5 * error + 2e-5, "from {wo}: {mean} ± {error}");
    }
}

#[test]
fn the_other_wavelengths_of_a_path_balance_too() {
    for case in cases() {
        // Refraction at rough dispersive glass leaves the path one wavelength only.
        if matches!(case.name, "rough glass" | "rough glass to water") {
            continue;
        }
        for (seed, wo) in views().into_iter().enumerate() {
            let (mean, error) = mean_and_error(&balance(&case, wo, 640.0, 460.0, seed as u64));
            assert!((mean - 1.0).abs() <= 4.5 * error + 2e-5, "{} from {wo}: {mean} ± {error}", case.name);
        }
    }
}

#[test]
fn light_takes_the_same_way_back() {
    for case in cases() {
        let mut random = random(11);
        for _ in 0..4000 {
            let (wo, wi) = (any_direction(random()), any_direction(random()));
            for nm in WAVELENGTHS_NM {
                let (here, there) = (case.sides(wo).here.n(nm), case.sides(wi).here.n(nm));
                let forth = case.eval(wo, wi, Transport::Radiance, nm);
                let back = case.eval(wi, wo, Transport::Radiance, nm);
                let (a, b) = (forth / (here * here), back / (there * there));
                // By the critical angle the transmittance goes to 0 as the root of a difference: what is left has fewer digits.
                assert!(
                    (a - b).abs() <= 1e-9 * a.max(b) + 1e-13,
                    "{}: f({wo}, {wi})/n² is {a} but {b} back",
                    case.name
                );
                let adjoint = case.eval(wi, wo, Transport::Importance, nm);
                assert!((forth - adjoint).abs() <= 1e-9 * forth + 1e-13, "{}: {forth}, adjoint {adjoint}", case.name);
            }
        }
    }
}

#[test]
fn reciprocity_fails_without_the_squared_index() {
    let case = cases().into_iter().find(|case| case.name == "rough plain glass").unwrap();
    let mut random = random(12);
    let (mut broken, mut through) = (0, 0);
    for _ in 0..4000 {
        let (wo, wi) = (any_direction(random()), any_direction(random()));
        let forth = case.eval(wo, wi, Transport::Importance, 500.0);
        let back = case.eval(wi, wo, Transport::Importance, 500.0);
        let (here, there) = (case.sides(wo).here.n(500.0), case.sides(wi).here.n(500.0));
        if wo.z * wi.z < 0.0 && forth > 0.0 {
            through += 1;
            broken += u32::from((forth / (here * here) - back / (there * there)).abs() > 1e-9 * forth);
        }
    }
    assert!(through > 300 && broken == through, "{broken} of {through}");
}

#[test]
fn a_delta_takes_the_same_way_back() {
    for case in cases() {
        for wo in views() {
            for u in [0.0, 0.999_999] {
                let Some(scatter) = case.sample(wo, 500.0, [0.3, 0.4, u]).filter(|scatter| scatter.delta) else {
                    continue;
                };
                let back = Scatter { wi: wo, ..scatter };
                let forth = case.surface.response(wo, &scatter, case.sides(wo), Transport::Radiance, 500.0);
                let back = case.surface.response(scatter.wi, &back, case.sides(scatter.wi), Transport::Radiance, 500.0);
                let (here, there) = (case.sides(wo).here.n(500.0), case.sides(scatter.wi).here.n(500.0));
                // Where the density per solid angle f of spread light changes by n², so does the solid angle itself.
                let (a, b) = (forth * (there * there) / (here * here), back * (here * here) / (there * there));
                assert!((a - b).abs() <= 1e-12 * a.max(b), "{} from {wo}: {a} but {b} back", case.name);
            }
        }
    }
}

#[test]
fn extreme_random_numbers_and_angles_stay_finite() {
    let extremes = [0.0, f64::MIN_POSITIVE, 0.25, 0.5, 1.0 - f64::EPSILON / 2.0];
    let grazing = [0.0, -0.0, 1e-300, 1e-12, -1e-12, 1e-5, -1e-5]
        .map(|z: f64| DVec3::new(FRAC_1_SQRT_2 * (1.0 - z * z).sqrt(), FRAC_1_SQRT_2 * (1.0 - z * z).sqrt(), z));
    let every_u = extremes.iter().flat_map(|&a| extremes.iter().flat_map(move |&b| extremes.map(|c| [a, b, c])));
    for case in cases() {
        for wo in views().into_iter().chain(grazing).chain([DVec3::NEG_Z]) {
            for u in every_u.clone() {
                let Some(scatter) = case.sample(wo, 500.0, u) else { continue };
                let name = case.name;
                assert!((scatter.wi.length() - 1.0).abs() < 1e-9, "{name} from {wo} with {u:?}: {:?}", scatter.wi);
                assert!(scatter.probability > 0.0 && scatter.probability.is_finite(), "{name} from {wo} with {u:?}");
                for nm in [360.0, 500.0, 830.0] {
                    for transport in [Transport::Radiance, Transport::Importance] {
                        let weight = case.weight(wo, &scatter, transport, nm);
                        assert!(weight.is_finite() && weight >= 0.0, "{name} from {wo} with {u:?}: weight {weight}");
                    }
                }
                let absorbed = case.absorbed(wo, &scatter, 500.0);
                assert!((0.0..=1.0 + 1e-12).contains(&absorbed), "{name} from {wo} with {u:?}: absorbs {absorbed}");
            }
        }
    }
}

#[test]
fn only_refraction_by_dispersive_media_makes_a_path_choose_its_wavelength() {
    each_view(|case, wo, nm, seed| {
        let mut random = random(seed);
        let dispersive = case.front.is_dispersive() || case.behind.is_dispersive();
        let refracts = matches!(case.surface, Surface::Dielectric(_));
        for _ in 0..50 {
            let Some(scatter) = case.sample(wo, nm, random()) else { continue };
            let expected = refracts && dispersive && scatter.event == Event::Transmission;
            assert_eq!(scatter.disperses, expected, "{} from {wo}", case.name);
        }
    });
}

#[test]
fn classes_say_how_widely_light_is_spread() {
    let classes: Vec<_> = cases().iter().map(|case| (case.name, case.surface.class())).collect();
    let of = |name| classes.iter().find(|(other, _)| *other == name).unwrap().1;
    assert_eq!(of("absorber"), Class::Absorbing);
    assert_eq!(["mirror", "polished metal", "polished glass", "pane"].map(of), [Class::Specular; 4]);
    assert_eq!(["rough metal", "rough glass", "paint"].map(of), [Class::Glossy; 3]);
    assert_eq!(["diffuse", "translucent", "mixture"].map(of), [Class::Diffuse; 3]);
}
