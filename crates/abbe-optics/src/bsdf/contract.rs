//! The contract test of all BSDFs.
//!
//! A case is a BSDF between two media, tested from both sides at several angles and wavelengths.
//! The seeds are fixed, because the χ² tests and the mean tests have about 10⁻⁵ false alarms each.

mod films;
mod grid;

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use self::grid::{Histogram, chi_square_deviations};
use super::*;
use crate::fluorophore::Fluorophore;
use crate::glass::RefractiveIndex;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::spectrum::{Outside, Spectrum};
use glam::DVec3;

struct BsdfCase {
    name: &'static str,
    bsdf: Bsdf,
    front: RefractiveIndex,
    behind: RefractiveIndex,
}

impl BsdfCase {
    fn iors(&self, wo: DVec3) -> InterfaceIors<'_> {
        if wo.z >= 0.0 {
            InterfaceIors { here: &self.front, there: &self.behind }
        } else {
            InterfaceIors { here: &self.behind, there: &self.front }
        }
    }

    fn local(&self) -> LocalBsdf<'_> {
        LocalBsdf { model: &self.bsdf, texels: Texels::NONE }
    }

    fn sample(&self, wo: DVec3, nm: f64, u: [f64; 3]) -> Option<BsdfSample> {
        self.local().sample(wo, self.iors(wo), nm, u)
    }

    fn weight(&self, wo: DVec3, sample: &BsdfSample, mode: TransportMode, nm: f64) -> f64 {
        self.local().eval_sample(wo, sample, self.iors(wo), mode, nm) / sample.probability
    }

    fn absorbed_fraction(&self, wo: DVec3, sample: &BsdfSample, nm: f64) -> f64 {
        self.local().absorbed_fraction(wo, sample, self.iors(wo), nm)
    }

    fn eval(&self, wo: DVec3, wi: DVec3, mode: TransportMode, nm: f64) -> f64 {
        self.local().eval(wo, wi, self.iors(wo), mode, nm)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3, nm: f64) -> f64 {
        self.local().pdf(wo, wi, self.iors(wo), nm)
    }
}

fn ramp(at_360: f64, at_830: f64) -> Spectrum {
    Spectrum::table(&[360.0, 830.0], &[at_360, at_830], Outside::Hold).unwrap()
}

fn copper_like(alpha: f64) -> Bsdf {
    Bsdf::conductor(ramp(1.3, 0.2), ramp(1.8, 5.0), alpha).unwrap()
}

fn glass(name: &str) -> RefractiveIndex {
    RefractiveIndex::catalogue(name).unwrap()
}

fn dyed() -> Bsdf {
    let dye = Fluorophore::new(ramp(0.9, 0.1), &ramp(0.2, 1.0), 0.7).unwrap();
    Bsdf::Fluorescent(Box::new(Fluorescent::new(ramp(0.5, 0.95), dye).unwrap()))
}

