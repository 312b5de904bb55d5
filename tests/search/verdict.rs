//! Compares the photon integrator with the path tracer on one scene, and checks the energy balance.

use crate::common::compare::two_sided;
use abbe_session::render::{Integrator, Job, Monitor, Progress, Rendered, Request, Run, StopRules};
use abbe_spectra::math::random::{Seed, hash64};

/// Renders per integrator. They differ in their seeds.
const RUNS: u64 = 4;

/// Independent groups of passes in a render.
const REPLICATES: usize = 8;

/// The block means of X, Y and Z, then the means of the whole picture.
type Values = Vec<f64>;

/// What the renders of one integrator measured.
struct Measured {
    /// The values of each replicate.
    replicates: Vec<Values>,
    /// The stated bias of each value.
    bias: Values,
    /// Emitted, closed-form and sampling power of each run in W, and the relative imbalance.
    ledger: Vec<[f64; 4]>,
}

/// Collects the sums of the passes.
#[derive(Default)]
struct Snapshots(Vec<Vec<[f64; 3]>>);

impl Monitor for Snapshots {
    fn after_pass(&mut self, _: &Progress) -> bool {
        true
    }

    fn checkpoint(&mut self, run: &mut Run) {
        self.0.push(run.picture().xyz);
    }
}

fn blocks(xyz: &[[f64; 3]], width: usize) -> Values {
    let side = xyz.len() / width / 2;
    let block = |i: usize| (i / width / side) * width.div_ceil(side) + i % width / side;
    let count = 2 * width.div_ceil(side);
    let mut sums = vec![0.0; 3 * (count + 1)];
    for (i, pixel) in xyz.iter().enumerate() {
        for c in 0..3 {
            sums[3 * block(i) + c] += pixel[c] / (side * side) as f64;
            sums[3 * count + c] += pixel[c] / xyz.len() as f64;
        }
    }
    sums
}

/// Returns the means of the replicates from the cumulative means after each pass.
fn replicates(cumulative: &[Vec<[f64; 3]>], width: usize) -> Vec<Values> {
    let mut means: Vec<(Values, f64)> = Vec::new();
    let mut before: Values = Vec::new();
    for (i, picture) in cumulative.iter().enumerate() {
        let total: Values = blocks(picture, width).iter().map(|value| value * (i + 1) as f64).collect();
        before.resize(total.len(), 0.0);
        let of_pass = total.iter().zip(&before).map(|(now, before)| now - before);
        if i < REPLICATES {
            means.push((of_pass.collect(), 1.0));
        } else {
            let (sum, count) = &mut means[i % REPLICATES];
            sum.iter_mut().zip(of_pass).for_each(|(sum, value)| *sum += value);
            *count += 1.0;
        }
        before = total;
    }
    means.into_iter().map(|(sum, count)| sum.into_iter().map(|value| value / count).collect()).collect()
}

/// Returns the stated bias of Y in each block. At edges of the illumination, the true bias is up to
/// twice the stated bias.
fn stated_bias(rendered: &Rendered) -> Values {
    let picture = &rendered.picture;
    let pixel = |i: usize| {
        let factor = if picture.edge[i] == Some(true) { 2.0 } else { 1.0 };
        [factor * f64::from(picture.bias[i].unwrap_or(0.0)); 3]
    };
    blocks(&(0..picture.xyz.len()).map(pixel).collect::<Vec<_>>(), picture.width)
}

fn measure(job: &mut Job, integrator: Integrator, passes: u64, stage: u64) -> Measured {
    let mut measured = Measured { replicates: Vec::new(), bias: Vec::new(), ledger: Vec::new() };
    for run in 0..RUNS {
        // The tables of the materials are kept from render to render.
        let words = [job.scene.settings.seed.unwrap_or(0), integrator as u64, stage, run];
        job.budget.seed = Seed::new(hash64(words));
        let request = Request { integrator, stop: StopRules { passes: Some(passes), ..StopRules::default() } };
        let mut snapshots = Snapshots::default();
        let rendered = job.render(request, &mut snapshots).expect("the scene renders");
        assert_eq!(rendered.stats.rejected_samples, 0, "contributions that are not finite");
        snapshots.0.push(rendered.picture.xyz.clone());
        measured.replicates.extend(replicates(&snapshots.0, rendered.picture.width));
        let bias = stated_bias(&rendered);
        measured.bias.resize(bias.len(), 0.0);
        measured.bias.iter_mut().zip(bias).for_each(|(sum, bias)| *sum += bias / RUNS as f64);
        let ledger = &rendered.stats.ledger_w;
        measured.ledger.push([ledger.emitted, ledger.lights, ledger.sampling, ledger.balance]);
    }
    measured
}

impl Measured {
    fn mean(&self, i: usize) -> f64 {
        self.replicates.iter().map(|values| values[i]).sum::<f64>() / self.replicates.len() as f64
    }

