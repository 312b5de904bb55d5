//! The statistics of a render, for reports and file headers.

use super::forecast::{ErrorMilestone, Forecast, Forecasts, RunTimes};
use super::job::Job;
use super::request::Integrator;
use super::run::Run;
use abbe_transport::pass::{PassSums, StageSeconds};
use abbe_transport::plan::{Tally, explain};
use abbe_transport::sensor::picture::ErrorMeans;
use abbe_transport::sensor::{Picture, PictureErrors};
use abbe_transport::walk::MAX_EVENTS;
use abbe_transport::walk::ledger::Ledger;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The mean energy balance of a pass, in W.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LedgerStats {
    /// The emitted power.
    pub emitted: f64,
    /// The part of `emitted` below 360 nm, which `lamps` does not include.
    #[serde(default)]
    pub ultraviolet: f64,
    /// The power gained (positive) or lost by random decisions, such as Russian roulette.
    pub sampling: f64,
    /// The power absorbed by surfaces and bodies.
    pub absorbed: f64,
    /// The power that fluorophores absorbed and did not emit, because the emitted photons have less
    /// energy.
    #[serde(default)]
    pub stokes_loss: f64,
    /// The power of the photons that fluorophores absorbed without emitting a photon.
    #[serde(default)]
    pub quantum_loss: f64,
    /// The power that left the scene.
    pub escaped: f64,
    /// The part of `escaped` that left the scene inside a body.
    #[serde(default)]
    pub escaped_inside: f64,
    /// The power of the paths that ended at the depth limit.
    pub depth_limit: f64,
    /// The imbalance of the power, relative to the emitted power.
    pub balance: f64,
    /// The power of the lights, computed from closed forms.
    #[serde(rename = "lamps")]
    pub lights: f64,
    /// The absorbed power of each material, with the material's name as the key.
    pub by_material: BTreeMap<String, f64>,
}

/// The means of the error layers over the picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorStats {
    /// The mean standard error of Y in cd/m².
    pub noise: f64,
    /// The mean bias of Y in cd/m².
    pub bias: f64,
    /// The relative error: √mean(noise² + bias²) / mean Y. `None` means that the error is unknown.
    pub relative: Option<f64>,
    /// The error of a typical pixel: the root mean square of the relative errors of all pixels
    /// except the worst 2 %. `--target-error` refers to it. `None` means that it is unknown.
    #[serde(default)]
    pub typical: Option<f64>,
    /// The median of the pixels' relative errors, or `None` if no error is known.
    #[serde(default)]
    pub median: Option<f64>,
    /// The 95th percentile of the pixels' relative errors, or `None` if no error is known.
    #[serde(default)]
    pub p95: Option<f64>,
    /// The block of pixels that contributes most to `relative`: the first column and row, and the
    /// column and row after the last.
    #[serde(default)]
    pub worst_region: Option<[usize; 4]>,
    /// The fraction of the worst region in the sum of noise² + bias² over the picture.
    #[serde(rename = "worst_share", default)]
    pub worst_fraction: Option<f64>,
    /// The number of pixels with unknown noise, such as pixels that no light has reached.
    pub unknown_pixels: usize,
    /// The number of pixels near an edge of the illumination, whose bias is probably larger than
    /// reported.
    pub edge_pixels: usize,
}

/// The forecast of the error if the render continued.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForecastStats {
    /// The relative root mean square error after four times the time of the run.
    pub error_after_four_times: f64,
    /// When the render reaches the two largest round values of this error below the present one.
    pub milestones: Vec<ErrorMilestone>,
    /// The forecast of the error of a typical pixel.
    #[serde(default)]
    pub typical: Option<TypicalForecastStats>,
}

/// The forecast of the error of a typical pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TypicalForecastStats {
    /// The error after four times the time of the run.
    pub error_after_four_times: f64,
    /// When the render reaches the two largest round errors below the present one.
    pub milestones: Vec<ErrorMilestone>,
}

/// The state of an effect, and how often the effect occurred.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectStats {
    /// The state: `on`, `off`, `forced` or `forbidden`.
    pub state: String,
    /// The number of events.
    pub events: u64,
}