/// Returns every BSDF variant, smooth and rough, with spectra that vary with the wavelength.
fn cases() -> Vec<BsdfCase> {
    let air = || RefractiveIndex::constant(1.0).unwrap();
    let in_air = |name, bsdf| BsdfCase { name, bsdf, front: air(), behind: air() };
    let into = |name, alpha, behind| BsdfCase { name, bsdf: Bsdf::dielectric(alpha).unwrap(), front: air(), behind };
    let leaf = || Bsdf::translucent(ramp(0.05, 0.6), ramp(0.0, 0.35)).unwrap();
    let paint = |alpha| Bsdf::glossy(ramp(0.1, 0.9), glass("polystyrene"), alpha).unwrap();
    let mixture = Bsdf::mix(vec![
        (0.5, Bsdf::diffuse(ramp(0.2, 0.9)).unwrap()),
        (1.0, copper_like(0.3)),
        (0.3, Bsdf::mirror(ramp(0.9, 0.7)).unwrap()),
        (0.2, Bsdf::mix(vec![(1.0, Bsdf::Absorber), (3.0, leaf())]).unwrap()),
    ]);
    let mut cases = vec![
        in_air("absorber", Bsdf::Absorber),
        in_air("diffuse", Bsdf::diffuse(ramp(0.0, 1.0)).unwrap()),
        in_air("white diffuse", Bsdf::diffuse(Spectrum::constant(1.0)).unwrap()),
        in_air("fluorescent", dyed()),
        in_air("translucent", leaf()),
        in_air("black translucent", Bsdf::translucent(ramp(0.0, 0.0), ramp(0.0, 0.0)).unwrap()),
        in_air("mirror", Bsdf::mirror(ramp(0.9, 0.3)).unwrap()),
        in_air("polished metal", copper_like(0.0)),
        in_air("rough metal", copper_like(0.15)),
        in_air("very rough metal", copper_like(0.8)),
        BsdfCase { name: "rough metal under water", front: glass("water 20C"), ..in_air("", copper_like(0.4)) },
        into("polished glass", 0.0, glass("N-SF10")),
        into("rough glass", 0.2, glass("N-SF10")),
        into("rough plain glass", 0.5, RefractiveIndex::constant(1.5).unwrap()),
        into("very rough glass", 1.0, glass("N-SF10")),
        into("rough matched glass", 0.3, air()),
        BsdfCase { name: "rough glass to water", front: glass("N-BK7"), ..into("", 0.3, glass("water 20C")) },
        in_air("pane", Bsdf::thin_dielectric(glass("N-BK7"), None).unwrap()),
        in_air("grey pane", Bsdf::thin_dielectric(glass("N-BK7"), Some(ramp(0.05, 0.9))).unwrap()),
        in_air("paint", paint(0.25)),
        in_air(
            "paint with interreflection",
            Bsdf::Glossy(Glossy::new(ramp(0.1, 0.9), glass("polystyrene"), 0.25).unwrap().with_interreflection()),
        ),
        in_air("varnish", paint(0.08)),
        in_air(
            "clear coat on black",
            Bsdf::glossy(ramp(0.0, 0.0), RefractiveIndex::constant(1.6).unwrap(), 0.5).unwrap(),
        ),
        in_air("metal of a given reflectance", Bsdf::metal(ramp(0.4, 0.9), 0.3).unwrap()),
        in_air("polished metal of a given reflectance", Bsdf::metal(ramp(0.4, 0.9), 0.0).unwrap()),
        in_air("mixture", mixture.unwrap()),
    ];
    cases.extend(films::cases());
    cases
}

/// Returns views on both sides of the surface, at 0 to 82 degrees to the normal.
fn views() -> Vec<DVec3> {
    let at = |degrees: f64, azimuth: f64, side: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos * side)
    };
    vec![DVec3::Z, at(35.0, 0.7, 1.0), at(60.0, 3.9, 1.0), at(82.0, 5.1, 1.0), at(20.0, 2.2, -1.0), at(65.0, 1.3, -1.0)]
}

const BSDF_TEST_NM: [f64; 2] = [430.0, 690.0];

fn random(seed: u64) -> impl FnMut() -> [f64; 3] {
    let mut stream = Stream::new(Seed::new(seed), Purpose::Camera, 0, 0);
    move || stream.triple()
}

