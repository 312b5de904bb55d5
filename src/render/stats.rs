//! What a render measured: for `--stats`, headers and tests.

use super::forecast::{Forecast, Milestone};
use super::{Job, Run};
use crate::plan::{State, WavelengthPlan, explain};
use crate::sensor::picture::ErrorMeans;
use crate::sensor::{ErrorSquares, Picture};
use crate::walk::Tally;
use crate::walk::ledger::Ledger;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Wall-clock seconds by stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// From start to end.
    pub total: f64,
    /// Learning aims and radii.
    pub pilot: f64,
    /// Posing the scene.
    pub pose: f64,
    /// Photons.
    pub emit: f64,
    /// Building trees.
    pub map: f64,
    /// Camera paths.
    pub gather: f64,
    /// From sums to XYZ.
    pub develop: f64,
}

/// The ledger in W, means over passes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LedgerStats {
    /// What the lights handed out.
    pub emitted: f64,
    /// What random choices gained or lost.
    pub sampling: f64,
    /// What surfaces and bodies absorbed.
    pub absorbed: f64,
    /// What left the scene.
    pub escaped: f64,
    /// What was given up at the limit of depth.
    pub depth_limit: f64,
    /// What is missing, relative to emitted.
    pub balance: f64,
    /// The lamps' power by their closed forms.
    pub lamps: f64,
    /// What was absorbed, by material.
    pub by_material: BTreeMap<String, f64>,
}

/// Error layers' image means.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorStats {
    /// Mean standard error of Y, cd/m².
    pub noise: f64,
    /// Mean bias of Y, cd/m².
    pub bias: f64,
    /// √mean(noise² + bias²) / mean Y; `None` if unknown.
    pub relative: Option<f64>,
    /// Pixels that no light reached.
    pub unknown_pixels: usize,
    /// Pixels beside an edge of light, where the bias is likely larger than told.
    pub edge_pixels: usize,
}

/// How the error would fall if the render went on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForecastStats {
    /// The relative error after four times the time that it took.
    pub error_after_four_times: f64,
    /// When the next two round errors would be reached, counted from the beginning.
    pub milestones: Vec<Milestone>,
}

/// One effect's state and how often it was at work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectStats {
    /// `on`, `off`, `forced` or `forbidden`.
    pub state: String,
    /// Events counted.
    pub events: u64,
}

/// All that a render measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stats {
    /// Passes done.
    pub passes: u64,
    /// Photon paths emitted.
    pub photons_emitted: u64,
    /// Those of them on the passes' shared wavelengths.
    pub photons_shared: u64,
    /// Photons stored in maps.
    pub photons_stored: u64,
    /// Wall-clock seconds.
    pub seconds: Seconds,
    /// Photons emitted per second of the emission stage.
    pub photons_per_second: f64,
    /// The process's largest memory so far; 0 where the system does not tell.
    pub peak_memory_bytes: u64,
    /// Where the light went.
    pub ledger_w: LedgerStats,
    /// How wrong the picture may be.
    pub error: ErrorStats,
    /// How much less wrong it would be after more time; `None` while its error is unknown.
    pub forecast: Option<ForecastStats>,
    /// Effects by name.
    pub effects: BTreeMap<String, EffectStats>,
    /// `free`, `shared` or `both`.
    pub wavelengths: String,
    /// Contributions dropped because they were not finite, or negative; anything but 0 is a bug.
    pub rejected_samples: u64,
    /// Threads that took part.
    pub threads: usize,
}

impl Stats {
    /// What a run has measured so far, and its picture's error.
    pub(super) fn new(job: &Job, run: &Run, picture: &Picture, forecast: Option<Forecast>) -> Self {
        let emit_seconds = run.seconds.emit;
        let mut ledger = run.ledger.clone();
        ledger.scale(1.0 / run.done.max(1) as f64);
        Self {
            passes: run.done,
            photons_emitted: run.tally.photons,
            photons_shared: run.tally.shared_photons,
            photons_stored: run.tally.stored,
            seconds: run.seconds,
            photons_per_second: if emit_seconds > 0.0 { run.tally.photons as f64 / emit_seconds } else { 0.0 },
            peak_memory_bytes: peak_memory_bytes(),
            ledger_w: ledger_stats(job, &ledger),
            error: ErrorStats::of(picture),
            forecast: forecast.map(|forecast| ForecastStats::of(&forecast, run.seconds.total)),
            effects: effect_stats(job, &run.tally),
            wavelengths: explain::wavelengths_word(&job.plan).to_string(),
            rejected_samples: run.tally.rejected,
            threads: rayon::current_num_threads(),
        }
    }

