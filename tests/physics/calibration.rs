//! Calibration of the error bars and of the forecasts on four example scenes, with small films and
//! few photons. The measured figures are in `docs/validation`.

use crate::common;
use abbe_session::render::{Forecast, Integrator, Monitor, Progress, Rendered, Request, Run, StopRules};
use abbe_transport::sensor::Picture;
use serde_json::Value;

/// One example scene on a small film, and its reference.
struct Measure {
    name: &'static str,
    film: [u64; 2],
    /// The integrator and the number of passes of the reference.
    reference: (Integrator, u64),
}

/// The number of independent short renders per scene.
const RENDERS: u64 = 200;

const PRISM: Measure = Measure { name: "prism", film: [64, 36], reference: (Integrator::Photon, 512) };
const GLASS_BALL: Measure = Measure { name: "glass_ball", film: [48, 48], reference: (Integrator::Photon, 512) };
/// The path tracer can find all light in this scene, so the reference has no kernel bias.
const CORNELL: Measure = Measure { name: "cornell", film: [48, 48], reference: (Integrator::Path, 4096) };
const PRISM_IN_FOG: Measure = Measure { name: "prism_in_fog", film: [64, 36], reference: (Integrator::Photon, 128) };

/// Photon paths per pass of a short render.
const PHOTONS: u64 = 10_000;

/// Photon paths per pass of a reference: its first kernels cover an eighth of the area.
const REFERENCE_PHOTONS: u64 = 8 * PHOTONS;

/// Passes of a short render.
const PASSES: u64 = 16;

/// Returns an example scene on a small film.
fn scene(&Measure { name, film: [width, height], .. }: &Measure, photons: u64) -> Value {
    let mut scene = common::example(name);
    scene["film"]["width"] = width.into();
    scene["film"]["height"] = height.into();
    common::with_setting(&scene, "photons", photons)
}

fn seeded(scene: &Value, seed: u64) -> Value {
    common::with_setting(scene, "seed", seed)
}

/// Counts how often the intervals contain the true value of their pixel, over several renders, and
/// compares the reported noise and bias with the measured ones.
struct Coverage<'a> {
    reference: &'a Picture,
    /// Pixel indices sorted by brightness, darkest first.
    order: Vec<usize>,
    /// The intervals that contain the true value, and all intervals, by quarters of `order`.
    covered: [(u64, u64); 4],
    unknown: u64,
    /// For each pixel, sums over the renders of Y minus the reference, and of its square.
    apart: Vec<[f64; 2]>,
    /// Sums over the renders of the squares of the reported noise and of the reported bias.
    reported: [f64; 2],
    /// For each pixel, the number of renders that mark it as close to an edge of light, and the sum
    /// of squares of the bias that they report.
    marked: Vec<(u64, f64)>,
    /// The sum of the relative errors that the renders report.
    relative: f64,
    renders: u64,
}

impl<'a> Coverage<'a> {
    fn new(reference: &'a Picture) -> Self {
        let mut order: Vec<usize> = (0..reference.xyz.len()).collect();
        order.sort_by(|&a, &b| reference.xyz[a][1].total_cmp(&reference.xyz[b][1]));
        Self {
            reference,
            apart: vec![[0.0; 2]; order.len()],
            order,
            covered: [(0, 0); 4],
            unknown: 0,
            reported: [0.0; 2],
            marked: vec![(0, 0.0); reference.xyz.len()],
            relative: 0.0,
            renders: 0,
        }
    }

    /// Returns the variance of a pixel of the reference.
    fn variance(&self, pixel: usize) -> f64 {
        f64::from(self.reference.noise[pixel].unwrap_or(0.0)).powi(2)
    }

    /// Counts one render. The noise of the reference widens the intervals.
    fn add(&mut self, picture: &Picture) {
        for (place, &pixel) in self.order.iter().enumerate() {
            let apart = picture.xyz[pixel][1] - self.reference.xyz[pixel][1];
            self.apart[pixel][0] += apart;
            self.apart[pixel][1] += apart * apart;
            let Some(half) = picture.half_interval_95(pixel, self.variance(pixel).sqrt()) else {
                self.unknown += 1;
                continue;
            };
            let (covered, all) = &mut self.covered[4 * place / self.order.len()];
            *covered += u64::from(apart.abs() <= half);
            *all += 1;
            self.reported[0] += f64::from(picture.noise[pixel].unwrap_or(0.0)).powi(2);
            self.reported[1] += f64::from(picture.bias[pixel].unwrap_or(0.0)).powi(2);
            self.marked[pixel].0 += u64::from(picture.edge[pixel] == Some(true));
            self.marked[pixel].1 += f64::from(picture.bias[pixel].unwrap_or(0.0)).powi(2);
        }
        self.relative += picture.error_means().relative.expect("a picture that is lit");
        self.renders += 1;
    }

    fn share(&self) -> f64 {
        let sum = |of: fn(&(u64, u64)) -> u64| self.covered.iter().map(of).sum::<u64>() as f64;
        sum(|quarter| quarter.0) / sum(|quarter| quarter.1)
    }

