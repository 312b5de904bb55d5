//! The contract test of all phase functions: the pdf integrates to 1, and the samples follow it.

use super::*;
use abbe_spectra::math::random::{ONE_MINUS_ULP, Purpose, Seed, Stream};
use abbe_spectra::spectrum::Outside;
use abbe_spectra::spectrum::Spectrum;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// In nm: the ends of the band, and two wavelengths between them.
const PHASE_TEST_NM: [f64; 4] = [360.0, 475.0, 550.0, 830.0];

/// A phase function, the tolerance of its integral, and the kinks of its pdf as 1 − cos θ.
struct PhaseCase {
    name: String,
    phase: PhaseFunction,
    tolerance: f64,
    kinks: Vec<f64>,
}

fn of_mean_cosine(g: f64) -> PhaseFunction {
    PhaseFunction::HenyeyGreenstein { g: Spectrum::constant(g) }
}

/// The angles of [`uneven_table`] in degrees, dense near the forward peak.
fn uneven_angles() -> Vec<f64> {
    (0..=90).map(|i| f64::from(i * i) / 45.0).collect()
}

fn uneven_table() -> PhaseFunction {
    let angles = uneven_angles();
    let lobe = |k: f64| angles.iter().map(|a: &f64| (k * a.to_radians().cos()).exp() + 0.02 * (a % 7.0)).collect();
    let mut columns: Vec<Vec<f64>> = [0.5, 3.0, 20.0].map(lobe).to_vec();
    // A range of angles without scattering.
    columns[1][20..40].fill(0.0);
    PhaseFunction::Table(Arc::new(PhaseTable::new(&angles, &[400.0, 500.0, 600.0], &columns).unwrap()))
}

fn cases() -> Vec<PhaseCase> {
    let analytic = |name: String, phase| PhaseCase { name, phase, tolerance: 1e-9, kinks: Vec::new() };
    let peaks = [-0.999, -0.4, -1e-4, 0.0, 1e-12, 0.3, 0.76, 0.9, 0.999]
        .map(|g| analytic(format!("Henyey & Greenstein {g}"), of_mean_cosine(g)));
    let ramp = Spectrum::table(&[360.0, 830.0], &[0.1, 0.9], Outside::Hold).unwrap();
    let kinks = uneven_angles().iter().map(|degrees| 1.0 - degrees.to_radians().cos()).collect();
    let mut cases = vec![
        analytic("isotropic".into(), PhaseFunction::Isotropic),
        analytic("Rayleigh".into(), PhaseFunction::Rayleigh),
        analytic("Henyey & Greenstein, coloured".into(), PhaseFunction::HenyeyGreenstein { g: ramp }),
        PhaseCase { name: "table".into(), phase: uneven_table(), tolerance: 1e-6, kinks },
    ];
    cases.extend(peaks);
    cases
}

/// Integrates f(cos θ)·p dω over the sphere by five-point Gauss quadrature in steps that are small
/// near the poles and end at every kink.
fn integral(case: &PhaseCase, nm: f64, f: impl Fn(f64) -> f64) -> f64 {
    const GAUSS_5: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    // 1 − |cos θ| from 2⁻⁴⁰ to 1 in steps of 1/32 octave.
    let near_a_pole = (-1280..=0).map(|i| 2.0_f64.powf(f64::from(i) / 32.0));
    let mut edges: Vec<f64> = near_a_pole.flat_map(|h| [h, 2.0 - h]).chain([0.0, 2.0]).collect();
    edges.extend(&case.kinks);
    edges.sort_by(f64::total_cmp);
    let step = |pair: &[f64]| -> f64 {
        let half = 0.5 * (pair[1] - pair[0]);
        let at = |x: f64| 1.0 - (pair[0] + half + half * x);
        GAUSS_5
            .iter()
            .map(|&(x, weight)| TAU * half * weight * f(at(x)) * case.phase.eval(Deflection::horizontal(at(x)), nm))
            .sum()
    };
    edges.windows(2).map(step).sum()
}

#[test]
fn the_pdf_integrates_to_one_and_has_its_mean_cosine() {
    for case in cases() {
        for nm in PHASE_TEST_NM {
            let (name, expected) = (&case.name, case.phase.mean_cosine(nm).unwrap());
            let whole = integral(&case, nm, |_| 1.0);
            assert!((whole - 1.0).abs() < case.tolerance, "{name} at {nm} nm: {whole}");
            let mean = integral(&case, nm, |cos| cos);
            assert!((mean - expected).abs() < case.tolerance, "{name} at {nm} nm: {mean}, stated {expected}");
        }
    }
}