    /// Returns the squared standard error of a mean.
    fn variance(&self, i: usize) -> f64 {
        let (n, mean) = (self.replicates.len() as f64, self.mean(i));
        self.replicates.iter().map(|values| (values[i] - mean).powi(2)).sum::<f64>() / (n - 1.0) / n
    }
}

/// The result of a comparison.
#[derive(Debug, Clone)]
pub(crate) struct Comparison {
    /// The probability that equal pictures differ so much, corrected for the number of values.
    pub(crate) p: f64,
    /// The value with the least probability.
    worst: Difference,
    /// Photons divided by paths, for the mean Y of the picture.
    ratio: f64,
    /// Half the width of the 95 % interval of the difference of the means, relative to the mean.
    pub(crate) half_width: f64,
    /// The stated bias of the mean, relative to the mean.
    bias: f64,
    /// The largest relative imbalance of a ledger.
    pub(crate) imbalance: f64,
    /// The mean emitted power relative to the closed form, minus 1, and its standard error.
    emitted: (f64, f64),
    /// The mean sampling power relative to the emitted power, and its standard error.
    sampling: (f64, f64),
    /// The probability that a correct ledger differs so much from its expected values.
    pub(crate) ledger_p: f64,
}

/// A value in both pictures.
#[derive(Debug, Clone, Copy, Default)]
struct Difference {
    /// The number of the value: three values per block, then three of the whole picture.
    number: usize,
    photon: f64,
    path: f64,
    /// The sum of the stated biases.
    bias: f64,
    /// The standard error of the difference.
    error: f64,
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { p, worst, ratio, half_width, bias, ledger_p, emitted, sampling, .. } = self;
        let Difference { number, photon, path, bias: worst_bias, error } = worst;
        write!(f, "photon/path {ratio:.4}, interval ± {half_width:.3} with bias {bias:.3}, p = {p:.1e}; ")?;
        write!(
            f,
            "value {number}: {photon:.4e}, {path:.4e}, bias {worst_bias:.1e}, error {error:.1e}; ledger p = {ledger_p:.1e}: "
        )?;
        write!(f, "emitted {:.4} ± {:.4}, sampling {:.4} ± {:.4}", emitted.0, emitted.1, sampling.0, sampling.1)
    }
}

/// Returns the probability that both means of a ledger differ from 0 so much. Standard errors are
/// at least 0.03 %, because rounding is not noise.
fn ledger_p(means: [(f64, f64); 2]) -> f64 {
    let p = means.map(|(mean, error)| two_sided(mean / error.max(3e-4), (RUNS - 1) as f64));
    (2.0 * p[0].min(p[1])).min(1.0)
}

fn mean_and_error(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt())
}

/// Compares both integrators.
pub(crate) fn compare(job: &mut Job, [photon_passes, path_passes]: [u64; 2], stage: u64) -> Comparison {
    const FLOOR: f64 = 5e-4;
    let photon = measure(job, Integrator::Photon, photon_passes, stage);
    let path = measure(job, Integrator::Path, path_passes, stage);
    let count = photon.bias.len();
    let bias = |i: usize| {
        let y = i - i % 3 + 1;
        let relative = |measured: &Measured| {
            let mean = measured.mean(y);
            if mean > 0.0 { measured.bias[y] / mean * measured.mean(i) } else { 0.0 }
        };
        relative(&photon) + relative(&path)
    };
    let mut least = (1.0, Difference::default());
    for i in 0..count {
        let floor = FLOOR * 0.5 * (photon.mean(count - 3 + i % 3) + path.mean(count - 3 + i % 3));
        let [va, vb] = [&photon, &path].map(|measured| measured.variance(i).max(floor * floor));
        let error = (va + vb).sqrt();
        let t = ((photon.mean(i) - path.mean(i)).abs() - bias(i)).max(0.0) / error;
        let degrees = (photon.replicates.len() - 1) as f64;
        let p = two_sided(t, (va + vb).powi(2) / ((va * va + vb * vb) / degrees));
        if p < least.0 {
            least = (p, Difference { number: i, photon: photon.mean(i), path: path.mean(i), bias: bias(i), error });
        }
    }
    let y = count - 2;
    let mean = 0.5 * (photon.mean(y) + path.mean(y));
    let ledger = &photon.ledger;
    let emitted = mean_and_error(ledger.iter().map(|row| row[0] / row[1] - 1.0));
    let sampling = mean_and_error(ledger.iter().map(|row| row[2] / row[0]));
    Comparison {
        p: -((count as f64) * (-least.0).ln_1p()).exp_m1(),
        worst: least.1,
        ratio: photon.mean(y) / path.mean(y),
        half_width: (2.04 * (photon.variance(y) + path.variance(y)).sqrt() + bias(y)) / mean,
        bias: bias(y) / mean,
        imbalance: ledger.iter().fold(0.0, |largest, row| row[3].abs().max(largest)),
        emitted,
        sampling,
        ledger_p: ledger_p([emitted, sampling]),
    }
}