    /// Returns the variance of one render's pixel and the square of its bias, both measured from
    /// the spread of the renders.
    fn shown(&self, pixel: usize) -> [f64; 2] {
        let (n, [sum, squares]) = (self.renders as f64, self.apart[pixel]);
        let variance = (squares - sum * sum / n) / (n - 1.0);
        [variance, (sum / n).powi(2) - variance / n - self.variance(pixel)]
    }

    /// Returns, for the pixels that most renders mark as close to an edge and for the others: their
    /// number, and the root mean squares of the measured and of the reported bias.
    fn at_edges(&self) -> [(usize, f64, f64); 2] {
        [true, false].map(|wanted| {
            let pixels = || (0..self.marked.len()).filter(|&pixel| (2 * self.marked[pixel].0 > self.renders) == wanted);
            let (count, n) = (pixels().count(), self.renders as f64);
            let root = |sum: f64| (sum.max(0.0) / count.max(1) as f64).sqrt() / self.reference.mean_y();
            let shown = pixels().map(|pixel| self.shown(pixel)[1]).sum();
            (count, root(shown), root(pixels().map(|pixel| self.marked[pixel].1).sum::<f64>() / n))
        })
    }

    fn report(&self, name: &str) {
        let quarters = self.covered.map(|(covered, all)| format!("{:.3}", covered as f64 / all as f64));
        let n = self.renders as f64;
        let unit = self.reference.mean_y() * (self.order.len() as f64).sqrt();
        let shown = self.order.iter().map(|&pixel| self.shown(pixel));
        let shown = shown.fold([0.0; 2], |sum, [noise, bias]| [sum[0] + noise, sum[1] + bias]);
        let [noise, bias] = shown.map(|square| square.max(0.0).sqrt() / unit);
        let [beside, others] = self.at_edges();
        let [noise_reported, bias_reported] = self.reported.map(|square| (square / n).sqrt() / unit);
        println!(
            "{name}: {:.4} covered, from dark to bright {}; noise {noise:.4}, reported {noise_reported:.4}; \
             bias {bias:.4}, reported {bias_reported:.4}; beside edges (pixels, shown, reported) {beside:.4?}, elsewhere {others:.4?}; \
             mean reported error {:.4}; {:.1} pixels unknown",
            self.share(),
            quarters.join(" "),
            self.relative / n,
            self.unknown as f64 / n,
        );
    }
}

/// Compares many short renders of a scene with its converged reference.
fn intervals_cover_the_reference_in_90_to_98_percent(measure: &Measure) {
    let (integrator, passes) = measure.reference;
    let reference = seeded(&scene(measure, REFERENCE_PHOTONS), 1 << 40);
    let reference = common::render(&reference, integrator, passes).picture;
    let short = scene(measure, PHOTONS);
    let mut coverage = Coverage::new(&reference);
    for seed in 0..RENDERS {
        let Rendered { picture, .. } = common::render(&seeded(&short, seed), Integrator::Photon, PASSES);
        coverage.add(&picture);
    }
    coverage.report(measure.name);
    assert!((0.90..=0.98).contains(&coverage.share()), "{}: {}", measure.name, coverage.share());
}

#[test]
#[ignore = "200 renders and a reference: 5 minutes"]
fn intervals_cover_the_reference_of_a_prism() {
    intervals_cover_the_reference_in_90_to_98_percent(&PRISM);
}

#[test]
#[ignore = "200 renders and a reference: 5 minutes"]
fn intervals_cover_the_reference_of_a_glass_ball() {
    intervals_cover_the_reference_in_90_to_98_percent(&GLASS_BALL);
}

#[test]
#[ignore = "200 renders and a reference: 3 minutes"]
fn intervals_cover_the_reference_of_a_box_of_diffuse_walls() {
    intervals_cover_the_reference_in_90_to_98_percent(&CORNELL);
}

#[test]
#[ignore = "200 renders and a reference: 15 minutes"]
fn intervals_cover_the_reference_of_a_prism_in_fog() {
    intervals_cover_the_reference_in_90_to_98_percent(&PRISM_IN_FOG);
}

/// Records the forecast after ten passes, and the errors at each doubling of the passes.
#[derive(Default)]
struct Watching {
    foretold: Option<Forecast>,
    /// The error measured there.
    came: Option<f64>,
    doubled: Vec<f64>,
}

/// The passes of the forecast, and those that it foretells.
const FROM: u64 = 10;
const TO: u64 = 40;

impl Monitor for Watching {
    fn after_pass(&mut self, progress: &Progress) -> bool {
        if progress.passes == FROM {
            self.foretold = progress.forecast;
        }
        true
    }

    fn checkpoint(&mut self, run: &mut Run) {
        let error = || run.typical_error().expect("a picture that is lit");
        if run.passes() == TO {
            self.came = Some(error());
        }
        if run.passes() >= 8 && run.passes().is_power_of_two() {
            self.doubled.push(error());
        }
    }
}