/// Returns the number of standard deviations by which χ², over cells of equal expected counts,
/// exceeds its mean (Wilson & Hilferty 1931).
fn chi_square_deviations(counts: &[u32]) -> f64 {
    let degrees = counts.len() as f64 - 1.0;
    let expected = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
    let sum: f64 = counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
    let spread = 2.0 / (9.0 * degrees);
    ((sum / degrees).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Returns the values of 1 − cos θ between intervals of equal probability of the pdf.
fn equal_mass_edges(phase: &PhaseFunction, nm: f64, bins: usize) -> Vec<f64> {
    // The steps are small near both poles, where the peaks are.
    let steps = 400_000;
    let height = |step: usize| {
        let t = step as f64 / steps as f64;
        let fine = |t: f64| t.powi(6);
        if t < 0.5 { fine(2.0 * t) } else { 2.0 - fine(2.0 - 2.0 * t) }
    };
    let mut edges = Vec::new();
    let mut sum = 0.0;
    for step in 0..steps {
        let (from, to) = (height(step), height(step + 1));
        let mass = TAU * (to - from) * phase.eval(Deflection::horizontal(1.0 - 0.5 * (from + to)), nm);
        while edges.len() + 1 < bins && (edges.len() + 1) as f64 / bins as f64 <= sum + mass {
            let wanted = (edges.len() + 1) as f64 / bins as f64;
            edges.push(from + (wanted - sum) / mass * (to - from));
        }
        sum += mass;
    }
    edges
}

/// Counts samples in 24 equally probable intervals of the angle times four azimuths.
fn drawn(phase: &PhaseFunction, expected_of: &PhaseFunction, nm: f64, number: u64) -> Vec<u32> {
    let bins = 24;
    let edges = equal_mass_edges(expected_of, nm, bins);
    let incoming = DVec3::new(0.36, -0.48, 0.8);
    let (across, up) = incoming.any_orthonormal_pair();
    let mut stream = Stream::new(Seed::new(5), Purpose::SurveyPhoton, 1, number);
    let mut counts = vec![0; 4 * bins];
    for _ in 0..60_000 {
        let out = phase.sample(incoming, nm, stream.pair());
        assert!((out.length() - 1.0).abs() < 1e-12);
        // Near the forward pole, 1 − cos θ is accurate from the difference of the unit vectors, and
        // near the backward pole from their sum.
        let height = if out.dot(incoming) > 0.0 {
            0.5 * (out - incoming).length_squared()
        } else {
            2.0 - 0.5 * (out + incoming).length_squared()
        };
        let bin = edges.partition_point(|&edge| edge <= height);
        let quarter = 2 * usize::from(out.dot(across) > 0.0) + usize::from(out.dot(up) > 0.0);
        counts[4 * bin + quarter] += 1;
    }
    counts
}

#[test]
fn samples_follow_the_pdf() {
    let mut number = 0;
    for PhaseCase { name, phase, .. } in cases() {
        for nm in PHASE_TEST_NM {
            number += 1;
            let deviations = chi_square_deviations(&drawn(&phase, &phase, nm, number));
            assert!(deviations < 4.5, "{name} at {nm} nm: χ² is {deviations} deviations too large");
        }
    }
}

#[test]
fn the_chi_square_test_rejects_a_slightly_different_peak() {
    let deviations = chi_square_deviations(&drawn(&of_mean_cosine(0.77), &of_mean_cosine(0.76), 500.0, 0));
    assert!(deviations > 4.5, "{deviations}");
}

#[test]
fn rayleigh_has_its_closed_form() {
    for cos in [-1.0, -0.3, 0.0, 0.5, 1.0_f64] {
        assert_eq!(
            PhaseFunction::Rayleigh.eval(Deflection::horizontal(cos), 500.0),
            3.0 / (16.0 * PI) * (1.0 + cos * cos)
        );
    }
}

#[test]
fn narrowest_peaks_and_extreme_random_numbers_stay_finite() {
    let narrow = [MAX_MEAN_COSINE, -MAX_MEAN_COSINE].map(of_mean_cosine);
    for phase in cases().into_iter().map(|case| case.phase).chain(narrow) {
        for nm in PHASE_TEST_NM {
            for cos in [-1.0, -0.5, 0.0, 1.0] {
                let pdf = phase.eval(Deflection::horizontal(cos), nm);
                assert!(pdf.is_finite() && pdf >= 0.0, "{phase:?} at {cos}: {pdf}");
            }
            for u in [0.0, 1e-17, 0.5, ONE_MINUS_ULP] {
                let out = phase.sample(DVec3::NEG_Z, nm, [u, 0.25]);
                assert!((out.length() - 1.0).abs() < 1e-12, "{phase:?} at {u}: {out}");
            }
        }
    }
    // The pdf has the peak (1 + g)/(4π(1 − g)²), and 1 − cos θ the median (1 − g)²(1 + g/2).
    let g = MAX_MEAN_COSINE;
    let peak = (1.0 + g) / (4.0 * PI * (1.0 - g) * (1.0 - g));
    assert!((of_mean_cosine(g).eval(Deflection::horizontal(1.0), 500.0) / peak - 1.0).abs() < 1e-9);
    let median = of_mean_cosine(g).sample(DVec3::Z, 500.0, [0.5, 0.0]);
    assert!((0.5 * (median - DVec3::Z).length_squared() / ((1.0 - g).powi(2) * (1.0 + 0.5 * g)) - 1.0).abs() < 1e-4);
}
