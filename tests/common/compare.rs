//! Statistical comparison of renders: values measured with independent seeds, and Welch's test with
//! Šidák's correction.

use super::{render, with_setting};
use abbe_session::render::{Integrator, Rendered};
use serde_json::Value;

/// The probability that a correct program fails any statistical test of the suite.
const SUITE_LEVEL: f64 = 0.01;

/// An upper bound of the number of comparisons in the suite.
const SUITE_COMPARISONS: f64 = 60.0;

/// Values measured in several renders that differ only in their seeds.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    runs: Vec<Vec<f64>>,
}

impl Measured {
    /// Renders the scene once per seed and takes values from each render.
    pub(crate) fn new(
        scene: &Value,
        (integrator, passes): (Integrator, u64),
        seeds: std::ops::Range<u64>,
        take: impl Fn(&Rendered) -> Vec<f64>,
    ) -> Self {
        let run = |seed: u64| take(&render(&super::with_setting(scene, "seed", seed), integrator, passes));
        Self { runs: seeds.map(run).collect() }
    }

    /// Wraps values that were measured already, one list per run.
    pub(crate) fn from_runs(runs: Vec<Vec<f64>>) -> Self {
        Self { runs }
    }

    /// Computes another quantity from several, within each run.
    pub(crate) fn combine(parts: &[&Self], combine: impl Fn(&[f64]) -> f64) -> Self {
        let runs = (0..parts[0].runs.len()).map(|run| {
            let count = parts[0].runs[run].len();
            (0..count).map(|i| combine(&parts.iter().map(|part| part.runs[run][i]).collect::<Vec<_>>())).collect()
        });
        Self { runs: runs.collect() }
    }

    /// Measures a scene by photon mapping with 8 seeds, extrapolated to kernels of radius 0 from
    /// the radii `radius` and half of it. The wider kernels have a small weight in the result and
    /// more photons each, so they get a quarter of the scene's photons. The number of photons does
    /// not change the bias.
    pub(crate) fn extrapolated_photons(
        scene: &Value,
        radius: f64,
        passes: u64,
        take: impl Fn(&Rendered) -> Vec<f64>,
    ) -> Self {
        let photons = scene["render"]["photons"].as_u64().expect("the scene states its photons");
        let [whole, half] = [(radius, photons / 4), (0.5 * radius, photons)].map(|(radius, photons)| {
            let scene = with_setting(&with_setting(scene, "radius", radius), "photons", photons);
            Self::new(&scene, (Integrator::Photon, passes), 0..8, &take)
        });
        Self::extrapolated(&whole, &half)
    }

    /// Extrapolates to radius 0 from renders with radius r and r/2: (4·L_{r/2} − L_r)/3 removes a
    /// bias that is proportional to r².
    pub(crate) fn extrapolated(whole: &Self, half: &Self) -> Self {
        Self::combine(&[half, whole], |l| (4.0 * l[0] - l[1]) / 3.0)
    }

    /// Returns the number of values per run.
    pub(crate) fn count(&self) -> usize {
        self.runs[0].len()
    }

    /// Returns the mean over the runs of one value.
    pub(crate) fn mean(&self, i: usize) -> f64 {
        self.runs.iter().map(|run| run[i]).sum::<f64>() / self.runs.len() as f64
    }