    /// What several runs of one scene's passes measured together: counts and seconds are sums, the ledger the mean over all passes.
    /// The error is that of their common picture, and so is the forecast, as if one machine had done all.
    pub(super) fn together(runs: &[&Self], (picture, squares): (&Picture, Option<ErrorSquares>)) -> Self {
        let count = |of: fn(&Self) -> u64| runs.iter().map(|run| of(run)).sum::<u64>();
        let mut effects: BTreeMap<String, EffectStats> = BTreeMap::new();
        for (name, effect) in runs.iter().flat_map(|run| &run.effects) {
            let so_far = effects.get(name).map_or(0, |so_far| so_far.events);
            let EffectStats { state, events } = effect.clone();
            effects.insert(name.clone(), EffectStats { state, events: so_far + events });
        }
        let seconds = Seconds::together(runs.iter().map(|run| run.seconds));
        let emitted = count(|run| run.photons_emitted);
        let passes = count(|run| run.passes);
        let run = (passes, seconds.total, seconds.pilot);
        let forecast = squares.and_then(|squares| Forecast::without_history(squares, run));
        Self {
            passes,
            photons_emitted: emitted,
            photons_shared: count(|run| run.photons_shared),
            photons_stored: count(|run| run.photons_stored),
            seconds,
            photons_per_second: if seconds.emit > 0.0 { emitted as f64 / seconds.emit } else { 0.0 },
            peak_memory_bytes: runs.iter().map(|run| run.peak_memory_bytes).max().unwrap_or(0),
            ledger_w: LedgerStats::mean(runs),
            error: ErrorStats::of(picture),
            forecast: forecast.map(|forecast| ForecastStats::of(&forecast, seconds.total)),
            effects,
            wavelengths: runs.first().map_or(String::new(), |run| run.wavelengths.clone()),
            rejected_samples: count(|run| run.rejected_samples),
            threads: runs.iter().map(|run| run.threads).max().unwrap_or(0),
        }
    }
}

impl Seconds {
    fn together(all: impl Iterator<Item = Self>) -> Self {
        all.fold(Self::default(), |sum, more| {
            let Self { total, pilot, pose, emit, map, gather, develop } = more;
            Self {
                total: sum.total + total,
                pilot: sum.pilot + pilot,
                pose: sum.pose + pose,
                emit: sum.emit + emit,
                map: sum.map + map,
                gather: sum.gather + gather,
                develop: sum.develop + develop,
            }
        })
    }
}

impl LedgerStats {
    /// The mean over the runs' passes.
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
            sampling: mean(&|ledger| ledger.sampling),
            absorbed: mean(&|ledger| ledger.absorbed),
            escaped: mean(&|ledger| ledger.escaped),
            depth_limit: mean(&|ledger| ledger.depth_limit),
            // All runs emit the same power but for noise.
            balance: mean(&|ledger| ledger.balance),
            lamps: mean(&|ledger| ledger.lamps),
            by_material: by_material.collect(),
        }
    }
}

impl ErrorStats {
    fn of(picture: &Picture) -> Self {
        let ErrorMeans { noise, bias, relative, unknown_pixels, edge_pixels } = picture.error_means();
        Self { noise, bias, relative, unknown_pixels, edge_pixels }
    }
}

impl ForecastStats {
    fn of(forecast: &Forecast, seconds: f64) -> Self {
        let error_after_four_times = forecast.error_after_seconds(4.0 * seconds);
        Self { error_after_four_times, milestones: forecast.milestones().collect() }
    }
}

fn ledger_stats(job: &Job, ledger: &Ledger) -> LedgerStats {
    let names = job.scene.materials.iter().map(|material| material.name.clone());
    LedgerStats {
        emitted: ledger.emitted,
        sampling: ledger.sampling,
        absorbed: ledger.absorbed_total(),
        escaped: ledger.escaped,
        depth_limit: ledger.depth_limit,
        balance: ledger.balance(),
        lamps: job.lamp_power_w(),
        by_material: names.zip(ledger.absorbed.iter().copied()).collect(),
    }
}

fn effect_stats(job: &Job, tally: &Tally) -> BTreeMap<String, EffectStats> {
    let events = |name: &str| match name {
        "dispersion" => tally.dispersions,
        "shared" if job.plan.wavelengths == WavelengthPlan::Shared => tally.shared_paths,
        "caustics" => tally.connections,
        "indirect" => tally.map_queries,
        "direct" => tally.shadow_rays,
        "depth-of-field" => tally.lens_rays,
        "diffraction" if job.plan.aperture.diffracts() => tally.lens_rays,
        "environment" => tally.environment_rays,
        "roughness" => tally.rough_events,
        "bodies" => tally.body_events,
        "absorption" => tally.absorptions,
        "media" => tally.media_stretches,
        "volume-photons" => tally.volume_points,
        "photon-beams" => tally.volume_beams,
        "light-map" => tally.light_map_looks,
        "aim" => tally.aimed,
        "motion" => tally.moments,
        _ => 0,
    };
    let state = |state: State| state.word().to_string();
    job.rows
        .iter()
        .map(|row| {
            (row.effect.name.to_string(), EffectStats { state: state(row.state), events: events(row.effect.name) })
        })
        .collect()
}

/// The largest resident memory of this process so far, where Linux tells.
fn peak_memory_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()).and_then(|n| n.parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}
