//! What a render measured: for `--stats`, headers and tests.

use super::{Job, Run};
use crate::plan::{State, WavelengthPlan, explain};
use crate::sensor::Picture;
use crate::walk::Tally;
use crate::walk::ledger::Ledger;
use serde::Serialize;
use std::collections::BTreeMap;

/// Wall-clock seconds by stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// From start to end.
    pub total: f64,
    /// Learning aims and radii.
    pub pilot: f64,
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
#[derive(Debug, Clone, PartialEq, Serialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorStats {
    /// Mean standard error of Y, cd/m².
    pub noise: f64,
    /// Mean bias of Y, cd/m².
    pub bias: f64,
    /// √mean(noise² + bias²) / mean Y; `None` if unknown.
    pub relative: Option<f64>,
    /// Pixels that no light reached.
    pub unknown_pixels: usize,
}

/// One effect's state and how often it was at work.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectStats {
    /// `on`, `off`, `forced` or `forbidden`.
    pub state: &'static str,
    /// Events counted.
    pub events: u64,
}

/// All that a render measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Effects by name.
    pub effects: BTreeMap<&'static str, EffectStats>,
    /// `free`, `shared` or `both`.
    pub wavelengths: &'static str,
    /// Contributions dropped because they were not finite; anything but 0 is a bug.
    pub rejected_samples: u64,
    /// Threads that took part.
    pub threads: usize,
}

impl Stats {
    pub(super) fn new(job: &Job, run: &Run, passes: u64, picture: &Picture) -> Self {
        let error = picture.error_means();
        let emit_seconds = run.seconds.emit;
        Self {
            passes,
            photons_emitted: run.tally.photons,
            photons_shared: run.tally.shared_photons,
            photons_stored: run.tally.stored,
            seconds: run.seconds,
            photons_per_second: if emit_seconds > 0.0 { run.tally.photons as f64 / emit_seconds } else { 0.0 },
            peak_memory_bytes: peak_memory_bytes(),
            ledger_w: ledger_stats(job, &run.ledger),
            error: ErrorStats {
                noise: error.noise,
                bias: error.bias,
                relative: error.relative,
                unknown_pixels: error.unknown_pixels,
            },
            effects: effect_stats(job, &run.tally),
            wavelengths: explain::wavelengths_word(&job.plan),
            rejected_samples: run.tally.rejected,
            threads: rayon::current_num_threads(),
        }
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

fn effect_stats(job: &Job, tally: &Tally) -> BTreeMap<&'static str, EffectStats> {
    let events = |name: &str| match name {
        "dispersion" => tally.dispersions,
        "shared" if job.plan.wavelengths == WavelengthPlan::Shared => tally.shared_paths,
        "caustics" => tally.connections,
        "indirect" => tally.map_queries,
        "direct" => tally.shadow_rays,
        "depth-of-field" => tally.lens_rays,
        "environment" => tally.environment_rays,
        "roughness" => tally.rough_events,
        "absorption" => tally.absorptions,
        "aim" => tally.aimed,
        _ => 0,
    };
    let state = |state: State| state.word();
    job.rows
        .iter()
        .map(|row| (row.effect.name, EffectStats { state: state(row.state), events: events(row.effect.name) }))
        .collect()
}

/// The largest resident memory of this process so far, where Linux tells.
fn peak_memory_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()).and_then(|n| n.parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}