    /// Returns the standard error of that mean.
    pub(crate) fn error(&self, i: usize) -> f64 {
        let (n, mean) = (self.runs.len() as f64, self.mean(i));
        (self.runs.iter().map(|run| (run[i] - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt()
    }

    /// Returns the mean over all values.
    pub(crate) fn overall(&self) -> f64 {
        (0..self.count()).map(|i| self.mean(i)).sum::<f64>() / self.count() as f64
    }

    /// Returns the mean standard error of a value, relative to the mean over all values.
    pub(crate) fn relative_error(&self) -> f64 {
        let mean_error = (0..self.count()).map(|i| self.error(i)).sum::<f64>() / self.count() as f64;
        mean_error / self.overall()
    }

    fn degrees(&self) -> f64 {
        self.runs.len() as f64 - 1.0
    }
}

/// The result of comparing two lists of values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Comparison {
    /// The probability that equal pictures differ by so much in any value, with Šidák's correction
    /// for the number of values.
    pub(crate) p: f64,
    /// The largest |t|.
    pub(crate) largest: f64,
    /// √mean t²; about 1 for equal pictures.
    pub(crate) rms: f64,
    /// The number of compared values.
    pub(crate) count: usize,
    /// The ratio of the means over all values.
    pub(crate) ratio: f64,
}

impl Comparison {
    /// Makes a comparison from each value's t and its degrees of freedom, and the ratio of the
    /// means.
    fn of(tests: impl Iterator<Item = (f64, f64)>, ratio: f64) -> Self {
        let (mut least_p, mut largest, mut squares, mut count) = (1.0_f64, 0.0_f64, 0.0, 0);
        for (t, degrees) in tests {
            least_p = least_p.min(two_sided(t, degrees));
            largest = largest.max(t.abs());
            squares += t * t;
            count += 1;
        }
        let p = -((count as f64) * (-least_p).ln_1p()).exp_m1();
        Self { p, largest, rms: (squares / count as f64).sqrt(), count, ratio }
    }

    /// Tells whether the two lists are equal within their noise.
    pub(crate) fn is_equal(&self) -> bool {
        let level = 1.0 - (1.0 - SUITE_LEVEL).powf(1.0 / SUITE_COMPARISONS);
        self.p >= level
    }
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { p, largest, rms, count, ratio } = self;
        write!(f, "p = {p:.2e}, largest |t| {largest:.2} of {count}, rms {rms:.2}, ratio of means {ratio:.5}")
    }
}

/// Compares value by value with Welch's t. Standard errors below 0.05 % of the overall mean are
/// raised to that, so that a value whose spread is small by chance does not decide.
pub(crate) fn compare(a: &Measured, b: &Measured) -> Comparison {
    const FLOOR: f64 = 5e-4;
    assert_eq!(a.count(), b.count());
    let floor = FLOOR * 0.5 * (a.overall() + b.overall()).abs();
    let welch = |i: usize| {
        let [va, vb] = [a.error(i).max(floor).powi(2), b.error(i).max(floor).powi(2)];
        let t = (a.mean(i) - b.mean(i)) / (va + vb).sqrt();
        (t, (va + vb).powi(2) / (va * va / a.degrees() + vb * vb / b.degrees()))
    };
    Comparison::of((0..a.count()).map(welch), a.overall() / b.overall())
}

/// Compares two pictures that should be equal and prints the result. Checks that their standard
/// errors relative to the mean are below `noise`, and that the pictures are equal.
#[track_caller]
pub(crate) fn assert_same(name: &str, a: &Measured, b: &Measured, noise: f64) {
    let found = compare(a, b);
    let [of_a, of_b] = [a, b].map(Measured::relative_error);
    println!("{name}: {found}; standard errors {of_a:.4}, {of_b:.4}");
    assert!(of_a < noise && of_b < noise, "too noisy to tell");
    assert!(found.is_equal(), "{found}");
}

/// Compares two pictures of which one has a fault, and prints the result. Checks that they differ.
#[track_caller]
pub(crate) fn assert_differs(name: &str, a: &Measured, b: &Measured) {
    let found = compare(a, b);
    println!("{name}: {found}");
    assert!(!found.is_equal());
}

/// Compares measured values with known ones.
pub(crate) fn compare_with(a: &Measured, truth: &[f64]) -> Comparison {
    let exact = Measured { runs: vec![truth.to_vec(), truth.to_vec()] };
    let student = |(i, truth): (usize, &f64)| {
        let t = (a.mean(i) - truth) / a.error(i).max(1e-12 * truth.abs()).max(f64::MIN_POSITIVE);
        (t, a.degrees())
    };
    Comparison::of(truth.iter().enumerate().map(student), a.overall() / exact.overall())
}

/// Returns the probability of |t| or more under Student's distribution: I_{ν/(ν+t²)}(ν/2, 1/2). The
/// integral is evaluated in the angle φ with t = √ν tan φ, where the density is cos^{ν−1} φ.
pub(crate) fn two_sided(t: f64, degrees: f64) -> f64 {
    let from = (t.abs() / degrees.sqrt()).atan();
    let integral = |from: f64| {
        const STEPS: usize = 4000;
        let step = (std::f64::consts::FRAC_PI_2 - from) / STEPS as f64;
        (0..STEPS).map(|i| (from + (i as f64 + 0.5) * step).cos().powf(degrees - 1.0) * step).sum::<f64>()
    };
    (integral(from) / integral(0.0)).min(1.0)
}

#[test]
fn the_tails_of_students_distribution_are_those_of_the_tables() {
    // Two-sided 5 % and 0.1 % points of standard tables: ν = 5 → 2.5706, 6.8688; ν = 20 → 2.0860,
    // 3.8495.
    for (degrees, t, p) in [(5.0, 2.5706, 0.05), (5.0, 6.8688, 0.001), (20.0, 2.0860, 0.05), (20.0, 3.8495, 0.001)] {
        assert!((two_sided(t, degrees) / p - 1.0).abs() < 1e-3);
    }
}