/// The number of seeds per scene.
const SEEDS: u64 = 12;

/// The forecasts of a scene, with a different seed for each.
#[derive(Default)]
struct Forecasts {
    /// The forecast error divided by the measured error after forty passes, in ascending order.
    ratios: Vec<f64>,
    /// The number of renders whose error rises by more than 2 % while the passes double.
    rises: u64,
    /// The number of renders in which the interval of the passes to the error after forty passes
    /// contains forty, or is unknown.
    held: u64,
}

impl Forecasts {
    fn median(&self) -> f64 {
        let middle = self.ratios.len() / 2;
        0.5 * (self.ratios[middle - 1] + self.ratios[middle])
    }

    fn within_25_percent(&self) -> u64 {
        self.ratios.iter().filter(|ratio| (*ratio - 1.0).abs() <= 0.25).count() as u64
    }
}

/// Forecasts the error of an example scene on a small film with several seeds.
fn forecasts(name: &str, [width, height]: [u64; 2]) -> Forecasts {
    let ratio = |seed: u64| {
        let sets = [
            format!("film.width={width}"),
            format!("film.height={height}"),
            format!("render.photons={PHOTONS}"),
            format!("render.seed={seed}"),
        ];
        let mut watching = Watching::default();
        let stop = StopRules { passes: Some(65), ..StopRules::default() };
        let request = Request { integrator: Integrator::Photon, stop };
        let job = common::example_job(name, &sets.each_ref().map(String::as_str));
        job.render(request, &mut watching).expect("the scene renders");
        assert_eq!(watching.doubled.len(), 4, "{name}, seed {seed}: {:?}", watching.doubled);
        let falls = watching.doubled.windows(2).all(|pair| pair[1] <= 1.02 * pair[0]);
        let (forecast, came) = (watching.foretold.expect("a forecast"), watching.came.expect("an error"));
        let error = forecast.error_after_passes(TO as f64);
        let holds = || {
            let to = forecast.milestone(error)?.seconds;
            let [least, most] = forecast.milestone(came)?.seconds_interval?;
            Some(least <= to && to <= most)
        };
        (error / came, falls, holds().unwrap_or(true))
    };
    let mut forecasts = Forecasts::default();
    for (ratio, falls, holds) in (0..SEEDS).map(ratio) {
        forecasts.ratios.push(ratio);
        forecasts.rises += u64::from(!falls);
        forecasts.held += u64::from(holds);
    }
    forecasts.ratios.sort_by(f64::total_cmp);
    let (least, most) = (forecasts.ratios[0], forecasts.ratios[SEEDS as usize - 1]);
    println!(
        "{name}: foretold over true {least:.2} to {most:.2}, median {:.2}; {} of {SEEDS} within 25 %; \
         {} errors rise; {} intervals hold",
        forecasts.median(),
        forecasts.within_25_percent(),
        forecasts.rises,
        forecasts.held,
    );
    forecasts
}

/// Checks the forecasts of a scene. One render of twelve may fail by chance: after ten passes most
/// replicates hold a single pass.
fn check_forecasts(name: &str, film: [u64; 2]) {
    let found = forecasts(name, film);
    assert!(found.within_25_percent() >= SEEDS - 2 && found.rises == 0, "{name}: {:?}", found.ratios);
}

/// Checks only the median of the forecasts of a scene whose single forecasts fall short.
fn check_median_forecast(name: &str, film: [u64; 2]) -> Forecasts {
    let found = forecasts(name, film);
    assert!((found.median() - 1.0).abs() <= 0.25, "{name}: {:?}", found.ratios);
    found
}

/// Checks the intervals of the forecasts of a scene: progress must not promise a wrong time.
fn check_intervals(name: &str, film: [u64; 2]) {
    let found = forecasts(name, film);
    assert!(found.held >= SEEDS - 1, "{name}: {} intervals hold", found.held);
}

#[test]
#[ignore = "48 renders of 65 passes: 3 minutes"]
fn ten_passes_forecast_the_error_after_forty_within_25_percent() {
    for measure in [PRISM, GLASS_BALL, PRISM_IN_FOG] {
        check_forecasts(measure.name, measure.film);
    }
    assert_eq!(check_median_forecast(CORNELL.name, CORNELL.film).rises, 0);
}

/// The constants of the forecast were chosen with the scenes of the test above. These scenes were
/// not used for that. In three of them, rare bright samples change the error of a small film. In
/// the diamond, a glint is so rare that the error of most seeds rises, and the time to an error is
/// said to be unknown.
#[test]
#[ignore = "72 renders of 65 passes: 2 minutes"]
fn forecasts_hold_in_scenes_that_did_not_choose_their_constants() {
    for name in ["two_prisms", "sodium"] {
        check_forecasts(name, [48, 32]);
    }
    for name in ["moving_caustic", "rainbow", "light_shafts"] {
        check_median_forecast(name, [48, 32]);
    }
    check_intervals("diamond", [48, 32]);
}