/// The statistics of a render.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Stats {
    /// The number of passes done.
    pub passes: u64,
    /// The number of photon paths.
    pub photons_emitted: u64,
    /// The number of photon paths that carry the shared wavelengths of their pass.
    pub photons_shared: u64,
    /// The number of photons stored on surfaces.
    pub photons_stored: u64,
    /// The number of camera samples, over all pixels.
    #[serde(default)]
    pub camera_samples: u64,
    /// The wall-clock time of each stage in s.
    pub seconds: StageSeconds,
    /// The number of photon paths, divided by the duration of the emission stage in s.
    pub photons_per_second: f64,
    /// The largest resident memory of the process so far, or 0 if the system does not report it.
    pub peak_memory_bytes: u64,
    /// The energy balance.
    pub ledger_w: LedgerStats,
    /// The error of the picture.
    pub error: ErrorStats,
    /// The forecast of the error, or `None` if the error is unknown.
    pub forecast: Option<ForecastStats>,
    /// The effects by name.
    pub effects: BTreeMap<String, EffectStats>,
    /// The wavelength plan: `free`, `shared` or `both`.
    pub wavelengths: String,
    /// The number of samples that were NaN, infinite or negative and were discarded: 0 unless the
    /// program has a bug.
    pub rejected_samples: u64,
    /// The number of worker threads.
    pub threads: usize,
    /// The names of lights whose spectra the shared wavelengths of no pass have sampled. Behind
    /// dispersive glass, the picture lacks their light, and its error is unknown.
    #[serde(default)]
    pub unsampled_lights: Vec<String>,
    /// The names of lights whose light the path tracer finds seldom or never behind the glass and
    /// the mirrors of the scene. The bias of the picture is then unknown.
    #[serde(default)]
    pub unfound_lights: Vec<String>,
    /// Notes on light that the picture lacks.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The notes that are warnings: light is missing, and the error is unknown.
    #[serde(default)]
    pub warnings: Vec<String>,
}

impl Stats {
    /// `unlit` names the specular objects that no pilot photon reached.
    pub(super) fn new(job: &Job, run: &Run, picture: &Picture, forecast: Option<Forecasts>, unlit: &[String]) -> Self {
        let PassSums { tally, seconds, .. } = &run.sums;
        let unsampled_lights: Vec<String> = run.coverage.missing().map(str::to_owned).collect();
        let misses_light = run.sums.film.misses_light();
        let unfound_lights: Vec<String> =
            job.hidden_lamps().filter(|_| misses_light).map(|light| light.name.clone()).collect();
        let unfound = job.note_of_missing_light(Integrator::Path).filter(|_| misses_light);
        let warnings: Vec<String> = unfound.into_iter().chain(unsampled_note(&unsampled_lights)).collect();
        Self {
            passes: run.done,
            photons_emitted: tally.photons,
            photons_shared: tally.shared_photons,
            photons_stored: tally.stored,
            camera_samples: tally.camera_samples,
            seconds: *seconds,
            photons_per_second: if seconds.emit > 0.0 { tally.photons as f64 / seconds.emit } else { 0.0 },
            peak_memory_bytes: peak_memory_bytes(),
            ledger_w: run.ledger_stats(job),
            error: ErrorStats::of(picture, unsampled_lights.is_empty() && !misses_light),
            forecast: forecast.map(|forecast| ForecastStats::of(&forecast, seconds.total)),
            effects: effect_stats(job, tally),
            wavelengths: explain::wavelengths_word(&job.plan).to_string(),
            rejected_samples: tally.rejected,
            threads: rayon::current_num_threads(),
            notes: notes(job, run, unlit).into_iter().chain(warnings.iter().cloned()).collect(),
            unsampled_lights,
            unfound_lights,
            warnings,
        }
    }

    /// Merges the statistics of several runs of one scene: sums of counts and times, the mean
    /// energy balance over all passes, and the error and the forecast of the merged picture, as if
    /// one machine had rendered all passes. `errors` are its squared errors, if known.
    pub(super) fn merged(runs: &[&Self], picture: &Picture, errors: Option<PictureErrors>) -> Self {
        let count = |of: fn(&Self) -> u64| runs.iter().map(|run| of(run)).sum::<u64>();
        let mut effects: BTreeMap<String, EffectStats> = BTreeMap::new();
        for (name, effect) in runs.iter().flat_map(|run| &run.effects) {
            let so_far = effects.get(name).map_or(0, |so_far| so_far.events);
            let EffectStats { state, events } = effect.clone();
            effects.insert(name.clone(), EffectStats { state, events: so_far + events });
        }
        let mut seconds = StageSeconds::default();
        runs.iter().for_each(|run| seconds.add(&run.seconds));
        let emitted = count(|run| run.photons_emitted);
        let passes = count(|run| run.passes);
        let times = RunTimes::of(passes, &seconds);
        let unsampled_lights = common_unsampled_lights(runs);
        let unfound_lights = runs.first().map_or_else(Vec::new, |run| run.unfound_lights.clone());
        let notes: Vec<String> = merged_notes(runs).into_iter().chain(unsampled_note(&unsampled_lights)).collect();
        let warned = |note: &&String| runs.iter().any(|run| run.warnings.contains(note));
        let warnings = notes.iter().filter(warned).cloned().collect();
        let errors = errors.filter(|_| unsampled_lights.is_empty());
        let forecast = errors.and_then(|errors| Forecasts::without_history(errors, times));
        Self {
            passes,
            photons_emitted: emitted,
            photons_shared: count(|run| run.photons_shared),
            photons_stored: count(|run| run.photons_stored),
            camera_samples: count(|run| run.camera_samples),
            seconds,
            photons_per_second: if seconds.emit > 0.0 { emitted as f64 / seconds.emit } else { 0.0 },
            peak_memory_bytes: runs.iter().map(|run| run.peak_memory_bytes).max().unwrap_or(0),
            ledger_w: LedgerStats::mean(runs),
            error: ErrorStats::of(picture, unsampled_lights.is_empty() && unfound_lights.is_empty()),
            forecast: forecast.map(|forecast| ForecastStats::of(&forecast, seconds.total)),
            effects,
            wavelengths: runs.first().map_or(String::new(), |run| run.wavelengths.clone()),
            rejected_samples: count(|run| run.rejected_samples),
            threads: runs.iter().map(|run| run.threads).max().unwrap_or(0),
            notes,
            unsampled_lights,
            unfound_lights,
            warnings,
        }
    }
}