fn any_direction(u: [f64; 3]) -> DVec3 {
    let z = 2.0 * u[0] - 1.0;
    let (sin, cos) = (TAU * u[1]).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

fn histogram(case: &BsdfCase, wo: DVec3, nm: f64, samples: usize, seed: u64) -> Histogram {
    let mut random = random(seed);
    let mut seen =
        Histogram { cells: vec![0.0; grid::BANDS * grid::SECTORS], deltas: 0.0, nowhere: 0.0, total: samples as f64 };
    for _ in 0..samples {
        match case.sample(wo, nm, random()) {
            Some(sample) if sample.delta => seen.deltas += 1.0,
            Some(sample) if sample.on_event_side(wo) => seen.cells[grid::cell(sample.wi)] += 1.0,
            Some(_) | None => seen.nowhere += 1.0,
        }
    }
    seen
}

/// Calls `check` for every case and view, each with its own seed. The wavelengths take turns.
fn each_view(mut check: impl FnMut(&BsdfCase, DVec3, f64, u64)) {
    let mut seed = 0;
    for case in cases() {
        for (wo, nm) in views().into_iter().zip(BSDF_TEST_NM.into_iter().cycle()) {
            seed += 1;
            check(&case, wo, nm, seed);
        }
    }
}

#[test]
fn samples_follow_the_pdf() {
    const SAMPLES: usize = 30_000;
    each_view(|case, wo, nm, seed| {
        let name = case.name;
        let seen = histogram(case, wo, nm, SAMPLES, seed);
        let pdf = grid::integrals(|wi| case.pdf(wo, wi, nm));
        let mass: f64 = pdf.iter().sum();
        let elsewhere = (seen.deltas + seen.nowhere) / seen.total;
        let error = (mass + elsewhere - 1.0).abs();
        let bound = 4.5 * (elsewhere * (1.0 - elsewhere) / seen.total).sqrt() + 1e-5;
        assert!(error < bound, "{name} from {wo} at {nm} nm: the density integrates to {mass}, not 1 − {elsewhere}");
        let expected: Vec<f64> = pdf.iter().map(|mass| mass * seen.total).collect();
        let deviations = chi_square_deviations(&seen, &expected);
        assert!(deviations < 4.5, "{name} from {wo} at {nm} nm: χ² is {deviations} deviations too large");
    });
}

#[test]
fn chi_square_rejects_a_slightly_different_roughness() {
    let (metal, near) = (copper_like(0.3), copper_like(0.34));
    let air = RefractiveIndex::constant(1.0).unwrap();
    let case = BsdfCase { name: "metal", bsdf: metal, front: air.clone(), behind: air };
    for wo in views() {
        let seen = histogram(&case, wo, 500.0, 30_000, 3);
        let expected = grid::integrals(|wi| 30_000.0 * near.at(0.0).pdf(wo, wi, case.iors(wo), 500.0));
        assert!(chi_square_deviations(&seen, &expected) > 4.5, "from {wo}");
    }
}

#[test]
fn samples_carry_the_pdf_of_their_direction() {
    each_view(|case, wo, nm, seed| {
        let mut random = random(seed);
        for _ in 0..50 {
            let u = random();
            let part = case.bsdf.at(random()[2]);
            let Some(sample) = part.sample(wo, case.iors(wo), nm, u) else { continue };
            assert!((sample.wi.length() - 1.0).abs() < 1e-12, "{}: |wi| = {}", case.name, sample.wi.length());
            assert!(sample.probability > 0.0, "{}", case.name);
            if !sample.delta && sample.on_event_side(wo) {
                let pdf = part.pdf(wo, sample.wi, case.iors(wo), nm);
                let error = (pdf / sample.probability - 1.0).abs();
                assert!(error < 1e-9, "{}: {pdf} and {}", case.name, sample.probability);
            }
        }
    });
}

#[test]
#[ignore = "nightly: 64 seconds of CPU time"]
fn no_bsdf_returns_more_power_than_arrives() {
    each_view(|case, wo, nm, seed| {
        let spread = |tolerance: f64| -> f64 {
            let power = |wi: DVec3| case.eval(wo, wi, TransportMode::Importance, nm) * wi.z.abs();
            grid::integrals_within(tolerance, power).iter().sum()
        };
        let mut random = random(seed);
        let weight = |sample| case.weight(wo, &sample, TransportMode::Importance, nm);
        let weights: Vec<f64> = (0..2000)
            .map(|_| case.sample(wo, nm, random()).filter(|sample| sample.delta).map_or(0.0, weight))
            .collect();
        let (deltas, error) = mean_and_error(&weights);
        // Films reflect and transmit with bounded probabilities, so their weights vary.
        let bound = 1.0 + 1e-5 + if case.bsdf.films().is_some() { 4.5 * error } else { 0.0 };
        // The error of the first integral is of the order of the bound.
        let mut found = spread(1e-7);
        if found + deltas > bound - 2e-4 {
            found = spread(1e-9);
        }
        assert!(found + deltas < bound, "{} from {wo} at {nm} nm: {found} + {deltas}", case.name);
    });
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Returns weight plus absorbed fraction at `nm` of each sample, with the hero `hero_nm`.
fn balance(case: &BsdfCase, wo: DVec3, hero_nm: f64, nm: f64, seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    (0..20_000)
        .map(|_| match case.sample(wo, hero_nm, random()) {
            Some(sample) => {
                case.weight(wo, &sample, TransportMode::Importance, nm) + case.absorbed_fraction(wo, &sample, nm)
            }
            None => 1.0,
        })
        .collect()
}

/// Mean weight plus mean absorbed fraction is 1, for some BSDFs also event by event.
#[test]
fn scattered_and_absorbed_power_sum_to_one() {
    each_view(|case, wo, nm, seed| {
        let (mean, error) = mean_and_error(&balance(case, wo, nm, nm, seed));
        let off = (mean - 1.0).abs();
        assert!(off <= 4.5 * error + 2e-5, "{} from {wo} at {nm} nm: {mean} ± {error}", case.name);
        let event_by_event =
            matches!(case.name, "diffuse" | "white diffuse" | "mirror" | "polished metal" | "polished glass" | "pane");
        if event_by_event {
            assert!(error < 1e-9, "{} from {wo} at {nm} nm is not balanced in each event: ± {error}", case.name);
        }
    });
}

/// It must fail if a rough metal's fraction omits what several events absorb.
#[test]
fn balance_test_rejects_absorption_of_single_events_only() {
    let case = cases().into_iter().find(|case| case.name == "very rough metal").unwrap();
    let Bsdf::Conductor(metal) = &case.bsdf else { panic!("a metal is a conductor") };
    for wo in views() {
        let mut random = random(5);
        let mutant: Vec<f64> = (0..20_000)
            .map(|_| match case.sample(wo, 500.0, random()) {
                Some(sample) => {
                    let lost_in_the_metal =
                        1.0 - metal.fresnel(sample.cos_microfacet, case.iors(wo), Texels::NONE, 500.0);
                    case.weight(wo, &sample, TransportMode::Importance, 500.0) + lost_in_the_metal
                }
                None => 1.0,
            })
            .collect();
        let (mean, error) = mean_and_error(&mutant);
        assert!((mean - 1.0).abs() > 4.5 * error + 2e-5, "from {wo}: {mean} ± {error}");
    }
}

#[test]
fn non_hero_wavelengths_balance_too() {
    for case in cases() {
        // After refraction at rough dispersive glass, and after a grating, the path keeps only one
        // wavelength, and its weight at the others is not defined.
        let is_grating = case.bsdf.grating().is_some();
        let is_dispersive_and_rough = matches!(
            case.name,
            "rough glass" | "very rough glass" | "rough glass to water" | "coated rough glass" | "silvered rough glass"
        );
        if is_grating || is_dispersive_and_rough {
            continue;
        }
        for (seed, wo) in views().into_iter().enumerate() {
            let (mean, error) = mean_and_error(&balance(&case, wo, 640.0, 460.0, seed as u64));
            assert!((mean - 1.0).abs() <= 4.5 * error + 2e-5, "{} from {wo}: {mean} ± {error}", case.name);
        }
    }
}

/// f(wo, wi)/n² is symmetric, with n on the side of `wo`. Importance is the adjoint.
#[test]
fn eval_is_reciprocal() {
    for case in cases() {
        let mut random = random(11);
        for _ in 0..4000 {
            let (wo, wi) = (any_direction(random()), any_direction(random()));
            for nm in BSDF_TEST_NM {
                let (here, there) = (case.iors(wo).here.n(nm), case.iors(wi).here.n(nm));
                let forth = case.eval(wo, wi, TransportMode::Radiance, nm);
                let back = case.eval(wi, wo, TransportMode::Radiance, nm);
                let (a, b) = (forth / (here * here), back / (there * there));
                // Near the critical angle, the transmittance depends on the square root of a small
                // difference, so the two values agree to fewer digits.
                assert!(
                    (a - b).abs() <= 1e-9 * a.max(b) + 1e-13,
                    "{}: f({wo}, {wi})/n² is {a} but {b} back",
                    case.name
                );
                let adjoint = case.eval(wi, wo, TransportMode::Importance, nm);
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
        let forth = case.eval(wo, wi, TransportMode::Importance, 500.0);
        let back = case.eval(wi, wo, TransportMode::Importance, 500.0);
        let (here, there) = (case.iors(wo).here.n(500.0), case.iors(wi).here.n(500.0));
        if wo.z * wi.z < 0.0 && forth > 0.0 {
            through += 1;
            broken += u32::from((forth / (here * here) - back / (there * there)).abs() > 1e-9 * forth);
        }
    }
    assert!(through > 300 && broken == through, "{broken} of {through}");
}

/// They are reciprocal without the n² of radiance, except those of gratings.
#[test]
fn delta_coefficients_are_reciprocal() {
    for case in cases().into_iter().filter(|case| case.bsdf.grating().is_none()) {
        for wo in views() {
            for u in [0.0, 0.999_999] {
                let Some(sample) = case.sample(wo, 500.0, [0.3, 0.4, u]).filter(|sample| sample.delta) else {
                    continue;
                };
                let back = BsdfSample { wi: wo, ..sample };
                let forth = case.local().eval_sample(wo, &sample, case.iors(wo), TransportMode::Radiance, 500.0);
                let back =
                    case.local().eval_sample(sample.wi, &back, case.iors(sample.wi), TransportMode::Radiance, 500.0);
                let (here, there) = (case.iors(wo).here.n(500.0), case.iors(sample.wi).here.n(500.0));
                // The factor (n_here/n_there)² of radiance is divided out. A lobe needs no such
                // division, because the solid angle changes by the same factor.
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
                let Some(sample) = case.sample(wo, 500.0, u) else { continue };
                let name = case.name;
                assert!((sample.wi.length() - 1.0).abs() < 1e-9, "{name} from {wo} with {u:?}: {:?}", sample.wi);
                assert!(sample.probability > 0.0 && sample.probability.is_finite(), "{name} from {wo} with {u:?}");
                for nm in [360.0, 500.0, 830.0] {
                    for mode in [TransportMode::Radiance, TransportMode::Importance] {
                        let weight = case.weight(wo, &sample, mode, nm);
                        assert!(weight.is_finite() && weight >= 0.0, "{name} from {wo} with {u:?}: weight {weight}");
                    }
                }
                let absorbed = case.absorbed_fraction(wo, &sample, 500.0);
                assert!((0.0..=1.0 + 1e-12).contains(&absorbed), "{name} from {wo} with {u:?}: absorbs {absorbed}");
            }
        }
    }
}

/// One dispersive medium suffices for refraction, and diffraction always disperses.
#[test]
fn only_dispersive_refraction_sets_disperses() {
    each_view(|case, wo, nm, seed| {
        let mut random = random(seed);
        let dispersive = case.front.is_dispersive() || case.behind.is_dispersive();
        let refracts = matches!(case.bsdf, Bsdf::Dielectric(_) | Bsdf::CoatedDielectric(_));
        for _ in 0..50 {
            let Some(sample) = case.sample(wo, nm, random()) else { continue };
            let refracted = refracts && dispersive && sample.event == ScatterEvent::Transmission;
            let expected = refracted || case.bsdf.grating().is_some();
            assert_eq!(sample.disperses, expected, "{} from {wo}", case.name);
        }
    });
}

#[test]
fn classes_follow_the_width_of_the_lobes() {
    let classes: Vec<_> = cases().iter().map(|case| (case.name, case.bsdf.class())).collect();
    let of = |name| classes.iter().find(|(other, _)| *other == name).unwrap().1;
    assert_eq!(of("absorber"), BsdfClass::Absorbing);
    assert_eq!(["mirror", "polished metal", "polished glass", "pane"].map(of), [BsdfClass::Specular; 4]);
    assert_eq!(["rough metal", "rough glass", "paint"].map(of), [BsdfClass::Glossy; 3]);
    assert_eq!(["diffuse", "translucent", "mixture"].map(of), [BsdfClass::Diffuse; 3]);
}

/// White furnace: clear media lose no light. The roughness of files, 0.05 to 1, is √α.
#[test]
fn rough_glass_returns_all_light_from_both_sides() {
    let mut random = random(21);
    for n in [1.1, 1.5, 2.4] {
        for roughness in [0.05, 0.3, 0.6, 1.0_f64] {
            let bsdf = Bsdf::dielectric(roughness * roughness).unwrap();
            let (front, behind) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(n).unwrap());
            let case = BsdfCase { name: "", bsdf, front, behind };
            for (cos, side) in [(1.0_f64, 1.0), (0.5, 1.0), (0.1, 1.0), (1.0, -1.0), (0.5, -1.0), (0.1, -1.0_f64)] {
                let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos * side);
                let weight = |u| {
                    let sample = case.sample(wo, 500.0, u);
                    sample.map_or(0.0, |sample| case.weight(wo, &sample, TransportMode::Importance, 500.0))
                };
                let weights: Vec<f64> = (0..40_000).map(|_| weight(random())).collect();
                let (albedo, error) = mean_and_error(&weights);
                let off = (albedo - 1.0).abs();
                assert!(off < 4.5 * error + 2e-3, "n {n}, roughness {roughness}, from {wo}: {albedo} ± {error}");
                assert!(error < 5e-3, "n {n}, roughness {roughness}, from {wo}: ± {error}");
            }
        }
    }
}

/// A rough metal without absorption (k → ∞) reflects all light.
#[test]
fn a_rough_perfect_metal_reflects_all_light() {
    for alpha in [0.1, 0.36, 1.0] {
        let metal = Bsdf::conductor(Spectrum::constant(0.0), Spectrum::constant(1e9), alpha).unwrap();
        let air = RefractiveIndex::constant(1.0).unwrap();
        let case = BsdfCase { name: "", bsdf: metal, front: air.clone(), behind: air };
        for cos in [1.0, 0.6, 0.15_f64] {
            let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let cells = grid::integrals(|wi| case.eval(wo, wi, TransportMode::Importance, 500.0) * wi.z.abs());
            let albedo: f64 = cells.iter().sum();
            assert!((0.998..=1.001).contains(&albedo), "alpha {alpha}, cosine {cos}: {albedo}");
        }
    }
}