impl Run {
    /// Returns the mean energy balance of the passes so far.
    pub fn ledger_stats(&self, job: &Job) -> LedgerStats {
        let mut ledger = self.sums.ledger.clone();
        ledger.scale(1.0 / self.done.max(1) as f64);
        ledger_stats(job, &ledger)
    }

    pub fn effect_stats(&self, job: &Job) -> BTreeMap<String, EffectStats> {
        effect_stats(job, &self.sums.tally)
    }

    /// Returns the wall-clock time of each stage so far in s.
    pub fn stage_seconds(&self) -> StageSeconds {
        self.sums.seconds
    }

    /// Returns the wall-clock time of the passes so far in s.
    pub fn seconds(&self) -> f64 {
        self.sums.seconds.total
    }
}

/// If only one in so many wavelengths suits a spectrum of the lights, a note names it. A pass has
/// four wavelengths, so four passes may lack its light.
const MANY_WAVELENGTHS: f64 = 16.0;

/// Returns the names of objects or lights for a note.
fn named(all: &[String]) -> String {
    /// The largest number of names in a note.
    const MAX_NAMES: usize = 5;
    let names: Vec<String> = all.iter().take(MAX_NAMES).map(|name| format!("\"{name}\"")).collect();
    let more = all.len().saturating_sub(MAX_NAMES);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", names.join(", "))
}

/// Returns notes on missing light without numbers, so that all parts of a picture have the same.
fn notes(job: &Job, run: &Run, unlit: &[String]) -> Vec<String> {
    let PassSums { ledger, tally, .. } = &run.sums;
    let limited = job.scene.settings.max_depth.map(|depth| {
        format!(
            "paths end after {depth} surface events (render.max_depth); the light beyond is not in the picture, but it \
             is in the bias bars, and ledger_w.depth_limit states its power"
        )
    });
    let capped = job.scene.settings.max_depth.is_none() && (ledger.depth_limit > 0.0 || tally.capped_paths > 0);
    let capped = capped.then(|| {
        format!(
            "some paths end at the cap of {MAX_EVENTS} events, because the scene absorbs almost no light; ledger_w.depth_limit \
             states their power, and the bias bars estimate the missing light of photons"
        )
    });
    let unlit = (!unlit.is_empty())
        .then(|| format!("no pilot photon reached {}; light that they focus may be missing", named(unlit)));
    let open = (ledger.escaped_inside > 0.0).then(|| {
        "some light left the scene inside a body: a body is open, or paths hit an edge exactly; \
         ledger_w.escaped_inside states the power"
            .to_string()
    });
    let wavelengths = job.wavelengths_per_useful_one();
    let rare = (wavelengths >= MANY_WAVELENGTHS).then(|| {
        format!(
            "the lights have very different spectra: behind dispersive glass, a camera path has one wavelength, and about \
             one in {wavelengths:.0} suits the spectrum that is sampled least; a short render may lack its light"
        )
    });
    let small = run.largest_work.is_some();
    let small = small.then(|| "passes are smaller than without a time limit, so that eight fit into it".to_owned());
    limited.into_iter().chain(capped).chain(open).chain(unlit).chain(rare).chain(small).collect()
}

/// Names lights whose spectra no pass has sampled, if there are any.
fn unsampled_note(lights: &[String]) -> Option<String> {
    (!lights.is_empty()).then(|| {
        format!(
            "no pass has sampled the spectrum of {}: light of such a spectrum is missing behind dispersive glass, and the \
             error of the picture is unknown; more passes show it",
            named(lights)
        )
    })
}

/// Returns the lights whose spectra no pass of any run has sampled.
fn common_unsampled_lights(runs: &[&Stats]) -> Vec<String> {
    let Some((first, others)) = runs.split_first() else { return Vec::new() };
    let is_common = |name: &&String| others.iter().all(|run| run.unsampled_lights.contains(name));
    first.unsampled_lights.iter().filter(is_common).cloned().collect()
}

/// Returns all different notes of several runs, without the notes on unsampled spectra.
fn merged_notes(runs: &[&Stats]) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    for run in runs {
        let unsampled = unsampled_note(&run.unsampled_lights);
        for note in run.notes.iter().filter(|note| Some(*note) != unsampled.as_ref()) {
            if !notes.contains(note) {
                notes.push(note.clone());
            }
        }
    }
    notes
}

impl LedgerStats {
    /// Returns the mean energy balance over the passes of all runs.
    fn mean(runs: &[&Stats]) -> Self {
        let passes: u64 = runs.iter().map(|run| run.passes).sum();
        let mean = |of: &dyn Fn(&Self) -> f64| {
            runs.iter().map(|run| of(&run.ledger_w) * run.passes as f64).sum::<f64>() / passes.max(1) as f64
        };
        let names = runs.first().map_or(Vec::new(), |run| run.ledger_w.by_material.keys().cloned().collect());
        let by_material = names
            .into_iter()
            .map(|name| (name.clone(), mean(&|ledger| ledger.by_material.get(&name).copied().unwrap_or(0.0))));
        Self {
            emitted: mean(&|ledger| ledger.emitted),
            ultraviolet: mean(&|ledger| ledger.ultraviolet),
            sampling: mean(&|ledger| ledger.sampling),
            absorbed: mean(&|ledger| ledger.absorbed),
            stokes_loss: mean(&|ledger| ledger.stokes_loss),
            quantum_loss: mean(&|ledger| ledger.quantum_loss),
            escaped: mean(&|ledger| ledger.escaped),
            escaped_inside: mean(&|ledger| ledger.escaped_inside),
            depth_limit: mean(&|ledger| ledger.depth_limit),
            // Relative to the emitted power, which is the same in all runs apart from noise.
            balance: mean(&|ledger| ledger.balance),
            lights: mean(&|ledger| ledger.lights),
            by_material: by_material.collect(),
        }
    }
}

impl ErrorStats {
    /// Returns the error of a picture. If it lacks light, the error is not `known`.
    fn of(picture: &Picture, known: bool) -> Self {
        let ErrorMeans { noise, bias, relative, unknown_pixels, edge_pixels } = picture.error_means();
        let distribution = picture.error_distribution();
        Self {
            noise,
            bias,
            relative: relative.filter(|_| known),
            typical: distribution.map(|errors| errors.typical).filter(|_| known),
            median: distribution.map(|errors| errors.median),
            p95: distribution.map(|errors| errors.p95),
            worst_region: distribution.map(|errors| errors.worst.corners),
            worst_fraction: distribution.map(|errors| errors.worst.fraction),
            unknown_pixels,
            edge_pixels,
        }
    }
}

impl ForecastStats {
    fn of(forecasts: &Forecasts, seconds: f64) -> Self {
        let after = |forecast: &Forecast| forecast.error_after_seconds(4.0 * seconds);
        let milestones = |forecast: &Forecast| forecast.milestones().collect();
        let Forecasts { typical, whole } = forecasts;
        Self {
            error_after_four_times: after(whole),
            milestones: milestones(whole),
            typical: Some(TypicalForecastStats {
                error_after_four_times: after(typical),
                milestones: milestones(typical),
            }),
        }
    }
}

fn ledger_stats(job: &Job, ledger: &Ledger) -> LedgerStats {
    let names = job.scene.materials.iter().map(|material| material.name.clone());
    LedgerStats {
        emitted: ledger.emitted,
        ultraviolet: ledger.ultraviolet,
        sampling: ledger.sampling,
        absorbed: ledger.absorbed_total(),
        stokes_loss: ledger.stokes_loss,
        quantum_loss: ledger.quantum_loss,
        escaped: ledger.escaped,
        escaped_inside: ledger.escaped_inside,
        depth_limit: ledger.depth_limit,
        balance: ledger.balance(),
        lights: job.light_power_w(),
        // Objects of a crystal have materials of the same name.
        by_material: names.zip(&ledger.absorbed).fold(BTreeMap::new(), |mut sums, (name, absorbed)| {
            *sums.entry(name).or_default() += absorbed;
            sums
        }),
    }
}

fn effect_stats(job: &Job, tally: &Tally) -> BTreeMap<String, EffectStats> {
    let stats = job.rows.iter().map(|row| {
        let effect = row.effect;
        let events = (effect.events)(tally, &job.plan);
        (effect.name.to_string(), EffectStats { state: row.state.word().to_string(), events })
    });
    stats.collect()
}

/// Returns the largest resident memory of this process so far on Linux, and 0 elsewhere.
fn peak_memory_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()).and_then(|n| n.parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}
